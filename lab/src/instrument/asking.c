#include "instrument/asking.h"

#include <math.h>

void dea_asking_start(struct dea_asking *asking, double now_s)
{
  for (size_t i = 0; i < asking->count; i++) {
    asking->due_s[i] = now_s;
  }
}

bool dea_asking_next(struct dea_asking *asking, double now_s, double *next_s)
{
  size_t first = 0;
  for (size_t i = 1; i < asking->count; i++) {
    first = asking->due_s[i] < asking->due_s[first] ? i : first;
  }
  if (asking->count == 0 || asking->due_s[first] > now_s) {
    *next_s = asking->count == 0 ? (double)INFINITY : asking->due_s[first];
    return false;
  }
  asking->reading = first;
  asking->asked_s = now_s;
  // One that takes longer than the interval is asked again at once, not for what was missed.
  asking->due_s[first] = fmax(asking->due_s[first] + asking->interval_s, now_s);
  *next_s = now_s + asking->timeout_s;
  return true;
}

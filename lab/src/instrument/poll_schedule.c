#include "instrument/poll_schedule.h"

#include <math.h>

void dea_poll_schedule_start(struct dea_poll_schedule *schedule, double now_s)
{
  for (size_t i = 0; i < schedule->count; i++) {
    schedule->due_s[i] = now_s;
  }
}

bool dea_poll_schedule_next(struct dea_poll_schedule *schedule, double now_s, double *next_s)
{
  size_t first = 0;
  for (size_t i = 1; i < schedule->count; i++) {
    first = schedule->due_s[i] < schedule->due_s[first] ? i : first;
  }
  if (schedule->count == 0 || schedule->due_s[first] > now_s) {
    *next_s = schedule->count == 0 ? (double)INFINITY : schedule->due_s[first];
    return false;
  }
  schedule->reading = first;
  schedule->asked_s = now_s;
  // One that takes longer than the interval is asked again at once, not for what was missed.
  schedule->due_s[first] = fmax(schedule->due_s[first] + schedule->interval_s, now_s);
  *next_s = now_s + schedule->timeout_s;
  return true;
}

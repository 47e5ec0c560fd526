/* Fuzz target: a Gocator's lines of text, whole and in pieces. */
#include "fuzz.h"

#include "instrument/gocator_parse.h"
#include "lines.h"

#include <math.h>

struct seen {
  size_t dropped, values, refused;
  double sum;
};

static void take(void *user, const char *line)
{
  struct seen *s = user;
  const char *reason;
  struct dea_gocator_value value;
  size_t most = strlen(line);
  s->refused += dea_gocator_refused(line, &reason);
  while (dea_gocator_value_next(&line, &value)) {
    s->values++;
    s->sum += isnan(value.thousandths) ? 1 : value.thousandths;
    if (most-- == 0 || value.id < 0) {
      __builtin_trap(); // more values than letters
    }
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct seen whole = {0}, pieces = {0};
  feed_lines(data, size, size + 1, &whole.dropped, take, &whole);
  feed_lines(data, size, 1, &pieces.dropped, take, &pieces);
  if (whole.values != pieces.values || whole.refused != pieces.refused ||
      whole.dropped != pieces.dropped || (whole.sum != pieces.sum && !isnan(whole.sum))) {
    __builtin_trap(); // how it is cut must not matter
  }
  return 0;
}

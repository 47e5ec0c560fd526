/* Fuzz target: a Gocator's lines of text, whole and in pieces. */
#include "lab/instrument/gocator_parse.h"
#include "lab/instrument/line_reader.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct stream {
  struct dea_line_reader reader;
  size_t values, refused;
  double sum;
};

static void feed(struct stream *s, const char *bytes, size_t length)
{
  const char *line, *reason;
  while ((line = dea_line_next(&s->reader, &bytes, &length)) != NULL) {
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
  if (length > 0) {
    __builtin_trap();
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static struct stream whole, pieces;
  const char *text = (const char *)data;
  memset(&whole, 0, sizeof whole);
  memset(&pieces, 0, sizeof pieces);
  feed(&whole, text, size);
  for (size_t at = 0; at < size; at++) {
    feed(&pieces, text + at, 1);
  }
  if (whole.values != pieces.values || whole.refused != pieces.refused ||
      whole.reader.dropped != pieces.reader.dropped ||
      (whole.sum != pieces.sum && !isnan(whole.sum))) {
    __builtin_trap();
  }
  return 0;
}

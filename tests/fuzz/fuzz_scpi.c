/* Fuzz target: answers of SCPI instruments, whole and in pieces. */
#include "lab/instrument/line_reader.h"
#include "lab/instrument/scpi_parse.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct stream {
  struct dea_line_reader reader;
  size_t lines, numbers, errors;
  double sum;
};

static void feed(struct stream *s, const char *bytes, size_t length)
{
  const char *line, *text;
  while ((line = dea_line_next(&s->reader, &bytes, &length)) != NULL) {
    double value = 0;
    int code = 0;
    s->lines++;
    s->numbers += dea_scpi_number(line, &value);
    s->errors += dea_scpi_error(line, &code, &text);
    s->sum += (isnan(value) ? 1 : value) + code;
    if (isinf(value) || fabs(value) > 9.9e37) {
      __builtin_trap(); // SCPI's infinity is no number
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
  if (whole.lines != pieces.lines || whole.numbers != pieces.numbers ||
      whole.errors != pieces.errors || whole.reader.dropped != pieces.reader.dropped ||
      whole.sum != pieces.sum) {
    __builtin_trap();
  }
  return 0;
}

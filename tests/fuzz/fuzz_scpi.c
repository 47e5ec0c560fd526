/* Fuzz target: answers of SCPI instruments, whole and in pieces. */
#include "fuzz.h"

#include "instrument/scpi_parse.h"
#include "lines.h"

#include <math.h>

struct seen {
  size_t dropped, lines, numbers, errors;
  double sum;
};

static void take(void *user, const char *line)
{
  struct seen *s = user;
  const char *text;
  char with_unit[DEA_SCPI_VALUE_SIZE];
  double value = 0;
  int code = 0;
  s->lines++;
  for (size_t field = dea_scpi_fields(line); field < (size_t)-1; field--) {
    s->numbers +=
        dea_scpi_number(line, field, &value) && dea_scpi_with_unit(line, field, with_unit);
  }
  s->errors += dea_scpi_error(line, &code, &text);
  s->sum += (isnan(value) ? 1 : value) + code;
  if (fabs(value) > 9.9e37) {
    __builtin_trap(); // SCPI's infinity is no number
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct seen whole = {0}, pieces = {0};
  feed_lines(data, size, size + 1, &whole.dropped, take, &whole);
  feed_lines(data, size, 1, &pieces.dropped, take, &pieces);
  if (whole.lines != pieces.lines || whole.numbers != pieces.numbers ||
      whole.errors != pieces.errors || whole.dropped != pieces.dropped || whole.sum != pieces.sum) {
    __builtin_trap(); // how it is cut must not matter
  }
  return 0;
}

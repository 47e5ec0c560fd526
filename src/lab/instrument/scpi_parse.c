#include "lab/instrument/scpi_parse.h"

#include "base/text.h"

#include <math.h>
#include <string.h>

static const double not_a_value = 9.8e37; // what SCPI keeps for that begins at 9.9e37

bool dea_scpi_number(const char *answer, double *value)
{
  const char *end;
  answer += strspn(answer, " \t");
  if (answer[0] == '\0' || strchr("+-.0123456789", answer[0]) == NULL) {
    return false;
  }
  double number = dea_text_to_double(answer, &end);
  if (end == answer || (*end != '\0' && strchr(".+-_:", *end) != NULL)) {
    return false; // nothing, or a date, a time, a version
  }
  *value = fabs(number) < not_a_value ? number : NAN;
  return true;
}

void dea_scpi_suffix(const char *answer, char out[DEA_SCPI_SUFFIX_SIZE])
{
  double value;
  const char *end = answer + strspn(answer, " \t");
  size_t n = 0;
  if (dea_scpi_number(answer, &value)) {
    dea_text_to_double(end, &end);
    for (; *end != '\0' && *end != ',' && *end != ';' && n + 1 < DEA_SCPI_SUFFIX_SIZE; end++) {
      out[n] = *end;
      n += *end != ' ' && *end != '\t';
    }
  }
  out[n] = '\0';
}

bool dea_scpi_error(const char *answer, int *code, const char **text)
{
  const char *end;
  answer += strspn(answer, " \t");
  double number = dea_text_to_double(answer, &end);
  if (end == answer || !(fabs(number) < 1e6) || (*end != ',' && *end != '\0')) {
    return false;
  }
  *code = (int)number;
  *text = *end == ',' ? end + 1 : end;
  return true;
}

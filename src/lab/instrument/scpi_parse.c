#include "lab/instrument/scpi_parse.h"

#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

static const double not_a_value = 9.8e37; // what SCPI keeps for that begins at 9.9e37

bool dea_scpi_number(const char *response, double *value)
{
  const char *end;
  response += strspn(response, " \t");
  if (response[0] == '\0' || strchr("+-.0123456789", response[0]) == NULL) {
    return false;
  }
  double number = dea_text_to_double(response, &end);
  if (end == response || (*end != '\0' && strchr(".+-_:", *end) != NULL)) {
    return false; // nothing, or a date, a time, a version
  }
  *value = fabs(number) < not_a_value ? number : NAN;
  return true;
}

void dea_scpi_suffix(const char *response, char out[DEA_SCPI_SUFFIX_SIZE])
{
  double value;
  const char *end = response + strspn(response, " \t");
  size_t n = 0;
  if (dea_scpi_number(response, &value)) {
    dea_text_to_double(end, &end);
    for (; *end != '\0' && *end != ',' && *end != ';' && n + 1 < DEA_SCPI_SUFFIX_SIZE; end++) {
      out[n] = *end;
      n += *end != ' ' && *end != '\t';
    }
  }
  out[n] = '\0';
}

bool dea_scpi_error(const char *response, int *code, const char **text)
{
  const char *end;
  response += strspn(response, " \t");
  double number = dea_text_to_double(response, &end);
  if (end == response || !(fabs(number) < 1e6) || (*end != ',' && *end != '\0')) {
    return false;
  }
  *code = (int)number;
  *text = *end == ',' ? end + 1 : end;
  return true;
}

bool dea_scpi_output_is_plain(const char *output)
{
  const char *hole = strchr(output, '%');
  return hole != NULL && hole > output && hole[1] == 'g' && strchr(hole + 1, '%') == NULL &&
         strchr(" ,", hole[-1]) != NULL && strchr(",", hole[2]) != NULL &&
         strchr(output, ';') == NULL;
}

static bool same_letters(const char *a, const char *b, size_t length)
{
  for (size_t i = 0; i < length; i++) {
    if (a[i] == '\0' || tolower((unsigned char)a[i]) != tolower((unsigned char)b[i])) {
      return false;
    }
  }
  return true;
}

static bool has_number(const char *text)
{
  double value;
  return dea_scpi_number(text, &value) && value != 0; // NAN is one too
}

/* The last mnemonic of a header "SOUR:VOLT" that has `length` bytes; *count: letters of it. */
static const char *last_mnemonic(const char *header, size_t length, size_t *count)
{
  size_t start = length;
  while (start > 0 && header[start - 1] != ':') {
    start--;
  }
  *count = length - start < 4 ? length - start : 4;
  return header + start;
}

/* Whether one of the values of a command, behind blanks or commas, is a number. */
static bool has_any_number(const char *values)
{
  for (const char *at = values; *at != '\0' && *at != ';';) {
    at += strspn(at, " \t,");
    if (has_number(at)) {
      return true;
    }
    at += strcspn(at, " \t,;");
  }
  return false;
}

/* One command of a line. */
static bool sets(const char *command, const char *output)
{
  size_t before = (size_t)(strchr(output, '%') - output), count, wanted;
  size_t header = strcspn(command, " \t;"), other = strcspn(output, " \t");
  const char *mine = last_mnemonic(command, header, &count);
  const char *set = last_mnemonic(output, other, &wanted);
  if (same_letters(command, output, before)) {
    return has_number(command + before);
  }
  if (count != wanted || !same_letters(mine, set, wanted)) {
    return false;
  }
  // "BSWV OFST,%g": it may be called by other words too, "BSWV WVTP,DC,OFST,5", "BSWV HLEV,5"
  return other + 1 == before ? has_number(command + header) : has_any_number(command + header);
}

bool dea_scpi_sets_output(const char *command, const char *output)
{
  for (; command != NULL; command = strchr(command, ';')) {
    command += strspn(command, "; \t");
    if (sets(command + strspn(command, ":"), output + strspn(output, ":"))) {
      return true;
    }
  }
  return false;
}

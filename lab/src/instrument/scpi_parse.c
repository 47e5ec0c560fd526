#include "instrument/scpi_parse.h"

#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double not_a_value = 9.8e37; // what SCPI keeps for that begins at 9.9e37

/* A number at the begin of a text, and where it ends. */
static bool read_number(const char *response, double *value, const char **behind)
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
  *behind = end;
  return true;
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

/* Where a field begins, from 1 on; 0: the only one. NULL: there is none. */
static const char *find_field(const char *response, size_t field)
{
  if (field == 0 && dea_scpi_fields(response) > 1) {
    return NULL;
  }
  for (size_t i = 1; i < field; i++) {
    response += strcspn(response, ",;");
    if (*response == '\0') {
      return NULL;
    }
    response++;
  }
  return response;
}

static bool is_digit(char c)
{
  return isdigit((unsigned char)c) != 0;
}

/* Whether the comma at `comma` may be a decimal one: digits alone before it, one behind it. */
static bool may_be_decimal(const char *response, const char *comma)
{
  const char *at = comma;
  while (at > response && is_digit(at[-1])) {
    at--;
  }
  bool digits = at < comma;
  while (at > response && strchr(" \t+-", at[-1]) != NULL) {
    at--;
  }
  return *comma == ',' && is_digit(comma[1]) && digits &&
         (at == response || strchr(",;", at[-1]) != NULL);
}

/* The number of a field, and where it ends. */
static const char *field_number(const char *response, size_t field, double *value,
                                const char **behind)
{
  const char *number = find_field(response, field);
  return number != NULL && read_number(number, value, behind) &&
                 !may_be_decimal(response, *behind) &&
                 !(number > response && may_be_decimal(response, number - 1))
             ? number
             : NULL;
}

bool dea_scpi_number(const char *response, size_t field, double *value)
{
  const char *behind;
  return field_number(response, field, value, &behind) != NULL;
}

size_t dea_scpi_fields(const char *response)
{
  size_t count = 1;
  for (; *response != '\0'; response++) {
    count += *response == ',' || *response == ';';
  }
  return count;
}

bool dea_scpi_voltage(const char *response, size_t field, bool in_V, bool in_kV, double *value)
{
  char suffix[DEA_SCPI_SUFFIX_SIZE];
  dea_scpi_suffix(response, field, suffix);
  bool kilo = suffix[0] == 'k' || suffix[0] == 'K', none = suffix[0] == '\0';
  const char *unit = suffix + kilo;
  size_t length = strlen(unit);
  bool volts = (length == 1 || length == 3) && same_letters("VDC", unit, length);
  return dea_scpi_number(response, field, value) && !isnan(*value) &&
         (none || (volts && (kilo ? in_kV : in_V)));
}

void dea_scpi_suffix(const char *response, size_t field, char out[DEA_SCPI_SUFFIX_SIZE])
{
  double value;
  const char *end = "";
  size_t n = 0;
  if (field_number(response, field, &value, &end) == NULL) {
    end = "";
  }
  for (; *end != '\0' && *end != ',' && *end != ';' && n + 1 < DEA_SCPI_SUFFIX_SIZE; end++) {
    out[n] = *end;
    n += *end != ' ' && *end != '\t';
  }
  out[n] = '\0';
}

bool dea_scpi_with_unit(const char *response, size_t field, char out[DEA_SCPI_VALUE_SIZE])
{
  double value;
  char suffix[DEA_SCPI_SUFFIX_SIZE], *unit = suffix;
  const char *end, *number = field_number(response, field, &value, &end);
  if (number == NULL) {
    return false;
  }
  dea_scpi_suffix(response, field, suffix);
  size_t length = strlen(unit);
  if (length > 2 && strcmp(unit + length - 2, "DC") == 0) {
    unit[length -= 2] = '\0';
    unit += length == 2 && unit[0] == 'N'; // NADC, NVDC: normal
  }
  if (unit[0] == 'M' && isupper((unsigned char)unit[1]) && unit[2] == '\0') {
    return false;
  }
  number += strspn(number, " \t");
  snprintf(out, DEA_SCPI_VALUE_SIZE, "%.*s %s", (int)(end - number < 60 ? end - number : 60),
           number, unit);
  return true;
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
  return hole != NULL && dea_scpi_is_one_line(output) && hole > output && hole[1] == 'g' &&
         strchr(hole + 1, '%') == NULL && strchr(" ,", hole[-1]) != NULL &&
         strchr(",", hole[2]) != NULL && strchr(output, ';') == NULL;
}

/* Whether a value is something other than 0: a number, or a word such as MAX, UP, DEF. ON and OFF
 * switch what was set, and set no number. */
static bool is_not_zero(const char *value)
{
  double number;
  const char *behind;
  value += strspn(value, " \t");
  size_t word = strcspn(value, " \t,;");
  bool switches =
      (word == 2 && same_letters(value, "ON", 2)) || (word == 3 && same_letters(value, "OFF", 3));
  return word > 0 && !switches &&
         !(read_number(value, &number, &behind) && number == 0); // NAN is no 0
}

static bool has_number(const char *text)
{
  double value;
  const char *behind;
  return read_number(text, &value, &behind) && value != 0; // NAN is one too
}

/* The last mnemonic of a header "SOUR:VOLT" that has `length` bytes; *count: letters of it. Those
 * that SCPI lets go at the end, [:LEVel][:IMMediate][:AMPLitude], are let go. */
static const char *last_mnemonic(const char *header, size_t length, size_t *count)
{
  static const char *const optional[] = {"LEV", "IMM", "AMPL"};
  for (bool more = true; more;) {
    size_t start = length;
    while (start > 0 && header[start - 1] != ':') {
      start--;
    }
    more = false;
    for (size_t i = 0; i < sizeof optional / sizeof optional[0] && start > 1; i++) {
      size_t letters = strlen(optional[i]);
      more =
          more || (length - start >= letters && same_letters(header + start, optional[i], letters));
    }
    if (!more) {
      *count = length - start < 4 ? length - start : 4;
      return header + start;
    }
    length = start - 1;
  }
  return header;
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
  if (memchr(command, '?', header) != NULL) {
    return false;
  }
  if (same_letters(command, "*RCL", 4)) { // what was stored may have any voltage
    return true;
  }
  if (same_letters(command, "APPL", 4)) { // all at once
    return has_any_number(command + header);
  }
  const char *mine = last_mnemonic(command, header, &count);
  const char *set = last_mnemonic(output, other, &wanted);
  if (same_letters(command, output, before)) {
    return is_not_zero(command + before);
  }
  if (count != wanted || !same_letters(mine, set, wanted)) {
    return false;
  }
  // "BSWV OFST,%g": it may be called by other words too, "BSWV WVTP,DC,OFST,5", "BSWV HLEV,5"
  return other + 1 == before ? is_not_zero(command + header) : has_any_number(command + header);
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

bool dea_scpi_configures(const char *command)
{
  command += strspn(command, ": \t");
  return strchr(command, ';') == NULL &&
         (same_letters(command, "CONF", 4) || same_letters(command, "SENS", 4));
}

bool dea_scpi_is_one_line(const char *command)
{
  while (*command != '\0' && (*command == '\t' || !iscntrl((unsigned char)*command))) {
    command++;
  }
  return *command == '\0';
}

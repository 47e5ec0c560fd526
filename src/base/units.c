#define _POSIX_C_SOURCE 200809L // pthread_mutex_t
#include "base/units.h"

#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <udunits2.h>

enum { UNIT_TEXT_MAX = 40 };

/* udunits2 keeps its error handler, its status and its parser in global variables; this lock lets
 * contexts of several threads read at the same time. */
static pthread_mutex_t udunits_lock = PTHREAD_MUTEX_INITIALIZER;

static ut_error_message_handler lock_udunits(void)
{
  pthread_mutex_lock(&udunits_lock);
  return ut_set_error_message_handler(ut_ignore);
}

static void unlock_udunits(ut_error_message_handler handler)
{
  ut_set_error_message_handler(handler);
  pthread_mutex_unlock(&udunits_lock);
}

/* Freeing a table takes it out of udunits2's list of all tables, so that too is locked. */
static void release_system(void *system)
{
  ut_error_message_handler handler = lock_udunits();
  ut_free_system(system);
  unlock_udunits(handler);
}

/* The table of udunits2, and the short word for its degree of an angle. NULL: it cannot be read. */
static ut_system *read_system(void)
{
  ut_system *system = ut_read_xml(NULL);
  ut_unit *degree = system != NULL ? ut_get_unit_by_name(system, "degree") : NULL;
  if (degree != NULL) {
    ut_map_name_to_unit("deg", UT_ASCII, degree);
  }
  ut_free(degree);
  return system;
}

/* The unit table of the context, read on first use (5 ms). */
static ut_system *system_get(struct dea_context *ctx)
{
  ut_system *system = dea_context_kept(ctx, release_system);
  if (system != NULL) {
    return system;
  }
  ut_error_message_handler handler = lock_udunits();
  system = read_system();
  unlock_udunits(handler);
  if (system == NULL) {
    dea_fail(ctx, DEA_E_TOOL, "the unit database of udunits2 cannot be read");
    return NULL;
  }
  return dea_context_keep(ctx, system, release_system) == DEA_OK ? system : NULL;
}

/* Names of the dimensions that designs use, for messages. */
static const struct {
  const char *unit, *name;
} dimensions[] = {
    {"m", "a length"},
    {"V", "a voltage"},
    {"V/m", "an electric field"},
    {"Pa", "a pressure"},
    {"kg/m^3", "a density"},
    {"radian", "an angle"},
    {"s", "a time"},
    {"Hz", "a frequency"},
    {"N", "a force"},
    {"N/m", "a force per length"},
    {"kg", "a mass"},
    {"A", "a current"},
    {"K", "a temperature"},
    {"m^2", "an area"},
    {"m^3", "a volume"},
    {"J", "an energy"},
    {"F", "a capacitance"},
    {"ohm", "a resistance"},
    {"ohm m", "a resistivity"},
    {"V/s", "a rate of voltage"},
};

static const char *dimension_name(const char *unit)
{
  for (size_t i = 0; i < sizeof dimensions / sizeof dimensions[0]; i++) {
    if (strcmp(dimensions[i].unit, unit) == 0) {
      return dimensions[i].name;
    }
  }
  return "a value";
}

/* Name of the dimension of a parsed unit, or NULL. */
static const char *dimension_of(const ut_system *system, const ut_unit *unit)
{
  const char *name = NULL;
  for (size_t i = 0; name == NULL && i < sizeof dimensions / sizeof dimensions[0]; i++) {
    ut_unit *other = ut_parse(system, dimensions[i].unit, UT_UTF8);
    if (other != NULL && ut_are_convertible(unit, other) != 0) {
      name = dimensions[i].name;
    }
    ut_free(other);
  }
  return name;
}

/* udunits2 also reads "5 um", "s since 2000", "lg(re mW)" and the like as units. Only products and
 * quotients of named units with small powers are units here. */
static bool is_plain_unit(const char *text)
{
  bool after_name = false;
  if (strlen(text) > UNIT_TEXT_MAX) {
    return false;
  }
  for (const char *c = text; *c != '\0'; c++) {
    unsigned char byte = (unsigned char)*c;
    if (isalpha(byte) || byte >= 0x80 || byte == '%') {
      after_name = true;
    } else if (isdigit(byte) || byte == '^' || byte == '-') {
      if (!after_name || (isdigit(byte) && isdigit((unsigned char)c[1]))) {
        return false;
      }
    } else if (byte == '/' || byte == '*' || byte == '.' || byte == ' ') {
      after_name = false;
    } else {
      return false;
    }
  }
  return text[0] != '\0' && strstr(text, "since") == NULL && strstr(text, "ref") == NULL &&
         strstr(text, "from") == NULL && strstr(text, "after") == NULL;
}

const char *dea_units_shown(const char *example, size_t *length)
{
  const char *end;
  dea_text_to_double(example + strspn(example, "["), &end);
  end += strspn(end, " ");
  *length = strcspn(end, ",]");
  return end;
}

/* The number at the head of text; *unit is what follows it, trimmed at the front. */
static bool read_number(const char *text, const struct dea_measure *due, double *value,
                        const char **unit, char why[DEA_WHY_SIZE])
{
  const char *c = text + (*text == '-' || *text == '+');
  bool digits = isdigit((unsigned char)c[0]) || (c[0] == '.' && isdigit((unsigned char)c[1]));
  bool hexadecimal = c[0] == '0' && (c[1] == 'x' || c[1] == 'X');
  if (!digits || hexadecimal) {
    char word[4] = {0};
    for (size_t i = 0; i < 3 && c[i] != '\0'; i++) {
      word[i] = (char)tolower((unsigned char)c[c[0] == '.' ? i + 1 : i]);
    }
    bool special = strcmp(word, "nan") == 0 || strcmp(word, "inf") == 0;
    snprintf(why, DEA_WHY_SIZE,
             special ? "'%.60s' is not a finite number; write for example '%s'"
                     : "'%.60s' is not a number; write for example '%s'",
             text, due->example);
    return false;
  }
  *value = dea_text_to_double(text, unit);
  if (!isfinite(*value)) {
    snprintf(why, DEA_WHY_SIZE, "'%.60s' is too large for a number", text);
    return false;
  }
  if (**unit == ',') {
    snprintf(why, DEA_WHY_SIZE, "'%.60s' has a comma; write the decimal sign as a point", text);
    return false;
  }
  while (**unit == ' ' || **unit == '\t') {
    ++*unit;
  }
  return true;
}

/* Says why a unit (NULL: not known) is not the one due. Naming its dimension parses a unit for each
 * one known, which is why it is done for bad units only. */
static void explain_unit(const ut_system *system, const char *text, const char *unit,
                         const ut_unit *from, const struct dea_measure *due, char why[DEA_WHY_SIZE])
{
  const char *name = unit != NULL && unit[0] == '%' ? "a percentage" // not the angle that it is too
                     : from != NULL                 ? dimension_of(system, from)
                                                    : NULL;
  if (name != NULL && strcmp(name, "an angle") == 0 && strchr(unit, '/') != NULL) {
    name = "a ratio"; // kV/V
  }
  if (from == NULL) {
    snprintf(why, DEA_WHY_SIZE, "'%.40s' in '%.60s' is not a known unit; write for example '%s'",
             unit, text, due->example);
  } else if (strcmp(due->unit, "1") == 0) {
    snprintf(why, DEA_WHY_SIZE, "'%.60s' is %s, but a number without a unit is due, such as '%s'",
             text, name != NULL ? name : "a value with a unit", due->example);
  } else {
    snprintf(why, DEA_WHY_SIZE, "'%.60s' is %s, but %s is due, such as '%s'", text,
             name != NULL ? name : "of another dimension", dimension_name(due->unit), due->example);
  }
}

/* Compares the unit with the one due and converts. */
static bool convert(const ut_system *system, const char *text, const char *unit, double value,
                    const struct dea_measure *due, double *si, char why[DEA_WHY_SIZE])
{
  ut_unit *from = ut_parse(system, unit, UT_UTF8), *to = ut_parse(system, due->unit, UT_UTF8);
  bool number_due = strcmp(due->unit, "1") == 0, percent = unit[0] == '%';
  size_t length;
  const char *shown = dea_units_shown(due->example, &length);
  bool as_shown = strlen(unit) == length && memcmp(unit, shown, length) == 0;
  bool known = from != NULL && to != NULL && ut_are_convertible(from, to) != 0 &&
               !(number_due && !as_shown) && !(strcmp(due->unit, "radian") == 0 && percent);
  cv_converter *converter = known ? ut_get_converter(from, to) : NULL;
  if (converter != NULL && cv_convert_double(converter, 2) < cv_convert_double(converter, 1)) {
    cv_free(converter); // udunits takes 2 s for 0.5 Hz; who writes that means something else
    converter = NULL;
    known = false;
  }
  if (!known) {
    explain_unit(system, text, unit, from, due, why);
  }
  if (converter != NULL) {
    *si = cv_convert_double(converter, value);
    cv_free(converter);
  }
  ut_free(from);
  ut_free(to);
  return converter != NULL;
}

/* Says that a number lacks its unit. Of a voltage who follows the advice is safe: V comes first,
 * and a bare 8000 is not made 8000 kV. */
static void explain_bare(const char *text, double value, const struct dea_measure *due,
                         char why[DEA_WHY_SIZE])
{
  static const double least_V = 100; // below it a number may have been meant in kV
  static const double least = 1e-3;  // below it one in um or mm was meant in SI
  size_t length;
  const char *unit = dea_units_shown(due->example, &length);
  if (value != 0 && fabs(value) < least) {
    unit = due->unit;
    length = strlen(unit);
  }
  bool voltage = strcmp(due->unit, "V") == 0, other = voltage && fabs(value) < least_V;
  int used = snprintf(
      why, DEA_WHY_SIZE, "'%.60s' has no unit: %s is due; write for example '%.40s %.*s'", text,
      dimension_name(due->unit), text, voltage ? 1 : (int)length, voltage ? "V" : unit);
  if (other && !(length == 1 && *unit == 'V')) {
    snprintf(why + used, DEA_WHY_SIZE - (size_t)used, " or '%.40s %.*s'", text, (int)length, unit);
  }
}

bool dea_units_read(struct dea_context *ctx, const char *text, struct dea_measure due, double *si,
                    char why[DEA_WHY_SIZE])
{
  double value;
  const char *unit;
  why[0] = '\0';
  if (!read_number(text, &due, &value, &unit, why)) {
    return false;
  }
  if (*unit == '\0') {
    if (strcmp(due.unit, "1") == 0) {
      *si = value;
      return true;
    }
    explain_bare(text, value, &due, why);
    return false;
  }
  if (!is_plain_unit(unit)) {
    snprintf(why, DEA_WHY_SIZE, "'%.60s' is not a number with a unit; write for example '%s'", text,
             due.example);
    return false;
  }
  ut_system *system = system_get(ctx);
  if (system == NULL) {
    return false;
  }
  ut_error_message_handler handler = lock_udunits();
  bool read = convert(system, text, unit, value, &due, si, why);
  unlock_udunits(handler);
  if (read && !isfinite(*si)) {
    snprintf(why, DEA_WHY_SIZE, "'%.60s' is too large for a number", text);
    return false;
  }
  if (!read && why[0] == '\0') {
    dea_fail(ctx, DEA_E_MEMORY, "out of memory in udunits2");
  }
  return read;
}

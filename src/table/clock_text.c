#define _DEFAULT_SOURCE // timegm
#include "table/clock_text.h"

#include <time.h>

static const double day_s = 86400;

/* Digits at the start, `least` to `most` of them; takes them out of the field. */
static bool read_digits(struct dea_slice *field, size_t least, size_t most, int *value)
{
  size_t n = 0;
  *value = 0;
  while (n < field->length && n < most && field->text[n] >= '0' && field->text[n] <= '9') {
    *value = 10 * *value + (field->text[n++] - '0');
  }
  field->text += n;
  field->length -= n;
  return n >= least;
}

static bool read_letter(struct dea_slice *field, const char *one_of, char *found)
{
  for (const char *c = one_of; *c != '\0' && field->length > 0; c++) {
    if (field->text[0] == *c) {
      *found = *c;
      field->text++;
      field->length--;
      return true;
    }
  }
  return false;
}

/* Days since 1970-01-01; false: there is no such day. */
static bool days_of(int year, int month, int day, double *days)
{
  struct tm date = {.tm_year = year - 1900, .tm_mon = month - 1, .tm_mday = day};
  *days = (double)timegm(&date) / day_s; // carries a 31st of April over
  return year >= 1900 && year <= 2200 && date.tm_mon == month - 1 && date.tm_mday == day;
}

/* A date and what parts it from the time; true and nothing taken when there is none. */
static bool read_date(struct dea_slice *field, double *days, bool *dated)
{
  struct dea_slice rest = *field;
  int a, b, c;
  char mark = '\0', again = '\0', gap;
  *days = 0;
  *dated = read_digits(&rest, 1, 4, &a) && read_letter(&rest, "-/.", &mark);
  if (!*dated) {
    return true;
  }
  bool year_first = field->length > 4 && field->text[4] == mark;
  bool good = read_digits(&rest, 1, 2, &b) && read_letter(&rest, "-/.", &again) && again == mark &&
              read_digits(&rest, year_first ? 1 : 4, year_first ? 2 : 4, &c) &&
              read_letter(&rest, " T", &gap) && (year_first ? mark != '.' : mark == '.');
  *field = rest;
  return good && (year_first ? days_of(a, b, c, days) : days_of(c, b, a, days));
}

/* Digits behind the point. */
static double read_part(struct dea_slice *field)
{
  double value = 0, unit = 1;
  int digit;
  while (read_digits(field, 1, 1, &digit)) {
    value = 10 * value + digit;
    unit *= 10;
  }
  return value / unit;
}

/* "Z", "+01:00", "-0330" or "+01" in seconds; true and nothing taken for anything else. */
static bool read_zone(struct dea_slice *field, double *zone_s)
{
  int hours, minutes = 0;
  char mark;
  *zone_s = 0;
  if (read_letter(field, "Z", &mark) || !read_letter(field, "+-", &mark)) {
    return true;
  }
  double sign = mark == '-' ? -1 : 1;
  bool good = read_digits(field, 2, 2, &hours);
  if (good && field->length > 0) {
    read_letter(field, ":", &mark);
    good = read_digits(field, 2, 2, &minutes);
  }
  *zone_s = good ? sign * (3600.0 * hours + 60.0 * minutes) : 0;
  return good;
}

bool dea_clock_text(struct dea_slice field, double *days, double *seconds, bool *dated)
{
  int hours, minutes, whole;
  double part = 0, zone_s = 0;
  char mark;
  field = dea_slice_trim(field);
  if (!read_date(&field, days, dated)) {
    return false;
  }
  field = dea_slice_trim(field);
  if (!read_digits(&field, 1, 2, &hours) || !read_letter(&field, ":", &mark) ||
      !read_digits(&field, 2, 2, &minutes) || !read_letter(&field, ":", &mark) ||
      !read_digits(&field, 2, 2, &whole) || hours > 23 || minutes > 59 || whole > 60) {
    return false;
  }
  if (read_letter(&field, ".,", &mark)) {
    part = read_part(&field);
  }
  if (*dated && !read_zone(&field, &zone_s)) {
    return false;
  }
  *seconds = 3600.0 * hours + 60.0 * minutes + whole + part - zone_s;
  return field.length == 0;
}

bool dea_text_clock_next(struct dea_text_clock *clock, struct dea_slice field, double fraction_s,
                         double *seconds)
{
  double days, now_s;
  bool dated, first = !clock->begun;
  if (!dea_clock_text(field, &days, &now_s, &dated) || (clock->begun && dated != clock->dated)) {
    return false;
  }
  now_s += fraction_s;
  if (first) {
    *clock = (struct dea_text_clock){true, dated, days, now_s, now_s, 0, -1, false};
  }
  clock->midnights += !dated && now_s < clock->last_s - 0.5 * day_s;
  clock->last_s = now_s;
  *seconds = (days - clock->first_day + clock->midnights) * day_s + (now_s - clock->first_s);
  clock->stands = clock->stands || !(*seconds > clock->before_s);
  clock->before_s = first ? -1 : *seconds;
  return true;
}

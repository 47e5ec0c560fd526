#include "table/slices.h"

#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

bool dea_lines_next(struct dea_lines *lines, struct dea_slice *line)
{
  if (lines->next >= lines->end) {
    return false;
  }
  size_t left = (size_t)(lines->end - lines->next);
  const char *stop = memchr(lines->next, '\n', left);
  size_t length = stop != NULL ? (size_t)(stop - lines->next) : left;
  *line = (struct dea_slice){lines->next, length};
  lines->next += length + (stop != NULL);
  lines->line++;
  if (length > 0 && line->text[length - 1] == '\r') {
    line->length--;
  }
  return true;
}

static bool is_blank(char c)
{
  return c == ' ' || c == '\t' || c == '\r';
}

struct dea_slice dea_slice_trim(struct dea_slice slice)
{
  while (slice.length > 0 && is_blank(slice.text[0])) {
    slice.text++;
    slice.length--;
  }
  while (slice.length > 0 && is_blank(slice.text[slice.length - 1])) {
    slice.length--;
  }
  return slice;
}

bool dea_slice_starts(struct dea_slice slice, const char *with)
{
  size_t n = strlen(with);
  return slice.length >= n && strncasecmp(slice.text, with, n) == 0;
}

bool dea_slice_is(struct dea_slice slice, const char *word)
{
  return slice.length == strlen(word) &&
         (slice.length == 0 || strncasecmp(slice.text, word, slice.length) == 0);
}

size_t dea_slice_find(struct dea_slice slice, const char *part)
{
  size_t n = strlen(part);
  for (size_t i = 0; i + n <= slice.length; i++) {
    if (memcmp(slice.text + i, part, n) == 0) {
      return i;
    }
  }
  return slice.length;
}

/* A field in quotes at the head of rest; doubled quotes in it stay doubled. */
static size_t quoted_length(struct dea_slice rest)
{
  size_t n = 1;
  while (n < rest.length &&
         (rest.text[n] != '"' || (n + 1 < rest.length && rest.text[n + 1] == '"'))) {
    n += rest.text[n] == '"' ? 2 : 1;
  }
  return n < rest.length ? n + 1 : rest.length;
}

bool dea_slice_field(struct dea_slice *rest, char separator, struct dea_slice *field)
{
  if (rest->text == NULL) {
    return false;
  }
  struct dea_slice left = *rest;
  while (left.length > 0 && left.text[0] != separator && is_blank(left.text[0])) {
    left.text++;
    left.length--;
  }
  if (separator == ' ') {
    left = dea_slice_trim(left);
    if (left.length == 0) {
      return false;
    }
  }
  size_t n = left.length > 0 && left.text[0] == '"' ? quoted_length(left) : 0;
  while (n < left.length &&
         !(separator == ' ' ? is_blank(left.text[n]) : left.text[n] == separator)) {
    n++;
  }
  *field = dea_slice_trim((struct dea_slice){left.text, n});
  if (field->length >= 2 && field->text[0] == '"' && field->text[field->length - 1] == '"') {
    *field = dea_slice_trim((struct dea_slice){field->text + 1, field->length - 2});
  }
  *rest = n < left.length ? (struct dea_slice){left.text + n + 1, left.length - n - 1}
                          : (struct dea_slice){NULL, 0};
  return true;
}

size_t dea_slice_count(struct dea_slice line, char separator)
{
  struct dea_slice field;
  size_t count = 0;
  while (dea_slice_field(&line, separator, &field)) {
    count++;
  }
  return count;
}

/* What instruments and programs write where they have no number. */
static bool is_missing(struct dea_slice slice)
{
  static const char *const words[] = {"",          "nan",      "-nan",      "+nan",      "na",
                                      "n/a",       "#n/a",     "null",      "none",      "-",
                                      "inf",       "-inf",     "+inf",      "ol",        "-ol",
                                      "+ol",       "1.#qnan",  "1.#ind",    "-1.#ind",   "1.#inf",
                                      "-1.#inf",   "invalid",  "overload",  "overflow",  "infinity",
                                      "-infinity", "nan(ind)", "-nan(ind)", // of Windows' printf
                                      "over",      "under",    "ovld",      "overrange", "n.a.",
                                      "n. a.",     "nd",       "no data",   "burnout",   "b.o."};
  size_t same = 0; // "+++++++" of data loggers, "#####" of spreadsheets
  while (same < slice.length && slice.text[same] == slice.text[0]) {
    same++;
  }
  if (same > 1 && same == slice.length && strchr("+-*#?", slice.text[0]) != NULL) {
    return true;
  }
  for (size_t i = 0; slice.length < 10 && i < sizeof words / sizeof words[0]; i++) {
    if (dea_slice_is(slice, words[i])) {
      return true;
    }
  }
  return false;
}

/* A decimal number taken apart. */
struct digits {
  uint64_t mantissa; // of the first 18 digits
  int exponent;      // of ten
  bool negative, exact, good;
};

static struct digits read_digits(struct dea_slice slice, char decimal)
{
  struct digits d = {.exact = true};
  size_t i = 0, count = 0, kept = 0;
  bool after = false;
  d.negative = slice.length > 0 && slice.text[0] == '-';
  i += slice.length > 0 && (slice.text[0] == '-' || slice.text[0] == '+');
  while (i > 0 && i < slice.length && is_blank(slice.text[i])) { // "+  0.5"
    i++;
  }
  for (; i < slice.length; i++) {
    char c = slice.text[i];
    if (c == decimal && !after) {
      after = true;
    } else if (isdigit((unsigned char)c)) {
      count++;
      d.exact = d.exact && kept < 18;
      if (kept < 18) {
        d.mantissa = 10 * d.mantissa + (uint64_t)(c - '0');
        kept += d.mantissa > 0;
        d.exponent -= after;
      }
    } else {
      break;
    }
  }
  d.good = count > 0;
  if (d.good && i < slice.length && strchr("eEdD", slice.text[i]) != NULL) { // D: of Fortran
    i++;
    bool minus = i < slice.length && slice.text[i] == '-';
    i += i < slice.length && (slice.text[i] == '-' || slice.text[i] == '+');
    int e = 0;
    d.good = i < slice.length;
    for (; i < slice.length && isdigit((unsigned char)slice.text[i]); i++) {
      e = e < 10000 ? 10 * e + (slice.text[i] - '0') : e;
    }
    d.exponent += minus ? -e : e;
  }
  d.good = d.good && i == slice.length;
  return d;
}

/* SCPI's infinity (9.9e37) and "not a number" (9.91e37), which oscilloscopes write into files. */
static double or_missing(double value)
{
  double size = fabs(value);
  return isfinite(value) && !(size > 9.89e37 && size < 1e38) ? value : NAN;
}

bool dea_slice_number(struct dea_slice slice, char decimal, double *value)
{
  static const double tens[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  struct digits d = read_digits(slice, decimal);
  *value = NAN;
  if (!d.good) {
    return is_missing(slice);
  }
  // both factors are exact doubles, so that one rounding gives the nearest
  if (d.exact && d.mantissa <= (uint64_t)1 << 53 && d.exponent >= -22 && d.exponent <= 22) {
    double m = (double)d.mantissa;
    m = d.exponent < 0 ? m / tens[-d.exponent] : m * tens[d.exponent];
    *value = or_missing(d.negative ? -m : m);
    return true;
  }
  char copy[400];
  size_t n = 0;
  if (slice.length >= sizeof copy) {
    return false;
  }
  for (size_t i = 0; i < slice.length; i++) {
    char c = slice.text[i];
    if (!is_blank(c)) {
      copy[n++] = (char)(c == decimal ? '.' : c == 'd' || c == 'D' ? 'e' : c);
    }
  }
  copy[n] = '\0';
  const char *end;
  *value = dea_text_to_double(copy, &end);
  *value = or_missing(*value);
  return *end == '\0';
}

/* Bytes of a mark between thousands at the start of a text; 0: there is none. */
static size_t group_mark(struct dea_slice slice)
{
  static const char *const marks[] = {
      ".", ",", "'", " ", "_", "\xc2\xa0", "\xe2\x80\xaf", "\xe2\x80\x89", "\xe2\x80\x99", "\xa0"};
  for (size_t i = 0; i < sizeof marks / sizeof marks[0]; i++) {
    const size_t n = strlen(marks[i]);
    if (slice.length >= n && memcmp(slice.text, marks[i], n) == 0) {
      return n;
    }
  }
  return 0;
}

bool dea_slice_has_groups(struct dea_slice slice)
{
  size_t i = slice.length > 0 && strchr("+-", slice.text[0]) != NULL, digits = 0, groups = 0;
  struct dea_slice mark = {"", 0};
  if (i >= slice.length || slice.text[i] == '0') {
    return false;
  }
  while (i < slice.length) {
    const struct dea_slice rest = {slice.text + i, slice.length - i};
    const size_t n = group_mark(rest);
    if (isdigit((unsigned char)slice.text[i])) {
      digits++;
      i++;
      continue;
    }
    if (n == 0 || (groups == 0 ? digits < 1 || digits > 3 : digits != 3)) {
      return false;
    }
    if (groups > 0 && !dea_slice_same(mark, (struct dea_slice){rest.text, n})) {
      if (strchr(".,", slice.text[i]) == NULL) {
        return false;
      }
      break; // the decimal mark
    }
    mark = (struct dea_slice){rest.text, n};
    groups++;
    digits = 0;
    i += n;
  }
  if (i == slice.length) {
    return groups > 0 && digits == 3;
  }
  for (i++; i < slice.length; i++) {
    if (!isdigit((unsigned char)slice.text[i])) {
      return false;
    }
  }
  return true;
}

bool dea_slice_same(struct dea_slice a, struct dea_slice b)
{
  return a.length == b.length && (a.length == 0 || memcmp(a.text, b.text, a.length) == 0);
}

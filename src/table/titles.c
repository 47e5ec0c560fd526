#include "table/titles.h"

#include "base/units.h"
#include "table/words.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { UNIT_SIZE = 48 };

/* In which dimensions a unit is looked for: those of channels first. */
static const char *const si_units[] = {"s",  "V", "A", "m",   "N", "Hz", "1",      "Pa",
                                       "kg", "K", "W", "ohm", "F", "C",  "radian", "V/m"};

/* 1, 0 or -1: out of memory or without a table of units, which the context knows. */
static int read_unit(struct dea_context *ctx, const char *unit, const char **si, double *factor)
{
  char text[UNIT_SIZE + 4], why[DEA_WHY_SIZE];
  snprintf(text, sizeof text, "1 %s", unit);
  for (size_t i = 0; i < sizeof si_units / sizeof si_units[0]; i++) {
    const char *example = strcmp(si_units[i], "1") == 0 ? text : "1 s";
    const struct dea_measure due = {si_units[i], example};
    if (dea_units_read(ctx, text, due, factor, why)) {
      *si = si_units[i];
      return 1;
    }
    if (strstr(why, "is not a known unit") != NULL || strstr(why, "is not a number") != NULL) {
      return 0;
    }
  }
  return 0;
}

/* The unit that a word of another alphabet, or a letter for a whole unit, stands for; the word
 * itself for others. */
static const char *in_latin(const char *unit)
{
  static const char *const words[][2] = {{"\xe7\xa7\x92", "s"},
                                         {"\xe3\x83\x9f\xe3\x83\xaa\xe7\xa7\x92", "ms"},
                                         {"\xe6\xaf\xab\xe7\xa7\x92", "ms"},
                                         {"\xec\xb4\x88", "s"},
                                         {"\xd1\x81", "s"},
                                         {"\xd0\xbc\xd1\x81", "ms"},
                                         {"\xd0\xbc\xd0\xba\xd1\x81", "us"},
                                         {"\xd0\x92", "V"},
                                         {"\xd0\xba\xd0\x92", "kV"},
                                         {"\xd0\xbc\xd0\x92", "mV"},
                                         {"\xd0\x90", "A"},
                                         {"\xd0\xbc\xd0\x90", "mA"},
                                         {"\xd0\xbc\xd0\xba\xd0\x90", "uA"},
                                         {"\xd0\xbc", "m"},
                                         {"\xd0\xbc\xd0\xbc", "mm"},
                                         {"\xd0\xbc\xd0\xba\xd0\xbc", "um"},
                                         {"\xd0\x9d", "N"},
                                         {"\xd0\xbc\xd0\x9d", "mN"},
                                         {"\xd0\xba\xd0\x9f\xd0\xb0", "kPa"},
                                         {"\xd0\x9c\xd0\x9f\xd0\xb0", "MPa"},
                                         {"\xe3\x8e\x9c", "mm"},
                                         {"\xe3\x8e\x9b", "um"},
                                         {"\xe3\x8e\x9d", "cm"},
                                         {"\xe3\x8e\xb2", "us"},
                                         {"\xe3\x8e\xb3", "ms"},
                                         {"\xe3\x8e\xb8", "kV"},
                                         {"\xe3\x8e\xb7", "mV"},
                                         {"\xe3\x8e\x83", "mA"},
                                         {"\xe3\x8e\x82", "uA"},
                                         {"\xe3\x8e\xaa", "kPa"},
                                         {"\xe3\x8e\xab", "MPa"}};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
    if (strcmp(unit, words[i][0]) == 0) {
      return words[i][1];
    }
  }
  return unit;
}

const char *dea_title_unit(struct dea_context *ctx, const char *unit, double *factor)
{
  const char *si = NULL;
  char lower[UNIT_SIZE], own[UNIT_SIZE];
  unit = in_latin(unit);
  size_t n = strlen(unit);
  if (n == 0 || n >= UNIT_SIZE) {
    return NULL;
  }
  if (strcmp(unit, "KV") == 0 || strcmp(unit, "KN") == 0 || strcmp(unit, "KPa") == 0) {
    snprintf(own, sizeof own, "k%s", unit + 1); // no kelvin
    unit = own;
  }
  if (read_unit(ctx, unit, &si, factor) != 1 && n > 2) { // "Volts", but not "MV" as "mv"
    for (size_t i = 0; i <= n; i++) {
      lower[i] = (char)tolower((unsigned char)unit[i]);
    }
    read_unit(ctx, lower, &si, factor);
  }
  return si;
}

/* The micro sign in UTF-8 and in Latin-1, and the Greek letter mu, become 'u'; false when the unit
 * is empty or too long for one. */
static bool fold_unit(struct dea_slice unit, char out[UNIT_SIZE])
{
  static const char *const micros[] = {"\xc2\xb5", "\xce\xbc", "\xb5"};
  size_t skip = 0;
  for (size_t i = 0; i < sizeof micros / sizeof micros[0] && skip == 0; i++) {
    size_t n = strlen(micros[i]);
    skip = unit.length > n && memcmp(unit.text, micros[i], n) == 0 ? n : 0;
  }
  if (unit.length == 0 || unit.length >= UNIT_SIZE) {
    return false;
  }
  snprintf(out, UNIT_SIZE, "%s%.*s", skip > 0 ? "u" : "", (int)(unit.length - skip),
           unit.text + skip);
  return true;
}

bool dea_title_is_unit(struct dea_context *ctx, struct dea_slice unit)
{
  // without a factor to SI
  static const char *const others[] = {"\302\260C", "\260C", "degC", "a.u.", "-", "1", "counts"};
  char text[UNIT_SIZE];
  double factor;
  for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
    if (dea_slice_is(unit, others[i])) {
      return true;
    }
  }
  return fold_unit(unit, text) && dea_title_unit(ctx, text, &factor) != NULL;
}

/* Units that are taken without brackets: what udunits knows beside these ("in", "a", "d") stands at
 * the end of names that mean something else. */
static bool is_bare_unit(struct dea_slice name, struct dea_slice unit)
{
  static const char *const units[] = {
      "s",  "ms", "us", "ns", "min", "sec", "msec", "usec", "V", "kV", "KV", "mV",  "uV", "MV",
      "mA", "uA", "nA", "m",  "mm",  "um",  "nm",   "cm",   "N", "mN", "uN", "kHz", "Hz", "MHz"};
  char text[UNIT_SIZE];
  bool known = false;
  if (fold_unit(unit, text)) {
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
      known = known || strcmp(text, units[i]) == 0;
    }
  }
  return known || (unit.length == 1 && unit.text[0] == 'A' && dea_word_takes_ampere(name));
}

/* How many letters part name and unit there: '/', '_' or " in "; weak: ':', ',', and a blank before
 * a unit of several letters. */
static size_t bare_mark(struct dea_slice title, size_t i, bool weak)
{
  char c = title.text[i];
  if (weak) {
    return c == ':' || c == ',' || (c == ' ' && i + 2 < title.length);
  }
  bool in = i + 4 < title.length && memcmp(title.text + i, " in ", 4) == 0;
  return in ? 4 : c == '/' || c == '_';
}

/* Unit behind the last of such marks. */
static bool split_bare(struct dea_slice title, bool weak, struct dea_slice *name,
                       struct dea_slice *unit)
{
  for (size_t i = title.length; i-- > 1;) {
    size_t skip = bare_mark(title, i, weak);
    if (skip > 0) {
      struct dea_slice before = dea_slice_trim((struct dea_slice){title.text, i});
      struct dea_slice after =
          dea_slice_trim((struct dea_slice){title.text + i + skip, title.length - i - skip});
      if (is_bare_unit(before, after)) {
        bool mark = before.length > 1 && strchr(":,", before.text[before.length - 1]) != NULL;
        *name = dea_slice_trim((struct dea_slice){before.text, before.length - mark});
        *unit = after;
        return true;
      }
    }
  }
  return false;
}

void dea_title_split(struct dea_context *ctx, struct dea_slice title, struct dea_slice *name,
                     struct dea_slice *unit)
{
  title = dea_slice_trim(title);
  *name = title;
  *unit = (struct dea_slice){"", 0};
  // the last pair of brackets that holds a unit
  for (size_t close = title.length; close-- > 0;) {
    static const char ends[] = ")]}>", starts[] = "([{<";
    const char *end = title.text[close] != '\0' ? strchr(ends, title.text[close]) : NULL;
    if (end == NULL) {
      continue;
    }
    char start = starts[end - ends];
    size_t open = close;
    while (open > 0 && title.text[open] != start) {
      open--;
    }
    struct dea_slice inside = dea_slice_trim(
        (struct dea_slice){title.text + open + 1, close > open ? close - open - 1 : 0});
    if (title.text[open] == start && dea_title_is_unit(ctx, inside)) {
      struct dea_slice before = dea_slice_trim((struct dea_slice){title.text, open});
      *unit = inside;
      // "w (um) @ t=0.1" stays whole
      *name = close + 1 == title.length ? before : title;
      if (name->length > 0 && (name->text[name->length - 1] == '/')) {
        *name = dea_slice_trim((struct dea_slice){name->text, name->length - 1});
      }
      return;
    }
  }
  // "In mV" is an input's title
  const size_t in = title.length > 3 && memcmp(title.text, "in ", 3) == 0 ? 3 : title.length;
  const struct dea_slice after = {title.text + in, title.length - in};
  if (is_bare_unit((struct dea_slice){"", 0}, after)) { // of a column without a name
    *unit = after;
    name->length = 0;
  } else if (!split_bare(title, false, name, unit)) {
    split_bare(title, true, name, unit);
  }
}

/* Whether nothing stands at `text[length]` but what people add to a unit. */
static bool is_unit_end(const char *text, size_t length)
{
  static const char *const ends[] = {"pp", "p-p", "rms", "dc", "ac", "/", "^"};
  while (length > 0 && (*text == ' ' || *text == '_')) {
    text++;
    length--;
  }
  for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
    size_t n = strlen(ends[i]);
    if (length >= n && dea_slice_is((struct dea_slice){text, n}, ends[i])) {
      return true;
    }
  }
  return length == 0;
}

bool dea_title_has_odd_unit(const char *name)
{
  // other units, and other ways to write these
  static const char *const others[] = {"dyn", "lb", "lbs", "oz", "kp", "mka", "mkm", "mks", "mkn"};
  size_t length = strlen(name), open = length;
  while (open > 0 && strchr("([{<", name[open - 1]) == NULL) {
    open--;
  }
  if (open == 0 || length - open < 2 || length - open > 7 ||
      strchr(")]}>", name[length - 1]) == NULL) {
    return false;
  }
  for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
    if (dea_slice_is((struct dea_slice){name + open, length - open - 1}, others[i])) {
      return true;
    }
  }
  // a unit, after a prefix or without one
  for (size_t at = open; at < open + 2 && at + 1 < length; at++) {
    bool prefixed = at == open || strchr("kmunpKMUNP", name[open]) != NULL;
    if (prefixed && strchr("vVaAnNmMsS", name[at]) != NULL &&
        is_unit_end(name + at + 1, length - at - 2)) {
      return true;
    }
  }
  return false;
}

/* Where the next title of a line parted by blanks ends: at `blanks` of them outside of brackets; a
 * bracket after blanks still belongs to it. */
static size_t title_end(struct dea_slice line, size_t blanks)
{
  size_t depth = 0;
  for (size_t i = 0; i < line.length; i++) {
    char c = line.text[i];
    if (c == '(' || c == '[') {
      depth++;
    } else if ((c == ')' || c == ']') && depth > 0) {
      depth--;
    } else if (depth == 0 && (c == ' ' || c == '\t')) {
      size_t n = 0;
      while (i + n < line.length && (line.text[i + n] == ' ' || line.text[i + n] == '\t')) {
        n++;
      }
      char next = i + n < line.length ? line.text[i + n] : '\0';
      bool tab = memchr(line.text + i, '\t', n) != NULL;
      if ((n >= blanks || tab) && !(next == '(' || next == '[')) {
        return i;
      }
      i += n - 1;
    }
  }
  return line.length;
}

/* Where it ends with a unit in brackets: "V0 (kV) Line integration (N)". */
static size_t unit_end(struct dea_slice line)
{
  size_t n = 0;
  while (n < line.length && line.text[n] != ')' && line.text[n] != ']') {
    n++;
  }
  return n + (n < line.length);
}

/* blanks: as of title_end; 0: each ends with a unit in brackets. */
static size_t part_line(struct dea_slice line, size_t blanks, size_t capacity,
                        struct dea_slice *out)
{
  size_t count = 0;
  line = dea_slice_trim(line);
  while (line.length > 0) {
    size_t n = blanks > 0 ? title_end(line, blanks) : unit_end(line);
    if (count < capacity) {
      out[count] = dea_slice_trim((struct dea_slice){line.text, n});
    }
    count++;
    line = dea_slice_trim((struct dea_slice){line.text + n, line.length - n});
  }
  return count;
}

bool dea_titles_part(struct dea_slice line, char separator, size_t count, struct dea_slice *out)
{
  if (separator == ' ') {
    return part_line(line, 2, count, out) == count || part_line(line, 1, count, out) == count ||
           part_line(line, 0, count, out) == count;
  }
  struct dea_slice field;
  size_t n = 0;
  while (dea_slice_field(&line, separator, &field)) {
    if (n < count) {
      out[n] = field;
    } else if (field.length > 0) {
      return false;
    }
    n++;
  }
  return n == count || n == count + 1;
}

#include "table/csv_dialect.h"

#include <ctype.h>
#include <string.h>

enum { SAMPLE_LINES = 2000, SAMPLE_BYTES = 1 << 22 };

/* The lines that are looked at: neither empty nor comments. */
struct sample {
  struct dea_context *ctx;
  const char *file;
  struct dea_slice *lines; // [count]
  size_t *numbers;         // [count] of lines
  size_t count;
  bool ends;  // with the text
  char given; // separator that a line "sep=;" of Excel says; '\0'
};

/* One way to read them, and how well it does. */
struct candidate {
  char separator, decimal;
  size_t count, rows, numeric, first, last; // rows: of its form; first, last: lines
  bool all_numeric;
};

bool dea_csv_is_comment(struct dea_slice line)
{
  line = dea_slice_trim(line);
  return line.length > 0 &&
         (line.text[0] == '#' || line.text[0] == '%' || dea_slice_starts(line, "//"));
}

bool dea_csv_is_blank(struct dea_slice line)
{
  for (size_t i = 0; i < line.length; i++) {
    if (strchr(" \t,;\"", line.text[i]) == NULL || line.text[i] == '\0') {
      return false;
    }
  }
  return true;
}

static dea_status read_sample(struct sample *sample, struct dea_slice text)
{
  struct dea_lines lines = {text.text, text.text + text.length, 0};
  struct dea_slice line;
  sample->lines = dea_alloc(sample->ctx, SAMPLE_LINES, sizeof *sample->lines);
  sample->numbers = dea_alloc(sample->ctx, SAMPLE_LINES, sizeof *sample->numbers);
  DEA_TRY_MEMORY(sample->lines != NULL && sample->numbers != NULL);
  while (sample->count < SAMPLE_LINES &&
         (sample->count < 2 || lines.next - text.text < SAMPLE_BYTES) &&
         dea_lines_next(&lines, &line)) {
    if (lines.line == 1 && line.length >= 5 && dea_slice_starts(line, "sep=")) {
      sample->given = line.text[4];
    } else if (!dea_csv_is_blank(line) && !dea_csv_is_comment(line)) {
      sample->lines[sample->count] = line;
      sample->numbers[sample->count++] = lines.line;
    }
  }
  sample->ends = lines.next >= lines.end;
  return DEA_OK;
}

/* Looks at one line: which fields are text, how many are numbers. */
static size_t classify_fields(struct dea_slice line, const struct candidate *c, bool *text,
                              size_t *count)
{
  struct dea_slice field;
  double value;
  size_t numeric = 0;
  *count = 0;
  while (dea_slice_field(&line, c->separator, &field)) {
    if (*count < DEA_TABLE_COLUMNS_MAX) {
      bool number = dea_slice_number(field, c->decimal, &value);
      text[*count] = !number;
      numeric += number && value == value;
    }
    ++*count;
  }
  return numeric;
}

/* Whether a line without a number says so in words (NaN, OL), not by dashes as a line of units. */
static bool says_missing(struct dea_slice line)
{
  for (size_t i = 0; i < line.length; i++) {
    if (isalnum((unsigned char)line.text[i])) {
      return true;
    }
  }
  return false;
}

/* The line itself, or the last one before it that is not all of missing values. */
static size_t skip_missing(const struct sample *sample, size_t line, const struct candidate *c,
                           bool *text)
{
  size_t count;
  while (line > 0 && classify_fields(sample->lines[line], c, text, &count) == 0 &&
         count <= DEA_TABLE_COLUMNS_MAX && memchr(text, true, count) == NULL) {
    line--;
  }
  return line;
}

/* How many lines before and with `last` are of its form. */
static void judge(const struct sample *sample, size_t last, struct candidate *c, bool *text,
                  bool *other)
{
  c->rows = 0;
  last = skip_missing(sample, last, c, text);
  c->numeric = classify_fields(sample->lines[last], c, text, &c->count);
  if (c->numeric == 0 || c->count > DEA_TABLE_COLUMNS_MAX) {
    return;
  }
  c->all_numeric = memchr(text, true, c->count) == NULL;
  c->first = c->last = last;
  c->rows = 1;
  for (size_t i = last; i-- > 0;) {
    size_t count, numeric = classify_fields(sample->lines[i], c, other, &count);
    bool same = count == c->count;
    for (size_t k = 0; same && k < count; k++) {
      same = !other[k] || text[k];
    }
    if (!same) {
      break;
    }
    c->rows++;
    c->first = numeric > 0 || says_missing(sample->lines[i]) ? i : c->first;
  }
}

static bool is_better(const struct candidate *a, const struct candidate *b)
{
  if ((a->rows > 0) != (b->rows > 0) || a->rows == 0) {
    return a->rows > 0;
  }
  if (a->separator == ' ' && b->separator == '\t' && b->rows > a->rows) {
    return false; // "1 000" between tabs
  }
  if (a->all_numeric != b->all_numeric) {
    return a->all_numeric;
  }
  if (a->rows != b->rows || a->numeric != b->numeric) {
    return a->rows != b->rows ? a->rows > b->rows : a->numeric > b->numeric;
  }
  return a->count > b->count; // "2," is a number and a missing one, not 2.0
}

/* The first field of the lines from `from` on that has marks between thousands and is no number;
 * only: [best->count] columns that count, NULL: all. An error then. */
static dea_status find_thousands(const struct sample *sample, size_t from,
                                 const struct candidate *best, const bool *only, bool *found)
{
  for (size_t i = from; i < sample->count && !*found; i++) {
    struct dea_slice rest = sample->lines[i], field;
    double value;
    for (size_t k = 0; !*found && dea_slice_field(&rest, best->separator, &field); k++) {
      *found = (only == NULL || (k < best->count && only[k])) && dea_slice_has_groups(field) &&
               !dea_slice_number(field, best->decimal, &value);
    }
    if (*found) {
      const struct dea_location location = {sample->file, sample->numbers[i],
                                            (size_t)(field.text - sample->lines[i].text) + 1};
      return dea_finding_add(sample->ctx, DEA_ERROR, location,
                             "'%.*s' has marks between thousands: export numbers without them",
                             (int)(field.length < 40 ? field.length : 40), field.text);
    }
  }
  return DEA_OK;
}

/* Whether a column of text has a number with the other decimal mark. */
static bool has_other_decimal(const struct sample *sample, const struct candidate *best,
                              const bool *text, char other)
{
  for (size_t i = best->first; i < sample->count; i++) {
    struct dea_slice rest = sample->lines[i], field;
    double value;
    for (size_t k = 0; dea_slice_field(&rest, best->separator, &field); k++) {
      if (k < best->count && text[k] && dea_slice_number(field, other, &value) && value == value &&
          memchr(field.text, other, field.length) != NULL) {
        return true;
      }
    }
  }
  return false;
}

/* Numbers with marks between thousands would be columns of text. best->rows 0: no line is of
 * numbers. text: room for the columns. */
static dea_status refuse_thousands(const struct sample *sample, const struct candidate *best,
                                   bool *text, bool *found)
{
  static const char separators[] = {';', '\t', ',', '|', ' '};
  size_t count;
  for (size_t i = 0; best->rows == 0 && i < sizeof separators && !*found; i++) {
    const struct candidate one = {.separator = separators[i], .decimal = '.'};
    DEA_TRY(sample->ctx, find_thousands(sample, sample->count - 1, &one, NULL, found));
  }
  if (best->rows == 0 || best->all_numeric) {
    return DEA_OK;
  }
  classify_fields(sample->lines[best->last], best, text, &count);
  DEA_TRY(sample->ctx, find_thousands(sample, best->first, best, text, found));
  struct candidate other = *best; // "1.000" beside "0,120"
  other.decimal = best->decimal == '.' ? ',' : '.';
  return !*found && has_other_decimal(sample, best, text, other.decimal)
             ? find_thousands(sample, best->first, &other, NULL, found)
             : DEA_OK;
}

/* The best way to read the sample; best->rows 0 when there is none. */
static void choose(const struct sample *sample, bool *text, bool *other, struct candidate *best)
{
  static const char separators[] = {'\t', ';', ',', '|', ' '};
  *best = (struct candidate){0};
  // the last line may be cut off, or be none of the numbers
  for (size_t back = 1; back <= 2 && back <= sample->count && best->rows < 2; back++) {
    for (size_t i = 0; i < 2 * sizeof separators; i++) {
      struct candidate c = {.separator = separators[i / 2], .decimal = i % 2 == 0 ? '.' : ','};
      if (sample->given != '\0' && c.separator != sample->given) {
        continue;
      }
      judge(sample, sample->count - back, &c, text, other);
      if (is_better(&c, best)) {
        *best = c;
      }
    }
  }
}

static bool is_digit_first(struct dea_slice field)
{
  return field.length > 0 && isdigit((unsigned char)field.text[0]);
}

/* Whether a line is of the form of a line of the numbers some columns of which hold text: dates
 * where there are dates, or the same words. */
static bool is_like(struct dea_slice line, struct dea_slice model, const struct candidate *best,
                    const bool *text)
{
  struct dea_slice a, b;
  double value;
  size_t numeric = 0;
  if (dea_slice_count(line, best->separator) != best->count) {
    return false;
  }
  for (size_t i = 0;
       dea_slice_field(&line, best->separator, &a) && dea_slice_field(&model, best->separator, &b);
       i++) {
    bool number = dea_slice_number(a, best->decimal, &value);
    bool same = dea_slice_same(a, b);
    if (text[i] ? !same && !(is_digit_first(a) && is_digit_first(b)) : !number) {
      return false;
    }
    numeric += !text[i] && value == value;
  }
  return numeric > 0;
}

/* Numbers further up would be lost: two tables in one file, or a line between them that is none.
 * text: columns of text. */
static dea_status check_above(const struct sample *sample, const struct candidate *best,
                              const bool *text, bool *flags)
{
  const struct dea_slice model = sample->lines[best->first];
  size_t alone = 0;
  for (size_t i = 0; i < best->first; i++) {
    size_t count, numeric = classify_fields(sample->lines[i], best, flags, &count);
    bool numbers =
        numeric > 0 && count <= DEA_TABLE_COLUMNS_MAX && memchr(flags, true, count) == NULL;
    alone = numbers && count == 1 ? alone + 1 : 0;
    if ((numbers && count > 1) || alone > 1 ||
        (!best->all_numeric && is_like(sample->lines[i], model, best, text))) {
      const struct dea_location location = {sample->file, sample->numbers[i], 1};
      DEA_TRY(sample->ctx,
              dea_finding_add(sample->ctx, DEA_ERROR, location,
                              "numbers stand here, and below other lines those from line %zu on: "
                              "split the file, or take out what is between them",
                              sample->numbers[best->first]));
      return dea_fail(sample->ctx, DEA_E_IO, "'%s' has more than one table", sample->file);
    }
  }
  return DEA_OK;
}

/* The lines above the numbers that may be titles, also comments. */
static void find_titles(struct dea_slice text, struct dea_csv_dialect *out)
{
  struct dea_lines lines = {text.text, out->data, 0};
  struct dea_slice line;
  while (dea_lines_next(&lines, &line)) {
    bool comment = dea_csv_is_comment(line);
    line = dea_slice_trim(line);
    if (comment) {
      size_t mark = line.text[0] == '/' ? 2 : 1;
      line = dea_slice_trim((struct dea_slice){line.text + mark, line.length - mark});
    }
    if (dea_csv_is_blank(line) || (lines.line == 1 && dea_slice_starts(line, "sep="))) {
      continue;
    }
    size_t last = DEA_CSV_TITLES_MAX - 1;
    memmove(out->titles + 1, out->titles, last * sizeof *out->titles);
    memmove(out->title_lines + 1, out->title_lines, last * sizeof *out->title_lines);
    out->titles[0] = line;
    out->title_lines[0] = lines.line;
    out->title_count += out->title_count < DEA_CSV_TITLES_MAX;
  }
}

/* Without a decimal mark in the sample the first one of the rest decides. */
static char find_decimal(struct dea_slice text, const struct candidate *best, const char *data)
{
  if (best->separator == ',' || best->decimal == ',') {
    return best->decimal;
  }
  for (const char *c = data; c + 1 < text.text + text.length; c++) {
    if ((*c == '.' || *c == ',') && isdigit((unsigned char)c[1])) {
      return *c;
    }
  }
  return best->decimal;
}

/* Fields at the ends of all lines of numbers that are empty and have no title, which separators
 * there make. */
static size_t count_trailing(const struct sample *sample, const struct candidate *best,
                             const struct dea_csv_dialect *dialect)
{
  size_t full =
      dialect->title_count == 0 ? 1 : dea_slice_count(dialect->titles[0], best->separator);
  for (size_t i = best->first; i < sample->count && full < best->count; i++) {
    struct dea_slice rest = sample->lines[i], field;
    for (size_t k = 0; dea_slice_field(&rest, best->separator, &field); k++) {
      full = field.length > 0 && k >= full ? k + 1 : full;
    }
  }
  return full < best->count ? best->count - full : 0;
}

static dea_status fill(const struct sample *sample, struct dea_slice text,
                       const struct candidate *best, struct dea_csv_dialect *out)
{
  out->separator = best->separator;
  out->count = best->count;
  out->data = sample->lines[best->first].text;
  out->line = sample->numbers[best->first] - 1;
  out->decimal = find_decimal(text, best, out->data);
  find_titles(text, out);
  out->count -= count_trailing(sample, best, out);
  // "1,5" below one title is a number with a decimal comma, not two
  if (out->separator == ',' && out->count == 2 && out->title_count > 0 &&
      dea_slice_count(out->titles[0], ',') == 1 &&
      memchr(out->data, '.', sample->lines[best->first].length) == NULL) {
    out->separator = ';';
    out->decimal = ',';
    out->count = 1;
  }
  out->text = dea_alloc(sample->ctx, DEA_TABLE_COLUMNS_MAX, sizeof *out->text);
  DEA_TRY_MEMORY(out->text != NULL);
  const struct candidate chosen = {.separator = out->separator, .decimal = out->decimal};
  size_t count;
  classify_fields(sample->lines[best->last], &chosen, out->text, &count);
  return DEA_OK;
}

/* A line between titles and numbers that looks like numbers with something odd in them would be
 * lost otherwise. */
static dea_status check_last_title(struct dea_context *ctx, const char *file,
                                   const struct dea_csv_dialect *dialect)
{
  struct dea_slice rest, field, odd = {"", 0};
  size_t numbers = 0, count = 0;
  double value;
  if (dialect->title_count == 0 || dialect->count < 2) {
    return DEA_OK;
  }
  rest = dialect->titles[0];
  while (dea_slice_field(&rest, dialect->separator, &field)) {
    bool number = dea_slice_number(field, dialect->decimal, &value);
    bool due = count < dialect->count && !dialect->text[count];
    numbers += due && number && value == value;
    odd = due && !number && odd.length == 0 ? field : odd;
    count++;
  }
  if (count != dialect->count || numbers == 0 || odd.length == 0) {
    return DEA_OK;
  }
  const struct dea_location location = {file, dialect->title_lines[0],
                                        (size_t)(odd.text - dialect->titles[0].text) + 1};
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location,
                               "'%.*s' stands in a line of numbers; write a missing one as NaN or "
                               "leave it empty",
                               (int)(odd.length < 40 ? odd.length : 40), odd.text));
  return dea_fail(ctx, DEA_E_IO, "'%s' has a line that is neither titles nor numbers", file);
}

static dea_status find_dialect(struct sample *sample, struct dea_slice text, bool *flags,
                               struct dea_csv_dialect *out)
{
  struct candidate best;
  bool found = false;
  DEA_TRY(sample->ctx, read_sample(sample, text));
  choose(sample, flags, flags + DEA_TABLE_COLUMNS_MAX, &best);
  DEA_TRY(sample->ctx, sample->count > 0 ? refuse_thousands(sample, &best, flags, &found) : DEA_OK);
  if (found) {
    return dea_fail(sample->ctx, DEA_E_IO, "'%s' cannot be read", sample->file);
  }
  if (best.rows == 0) {
    const struct dea_location location = {sample->file, 1, 1};
    DEA_TRY(sample->ctx, dea_finding_add(sample->ctx, DEA_ERROR, location, "no rows of numbers"));
    return dea_fail(sample->ctx, DEA_E_IO,
                    "'%s' has no lines of numbers parted by commas, semicolons, tabs or blanks",
                    sample->file);
  }
  DEA_TRY(sample->ctx, fill(sample, text, &best, out));
  DEA_TRY(sample->ctx, check_last_title(sample->ctx, sample->file, out));
  return check_above(sample, &best, out->text, flags);
}

dea_status dea_csv_dialect_find(struct dea_context *ctx, const char *file, struct dea_slice text,
                                struct dea_csv_dialect *out)
{
  struct sample sample = {.ctx = ctx, .file = file};
  *out = (struct dea_csv_dialect){0};
  bool *flags = dea_alloc(ctx, 2 * (size_t)DEA_TABLE_COLUMNS_MAX, sizeof *flags);
  dea_status status = flags != NULL ? find_dialect(&sample, text, flags, out) : DEA_E_MEMORY;
  dea_free(ctx, sample.lines);
  dea_free(ctx, sample.numbers);
  dea_free(ctx, flags);
  return status;
}

#include "table/text_rows.h"

#include "table/clock_text.h"
#include "table/fields.h"
#include "table/titles.h"
#include "table/words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ERRORS_MAX = 20, NONE = -1 };

struct rows {
  struct dea_context *ctx;
  const struct dea_csv_dialect *dialect;
  struct dea_table *table;
  int *column;                   // [dialect->count] of the table, or NONE: text
  double *row;                   // [dialect->count]
  struct dea_text_marks *marks;  // [dialect->count]
  struct dea_text_clock *clocks; // [dialect->count], begun for columns of times as text
  size_t fraction;               // column with the "ms" of the clock before it, 0: none
  double fraction_s;             // its unit
  size_t count;                  // of rows so far
  size_t blank;                  // lines of separators only since the last row
  size_t errors;
};

static int shown(struct dea_slice slice)
{
  return (int)(slice.length < 40 ? slice.length : 40);
}

/* How many rows there can be: lines, each of which takes a byte a field. */
static size_t rows_room(struct dea_slice text, const struct dea_csv_dialect *dialect)
{
  const char *end = text.text + text.length;
  size_t left = (size_t)(end - dialect->data), lines = 1;
  for (const char *c = dialect->data; (c = memchr(c, '\n', (size_t)(end - c))) != NULL; c++) {
    lines++;
  }
  size_t most = left / dialect->count + 1;
  return lines < most ? lines : most;
}

/* Name and unit of a title; given: its unit in a line of its own, NULL: none is. */
static void name_and_unit(struct dea_context *ctx, struct dea_slice title,
                          const struct dea_slice *given, struct dea_slice *name_out,
                          struct dea_slice *unit_out)
{
  struct dea_slice name = title, unit = {"", 0};
  if (given != NULL && given->length > 0) {
    unit = *given;
    bool bracket = unit.length > 2 && (unit.text[0] == '(' || unit.text[0] == '[');
    unit = bracket ? dea_slice_trim((struct dea_slice){unit.text + 1, unit.length - 2}) : unit;
  }
  if (unit.length == 0 || dea_slice_is(unit, "-")) { // of dashes alone the title has it
    dea_title_split(ctx, title, &name, &unit);
  }
  *name_out = name;
  *unit_out = unit;
}

/* A name for what has none: "column 3". */
static dea_status add_column(struct rows *rows, size_t index, struct dea_slice title,
                             const struct dea_slice *given, size_t capacity)
{
  struct dea_slice name, unit;
  char number[32];
  name_and_unit(rows->ctx, title, given, &name, &unit);
  if (name.length == 0) {
    snprintf(number, sizeof number, "column %zu", index + 1);
    name = (struct dea_slice){number, strlen(number)};
  }
  rows->column[index] = (int)rows->table->column_count;
  return dea_table_add(rows->ctx, rows->table, name.text, name.length, unit.text, unit.length,
                       capacity) != NULL
             ? DEA_OK
             : dea_context_status(rows->ctx);
}

/* A field of the first row. */
static struct dea_slice first_field(const struct rows *rows, struct dea_slice text, size_t index)
{
  struct dea_lines lines = {rows->dialect->data, text.text + text.length, 0};
  struct dea_slice line, field = {"", 0};
  bool more = dea_lines_next(&lines, &line);
  for (size_t i = 0; i <= index && more; i++) {
    more = dea_slice_field(&line, rows->dialect->separator, &field);
  }
  return more ? field : (struct dea_slice){"", 0};
}

/* Notes a column of text with its first field that is no number, and where that is. */
static dea_status leave_column(const struct rows *rows, struct dea_slice text, size_t index,
                               struct dea_slice name)
{
  struct dea_lines lines = {rows->dialect->data, text.text + text.length, rows->dialect->line};
  struct dea_slice line, field = {"", 0};
  bool number = true;
  double value;
  while (number && dea_lines_next(&lines, &line)) {
    bool more = !dea_csv_is_comment(line) && !dea_csv_is_blank(line);
    for (size_t i = 0; i <= index && more; i++) {
      more = dea_slice_field(&line, rows->dialect->separator, &field);
    }
    number = !more || dea_slice_number(field, rows->dialect->decimal, &value);
  }
  return dea_table_leave(rows->ctx, rows->table, name, field, lines.line);
}

/* Whether a column of text is one of times, by its first row. */
static bool is_clock(struct rows *rows, struct dea_slice text, size_t index)
{
  double seconds, part = 0;
  if (rows->fraction == index + 1) {
    dea_slice_number(first_field(rows, text, index + 1), rows->dialect->decimal, &part);
  }
  return dea_text_clock_next(&rows->clocks[index], first_field(rows, text, index),
                             part * rows->fraction_s, &seconds);
}

/* A column that is called "ms" or "us", beside one of times as text, belongs to those. */
static void find_fraction(struct rows *rows, struct dea_slice text, const struct dea_slice *titles,
                          const struct dea_slice *units)
{
  for (size_t i = rows->dialect->skipped + 1; i < rows->dialect->count; i++) {
    struct dea_slice name, unit;
    char word[64];
    double factor, days, seconds;
    bool dated;
    name_and_unit(rows->ctx, titles[i], units != NULL ? &units[i] : NULL, &name, &unit);
    unit = unit.length > 0 ? unit : name;
    snprintf(word, sizeof word, "%.*s", shown(unit), unit.text);
    const char *si = unit.length > 0 ? dea_title_unit(rows->ctx, word, &factor) : NULL;
    if ((name.length == 0 || dea_slice_same(name, unit)) && si != NULL && strcmp(si, "s") == 0 &&
        factor < 0.5 && !rows->dialect->text[i] && rows->dialect->text[i - 1] &&
        dea_clock_text(first_field(rows, text, i - 1), &days, &seconds, &dated)) {
      rows->fraction = i;
      rows->fraction_s = factor;
      return;
    }
  }
}

/* Whether a column of numbers has the times, by its unit or its name. */
static bool has_times(const struct rows *rows, const struct dea_slice *titles,
                      const struct dea_slice *units)
{
  for (size_t i = 0; i < rows->dialect->count; i++) {
    struct dea_slice name, unit;
    char text[64];
    double factor;
    name_and_unit(rows->ctx, titles[i], units != NULL ? &units[i] : NULL, &name, &unit);
    snprintf(text, sizeof text, "%.*s", shown(unit), unit.text);
    const char *si = unit.length > 0 ? dea_title_unit(rows->ctx, text, &factor) : NULL;
    snprintf(text, sizeof text, "%.*s", shown(name), name.text);
    if (i >= rows->dialect->skipped && !rows->dialect->text[i] && i != rows->fraction &&
        ((si != NULL && strcmp(si, "s") == 0) || dea_word_of_quantity(text) == DEA_WORD_TIME)) {
      return true;
    }
  }
  return false;
}

static dea_status add_columns(struct rows *rows, struct dea_slice text,
                              const struct dea_slice *titles, const struct dea_slice *units)
{
  static const struct dea_slice second = {"s", 1};
  size_t capacity = rows_room(text, rows->dialect);
  find_fraction(rows, text, titles, units);
  bool numbers = has_times(rows, titles, units);
  for (size_t i = 0; i < rows->dialect->count; i++) {
    rows->column[i] = NONE;
    if (i < rows->dialect->skipped || (i > 0 && i == rows->fraction)) {
      continue;
    }
    if (!numbers && rows->dialect->text[i] && is_clock(rows, text, i)) {
      numbers = true; // one clock is enough
      DEA_TRY(rows->ctx, add_column(rows, i, titles[i], &second, capacity));
      rows->table->columns[rows->column[i]].origin_s =
          rows->clocks[i].first_day * 86400 + rows->clocks[i].first_s;
    } else if (!rows->dialect->text[i]) {
      DEA_TRY(rows->ctx,
              add_column(rows, i, titles[i], units != NULL ? &units[i] : NULL, capacity));
    } else {
      const struct dea_location location = {rows->table->file, rows->dialect->line + 1, 1};
      struct dea_slice name, unit = {"", 0}, field = first_field(rows, text, i);
      dea_title_split(rows->ctx, titles[i], &name, &unit);
      double value; // numbers with something else among them, in the lines that were looked at
      bool odd = dea_slice_number(field, rows->dialect->decimal, &value);
      DEA_TRY(rows->ctx, leave_column(rows, text, i, name));
      DEA_TRY(rows->ctx,
              dea_finding_add(rows->ctx, unit.length > 0 || odd ? DEA_WARNING : DEA_NOTE, location,
                              "column %zu '%.*s' holds text ('%.*s') and is left out", i + 1,
                              shown(titles[i]), titles[i].text, shown(field), field.text));
    }
  }
  return DEA_OK;
}

/* The row in rows->row becomes the next one, after NAN for blank ones before it. */
static void keep_row(struct rows *rows)
{
  for (; rows->blank > 0; rows->blank--, rows->count++) {
    for (size_t i = 0; i < rows->dialect->count; i++) {
      if (rows->column[i] != NONE) {
        rows->table->columns[rows->column[i]].values[rows->count] = NAN;
      }
    }
  }
  for (size_t i = 0; i < rows->dialect->count; i++) {
    if (rows->column[i] != NONE) {
      rows->table->columns[rows->column[i]].values[rows->count] = rows->row[i];
    }
  }
  rows->count++;
}

/* Digits from `i` on. */
static size_t digits(struct dea_slice field, size_t i)
{
  size_t n = 0;
  while (i + n < field.length && field.text[i + n] >= '0' && field.text[i + n] <= '9') {
    n++;
  }
  return n;
}

void dea_text_marks_count(struct dea_text_marks *marks, struct dea_slice field, char decimal,
                          size_t line)
{
  size_t sign = field.length > 0 && (field.text[0] == '-' || field.text[0] == '+');
  size_t before = digits(field, sign), mark = sign + before;
  if (mark == field.length) {
    marks->plain += before > 0;
  } else if (field.text[mark] == decimal) {
    bool like = before >= 1 && before <= 3 && field.text[sign] != '0' &&
                digits(field, mark + 1) == 3 && mark + 4 == field.length;
    if (like && marks->thousands == 0) {
      marks->line = line;
      marks->first = field;
    }
    marks->thousands += like;
    marks->others += !like;
  }
}

/* "980, 1.020": a mark that comes with four digits parts thousands, also when it could be read as
 * the decimal one. So does a comma within quotes where commas part the fields. Points part
 * thousands where semicolons or tabs part the fields. */
bool dea_text_marks_refuse(struct dea_context *ctx, const struct dea_text_marks *m, char separator,
                           char decimal, const char *file, const char *name)
{
  const bool comma = decimal == ',', may = comma || separator == ';' || separator == '\t';
  if (!may || m->others > 0 || m->thousands < 2 || !(m->plain > 0 || (comma && separator == ','))) {
    return false;
  }
  const struct dea_location location = {file, m->line, 1};
  (void)dea_finding_add(ctx, DEA_ERROR, location,
                        "the '%c' of '%.*s' in '%.60s' seems to stand between thousands, since "
                        "three digits always follow it: export numbers without such marks, or "
                        "with the same number of decimals throughout",
                        decimal, shown(m->first), m->first.text, name);
  return true;
}

static dea_status refuse_thousands(struct rows *rows)
{
  for (size_t i = 0; i < rows->dialect->count; i++) {
    rows->errors += rows->column[i] != NONE &&
                    dea_text_marks_refuse(rows->ctx, &rows->marks[i], rows->dialect->separator,
                                          rows->dialect->decimal, rows->table->file,
                                          rows->table->columns[rows->column[i]].name);
  }
  return dea_context_status(rows->ctx) == DEA_E_MEMORY ? DEA_E_MEMORY : DEA_OK;
}

/* rest: the fields behind it. */
static dea_status read_field(struct rows *rows, size_t line, struct dea_slice whole, size_t index,
                             struct dea_slice field, struct dea_slice rest)
{
  if (index >= rows->dialect->count || rows->column[index] == NONE) {
    return DEA_OK;
  }
  bool clock = rows->clocks[index].begun, parted = clock && rows->fraction == index + 1;
  struct dea_slice part_field = {"", 0};
  double part = 0;
  bool good = !parted || (dea_slice_field(&rest, rows->dialect->separator, &part_field) &&
                          dea_slice_number(part_field, rows->dialect->decimal, &part));
  if (clock && good &&
      dea_text_clock_next(&rows->clocks[index], field, part * rows->fraction_s,
                          &rows->row[index])) {
    return DEA_OK;
  }
  if (!clock && dea_slice_number(field, rows->dialect->decimal, &rows->row[index])) {
    dea_text_marks_count(&rows->marks[index], field, rows->dialect->decimal, line);
    return DEA_OK;
  }
  const struct dea_location location = {rows->table->file, line,
                                        (size_t)(field.text - whole.text) + 1};
  rows->errors++;
  if (clock) {
    return dea_finding_add(rows->ctx, DEA_ERROR, location,
                           "'%.*s' is no time as those above it are", shown(field), field.text);
  }
  if (dea_slice_has_groups(field)) {
    return dea_finding_add(rows->ctx, DEA_ERROR, location,
                           "'%.*s' has marks between thousands: export numbers without them",
                           shown(field), field.text);
  }
  return dea_finding_add(rows->ctx, DEA_ERROR, location,
                         "'%.*s' is not a number%s; write a missing one as NaN or leave it empty",
                         shown(field), field.text,
                         rows->dialect->decimal == ',' ? " with a decimal comma" : "");
}

/* last: the file ends in this line, without a line end. */
static dea_status read_line(struct rows *rows, size_t line, struct dea_slice whole, bool last)
{
  const struct dea_csv_dialect *dialect = rows->dialect;
  struct dea_slice rest = whole, field = {"", 0};
  size_t count = dea_slice_count(whole, dialect->separator);
  const struct dea_location location = {rows->table->file, line, 1};
  if (last && count < dialect->count) {
    return dea_finding_add(rows->ctx, DEA_WARNING, location,
                           "the last line has %zu of %zu fields: the file was cut off there; the "
                           "line is left out",
                           count, dialect->count);
  }
  for (size_t i = 0; dea_slice_field(&rest, dialect->separator, &field); i++) {
    count -= i >= dialect->count && field.length == 0; // separators at the end of a line
  }
  if (count != dialect->count) {
    rows->errors++;
    return dea_finding_add(rows->ctx, DEA_ERROR, location,
                           "the line has %zu field%s where %zu are due: when another table begins "
                           "here, split the file",
                           count, count == 1 ? "" : "s", dialect->count);
  }
  if (rows->table->fields != NULL) {
    rows->table->fields->lines[rows->count] = whole;
    rows->table->fields->numbers[rows->count++] = line;
    return DEA_OK;
  }
  size_t before = rows->errors;
  rest = whole;
  for (size_t i = 0; dea_slice_field(&rest, dialect->separator, &field); i++) {
    DEA_TRY(rows->ctx, read_field(rows, line, whole, i, field, rest));
  }
  if (rows->errors == before) {
    keep_row(rows);
  }
  return DEA_OK;
}

/* Times as text often have whole seconds, and rows come faster: those are left out. */
static dea_status drop_standing_clocks(struct rows *rows)
{
  const struct dea_location location = {rows->table->file, rows->dialect->line + 1, 1};
  for (size_t i = 0; i < rows->dialect->count; i++) {
    if (rows->clocks[i].stands) {
      struct dea_table_column *column = &rows->table->columns[rows->column[i]];
      size_t after = rows->table->column_count - (size_t)rows->column[i] - 1;
      DEA_TRY(rows->ctx, dea_finding_add(rows->ctx, DEA_WARNING, location,
                                         "the times in '%.60s' repeat or fall, and are left out",
                                         column->name));
      dea_free(rows->ctx, column->name);
      dea_free(rows->ctx, column->unit);
      dea_free(rows->ctx, column->values);
      memmove(column, column + 1, after * sizeof *column);
      rows->table->column_count--;
      return DEA_OK; // there is one at most
    }
  }
  return DEA_OK;
}

static dea_status read_lines(struct rows *rows, struct dea_slice text)
{
  struct dea_lines lines = {rows->dialect->data, text.text + text.length, rows->dialect->line};
  struct dea_slice line;
  while (rows->errors < ERRORS_MAX && dea_lines_next(&lines, &line)) {
    if (dea_csv_is_comment(line) || dea_slice_trim(line).length == 0) {
      continue;
    }
    if (dea_csv_is_blank(line)) {
      rows->blank += dea_slice_count(line, rows->dialect->separator) >= rows->dialect->count;
      continue;
    }
    bool last = lines.next == lines.end && lines.end[-1] != '\n';
    DEA_TRY(rows->ctx, read_line(rows, lines.line, line, last));
    if ((lines.line & 0xffff) == 0) {
      dea_progress(rows->ctx, "reading", (size_t)(lines.next - text.text), text.length);
      if (dea_interrupted(rows->ctx)) {
        return dea_fail(rows->ctx, DEA_E_INTERRUPTED, "interrupted");
      }
    }
  }
  for (size_t i = 0; rows->column != NULL && i < rows->dialect->count;
       i++) { // a table may have those of other sections
    if (rows->column[i] != NONE) {
      rows->table->columns[rows->column[i]].count = rows->count;
    }
  }
  if (rows->errors == 0 && rows->column != NULL) {
    DEA_TRY(rows->ctx, refuse_thousands(rows));
    DEA_TRY(rows->ctx, drop_standing_clocks(rows));
  }
  return rows->errors == 0 ? DEA_OK
                           : dea_fail(rows->ctx, DEA_E_IO, "'%s' has lines that cannot be read",
                                      rows->table->file);
}

dea_status dea_text_rows_read(struct dea_context *ctx, struct dea_slice text,
                              const struct dea_csv_dialect *dialect, const struct dea_slice *titles,
                              const struct dea_slice *units, struct dea_table *out)
{
  struct rows rows = {.ctx = ctx, .dialect = dialect, .table = out};
  rows.column = dea_alloc(ctx, dialect->count, sizeof *rows.column);
  rows.row = rows.column != NULL ? dea_alloc(ctx, dialect->count, sizeof *rows.row) : NULL;
  rows.marks = rows.row != NULL ? dea_alloc(ctx, dialect->count, sizeof *rows.marks) : NULL;
  rows.clocks = rows.marks != NULL ? dea_alloc(ctx, dialect->count, sizeof *rows.clocks) : NULL;
  dea_status status = rows.clocks != NULL ? add_columns(&rows, text, titles, units) : DEA_E_MEMORY;
  status = status == DEA_OK ? read_lines(&rows, text) : status;
  dea_free(ctx, rows.column);
  dea_free(ctx, rows.row);
  dea_free(ctx, rows.marks);
  dea_free(ctx, rows.clocks);
  return status;
}

dea_status dea_text_lines_read(struct dea_context *ctx, struct dea_slice text,
                               const struct dea_csv_dialect *dialect, struct dea_table *out)
{
  struct rows rows = {.ctx = ctx, .dialect = dialect, .table = out};
  const size_t capacity = rows_room(text, dialect);
  out->fields->lines = dea_alloc(ctx, capacity, sizeof *out->fields->lines);
  out->fields->numbers = dea_alloc(ctx, capacity, sizeof *out->fields->numbers);
  DEA_TRY_MEMORY(out->fields->lines != NULL && out->fields->numbers != NULL);
  const dea_status status = read_lines(&rows, text);
  out->fields->rows = rows.count;
  return status;
}

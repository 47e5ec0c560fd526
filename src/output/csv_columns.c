#include "output/csv_columns.h"

#include "base/csv_line.h"
#include "base/file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FILE_MAX = 100000000, FIELDS_MAX = 64, FINDINGS_MAX = 20 };

struct reader {
  struct dea_context *ctx;
  const struct dea_csv_wanted *wanted;
  size_t wanted_count;
  struct dea_csv_columns *out;
  char separator;
  size_t line, room, errors, field_count;
  int meaning[FIELDS_MAX]; // of each field: index of wanted, -1: none
  double factor[DEA_CSV_COLUMNS_MAX];
};

bool dea_csv_unit(struct dea_context *ctx, const char *unit, struct dea_measure due, double *factor,
                  char why[DEA_WHY_SIZE])
{
  char one[DEA_CSV_FIELD_MAX + 2];
  snprintf(one, sizeof one, "1 %s", unit);
  return dea_units_read(ctx, one, due, factor, why);
}

/* Counts an error; false when its finding should no longer be added. */
static bool one_more(struct reader *r, size_t column, struct dea_location *location)
{
  *location = (struct dea_location){r->out->file, r->line, column};
  return ++r->errors <= FINDINGS_MAX;
}

static dea_status read_unit(struct reader *r, int w, const char *title, const char *unit,
                            size_t column)
{
  char why[DEA_WHY_SIZE] = "";
  struct dea_location location;
  if (unit[0] == '\0' && strcmp(r->wanted[w].measure.unit, "1") == 0) {
    r->factor[w] = 1;
    return DEA_OK;
  }
  if (unit[0] == '\0') {
    return one_more(r, column, &location)
               ? dea_finding_add(r->ctx, DEA_ERROR, location,
                                 "'%s' needs a unit in parentheses, for example '%s'", title,
                                 r->wanted[w].title)
               : DEA_OK;
  }
  if (dea_csv_unit(r->ctx, unit, r->wanted[w].measure, &r->factor[w], why)) {
    return DEA_OK;
  }
  if (why[0] == '\0') {
    return dea_context_status(r->ctx);
  }
  return one_more(r, column, &location)
             ? dea_finding_add(r->ctx, DEA_ERROR, location, "the unit in '%s' does not fit: %s",
                               title, why)
             : DEA_OK;
}

static dea_status read_title(struct reader *r, const char *title, size_t column)
{
  char name[DEA_CSV_FIELD_MAX], unit[DEA_CSV_FIELD_MAX];
  struct dea_location location = {r->out->file, r->line, column};
  int *meaning = &r->meaning[r->field_count++];
  *meaning = -1;
  dea_csv_split_title(title, name, unit);
  for (size_t w = 0; w < r->wanted_count && *meaning < 0; w++) {
    *meaning = strcmp(name, r->wanted[w].name) == 0 ? (int)w : -1;
  }
  if (*meaning < 0) {
    return dea_finding_add(r->ctx, DEA_NOTE, location, "column '%s' is not used", title);
  }
  for (size_t f = 0; f + 1 < r->field_count; f++) {
    if (r->meaning[f] == *meaning) {
      return one_more(r, column, &location)
                 ? dea_finding_add(r->ctx, DEA_ERROR, location, "'%s' is there twice", title)
                 : DEA_OK;
    }
  }
  return read_unit(r, *meaning, title, unit, column);
}

static dea_status read_header(struct reader *r, const char *line)
{
  const char *cursor = line;
  char title[DEA_CSV_FIELD_MAX];
  size_t column;
  struct dea_location location;
  bool there[DEA_CSV_COLUMNS_MAX] = {false};
  r->separator = dea_csv_separator(line);
  while (dea_csv_field(line, &cursor, r->separator, title, &column)) {
    if (r->field_count == FIELDS_MAX) {
      return one_more(r, column, &location)
                 ? dea_finding_add(r->ctx, DEA_ERROR, location, "more than %d columns", FIELDS_MAX)
                 : DEA_OK;
    }
    DEA_TRY(r->ctx, read_title(r, title, column));
    int meaning = r->meaning[r->field_count - 1];
    if (meaning >= 0) {
      there[meaning] = true;
    }
  }
  for (size_t w = 0; w < r->wanted_count; w++) {
    if (r->wanted[w].needed && !there[w] && one_more(r, 1, &location)) {
      DEA_TRY(r->ctx, dea_finding_add(r->ctx, DEA_ERROR, location, "no column such as '%s'",
                                      r->wanted[w].title));
    }
  }
  return DEA_OK;
}

/* Room for one more row in all columns that are there. */
static bool grow(struct reader *r)
{
  if (r->out->rows < r->room) {
    return true;
  }
  size_t room = r->room > 0 ? 2 * r->room : 256;
  size_t *line = dea_resize(r->ctx, r->out->line, room, sizeof *line);
  if (line == NULL) {
    return false;
  }
  r->out->line = line;
  for (size_t f = 0; f < r->field_count; f++) {
    if (r->meaning[f] >= 0) {
      double **values = &r->out->values[r->meaning[f]];
      double *moved = dea_resize(r->ctx, *values, room, sizeof *moved);
      if (moved == NULL) {
        return false;
      }
      *values = moved;
    }
  }
  r->room = room;
  return true;
}

/* One field of a row; value: NAN for one that is empty. */
static dea_status read_field(struct reader *r, size_t field, char *text, size_t column)
{
  int w = r->meaning[field];
  struct dea_location location;
  char shown[DEA_CSV_FIELD_MAX];
  double value;
  if (w < 0) {
    return DEA_OK;
  }
  snprintf(shown, sizeof shown, "%s", text);
  bool number = dea_csv_number(r->separator, text, &value);
  if (number && (!isnan(value) || !r->wanted[w].filled)) {
    r->out->values[w][r->out->rows] = value * r->factor[w];
    return DEA_OK;
  }
  if (!one_more(r, column, &location)) {
    return DEA_OK;
  }
  return number ? dea_finding_add(r->ctx, DEA_ERROR, location, "a row without '%s'",
                                  r->wanted[w].title)
                : dea_finding_add(r->ctx, DEA_ERROR, location, "'%s' is not a number", shown);
}

static dea_status read_row(struct reader *r, const char *line)
{
  const char *cursor = line;
  char text[DEA_CSV_FIELD_MAX];
  size_t column = 1, field = 0, before = r->errors;
  struct dea_location location;
  bool more = false;
  if (!grow(r)) {
    return DEA_E_MEMORY;
  }
  for (; !more && dea_csv_field(line, &cursor, r->separator, text, &column); field++) {
    more = field == r->field_count;
    if (!more) {
      DEA_TRY(r->ctx, read_field(r, field, text, column));
    }
  }
  if ((more || field < r->field_count) && one_more(r, column, &location)) {
    DEA_TRY(r->ctx, dea_finding_add(
                        r->ctx, DEA_ERROR, location, "%s fields than the header, which has %zu%s",
                        more ? "more" : "fewer", r->field_count,
                        more && r->separator == ','
                            ? "; where the decimal sign is a comma, columns are parted by ;"
                            : ""));
  }
  r->out->line[r->out->rows] = r->line;
  r->out->rows += r->errors == before ? 1 : 0;
  return DEA_OK;
}

static dea_status read_lines(struct reader *r, char *text)
{
  struct dea_location location;
  const char *line = dea_csv_line(&text, &r->line);
  if (line != NULL) {
    DEA_TRY(r->ctx, read_header(r, line));
  }
  bool header_good = r->errors == 0; // without one the rows say nothing
  while (header_good && r->errors < FINDINGS_MAX &&
         (line = dea_csv_line(&text, &r->line)) != NULL) {
    DEA_TRY(r->ctx, read_row(r, line));
  }
  if (r->out->rows == 0 && r->errors == 0 && one_more(r, 1, &location)) {
    return dea_finding_add(r->ctx, DEA_ERROR, location, "no rows of numbers");
  }
  return DEA_OK;
}

static dea_status read_text(struct reader *r, char *text, size_t length)
{
  const char *file = r->out->file;
  if (memchr(text, '\0', length) != NULL) {
    return dea_fail(r->ctx, DEA_E_IO, "%s is not a text file", file);
  }
  DEA_TRY(r->ctx, read_lines(r, text));
  return r->errors == 0 ? DEA_OK
                        : dea_fail(r->ctx, DEA_E_IO, "%s cannot be used: %zu error%s", file,
                                   r->errors, r->errors == 1 ? "" : "s");
}

dea_status dea_csv_columns_read(struct dea_context *ctx, const char *file,
                                const struct dea_csv_wanted *wanted, size_t count,
                                struct dea_csv_columns *out)
{
  struct reader r = {.ctx = ctx, .wanted = wanted, .wanted_count = count, .out = out};
  char *text;
  size_t length;
  *out = (struct dea_csv_columns){.file = dea_intern(ctx, file)};
  if (out->file == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status read = dea_file_read(ctx, file, FILE_MAX, &text, &length);
  DEA_TRY(ctx, read == DEA_E_DESIGN ? dea_fail(ctx, DEA_E_IO, "'%s' is too large", file) : read);
  dea_status status = read_text(&r, text, length);
  dea_free(ctx, text);
  if (status != DEA_OK) {
    dea_csv_columns_free(ctx, out);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}

void dea_csv_columns_free(struct dea_context *ctx, struct dea_csv_columns *columns)
{
  dea_free(ctx, columns->line);
  for (int c = 0; c < DEA_CSV_COLUMNS_MAX; c++) {
    dea_free(ctx, columns->values[c]);
  }
  *columns = (struct dea_csv_columns){0};
}

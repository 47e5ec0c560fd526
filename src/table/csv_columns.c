#include "table/csv_columns.h"

#include "base/csv_line.h"
#include "table/fields.h"
#include "table/titles.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FINDINGS_MAX = 20 };

struct reader {
  struct dea_context *ctx;
  const struct dea_csv_wanted *wanted;
  size_t wanted_count;
  struct dea_csv_columns *out;
  struct dea_fields fields;
  size_t errors;
  size_t at[DEA_CSV_COLUMNS_MAX]; // field of each wanted one, from 1; 0: not there
  bool strain[DEA_CSV_COLUMNS_MAX];
  double factor[DEA_CSV_COLUMNS_MAX];
  struct dea_text_marks marks[DEA_CSV_COLUMNS_MAX];
};

bool dea_csv_unit(struct dea_context *ctx, const char *unit, struct dea_measure due, double *factor,
                  char why[DEA_WHY_SIZE])
{
  char one[DEA_CSV_FIELD_MAX + 2];
  snprintf(one, sizeof one, "1 %s", unit);
  return dea_units_read(ctx, one, due, factor, why);
}

/* Where an error is; false when there are too many to be told. */
static bool one_more(struct reader *r, struct dea_slice piece, struct dea_location *location)
{
  *location = dea_fields_place(&r->fields, piece);
  return ++r->errors <= FINDINGS_MAX;
}

/* Factor of a unit: as people write it, or an error. */
static dea_status read_unit(struct reader *r, size_t w, struct dea_slice title, const char *unit)
{
  static const char *const ones[] = {"-", "1", "mm/mm", "m/m", "in/in"};
  const struct dea_measure due = r->wanted[w].measure;
  const bool one = strcmp(due.unit, "1") == 0;
  char why[DEA_WHY_SIZE] = "";
  struct dea_location location;
  r->factor[w] = one && strcmp(unit, "%") == 0 ? 0.01 : 1;
  bool good = one && (unit[0] == '\0' || strcmp(unit, "%") == 0);
  for (size_t i = 0; one && i < sizeof ones / sizeof ones[0]; i++) {
    good = good || strcmp(unit, ones[i]) == 0;
  }
  const char *si = good || unit[0] == '\0' ? NULL : dea_title_unit(r->ctx, unit, &r->factor[w]);
  if (good || (si != NULL && !one && strcmp(si, due.unit) == 0) ||
      (unit[0] != '\0' && dea_csv_unit(r->ctx, unit, due, &r->factor[w], why))) {
    return DEA_OK;
  }
  if (unit[0] != '\0' && why[0] == '\0') {
    return dea_context_status(r->ctx);
  }
  const int length = (int)(title.length < 60 ? title.length : 60);
  if (!one_more(r, title, &location)) {
    return DEA_OK;
  }
  return unit[0] == '\0'
             ? dea_finding_add(r->ctx, DEA_ERROR, location,
                               "'%.*s' needs a unit in parentheses, for example '%s'", length,
                               title.text, r->wanted[w].title)
             : dea_finding_add(r->ctx, DEA_ERROR, location, "the unit in '%.*s' does not fit: %s",
                               length, title.text, why);
}

/* Whether a name is that of a strain, which is 1 less than a stretch. */
static bool is_strain(const char *name)
{
  static const char *const words[] = {"strain", "dehnung"};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
    const char *at = strstr(name, words[i]);
    if (at != NULL && at[strlen(words[i])] == '\0' && strstr(name, "true") == NULL &&
        strstr(name, "log") == NULL) {
      return true;
    }
  }
  return false;
}

static bool has_name(const struct dea_csv_wanted *wanted, const char *name)
{
  bool has = strcmp(name, wanted->name) == 0;
  for (size_t i = 0; i < 2; i++) {
    has = has || (wanted->other[i] != NULL && strcmp(name, wanted->other[i]) == 0);
  }
  return has;
}

static dea_status read_title(struct reader *r, size_t column)
{
  char name[DEA_CSV_FIELD_MAX], unit[DEA_CSV_FIELD_MAX];
  const struct dea_slice title = r->fields.titles[column];
  const int length = (int)(title.length < 60 ? title.length : 60);
  const struct dea_location location = dea_fields_place(&r->fields, title);
  dea_fields_title(r->ctx, &r->fields, column, name, unit);
  size_t w = 0;
  while (w < r->wanted_count && !has_name(&r->wanted[w], name)) {
    w++;
  }
  for (size_t k = 0; w == r->wanted_count && k < r->wanted_count; k++) {
    w = r->wanted[k].strain && !r->wanted[k].needed && is_strain(name) && r->at[k] == 0 ? k : w;
  }
  if (w == r->wanted_count && length == 0) {
    return DEA_OK;
  }
  if (w == r->wanted_count) {
    return dea_finding_add(r->ctx, DEA_NOTE, location, "column '%.*s' is not used", length,
                           title.text);
  }
  if (r->at[w] > 0) {
    r->errors++;
    return dea_finding_add(r->ctx, DEA_ERROR, location, "'%.*s' is there twice", length,
                           title.text);
  }
  r->at[w] = column + 1;
  r->strain[w] = r->wanted[w].strain && is_strain(name);
  return read_unit(r, w, title, unit);
}

static dea_status read_titles(struct reader *r)
{
  struct dea_location location;
  for (size_t f = 0; f < r->fields.count; f++) {
    DEA_TRY(r->ctx, read_title(r, f));
  }
  for (size_t w = 0; w < r->wanted_count; w++) {
    if (r->wanted[w].needed && r->at[w] == 0 && one_more(r, r->fields.titles[0], &location)) {
      DEA_TRY(r->ctx, dea_finding_add(r->ctx, DEA_ERROR, location, "no column such as '%s'",
                                      r->wanted[w].title));
    }
  }
  return DEA_OK;
}

/* The field of a row for wanted column w. */
static dea_status read_field(struct reader *r, size_t row, size_t w, struct dea_slice field)
{
  struct dea_location location;
  double value;
  if (!dea_fields_number(r->ctx, &r->fields, row, field, &r->marks[w], &value)) {
    r->errors++;
    return dea_context_status(r->ctx) == DEA_E_MEMORY ? DEA_E_MEMORY : DEA_OK;
  }
  r->out->values[w][row] = value * r->factor[w] + (r->strain[w] ? 1 : 0);
  return isnan(value) && r->wanted[w].filled && one_more(r, field, &location)
             ? dea_finding_add(r->ctx, DEA_ERROR, location, "a row without '%s'",
                               r->wanted[w].title)
             : DEA_OK;
}

static dea_status read_rows(struct reader *r)
{
  for (size_t w = 0; w < r->wanted_count; w++) {
    if (r->at[w] > 0) {
      r->out->values[w] = dea_alloc(r->ctx, r->fields.rows, sizeof(double));
      DEA_TRY(r->ctx, r->out->values[w] != NULL ? DEA_OK : DEA_E_MEMORY);
    }
  }
  for (size_t row = 0; row < r->fields.rows && r->errors < FINDINGS_MAX; row++) {
    struct dea_slice rest = r->fields.lines[row], field;
    for (size_t f = 0; dea_slice_field(&rest, r->fields.separator, &field); f++) {
      for (size_t w = 0; w < r->wanted_count; w++) {
        DEA_TRY(r->ctx, r->at[w] == f + 1 ? read_field(r, row, w, field) : DEA_OK);
      }
    }
  }
  for (size_t w = 0; w < r->wanted_count && r->errors == 0; w++) {
    r->errors += r->at[w] > 0 &&
                 dea_text_marks_refuse(r->ctx, &r->marks[w], r->fields.separator, r->fields.decimal,
                                       r->fields.file, r->wanted[w].title);
  }
  return DEA_OK;
}

static dea_status read_fields(struct reader *r)
{
  const char *file = r->out->file;
  DEA_TRY(r->ctx, read_titles(r));
  if (r->errors == 0) { // without titles the rows say nothing
    DEA_TRY(r->ctx, read_rows(r));
  }
  r->out->rows = r->fields.rows;
  r->out->line = r->fields.numbers;
  r->fields.numbers = NULL;
  return r->errors == 0 ? DEA_OK
                        : dea_fail(r->ctx, DEA_E_IO, "%s cannot be used: %zu error%s", file,
                                   r->errors, r->errors == 1 ? "" : "s");
}

dea_status dea_csv_columns_read(struct dea_context *ctx, const char *file,
                                const struct dea_csv_wanted *wanted, size_t count,
                                struct dea_csv_columns *out)
{
  struct reader r = {.ctx = ctx, .wanted = wanted, .wanted_count = count, .out = out};
  *out = (struct dea_csv_columns){0};
  DEA_TRY(ctx, dea_fields_read(ctx, file, &r.fields));
  out->file = r.fields.file;
  const dea_status status = read_fields(&r);
  dea_fields_free(ctx, &r.fields);
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

#include "table/csv_columns.h"

#include "base/csv_line.h"
#include "base/file.h"
#include "table/csv_text.h"
#include "table/fields.h"
#include "table/text_file.h"
#include "table/titles.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FINDINGS_MAX = 20, FILE_MAX = 100000000 };

// Fields ------------------------------------------------------------------------------------------

static dea_status read_file(struct dea_context *ctx, const char *file, struct dea_fields *out)
{
  struct dea_table table = {.file = dea_intern(ctx, file), .fields = out};
  size_t length;
  *out = (struct dea_fields){.file = table.file};
  DEA_TRY_MEMORY(table.file != NULL);
  const dea_status read = dea_file_read(ctx, file, FILE_MAX, &out->bytes, &length);
  DEA_TRY(ctx, read == DEA_E_DESIGN ? dea_fail(ctx, DEA_E_IO, "'%s' is too large", file) : read);
  return DEA_CHAIN(ctx, dea_text_file_read(ctx, (const unsigned char *)out->bytes, length,
                                           dea_table_read_text, &table));
}

static void free_fields(struct dea_context *ctx, struct dea_fields *fields)
{
  dea_free(ctx, fields->titles);
  dea_free(ctx, fields->lines);
  dea_free(ctx, fields->numbers);
  dea_free(ctx, fields->bytes);
  dea_free(ctx, fields->copy);
}

/* Where a piece of its text stands. */
static struct dea_location place_of(const struct dea_fields *fields, struct dea_slice piece)
{
  struct dea_location at = {fields->file, 1, 1};
  const char *end = fields->text.text + fields->text.length;
  for (const char *c = fields->text.text; c < piece.text && c < end; c++) {
    at.column = *c == '\n' ? 1 : at.column + 1;
    at.line += *c == '\n';
  }
  return at;
}

static void copy_slice(struct dea_slice slice, char *out)
{
  const size_t n = slice.length < DEA_CSV_FIELD_MAX ? slice.length : DEA_CSV_FIELD_MAX - 1;
  if (n > 0) {
    memcpy(out, slice.text, n);
  }
  out[n] = '\0';
}

/* Name and unit of a column's title, each DEA_CSV_FIELD_MAX bytes; the name as dea_csv_fold has it,
 * also where its unit is none that is known. */
static void split_title(struct dea_context *ctx, const struct dea_fields *fields, size_t column,
                        char *name, char *unit)
{
  char title[DEA_CSV_FIELD_MAX];
  struct dea_slice bare, own = fields->units[column];
  copy_slice(fields->titles[column], title);
  dea_csv_split_title(title, name, unit);
  if (unit[0] == '\0' && own.length > 0) {
    const bool bracket = own.length > 2 && (own.text[0] == '(' || own.text[0] == '[');
    copy_slice(bracket ? (struct dea_slice){own.text + 1, own.length - 2} : own, unit);
  } else if (unit[0] == '\0') {
    dea_title_split(ctx, fields->titles[column], &bare, &own);
    copy_slice(own, unit);
    copy_slice(bare, title);
    dea_csv_fold(title, name);
  }
}

/* "1e999" and "inf", which are no words for a missing value. */
static bool is_too_large(struct dea_slice field, double value)
{
  char text[DEA_CSV_FIELD_MAX];
  const char *end;
  copy_slice(field, text);
  return value != value && isinf(dea_text_to_double(text, &end)) && *end == '\0';
}

/* The number of a field of a row, NAN for a missing one. What is none is an error, and false.
 * marks: of this column. */
static bool read_number(struct dea_context *ctx, const struct dea_fields *fields, size_t row,
                        struct dea_slice field, struct dea_text_marks *marks, double *value)
{
  // "3.5" among decimal commas, where a comma parts no fields
  const char other = fields->separator == ',' || dea_slice_has_groups(field) ? fields->decimal
                     : fields->decimal == ','                                ? '.'
                                                                             : ',';
  const bool number =
      dea_slice_number(field, fields->decimal, value) || dea_slice_number(field, other, value);
  if (number && !is_too_large(field, *value)) {
    dea_text_marks_count(marks, field, fields->decimal, fields->numbers[row]);
    return true;
  }
  const struct dea_location here = {fields->file, fields->numbers[row],
                                    (size_t)(field.text - fields->lines[row].text) + 1};
  (void)dea_finding_add(ctx, DEA_ERROR, here,
                        dea_slice_has_groups(field)
                            ? "'%.*s' has marks between thousands: export numbers without them"
                            : "'%.*s' is not a number",
                        (int)(field.length < 40 ? field.length : 40), field.text);
  return false;
}

// Columns -----------------------------------------------------------------------------------------

/* What a column of the file is. */
struct meaning {
  double *values; // of that wanted, or its std; NULL: not used
  size_t wanted;
  bool std, strain;
  double factor;
  struct dea_text_marks marks;
};

struct reader {
  struct dea_context *ctx;
  const struct dea_csv_wanted *wanted;
  size_t wanted_count;
  const char *known;
  struct dea_csv_columns *out;
  struct dea_fields fields;
  struct meaning *meanings; // [fields.count]
  size_t errors;
};

/* Where an error is; false when there are too many to be told. */
static bool one_more(struct reader *r, struct dea_slice piece, struct dea_location *location)
{
  *location = place_of(&r->fields, piece);
  return ++r->errors <= FINDINGS_MAX;
}

/* Factor of a unit: as people write it, or an error. */
static dea_status read_unit(struct reader *r, const struct dea_csv_wanted *w,
                            struct dea_slice title, const char *unit, double *factor)
{
  static const char *const ones[] = {"-", "1", "mm/mm", "m/m", "in/in"};
  const bool one = strcmp(w->measure.unit, "1") == 0;
  char why[DEA_WHY_SIZE] = "", text[DEA_CSV_FIELD_MAX + 2];
  struct dea_location location;
  *factor = one && strcmp(unit, "%") == 0 ? 0.01 : 1;
  bool good = one && (unit[0] == '\0' || strcmp(unit, "%") == 0);
  for (size_t i = 0; one && i < sizeof ones / sizeof ones[0]; i++) {
    good = good || strcmp(unit, ones[i]) == 0;
  }
  const char *si = good || unit[0] == '\0' ? NULL : dea_title_unit(r->ctx, unit, factor);
  snprintf(text, sizeof text, "1 %s", unit);
  if (good || (si != NULL && !one && strcmp(si, w->measure.unit) == 0) ||
      (unit[0] != '\0' && dea_units_read(r->ctx, text, w->measure, factor, why))) {
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
                               title.text, w->title)
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

static bool is_name(const char *name, const char *of)
{
  return of != NULL && strcmp(name, of) == 0;
}

/* Number of the column wanted that a name means; count: none. */
static size_t find_wanted(const struct reader *r, const char *name)
{
  for (size_t w = 0; w < r->wanted_count; w++) {
    const struct dea_csv_wanted *one = &r->wanted[w];
    bool has = is_name(name, one->name) || is_name(name, one->key);
    for (size_t i = 0; i < sizeof one->other / sizeof one->other[0]; i++) {
      has = has || is_name(name, one->other[i]);
    }
    if (has) {
      return w;
    }
  }
  for (size_t w = 0; w < r->wanted_count; w++) {
    if (r->wanted[w].strain && !r->wanted[w].needed && is_strain(name) &&
        r->out->values[w] == NULL) {
      return w;
    }
  }
  return r->wanted_count;
}

/* Cuts the word for an uncertainty from the end of a name; whether there was one. */
static bool cut_std(char *name)
{
  static const char *const words[] = {"std", "err", "error", "uncertainty"};
  size_t length = strlen(name);
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
    size_t n = strlen(words[i]);
    bool alone = strcmp(name, words[i]) == 0;
    if (alone ||
        (length > n && name[length - n - 1] == ' ' && strcmp(name + length - n, words[i]) == 0)) {
      name[alone ? 0 : length - n - 1] = '\0';
      return true;
    }
  }
  return false;
}

/* The title nearest to a name that is none; NULL where none is near. */
static dea_status find_nearest(struct reader *r, const char *name, const char **title)
{
  enum { NAMES = 2 + sizeof r->wanted->other / sizeof r->wanted->other[0] };
  struct dea_arena memory = {.ctx = r->ctx};
  const char **names = dea_arena_alloc(&memory, NAMES * r->wanted_count, sizeof *names);
  size_t count = 0;
  *title = NULL;
  for (size_t w = 0; names != NULL && w < r->wanted_count; w++) {
    for (size_t k = 0; k < NAMES; k++) {
      const char *one = k == 0   ? r->wanted[w].name
                        : k == 1 ? r->wanted[w].key
                                 : r->wanted[w].other[k - 2];
      if (one != NULL) {
        names[count++] = one;
      }
    }
  }
  const char *nearest = names != NULL ? dea_nearest_name(name, names, count) : NULL;
  if (nearest != NULL) {
    *title = r->wanted[find_wanted(r, nearest)].title;
  }
  const dea_status status = dea_arena_status(&memory);
  dea_arena_free(&memory);
  return status;
}

static dea_status unknown_title(struct reader *r, struct dea_slice title, const char *name)
{
  const int length = (int)(title.length < 60 ? title.length : 60);
  struct dea_location location = place_of(&r->fields, title);
  const char *nearest;
  if (length == 0) {
    return DEA_OK;
  }
  if (r->known == NULL) {
    return dea_finding_add(r->ctx, DEA_NOTE, location, "column '%.*s' is not used", length,
                           title.text);
  }
  if (!one_more(r, title, &location)) {
    return DEA_OK;
  }
  DEA_TRY(r->ctx, find_nearest(r, name, &nearest));
  return dea_finding_add(r->ctx, DEA_ERROR, location, "'%.*s' is not a known quantity; %s%s%s",
                         length, title.text,
                         nearest != NULL ? "did you mean '" : "known are, for example, ",
                         nearest != NULL ? nearest : r->known, nearest != NULL ? "'?" : "");
}

static dea_status read_title(struct reader *r, size_t column)
{
  char name[DEA_CSV_FIELD_MAX], unit[DEA_CSV_FIELD_MAX];
  struct meaning *m = &r->meanings[column];
  const struct meaning *before = column > 0 ? m - 1 : NULL;
  const struct dea_slice title = r->fields.titles[column];
  const int length = (int)(title.length < 60 ? title.length : 60);
  split_title(r->ctx, &r->fields, column, name, unit);
  m->wanted = find_wanted(r, name);
  if (m->wanted == r->wanted_count && cut_std(name)) {
    m->std = true;
    m->wanted = name[0] != '\0'  ? find_wanted(r, name)
                : before != NULL ? before->wanted
                                 : m->wanted;
    if (m->wanted < r->wanted_count && !r->wanted[m->wanted].uncertain) {
      m->wanted = r->wanted_count;
    }
  }
  if (m->wanted == r->wanted_count) {
    return unknown_title(r, title, name);
  }
  const struct dea_csv_wanted *w = &r->wanted[m->wanted];
  double **values = m->std ? &r->out->std[m->wanted] : &r->out->values[m->wanted];
  struct dea_location location = place_of(&r->fields, title);
  if (*values != NULL) {
    r->errors++;
    return dea_finding_add(r->ctx, DEA_ERROR, location, "'%.*s' is there twice", length,
                           title.text);
  }
  *values = m->values = dea_arena_alloc(&r->out->memory, r->fields.rows, sizeof(double));
  DEA_TRY(r->ctx, dea_arena_status(&r->out->memory));
  if (w->guess != NULL && strcmp(name, w->guess) == 0) {
    DEA_TRY(r->ctx,
            dea_finding_add(r->ctx, DEA_NOTE, location, "'%.*s' %s", length, title.text, w->note));
  }
  m->strain = w->strain && is_strain(name);
  m->factor = m->std && name[0] == '\0' ? before->factor : 1;
  const bool said = (m->std && name[0] == '\0') || is_name(name, w->key) || w->parse != NULL;
  return unit[0] == '\0' && said ? DEA_OK : read_unit(r, w, title, unit, &m->factor);
}

static dea_status read_titles(struct reader *r)
{
  struct dea_location location;
  for (size_t f = 0; f < r->fields.count; f++) {
    DEA_TRY(r->ctx, read_title(r, f));
  }
  for (size_t w = 0; w < r->wanted_count; w++) {
    if (r->wanted[w].needed && r->out->values[w] == NULL &&
        one_more(r, r->fields.titles[0], &location)) {
      DEA_TRY(r->ctx, dea_finding_add(r->ctx, DEA_ERROR, location, "no column such as '%s'",
                                      r->wanted[w].title));
    }
  }
  return DEA_OK;
}

/* The field of a row, of a column that is used. */
static dea_status read_field(struct reader *r, size_t row, struct meaning *m,
                             struct dea_slice field)
{
  const struct dea_csv_wanted *wanted = &r->wanted[m->wanted];
  struct dea_location location;
  double value;
  if (wanted->parse != NULL) {
    char words[DEA_CSV_FIELD_MAX];
    snprintf(words, sizeof words, "%.*s", (int)(field.length < sizeof words ? field.length : 0),
             field.text);
    m->values[row] = wanted->parse(words);
    return DEA_OK;
  }
  if (!read_number(r->ctx, &r->fields, row, field, &m->marks, &value)) {
    r->errors++;
    return dea_context_status(r->ctx) == DEA_E_MEMORY ? DEA_E_MEMORY : DEA_OK;
  }
  m->values[row] = value * m->factor + (m->strain ? 1 : 0);
  return isnan(value) && wanted->filled && !m->std && one_more(r, field, &location)
             ? dea_finding_add(r->ctx, DEA_ERROR, location, "a row without '%s'", wanted->title)
             : DEA_OK;
}

static dea_status read_rows(struct reader *r)
{
  for (size_t row = 0; row < r->fields.rows && r->errors < FINDINGS_MAX; row++) {
    struct dea_slice rest = r->fields.lines[row], field;
    for (size_t f = 0; f < r->fields.count && dea_slice_field(&rest, r->fields.separator, &field);
         f++) {
      DEA_TRY(r->ctx,
              r->meanings[f].values != NULL ? read_field(r, row, &r->meanings[f], field) : DEA_OK);
    }
  }
  for (size_t f = 0; f < r->fields.count && r->errors == 0; f++) {
    struct meaning *m = &r->meanings[f];
    r->errors += m->values != NULL &&
                 dea_text_marks_refuse(r->ctx, &m->marks, r->fields.separator, r->fields.decimal,
                                       r->fields.file, r->wanted[m->wanted].title);
  }
  return DEA_OK;
}

static dea_status read_fields(struct reader *r)
{
  const char *file = r->out->file;
  struct dea_arena *memory = &r->out->memory;
  r->meanings = dea_arena_alloc(memory, r->fields.count, sizeof *r->meanings);
  r->out->values = dea_arena_alloc(memory, r->wanted_count, sizeof *r->out->values);
  r->out->std = dea_arena_alloc(memory, r->wanted_count, sizeof *r->out->std);
  DEA_TRY(r->ctx, dea_arena_status(memory));
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
                                const char *known, struct dea_csv_columns *out)
{
  struct reader r = {
      .ctx = ctx, .wanted = wanted, .wanted_count = count, .known = known, .out = out};
  *out = (struct dea_csv_columns){.memory = {.ctx = ctx}};
  dea_status status = read_file(ctx, file, &r.fields);
  out->file = r.fields.file;
  status = status == DEA_OK ? read_fields(&r) : status;
  free_fields(ctx, &r.fields);
  DEA_TRY_ELSE(ctx, status, dea_csv_columns_free(ctx, out));
  return DEA_OK;
}

void dea_csv_columns_free(struct dea_context *ctx, struct dea_csv_columns *columns)
{
  dea_free(ctx, columns->line);
  dea_arena_free(&columns->memory);
  *columns = (struct dea_csv_columns){0};
}

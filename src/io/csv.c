#include "io/csv.h"

#include "base/write_file.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

void dea_column_title(const struct dea_column *column, char *out, size_t size)
{
  if (strcmp(column->display_unit, "1") == 0) {
    snprintf(out, size, "%s", column->header);
  } else {
    snprintf(out, size, "%s (%s)", column->header, column->display_unit);
  }
}

static void add_number(struct dea_text *text, double value)
{
  if (!isnan(value)) {
    dea_text_add(text, "%.12g", value);
  }
}

/* A file that is being written. */
struct sheet {
  struct dea_text text;
  int count;     // of columns
  bool *columns; // [count] those that hold a number at some point; owned
  bool any;      // a line, without which there is no file
};

static dea_status begin_sheet(struct dea_context *ctx, struct sheet *out)
{
  *out = (struct sheet){.text = {.ctx = ctx}, .count = dea_column_count(ctx)};
  out->columns = dea_alloc(ctx, (size_t)out->count, sizeof *out->columns);
  return out->columns != NULL ? DEA_OK : DEA_E_MEMORY;
}

/* Writes directory/MODEL_KIND.csv, or MODEL_KIND_WHAT.csv; kind, what: "" for none. */
static void name_sheet(const char *model, const char *kind, const char *what,
                       char out[DEA_RESULT_TABLE_FILE_SIZE])
{
  snprintf(out, DEA_RESULT_TABLE_FILE_SIZE, "%s%s%s%s%s.csv", model, kind[0] != '\0' ? "_" : "",
           kind, what[0] != '\0' ? "_" : "", what);
}

static dea_status end_sheet(struct sheet *s, const char *directory, const char *model,
                            const char *kind, const char *what)
{
  char name[DEA_RESULT_TABLE_FILE_SIZE];
  name_sheet(model, kind, what, name);
  dea_status status = s->any ? dea_text_write(s->text.ctx, &s->text, directory, name) : DEA_OK;
  dea_free(s->text.ctx, s->columns);
  dea_text_free(&s->text);
  return status;
}

/* Adds to what is used already. */
static void mark_used(const struct dea_load_point *points, size_t count, struct sheet *s)
{
  for (int c = 0; c < s->count; c++) {
    s->columns[c] = s->columns[c] || dea_points_have(points, count, c);
  }
  s->any = s->any || count > 0;
}

/* Columns of standard uncertainties, behind all others: the titles (point SIZE_MAX) or a row. */
static void add_std(struct dea_text *text, const struct dea_curve *curve, size_t point)
{
  for (int c = 0; curve->std != NULL && c < dea_column_count(text->ctx); c++) {
    const struct dea_column *column = dea_column_at(text->ctx, c);
    const bool bare = strcmp(column->display_unit, "1") == 0;
    if (!dea_points_have(curve->std, curve->count, c)) {
      continue;
    }
    dea_text_add(text, ",");
    if (point == SIZE_MAX) {
      char title[DEA_COLUMN_TITLE_SIZE];
      snprintf(title, sizeof title, "%s std%s%s%s", column->header, bare ? "" : " (",
               bare ? "" : column->display_unit, bare ? "" : ")");
      dea_csv_add_name(text, title);
    } else {
      add_number(text, dea_point_get(&curve->std[point], c) * fabs(column->factor));
    }
  }
}

/* Without the end of the line. */
static void add_header(struct sheet *s)
{
  for (int c = 0; c < s->count; c++) {
    if (s->columns[c]) {
      char title[DEA_COLUMN_TITLE_SIZE];
      dea_column_title(dea_column_at(s->text.ctx, c), title, sizeof title);
      dea_csv_add_name(&s->text, title);
      dea_text_add(&s->text, ",");
    }
  }
  dea_text_add(&s->text, "stable,unstable_modes,trusted,flags");
}

/* Without the end of the line. */
static void add_point(struct sheet *s, const struct dea_load_point *point)
{
  for (int c = 0; c < s->count; c++) {
    if (s->columns[c]) {
      add_number(&s->text, dea_point_get(point, c) * dea_column_at(s->text.ctx, c)->factor);
      dea_text_add(&s->text, ",");
    }
  }
  char words[DEA_FLAGS_SIZE];
  dea_text_add(&s->text, "%d,%d,%d,%s", point->stable, point->unstable_modes,
               dea_load_point_trusted(point), dea_flags_text(dea_load_point_flags(point), words));
}

dea_status dea_csv_write_curve(struct dea_context *ctx, const struct dea_curve *curve,
                               const char *directory)
{
  struct sheet s;
  DEA_TRY(ctx, begin_sheet(ctx, &s));
  mark_used(curve->points, curve->count, &s);
  s.any = true; // also without points
  add_header(&s);
  add_std(&s.text, curve, SIZE_MAX);
  dea_text_add(&s.text, "\n");
  for (size_t i = 0; i < curve->count; i++) {
    add_point(&s, &curve->points[i]);
    add_std(&s.text, curve, i);
    dea_text_add(&s.text, "\n");
  }
  return end_sheet(&s, directory, curve->model, curve->kind, "");
}

/* Nothing without any. */
static dea_status write_events(struct dea_context *ctx, const struct dea_curve *curve,
                               const char *directory)
{
  struct sheet s;
  DEA_TRY(ctx, begin_sheet(ctx, &s));
  for (size_t i = 0; i < curve->event_count; i++) {
    mark_used(&curve->events[i].point, 1, &s);
  }
  dea_text_add(&s.text, "event,");
  add_header(&s);
  dea_text_add(&s.text, "\n");
  for (size_t i = 0; i < curve->event_count; i++) {
    dea_text_add(&s.text, "%s,", dea_event_name(curve->events[i].kind));
    add_point(&s, &curve->events[i].point);
    dea_text_add(&s.text, "\n");
  }
  return end_sheet(&s, directory, curve->model, curve->kind, "events");
}

/* Header of a table of profiles; first: what stands before the voltage. */
static void add_profile_header(struct dea_text *text, const char *first)
{
  dea_text_add(text, "%sV (kV)", first);
  for (int c = 0; c < DEA_PROFILE_COLUMNS; c++) {
    char title[DEA_COLUMN_TITLE_SIZE];
    dea_column_title(&dea_profile_columns[c], title, sizeof title);
    dea_text_add(text, ",%s", title);
  }
  dea_text_add(text, "\n");
}

/* name: in front of each line, "" for none. */
static void add_profile(struct dea_text *text, const char *name,
                        const struct dea_profile_record *record)
{
  for (size_t i = 0; i < record->count; i++) {
    if (name[0] != '\0') {
      dea_csv_add_name(text, name);
      dea_text_add(text, ",");
    }
    add_number(text, record->voltage_V * 1e-3);
    for (size_t c = 0; c < DEA_PROFILE_COLUMNS; c++) {
      dea_text_add(text, ",");
      add_number(text, record->columns[c * record->count + i] * dea_profile_columns[c].factor);
    }
    dea_text_add(text, "\n");
  }
}

/* All profiles of one model, one below the other. Of a study ("": none) those of its variants with
 * their names in front. Nothing when there is none. */
static dea_status write_profiles(struct dea_context *ctx, const struct dea_result *result,
                                 const char *model, const char *study, const char *directory)
{
  const bool of_study = study[0] != '\0';
  struct sheet s;
  DEA_TRY(ctx, begin_sheet(ctx, &s));
  add_profile_header(&s.text, of_study ? "name," : "");
  for (size_t i = 0; i < result->profile_count && !of_study; i++) {
    if (strcmp(result->profiles[i].model, model) == 0) {
      s.any = true;
      add_profile(&s.text, "", &result->profiles[i]);
    }
  }
  for (size_t i = 0; i < result->variant_count && of_study; i++) {
    const struct dea_variant *variant = &result->variants[i];
    if (dea_variant_is(variant, model, study) && variant->profile.count > 0) {
      s.any = true;
      add_profile(&s.text, variant->name, &variant->profile);
    }
  }
  return end_sheet(&s, directory, model, study, "profiles");
}

// Variants ---------------------------------------------------------------------------------------

static void add_variant(struct sheet *s, bool meshes, const struct dea_variant *variant)
{
  for (size_t i = 0; i < variant->curve.count; i++) {
    dea_csv_add_name(&s->text, variant->name);
    dea_text_add(&s->text, ",");
    if (meshes) {
      add_number(&s->text, variant->refinement);
      dea_text_add(&s->text, ",%zu,%zu,%zu,", variant->size.elements, variant->size.nodes,
                   variant->size.unknowns);
    }
    add_number(&s->text, variant->wall_s);
    dea_text_add(&s->text, ",");
    add_point(s, &variant->curve.points[i]);
    dea_text_add(&s->text, "\n");
  }
}

/* All points of all variants of a study, with name and mesh of the variant in front. */
static dea_status write_variants(struct dea_context *ctx, const struct dea_result *result,
                                 const char *model, const char *study, const char *directory)
{
  struct sheet s;
  bool meshes = false;
  DEA_TRY(ctx, begin_sheet(ctx, &s));
  for (size_t i = 0; i < result->variant_count; i++) {
    if (dea_variant_is(&result->variants[i], model, study)) {
      meshes = meshes || result->variants[i].size.nodes > 0;
      mark_used(result->variants[i].curve.points, result->variants[i].curve.count, &s);
      s.any = true; // also without points
    }
  }
  dea_text_add(&s.text, "name,%stime (s),", meshes ? "refinement,elements,nodes,unknowns," : "");
  add_header(&s);
  dea_text_add(&s.text, "\n");
  for (size_t i = 0; i < result->variant_count; i++) {
    if (dea_variant_is(&result->variants[i], model, study)) {
      add_variant(&s, meshes, &result->variants[i]);
    }
  }
  return end_sheet(&s, directory, model, study, "");
}

// Tables of studies -------------------------------------------------------------------------------

/* "level 2 (kV)": the title of the number-th column of a list; 0: of a column that is none. */
static void add_list_title(const struct dea_result_column *column, size_t number,
                           struct dea_text *out)
{
  char title[96];
  struct dea_result_column one = *column;
  if (number > 0) {
    snprintf(title, sizeof title, "%s %zu", column->title, number);
    one.title = title;
  }
  dea_result_table_column_title(&one, out);
}

/* Header (row SIZE_MAX) or a row. */
static void add_table_row(struct dea_text *text, const struct dea_result_table *table, size_t row)
{
  bool first = true;
  for (size_t c = 0; c < table->type.column_count; c++) {
    const struct dea_result_column *column = &table->type.columns[c];
    for (size_t k = 0; k < dea_result_table_shown(table, c, DEA_IN_CSV); k++, first = false) {
      struct dea_text cell = {.ctx = text->ctx};
      if (row == SIZE_MAX) {
        add_list_title(column, dea_result_table_values(table, c) > 1 ? k + 1 : 0, &cell);
      } else {
        dea_result_table_cell_text(table, row, c, k, 12, &cell);
      }
      dea_text_add(text, "%s", first ? "" : ",");
      dea_csv_add_name(text, dea_text_get(&cell));
      dea_text_free_in(&cell, text);
    }
  }
  dea_text_add(text, "\n");
}

static dea_status write_table(struct dea_context *ctx, const struct dea_result_table *table,
                              const char *directory)
{
  struct sheet s;
  if ((table->type.where & DEA_IN_CSV) == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, begin_sheet(ctx, &s));
  s.any = true;
  add_table_row(&s.text, table, SIZE_MAX);
  for (size_t row = 0; row < table->row_count; row++) {
    add_table_row(&s.text, table, row);
  }
  return end_sheet(&s, directory, table->model, table->type.study, table->type.name);
}

void dea_csv_table_name(const struct dea_result_table *table, char out[DEA_RESULT_TABLE_FILE_SIZE])
{
  name_sheet(table->model, table->type.study, table->type.name, out);
}

/* Whether a variant is the first of its model and study. */
static bool first_of_study(const struct dea_result *result, size_t i)
{
  const struct dea_curve *curve = &result->variants[i].curve;
  for (size_t k = 0; k < i; k++) {
    if (dea_variant_is(&result->variants[k], curve->model, curve->kind)) {
      return false;
    }
  }
  return true;
}

dea_status dea_csv_write(struct dea_context *ctx, const struct dea_result *result,
                         const char *directory)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  for (size_t i = 0; i < result->curve_count; i++) {
    DEA_TRY(ctx, dea_csv_write_curve(ctx, &result->curves[i], directory));
    DEA_TRY(ctx, write_events(ctx, &result->curves[i], directory));
  }
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    DEA_TRY(ctx, write_profiles(ctx, result, models[m], "", directory));
  }
  for (size_t i = 0; i < result->variant_count; i++) {
    if (first_of_study(result, i)) {
      const struct dea_curve *curve = &result->variants[i].curve;
      DEA_TRY(ctx, write_variants(ctx, result, curve->model, curve->kind, directory));
      DEA_TRY(ctx, write_profiles(ctx, result, curve->model, curve->kind, directory));
    }
  }
  for (size_t i = 0; i < result->table_count; i++) {
    DEA_TRY(ctx, write_table(ctx, &result->tables[i], directory));
  }
  return DEA_OK;
}

bool dea_csv_has(const struct dea_result *result)
{
  bool any = result->curve_count + result->variant_count + result->profile_count > 0;
  for (size_t i = 0; i < result->table_count; i++) {
    any = any || (result->tables[i].type.where & DEA_IN_CSV) != 0;
  }
  return any;
}

#include "io/summary_studies.h"

#include "result/columns.h"

#include <math.h>
#include <string.h>

static json_t *flags_json(unsigned flags)
{
  json_t *list = json_array();
  for (int k = 0; k < DEA_FLAG_COUNT; k++) {
    if ((flags >> k & 1u) != 0) {
      json_array_append_new(list, json_string(dea_flag_words[k].word));
    }
  }
  return list;
}

static void write_columns(json_t *object, const struct dea_context *ctx,
                          const struct dea_load_point *point)
{
  for (int c = 0; c < dea_column_count(ctx); c++) {
    dea_json_add(object, dea_column_at(ctx, c)->key, dea_point_get(point, c));
  }
}

/* std: standard uncertainties of its numbers; NULL: none are known. */
static json_t *point_json(const struct dea_context *ctx, const struct dea_load_point *point,
                          const struct dea_load_point *std)
{
  json_t *object = json_object();
  write_columns(object, ctx, point);
  json_object_set_new(object, "stable", json_boolean(point->stable));
  json_object_set_new(object, "unstable_modes", json_integer(point->unstable_modes));
  json_object_set_new(object, "trusted", json_boolean(dea_load_point_trusted(point)));
  json_object_set_new(object, "flags", flags_json(dea_load_point_flags(point)));
  if (std != NULL) {
    json_t *uncertainties = json_object();
    write_columns(uncertainties, ctx, std);
    json_object_set_new(object, "std", uncertainties);
  }
  return object;
}

json_t *dea_points_json(const struct dea_context *ctx, const struct dea_curve *curve)
{
  json_t *list = json_array();
  for (size_t i = 0; curve != NULL && i < curve->count; i++) {
    json_array_append_new(
        list, point_json(ctx, &curve->points[i], curve->std != NULL ? &curve->std[i] : NULL));
  }
  return list;
}

static json_t *list_json(const struct dea_cell *cells, size_t count)
{
  json_t *list = json_array();
  for (size_t i = 0; i < count; i++) {
    json_array_append_new(list, dea_json_number(cells[i].number));
  }
  return list;
}

static json_t *cell_json(const struct dea_context *ctx, const struct dea_result *result,
                         const struct dea_result_table *table, size_t row, size_t c)
{
  const struct dea_cell *cell = dea_result_table_cell(table, row, c);
  switch (table->type.columns[c].kind) {
  case DEA_CELL_TEXT:
    return json_string(cell->text);
  case DEA_CELL_FLAG:
    return json_boolean(cell->number > 0);
  case DEA_CELL_COUNT:
    return json_integer((json_int_t)cell->number);
  case DEA_CELL_QUANTITY:
    return json_string(dea_result_table_quantity(table, row)->key);
  case DEA_CELL_POINTS:
    return dea_points_json(ctx, &result->variants[(size_t)cell->number].curve);
  case DEA_CELL_NUMBER:
  case DEA_CELL_VALUE:
    break;
  }
  return dea_json_number(cell->number);
}

/* A row's keys go into an object. */
static void write_row(const struct dea_context *ctx, const struct dea_result *result,
                      const struct dea_result_table *table, size_t row, json_t *object)
{
  for (size_t c = 0; c < table->type.column_count; c++) {
    const struct dea_result_column *column = &table->type.columns[c];
    const struct dea_cell *cell = dea_result_table_cell(table, row, c);
    bool none = column->kind != DEA_CELL_TEXT && !isfinite(cell->number);
    if ((column->hidden & DEA_IN_JSON) != 0) {
      continue;
    }
    if (column->list) {
      json_object_set_new(object, column->key, list_json(cell, dea_result_table_values(table, c)));
    } else if (!none || column->null) {
      json_object_set_new(object, column->key, cell_json(ctx, result, table, row, c));
    }
  }
}

/* The object of a study within that of its model. */
static json_t *study_object(json_t *parent, const char *study)
{
  if (json_object_get(parent, study) == NULL) {
    json_object_set_new(parent, study, json_object());
  }
  return json_object_get(parent, study);
}

static void write_table(const struct dea_context *ctx, const struct dea_result *result,
                        const struct dea_result_table *table, json_t *model)
{
  const struct dea_result_table_type *type = &table->type;
  json_t *parent = type->key != NULL ? model : study_object(model, type->study);
  const char *key = type->key != NULL ? type->key : type->name;
  if (type->one_row) {
    json_t *object = key[0] != '\0' ? study_object(parent, key) : parent;
    for (size_t row = 0; row < table->row_count; row++) {
      write_row(ctx, result, table, row, object);
    }
    return;
  }
  json_t *list = json_array();
  for (size_t row = 0; row < table->row_count; row++) {
    json_t *object = json_object();
    write_row(ctx, result, table, row, object);
    json_array_append_new(list, object);
  }
  json_object_set_new(parent, key, list);
}

void dea_summary_add_studies(const struct dea_context *ctx, const struct dea_result *result,
                             const char *model, json_t *object)
{
  for (size_t i = 0; i < result->table_count; i++) {
    const struct dea_result_table *table = &result->tables[i];
    if (strcmp(table->model, model) == 0 && (table->type.where & DEA_IN_JSON) != 0) {
      write_table(ctx, result, table, object);
    }
  }
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    if (strcmp(curve->model, model) == 0 && curve->listed) {
      json_object_set_new(object, curve->kind, dea_points_json(ctx, curve));
    }
  }
}

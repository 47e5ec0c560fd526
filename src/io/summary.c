#include "io/summary.h"

#include "base/json.h"
#include "result/columns.h"
#include "result/trust.h"

#include <math.h>
#include <string.h>

// Points and studies ------------------------------------------------------------------------------

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

/* All points of a curve (NULL: none). */
static json_t *points_json(const struct dea_context *ctx, const struct dea_curve *curve)
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
    return points_json(ctx, &result->variants[(size_t)cell->number].curve);
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
  json_t *list = dea_json_add_list(parent, key);
  for (size_t row = 0; row < table->row_count; row++) {
    write_row(ctx, result, table, row, dea_json_append(list));
  }
}

/* Adds the tables that studies made of a model, and the points of curves that are listed. */
static void write_studies(const struct dea_context *ctx, const struct dea_result *result,
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
      json_object_set_new(object, curve->kind, points_json(ctx, curve));
    }
  }
}

// Models ------------------------------------------------------------------------------------------

/* First event of each kind along the path. */
static json_t *limits_json(const struct dea_curve *path)
{
  static const enum dea_event_kind kinds[] = {DEA_EVENT_PULL_IN, DEA_EVENT_SNAP_BACK,
                                              DEA_EVENT_SLACK, DEA_EVENT_BREAKDOWN};
  json_t *object = json_object();
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
    const struct dea_event *event = dea_curve_first_event(path, kinds[k]);
    if (event != NULL) {
      char key[64];
      snprintf(key, sizeof key, "%s_voltage_V", dea_event_name(kinds[k]));
      dea_json_add(object, key, event->point.voltage_V);
      snprintf(key, sizeof key, "%s_stretch", dea_event_name(kinds[k]));
      dea_json_add(object, key, event->point.electrode_stretch);
    }
  }
  if (dea_curve_first_event(path, DEA_EVENT_PULL_IN) != NULL) {
    json_object_set_new(object, "pull_in_of_slack_film", json_boolean(dea_curve_is_slack(path)));
  }
  return object;
}

/* First curve of a model, of its variants too, that was stopped; NULL when none was. */
static const struct dea_curve *first_stopped(const struct dea_result *result, const char *model)
{
  size_t curves = result->curve_count;
  for (size_t i = 0; i < curves + result->variant_count; i++) {
    const struct dea_curve *curve =
        i < curves ? &result->curves[i] : &result->variants[i - curves].curve;
    if (strcmp(curve->model, model) == 0 && !curve->complete) {
      return curve;
    }
  }
  return NULL;
}

/* How far the sweep is to be trusted. */
static json_t *trust_json(const struct dea_curve *sweep)
{
  json_t *object = json_object();
  if (sweep != NULL && sweep->count > 0) {
    struct dea_trust trust = dea_curve_trust(sweep);
    dea_json_add(object, "trusted_and_safe_V", trust.good_V);
    dea_json_add(object, "trusted_V", trust.trusted_V);
    dea_json_add(object, "safe_V", trust.safe_V);
  }
  return object;
}

/* Puts what is known of one model into an object. */
static void write_model(const struct dea_context *ctx, const struct dea_result *result,
                        const char *model, json_t *object)
{
  const struct dea_curve *sweep = dea_result_find(result, model, "sweep");
  json_object_set_new(object, "model", json_string(model));
  json_object_set_new(object, "points", points_json(ctx, sweep));
  json_object_set_new(object, "trust", trust_json(sweep));
  const struct dea_curve *stopped = first_stopped(result, model);
  json_object_set_new(object, "complete", json_boolean(stopped == NULL));
  dea_json_add_text(object, "stopped", stopped != NULL ? stopped->stopped : "");
  json_object_set_new(object, "status",
                      json_string(dea_status_name(stopped != NULL ? stopped->status : DEA_OK)));
  json_object_set_new(object, "verdict",
                      json_string(stopped != NULL ? dea_verdict_of(stopped->status) : ""));
  const struct dea_curve *path = dea_result_find(result, model, "path");
  json_object_set_new(object, "limits", limits_json(path != NULL ? path : sweep));
  write_studies(ctx, result, model, object);
}

static json_t *design_json(const struct dea_result *result)
{
  json_t *object = json_object();
  const struct dea_design *design = result->design;
  dea_json_add_text(object, "title", design != NULL ? design->title.text : "");
  dea_json_add_text(object, "file", design != NULL ? design->file : "");
  dea_json_add_text(object, "sha256", result->provenance.input_sha256);
  return object;
}

static json_t *provenance_json(const struct dea_provenance *p)
{
  json_t *object = json_object();
  dea_json_add_text(object, "program", p->program);
  dea_json_add_text(object, "compiler", p->compiler);
  dea_json_add_text(object, "build", p->build);
  dea_json_add_text(object, "libraries", p->libraries);
  dea_json_add_text(object, "started", p->started);
  dea_json_add(object, "wall_s", p->wall_s);
  json_t *solver = json_object();
#define PUT(member, label)                                                                         \
  json_object_set_new(solver, #member, json_integer((json_int_t)p->solver.member));
  DEA_SOLVER_COUNTERS(PUT)
#undef PUT
  json_object_set_new(object, "solver", solver);
  dea_json_add_text(object, "input_sha256", p->input_sha256);
  dea_json_add_text(object, "overrides", p->overrides);
  dea_json_add_text(object, "command", p->command);
  return object;
}

/* What was said of the design and its models so far, errors aside. */
static json_t *notes_json(const struct dea_context *ctx)
{
  json_t *notes = json_array();
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    if (findings[i].severity != DEA_ERROR) { // text that is not UTF-8 is left out
      json_array_append_new(notes, json_string(findings[i].text));
    }
  }
  return notes;
}

dea_status dea_summary_text(struct dea_context *ctx, const struct dea_result *result, char **out)
{
  json_t *root = json_object();
  json_object_set_new(root, "schema", json_integer(DEA_SUMMARY_SCHEMA));
  dea_json_add_text(root, "program", result->provenance.program);
  json_object_set_new(root, "design", design_json(result));
  json_t *more = json_array();
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    json_t *object = m == 0 ? root : json_object();
    write_model(ctx, result, models[m], object);
    if (m > 0) {
      json_array_append_new(more, object);
    }
  }
  if (count == 0) {
    json_object_set_new(root, "points", json_array());
  }
  json_object_set_new(root, "more_models", more);
  json_object_set_new(root, "notes", notes_json(ctx));
  json_object_set_new(root, "provenance", provenance_json(&result->provenance));
  return dea_json_text(ctx, root, out);
}

#include "output/summary_studies.h"

#include "result/convergence.h"

#include <math.h>

/* Name, mesh, time and how it ended; points: with all of its points. */
static json_t *variant_json(const struct dea_variant *variant, bool points)
{
  json_t *object = json_object();
  dea_json_put_text(object, "name", variant->name);
  dea_json_put(object, "refinement", variant->refinement);
  if (variant->size.nodes > 0) {
    json_object_set_new(object, "elements", json_integer((json_int_t)variant->size.elements));
    json_object_set_new(object, "nodes", json_integer((json_int_t)variant->size.nodes));
    json_object_set_new(object, "unknowns", json_integer((json_int_t)variant->size.unknowns));
  }
  dea_json_put(object, "wall_s", variant->wall_s);
  json_object_set_new(object, "complete", json_boolean(variant->curve.complete));
  dea_json_put_text(object, "stopped", variant->curve.stopped);
  if (points) {
    json_object_set_new(object, "points", dea_points_json(&variant->curve));
  }
  return object;
}

/* Numbers with null for those that are none. */
static json_t *numbers_json(const double *values, size_t count)
{
  json_t *list = json_array();
  for (size_t i = 0; i < count; i++) {
    json_array_append_new(list, isfinite(values[i]) ? json_real(values[i]) : json_null());
  }
  return list;
}

static json_t *row_json(const struct dea_convergence *convergence,
                        const struct dea_convergence_row *row)
{
  json_t *object = json_object();
  dea_json_put_text(object, "quantity", dea_point_columns[row->column].key);
  dea_json_put(object, "voltage_V", row->voltage_V);
  json_object_set_new(object, "values", numbers_json(row->values, convergence->mesh_count));
  json_object_set_new(object, "errors", numbers_json(row->errors, convergence->mesh_count));
  dea_json_put(object, "order", row->order);
  dea_json_put(object, "extrapolated", row->extrapolated);
  dea_json_put_text(object, "remark", dea_order_text(row->kind));
  return object;
}

/* Voltage by voltage the refinement that is enough, null where none is. */
static json_t *enough_json(const struct dea_convergence *convergence)
{
  json_t *list = json_array();
  double last = NAN;
  for (size_t i = 0; i < convergence->row_count; i++) {
    double voltage_V = convergence->rows[i].voltage_V;
    if (voltage_V != last) {
      size_t mesh = dea_convergence_enough(convergence, voltage_V);
      json_t *object = json_object();
      dea_json_put(object, "voltage_V", voltage_V);
      json_object_set_new(object, "refinement",
                          mesh < convergence->mesh_count
                              ? json_real(convergence->meshes[mesh]->refinement)
                              : json_null());
      json_array_append_new(list, object);
    }
    last = voltage_V;
  }
  return list;
}

static dea_status put_convergence(struct dea_context *ctx, const struct dea_result *result,
                                  const char *model, json_t *parent)
{
  struct dea_convergence *convergence;
  DEA_TRY(ctx, dea_convergence_create(ctx, result, model, &convergence));
  if (convergence == NULL) {
    return DEA_OK;
  }
  json_t *object = json_object(), *meshes = json_array(), *quantities = json_array();
  struct dea_text verdict = {.ctx = ctx};
  dea_convergence_verdict(convergence, &verdict);
  dea_json_put(object, "tolerance", convergence->tolerance);
  for (size_t m = 0; m < convergence->mesh_count; m++) {
    json_array_append_new(meshes, variant_json(convergence->meshes[m], false));
  }
  json_object_set_new(object, "meshes", meshes);
  for (size_t i = 0; i < convergence->row_count; i++) {
    json_array_append_new(quantities, row_json(convergence, &convergence->rows[i]));
  }
  json_object_set_new(object, "quantities", quantities);
  json_object_set_new(object, "enough", enough_json(convergence));
  dea_json_put_text(object, "verdict", dea_text_get(&verdict));
  json_object_set_new(parent, "convergence", object);
  dea_status status = verdict.failed ? DEA_E_MEMORY : DEA_OK;
  dea_text_free(&verdict);
  dea_convergence_destroy(ctx, convergence);
  return status;
}

static void put_designs(const struct dea_result *result, const char *model, json_t *parent)
{
  json_t *designs = NULL;
  for (size_t i = 0; i < result->variant_count; i++) {
    if (dea_variant_is(&result->variants[i], model, "compare-design")) {
      designs = designs != NULL ? designs : json_array();
      json_array_append_new(designs, variant_json(&result->variants[i], true));
    }
  }
  if (designs != NULL) {
    json_object_set_new(parent, "designs", designs);
  }
}

/* All points of a curve of that kind, where there is one. */
static void put_curve(const struct dea_result *result, const char *model, const char *kind,
                      json_t *parent)
{
  const struct dea_curve *curve = dea_result_find(result, model, kind);
  if (curve != NULL) {
    json_object_set_new(parent, kind, dea_points_json(curve));
  }
}

dea_status dea_summary_put_studies(struct dea_context *ctx, const struct dea_result *result,
                                   const char *model, json_t *object)
{
  DEA_TRY(ctx, put_convergence(ctx, result, model, object));
  put_designs(result, model, object);
  DEA_TRY(ctx, dea_summary_put_transient(ctx, result, model, object));
  put_curve(result, model, "modal", object);
  put_curve(result, model, "frequency", object);
  return DEA_OK;
}

/* Study "sweep": stable equilibria at the asked voltages, in their order, each from the one before;
 * a curve that has points already goes on after them.
 */
#include "study/study.h"

#include <math.h>
#include <stdio.h>

/* Voltage of the next limit point above this stretch on the model's path, minus the point's
 * voltage; NAN when the path has none. */
static double distance_to_pull_in(const struct dea_curve *path, const struct dea_load_point *point)
{
  for (size_t k = 0; path != NULL && k < path->event_count; k++) {
    const struct dea_event *event = &path->events[k];
    if (event->kind == DEA_EVENT_PULL_IN &&
        event->point.electrode_stretch >= point->electrode_stretch) {
      return event->point.voltage_V - point->voltage_V;
    }
  }
  return NAN;
}

static dea_status add_profile(struct dea_context *ctx, const struct dea_model_type *type,
                              struct dea_model *model, double voltage_V, struct dea_result *result)
{
  struct dea_profile profile;
  if (type->profile == NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_model_profile(ctx, type, model, &profile));
  DEA_TRY(ctx, dea_result_add_profile(ctx, result, type->name, voltage_V, &profile));
  return DEA_OK;
}

static dea_status add_surface(struct dea_context *ctx, const struct dea_model_type *type,
                              struct dea_model *model, const struct dea_curve *curve,
                              struct dea_result *result)
{
  size_t last = curve->count - 1;
  struct dea_field_mesh *mesh;
  if (type->fields == NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_model_fields(ctx, type, model, DEA_FIELDS_SURFACE, &mesh));
  DEA_TRY(ctx, dea_result_add_surface(ctx, result, type->name, last, curve->points[last].voltage_V,
                                      mesh));
  return DEA_OK;
}

/* Solves one voltage and adds its point, profile and surface. */
static dea_status sweep_point(struct dea_context *ctx, const struct dea_model_type *type,
                              struct dea_model *model, double voltage_V, struct dea_result *result,
                              struct dea_curve *curve)
{
  struct dea_load_point point;
  if (dea_interrupted(ctx)) {
    return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted before %.6g kV; %zu points are kept",
                    1e-3 * voltage_V, curve->count);
  }
  DEA_TRY(ctx, type->solve(ctx, model, voltage_V, &point));
  point.pull_in_distance_V =
      distance_to_pull_in(dea_result_find(result, type->name, "path"), &point);
  DEA_TRY(ctx, dea_curve_add_point(ctx, curve, &point));
  DEA_TRY(ctx, add_profile(ctx, type, model, voltage_V, result));
  DEA_TRY(ctx, add_surface(ctx, type, model, curve, result));
  if (result->keeper != NULL) {
    DEA_TRY(ctx, result->keeper->point(ctx, result->keeper->user, type, model, result, curve));
  }
  return DEA_OK;
}

/* What a curve says of itself until its sweep has come to an end: it is kept on the way. */
static void open_curve(struct dea_curve *curve)
{
  curve->complete = false;
  curve->status = DEA_E_INTERRUPTED;
  snprintf(curve->stopped, sizeof curve->stopped, "the run was ended before the sweep");
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  const struct dea_design *design = result->design;
  size_t total = design->compute.voltage_count;
  char what[DEA_NAME_SIZE + 8];
  struct dea_curve *curve;
  DEA_TRY(ctx, dea_result_get_curve(ctx, result, type->name, "sweep", &curve));
  snprintf(what, sizeof what, "%s sweep", type->name);
  open_curve(curve);
  dea_status status = DEA_OK;
  if (result->keeper != NULL) {
    status = result->keeper->start(ctx, result->keeper->user, type, model, curve);
  }
  for (size_t i = curve->count; i < total && status == DEA_OK; i++) {
    status = sweep_point(ctx, type, model, design->compute.voltages_V[i], result, curve);
    if (status == DEA_OK) {
      dea_progress(ctx, what, i + 1, total);
    }
  }
  DEA_TRY(ctx, dea_curve_end(ctx, curve, status));
  return DEA_OK;
}

const struct dea_study dea_study_sweep = {.name = "sweep", .run = run};

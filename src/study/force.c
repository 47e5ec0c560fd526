/* Study "force": a rigid tip is brought to a depth, or pressed until it feels a preload, at 0 V; it
 * is held there while the voltage goes through the sweep. Depth after depth that gives force
 * against voltage at fixed depths and force against depth at fixed voltages: the actuator's load
 * lines. */
#include "study/force.h"
#include "study/study.h"

#include <math.h>
#include <stdio.h>

enum { PRELOAD_TRIALS = 12 };
static const double preload_close = 1e-3; // of the preload

/* Depth at which the tip feels the preload at 0 V: secant steps from two touches. Leaves the tip
 * there. */
static dea_status find_preload(struct dea_context *ctx, const struct dea_model_type *type,
                               struct dea_model *model, const struct dea_probe *tip,
                               double preload_N, double first_m)
{
  struct dea_load_point point;
  double depth_m = first_m, last_m = 0, last_N = 0;
  for (int i = 0; i < PRELOAD_TRIALS; i++) {
    DEA_TRY(ctx, dea_model_indent(ctx, type, model, tip, depth_m, &point));
    if (fabs(point.force_N - preload_N) <= preload_close * preload_N) {
      return DEA_OK;
    }
    double slope = (point.force_N - last_N) / (depth_m - last_m);
    double next = slope > 0 ? depth_m + (preload_N - point.force_N) / slope : 2 * depth_m;
    last_m = depth_m;
    last_N = point.force_N;
    depth_m = fmin(fmax(next, 0.3 * last_m), 3 * last_m);
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no depth gives the preload of %.4g mN",
                  1e3 * preload_N);
}

dea_status dea_force_indent(struct dea_context *ctx, const struct dea_model_type *type,
                            struct dea_model *model, const struct dea_design *design, size_t stop)
{
  size_t depths = design->compute.force.depth_count;
  const struct dea_probe tip = {.shape = (enum dea_probe_shape)design->compute.force.tip.value,
                                .radius_m = design->compute.force.radius_m.si,
                                .edge_radius_m = design->compute.force.edge_radius_m.si,
                                .from_fibre_side = design->compute.force.side.value == 0};
  struct dea_load_point point;
  if (stop < depths) {
    DEA_TRY(ctx, dea_model_indent(ctx, type, model, &tip, design->compute.force.depths_m[stop].si,
                                  &point));
    return DEA_OK;
  }
  DEA_TRY(ctx, find_preload(ctx, type, model, &tip,
                            design->compute.force.preloads_N[stop - depths].si, tip.radius_m));
  return DEA_OK;
}

/* One stop: press at 0 V, then all voltages. */
static dea_status load_line(struct dea_context *ctx, const struct dea_model_type *type,
                            const struct dea_result *result, size_t stop, struct dea_curve *curve)
{
  const struct dea_design *design = result->design;
  struct dea_model *model;
  DEA_TRY(ctx, type->create(ctx, result->device, &model));
  dea_status status = dea_force_indent(ctx, type, model, design, stop);
  if (status == DEA_OK) {
    status = dea_study_take_points(ctx, type, model, design->compute.voltages_V,
                                   design->compute.voltage_count, curve);
  }
  type->destroy(ctx, model);
  return status;
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  (void)model; // none: each depth starts from rest
  const struct dea_design *design = result->design;
  size_t stops = design->compute.force.depth_count + design->compute.force.preload_count;
  char what[DEA_NAME_SIZE + 8];
  struct dea_curve *curve;
  if (type->indent == NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, type->name, "force", &curve));
  snprintf(what, sizeof what, "%s force", type->name);
  dea_status status = DEA_OK;
  for (size_t i = 0; i < stops && status == DEA_OK; i++) {
    status = load_line(ctx, type, result, i, curve);
    if (status == DEA_OK) {
      dea_progress(ctx, what, i + 1, stops);
    }
  }
  DEA_TRY(ctx, dea_curve_end(ctx, curve, status));
  return DEA_OK;
}

static bool asked(const struct dea_design *design)
{
  return design->compute.force.depth_count + design->compute.force.preload_count > 0;
}

const struct dea_study dea_study_force = {
    .name = "force",
    .asked = asked,
    .needs = "compute.force.depth or compute.force.preload",
    .own_models = true,
    .run = run,
};

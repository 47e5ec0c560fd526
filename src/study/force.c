/* Study "force": a rigid tip is brought to a depth, or pressed until it feels a preload, at 0 V; it
 * is held there while the voltage goes through the sweep. Depth after depth that gives force
 * against voltage at fixed depths and force against depth at fixed voltages: the actuator's load
 * lines. */
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
    DEA_TRY(ctx, type->press(ctx, model, tip, depth_m, &point));
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

/* One depth, or the preload where it is above 0: press at 0 V, then all voltages. */
static dea_status load_line(struct dea_context *ctx, const struct dea_model_type *type,
                            const struct dea_result *result, const struct dea_probe *tip,
                            double depth_m, double preload_N, struct dea_curve *curve)
{
  const struct dea_design *design = result->design;
  struct dea_model *model;
  struct dea_load_point point;
  DEA_TRY(ctx, type->create(ctx, result->device, &model));
  dea_status status = preload_N > 0 ? find_preload(ctx, type, model, tip, preload_N, tip->radius_m)
                                    : type->press(ctx, model, tip, depth_m, &point);
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
  size_t depths = design->compute.force.depth_count;
  size_t stops = depths + design->compute.force.preload_count;
  char what[DEA_NAME_SIZE + 8];
  struct dea_curve *curve;
  if (type->press == NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, type->name, "force", &curve));
  const struct dea_probe tip = {.shape = (enum dea_probe_shape)design->compute.force.tip.value,
                                .radius_m = design->compute.force.radius_m.si,
                                .edge_radius_m = design->compute.force.edge_radius_m.si,
                                .from_fibre_side = design->compute.force.side.value == 0};
  snprintf(what, sizeof what, "%s force", type->name);
  dea_status status = DEA_OK;
  for (size_t i = 0; i < stops && status == DEA_OK; i++) {
    double depth_m = i < depths ? design->compute.force.depths_m[i].si : 0;
    double preload_N = i < depths ? 0 : design->compute.force.preloads_N[i - depths].si;
    status = load_line(ctx, type, result, &tip, depth_m, preload_N, curve);
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

/* What studies share: going through voltages with a model. */
#include "study/observe.h"
#include "study/study.h"

#include <stdio.h>

double dea_study_highest_V(const struct dea_result *result)
{
  double reached_V = dea_result_highest_V(result);
  return reached_V > 0 ? reached_V : dea_design_highest_V(result->design);
}

size_t dea_study_stops(const struct dea_design *design, const struct dea_quantity *given,
                       size_t given_count, bool with_rest, double out[DEA_DESIGN_STOPS_MAX])
{
  enum { QUARTERS = 4 };
  double highest_V = dea_design_highest_V(design);
  size_t count = 0;
  for (size_t i = 0; i < given_count; i++) {
    out[i] = given[i].si;
  }
  for (int i = with_rest ? 0 : 1; i <= QUARTERS && given_count == 0; i++) {
    out[count++] = highest_V * i / QUARTERS;
  }
  return given_count > 0 ? given_count : count;
}

dea_status dea_study_add_points(struct dea_context *ctx, const struct dea_model_type *type,
                                struct dea_model *model, const struct dea_device *device,
                                const double *voltages_V, size_t count, struct dea_curve *curve)
{
  for (size_t i = 0; i < count; i++) {
    struct dea_load_point point;
    if (dea_interrupted_anywhere(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted before %.6g kV; %zu points are kept",
                      1e-3 * voltages_V[i], curve->count);
    }
    DEA_TRY(ctx, type->solve(ctx, model, voltages_V[i], &point));
    DEA_TRY(ctx, dea_study_add_point(ctx, type, model, device, &point, curve));
  }
  return DEA_OK;
}

dea_status dea_study_stop_by_stop(
    struct dea_context *ctx, const struct dea_model_type *type, struct dea_result *result,
    const char *kind, bool whole, const double *voltages_V, size_t count,
    dea_status (*take)(struct dea_context *ctx, const struct dea_model_type *type,
                       struct dea_model *model, const struct dea_load_point *at, size_t stop,
                       struct dea_result *result, struct dea_curve *curve))
{
  struct dea_model *model = NULL;
  struct dea_curve *curve;
  char what[2 * DEA_NAME_SIZE];
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, type->name, kind, &curve));
  curve->listed = true;
  snprintf(what, sizeof what, "%s %s", type->name, kind);
  dea_status status = (whole ? dea_model_create_whole : dea_model_create)(ctx, type, result->design,
                                                                          result->device, &model);
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    struct dea_load_point at;
    if (dea_interrupted_anywhere(ctx)) {
      status = dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted; %zu points are kept", curve->count);
      break;
    }
    status = type->solve(ctx, model, voltages_V[i], &at);
    status = status == DEA_OK ? take(ctx, type, model, &at, i, result, curve) : status;
    if (status == DEA_OK) {
      dea_progress(ctx, what, i + 1, count);
    }
  }
  if (model != NULL) {
    type->destroy(ctx, model);
  }
  return dea_curve_end(ctx, curve, status);
}

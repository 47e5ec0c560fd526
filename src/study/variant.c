#include "study/variant.h"

#include "base/clock.h"
#include "study/study.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void set_size(const struct dea_model_type *type, const struct dea_model *model,
                     double refinement, struct dea_variant *variant)
{
  if (type->size != NULL) {
    type->size(model, &variant->size);
    variant->refinement = refinement;
  }
}

/* All of one model. After a failure there are points, but no profile: the model may be anywhere. */
static dea_status use_model(struct dea_context *ctx, const struct dea_model_type *type,
                            struct dea_model *model, const struct dea_variant_run *run,
                            struct dea_variant *variant)
{
  struct dea_profile profile;
  set_size(type, model, run->settings.refinement, variant);
  DEA_TRY(ctx, dea_study_add_points(ctx, type, model, run->device, run->voltages_V,
                                    run->voltage_count, &variant->curve));
  if (type->profile != NULL && variant->curve.count > 0) {
    DEA_TRY(ctx, dea_model_profile(ctx, type, model, &profile));
    DEA_TRY(ctx, dea_variant_set_profile(ctx, variant,
                                         variant->curve.points[variant->curve.count - 1].voltage_V,
                                         &profile));
  }
  return DEA_OK;
}

dea_status dea_variant_run(struct dea_context *ctx, const struct dea_model_type *type,
                           const struct dea_variant_run *run, struct dea_result *result)
{
  struct dea_variant *variant;
  struct dea_model *model;
  double start_s = dea_clock_s();
  DEA_TRY(ctx, dea_result_add_variant(ctx, result, type->name, run->study, run->name, &variant));
  dea_status status = type->create(ctx, run->device, &run->settings, &model);
  if (status == DEA_OK) {
    status = use_model(ctx, type, model, run, variant);
    type->destroy(ctx, model);
  }
  variant->wall_s = dea_clock_s() - start_s;
  return dea_curve_end(ctx, &variant->curve, status);
}

/* The last profile of a model in the result; NULL when it has none. */
static const struct dea_profile_record *last_profile(const struct dea_result *result,
                                                     const char *model)
{
  for (size_t i = result->profile_count; i > 0; i--) {
    if (strcmp(result->profiles[i - 1].model, model) == 0) {
      return &result->profiles[i - 1];
    }
  }
  return NULL;
}

dea_status dea_variant_of_sweep(struct dea_context *ctx, const struct dea_model_type *type,
                                const struct dea_model *model, const char *study, const char *name,
                                struct dea_result *result)
{
  const struct dea_curve *sweep = dea_result_find(result, type->name, "sweep");
  const struct dea_profile_record *last = last_profile(result, type->name);
  struct dea_variant *variant;
  DEA_TRY(ctx, dea_result_add_variant(ctx, result, type->name, study, name, &variant));
  set_size(type, model, dea_model_settings_of(result->design).refinement, variant);
  variant->wall_s = NAN;
  for (size_t i = 0; i < sweep->count; i++) {
    DEA_TRY(ctx, dea_curve_add_point(ctx, &variant->curve, &sweep->points[i]));
  }
  if (last != NULL) {
    const struct dea_profile profile = dea_profile_of_record(last);
    DEA_TRY(ctx, dea_variant_set_profile(ctx, variant, last->voltage_V, &profile));
  }
  variant->curve.complete = sweep->complete;
  variant->curve.status = sweep->status;
  snprintf(variant->curve.stopped, sizeof variant->curve.stopped, "%s", sweep->stopped);
  return DEA_OK;
}

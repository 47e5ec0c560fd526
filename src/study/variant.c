#include "study/variant.h"

#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void dea_variant_set_size(const struct dea_study_job *job, double refinement,
                          struct dea_variant *variant)
{
  if (job->type->size != NULL) {
    job->type->size(job->model, &variant->size);
    variant->refinement = refinement;
  }
}

dea_status dea_variant_add_profile(struct dea_context *ctx, const struct dea_study_job *job,
                                   struct dea_variant *variant)
{
  const struct dea_curve *curve = &variant->curve;
  struct dea_profile profile;
  if (job->type->profile == NULL || curve->count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, job->type->profile(ctx, job->model, &profile));
  return dea_variant_set_profile(ctx, variant, curve->points[curve->count - 1].voltage_V, &profile);
}

/* All of one model. After a failure there are points, but no profile: the model may be anywhere. */
static dea_status use_model(struct dea_context *ctx, const struct dea_study_job *job,
                            const struct dea_variant_run *run, struct dea_variant *variant)
{
  dea_variant_set_size(job, run->settings.refinement, variant);
  DEA_TRY(ctx, dea_study_add_points(ctx, job, run->device, run->voltages_V, run->voltage_count,
                                    &variant->curve));
  return DEA_CHAIN(ctx, dea_variant_add_profile(ctx, job, variant));
}

dea_status dea_variant_run(struct dea_context *ctx, const struct dea_study_job *job,
                           const struct dea_variant_run *run)
{
  const struct dea_model_type *type = job->type;
  struct dea_study_job own = *job;
  struct dea_variant *variant;
  double start_s = dea_clock_s();
  DEA_TRY(ctx,
          dea_result_add_variant(ctx, job->result, type->name, run->study, run->name, &variant));
  dea_status status = type->create(ctx, run->device, &run->settings, &own.model);
  if (status == DEA_OK) {
    status = use_model(ctx, &own, run, variant);
    type->destroy(ctx, own.model);
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

dea_status dea_variant_of_sweep(struct dea_context *ctx, const struct dea_study_job *job,
                                const char *study, const char *name)
{
  struct dea_result *result = job->result;
  const char *model = job->type->name;
  const struct dea_curve *sweep = dea_result_find(result, model, "sweep");
  const struct dea_profile_record *last = last_profile(result, model);
  struct dea_variant *variant;
  DEA_TRY(ctx, dea_result_add_variant(ctx, result, model, study, name, &variant));
  dea_variant_set_size(job, dea_model_settings_of(result->design).refinement, variant);
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

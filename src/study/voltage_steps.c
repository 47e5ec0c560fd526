/* What studies share: going through voltages with a model. */
#include "study/observe.h"
#include "study/study.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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

const struct dea_curve *dea_study_first_curve(const struct dea_result *result, const char *kind,
                                              size_t least)
{
  for (size_t i = 0; i < result->curve_count; i++) {
    if (strcmp(result->curves[i].kind, kind) == 0 && result->curves[i].count >= least) {
      return &result->curves[i];
    }
  }
  return NULL;
}

double dea_study_distance_to_pull_in(const struct dea_curve *path,
                                     const struct dea_load_point *point)
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

void dea_study_progress(struct dea_context *ctx, const struct dea_study_job *job, const char *study,
                        size_t done, size_t total)
{
  char what[2 * DEA_NAME_SIZE];
  snprintf(what, sizeof what, "%s %s", job->type->name, study);
  dea_progress(ctx, what, done, total);
}

dea_status dea_study_add_points(struct dea_context *ctx, const struct dea_study_job *job,
                                const struct dea_device *device, const double *voltages_V,
                                size_t count, struct dea_curve *curve)
{
  for (size_t i = 0; i < count; i++) {
    struct dea_load_point point;
    if (dea_interrupted_anywhere(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted before %.6g kV; %zu points are kept",
                      1e-3 * voltages_V[i], curve->count);
    }
    DEA_TRY(ctx, job->type->solve(ctx, job->model, voltages_V[i], &point));
    DEA_TRY(ctx, dea_study_add_point(ctx, job, device, &point, curve));
  }
  return DEA_OK;
}

dea_status dea_study_stop_by_stop(struct dea_context *ctx, const struct dea_study_job *job,
                                  const char *kind, bool whole, const double *voltages_V,
                                  size_t count, dea_study_stop add)
{
  const struct dea_model_type *type = job->type;
  struct dea_result *result = job->result;
  struct dea_study_job own = *job;
  struct dea_curve *curve;
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, type->name, kind, &curve));
  curve->listed = true;
  dea_status status = (whole ? dea_model_create_whole : dea_model_create)(
      ctx, type, result->design, result->device, &own.model);
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    struct dea_load_point at;
    if (dea_interrupted_anywhere(ctx)) {
      status = dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted; %zu points are kept", curve->count);
      break;
    }
    status = type->solve(ctx, own.model, voltages_V[i], &at);
    status = status == DEA_OK ? add(ctx, &own, &at, i, curve) : status;
    if (status == DEA_OK) {
      dea_study_progress(ctx, job, kind, i + 1, count);
    }
  }
  if (own.model != NULL) {
    type->destroy(ctx, own.model);
  }
  return dea_curve_end(ctx, curve, status);
}

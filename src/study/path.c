/* Study "path": the whole equilibrium path with its events. */
#include "study/observe.h"
#include "study/study.h"

#include <math.h>

struct target {
  struct dea_context *ctx;
  const struct dea_study_job *job; // whose model stands at each point that it hands out
  struct dea_monitor_set set;
  struct dea_curve *curve;
};

static dea_status store_point(void *user, const struct dea_load_point *point)
{
  struct target *target = user;
  struct dea_load_point with = *point;
  DEA_TRY(target->ctx, dea_monitor_set_read(target->ctx, &target->set, target->job->type,
                                            target->job->model, false, &with));
  return dea_curve_add_point(target->ctx, target->curve, &with);
}

static dea_status store_event(void *user, const struct dea_event *event)
{
  struct target *target = user;
  return dea_curve_add_event(target->ctx, target->curve, event);
}

/* Total stretch at which the path ends: the design's, or else by default far enough to hold the
 * sweep too, so that no point of it lies beyond the path's figure and events. */
static dea_status choose_end(struct dea_context *ctx, const struct dea_model_type *type,
                             const struct dea_result *result, double *out)
{
  const struct dea_design *design = result->design;
  struct dea_load_point point;
  struct dea_model *model;
  *out = dea_device_path_end(result->device, design);
  if (design->compute.path_max_stretch.origin != DEA_DEFAULT) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_model_create(ctx, type, result->design, result->device, &model));
  const size_t errors =
      dea_finding_trial_begin(ctx); // of a snap-through on the way the sweep tells
  dea_status status = type->solve(ctx, model, dea_design_highest_V(design), &point);
  dea_finding_trial_end(ctx, errors);
  type->destroy(ctx, model);
  if (status == DEA_OK) {
    *out = fmax(*out, dea_device_pre_stretch(result->device) * point.electrode_stretch);
  }
  return status == DEA_E_MEMORY ? status : DEA_OK; // without equilibrium: the sweep will say so
}

/* A long path ends at the highest voltage, and before only where the design says so. */
static struct dea_path_options long_options(const struct dea_design *design)
{
  const struct dea_quantity *end = &design->compute.path_max_stretch;
  return (struct dea_path_options){
      .max_stretch = end->origin == DEA_DEFAULT ? (double)INFINITY : end->si,
      .max_voltage_V = dea_design_highest_V(design),
      .max_points = DEA_LONG_PATH_POINTS_MAX,
  };
}

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_model_type *type = job->type;
  struct dea_result *result = job->result;
  struct target target = {.ctx = ctx, .job = job};
  bool is_long = type->path == NULL && type->long_path != NULL;
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, type->name, "path", &target.curve));
  struct dea_path_options options = {.max_voltage_V = INFINITY, .max_points = DEA_PATH_POINTS_MAX};
  if (is_long) {
    options = long_options(result->design);
  } else {
    DEA_TRY(ctx, choose_end(ctx, type, result, &options.max_stretch));
  }
  dea_status status = dea_monitor_set_init(ctx, type, result->device, &target.set);
  if (status == DEA_OK) {
    status = dea_model_path(ctx, type, job->model, &options, store_point, store_event, &target);
  }
  dea_monitor_set_free(&target.set);
  DEA_TRY(ctx, dea_curve_end(ctx, target.curve, status));
  for (size_t i = 0; i < target.curve->count; i++) {
    struct dea_load_point *point = &target.curve->points[i];
    if (point->stable) {
      point->pull_in_distance_V = dea_study_distance_to_pull_in(target.curve, point);
    }
  }
  return DEA_OK;
}

static bool able(const struct dea_model_type *type, const struct dea_result *result)
{
  return type->path != NULL ||
         (type->long_path != NULL && result->design->compute.solid.path.value != 0);
}

const struct dea_study dea_study_path = {
    .name = "path", .ability = "a path without compute.solid.path", .able = able, .run = run};

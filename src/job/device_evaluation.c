#include "job/device_evaluation.h"

#include "result/compare.h"
#include "study/force.h"
#include "study/observe.h"
#include "study/study.h"

#include <stdio.h>
#include <string.h>

/* ---- one evaluation ---- */

/* Statuses after which the work cannot go on. */
static bool is_fatal(dea_status status)
{
  return dea_status_ends(status) || status == DEA_E_TOOL || status == DEA_E_UNSUPPORTED;
}

/* Keeps the message of a failure after which the work can go on in model->why, and gives DEA_OK;
 * passes the others on. */
static dea_status keep_why(struct dea_device_model *model, dea_status status)
{
  if (status == DEA_OK || is_fatal(status)) {
    return status;
  }
  snprintf(model->why, sizeof model->why, "%.199s", dea_context_message(model->ctx));
  dea_context_clear(model->ctx);
  return DEA_OK;
}

/* More area than this, or less than its inverse, beside a design nearby: another branch, as beyond
 * pull-in. */
static const double branch_jump = 1.5;

/* Copies the state of the last point, for the next evaluation to start from. */
static dea_status keep_state(struct dea_device_model *model, struct dea_model *m, size_t stop)
{
  struct dea_context *ctx = model->ctx;
  struct dea_state now = {0}, *kept = &model->states[stop];
  DEA_TRY(ctx, model->type->save(ctx, m, &now));
  dea_state_free_values(ctx, kept);
  return dea_state_copy_values(ctx, &now, kept);
}

static void drop_state(struct dea_device_model *model, struct dea_state *state)
{
  dea_state_free_values(model->ctx, state);
  *state = (struct dea_state){0};
}

/* Largest area stretch of the film at a point. */
static double area_of(const struct dea_load_point *point)
{
  return point->true_field_V_per_m / point->nominal_field_V_per_m;
}

/* One point from the state of another design at that voltage, if it has one. */
static dea_status solve_from_start(struct dea_device_model *model, struct dea_model *m, size_t stop,
                                   struct dea_load_point *out)
{
  struct dea_context *ctx = model->ctx;
  const struct dea_state *state = &model->start.states[stop];
  bool near = state->array_count > 0;
  if (near && model->type->load(ctx, m, state) != DEA_OK) {
    dea_context_clear(ctx); // another mesh
    near = false;
  }
  DEA_TRY(ctx, model->type->solve(ctx, m, model->voltage_V[stop], out));
  if (near) {
    const double grown = area_of(out) / area_of(&model->start.points[stop]);
    model->doubtful = model->doubtful || out->min_tension_N_per_m <= 0 || !out->stable ||
                      grown > branch_jump || grown < 1 / branch_jump;
  }
  return DEA_OK;
}

/* One point: near the one that the last evaluation found there, else on the way from the last
 * voltage. A slack film has more than one state, and is gone to on that way only. */
static dea_status solve(struct dea_device_model *model, struct dea_model *m, size_t stop,
                        struct dea_load_point *out)
{
  struct dea_context *ctx = model->ctx;
  if (model->from_start) {
    return solve_from_start(model, m, stop, out);
  }
  if (model->states != NULL && model->states[stop].array_count > 0 &&
      model->type->load(ctx, m, &model->states[stop]) != DEA_OK) {
    dea_context_clear(ctx); // another mesh
  }
  DEA_TRY(ctx, model->type->solve(ctx, m, model->voltage_V[stop], out));
  if (model->states == NULL) {
    return DEA_OK;
  }
  if (out->min_tension_N_per_m <= 0) {
    drop_state(model, &model->states[stop]);
    return DEA_OK;
  }
  return keep_state(model, m, stop);
}

static dea_status follow(struct dea_device_model *model, const struct dea_design *design,
                         const struct dea_device *device, const struct dea_device_group *group,
                         struct dea_load_point *points)
{
  struct dea_context *ctx = model->ctx;
  struct dea_model *m;
  size_t last = group->count;
  while (model->wanted != NULL && last > 0 && !model->wanted[group->first + last - 1]) {
    last--;
  }
  DEA_TRY(ctx, dea_model_create(ctx, model->type, design, device, &m));
  dea_status status = DEA_OK;
  bool left = false; // the branch that begins at 0 V
  struct dea_monitor_set set = {.count = 0};
  model->monitors.ctx = ctx;
  status = model->observed ? dea_monitor_set_init(ctx, model->type, device, &set) : DEA_OK;
  if (group->held && status == DEA_OK) {
    struct dea_probe tip = dea_force_indenter(design);
    struct dea_load_point touched;
    status = dea_model_indent(ctx, model->type, m, &tip,
                              dea_force_first_depth_m(design) + group->depth_m, &touched);
  }
  for (size_t k = 0; k < last && status == DEA_OK; k++) {
    struct dea_load_point point;
    if (dea_interrupted(ctx)) {
      status = dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted");
      break;
    }
    status = solve(model, m, group->first + k, &point);
    status =
        status == DEA_OK ? dea_monitor_set_read(ctx, &set, model->type, m, false, &point) : status;
    if (status == DEA_OK) {
      points[group->first + k] = point;
      points[group->first + k].monitors = dea_monitor_values_copy(&model->monitors, point.monitors);
      left = left || (model->type->passed != NULL && model->type->passed(m) != NULL);
      if (left && model->states != NULL) { // it has come here by a snap-through
        drop_state(model, &model->states[group->first + k]);
      }
      model->doubtful = model->doubtful || left;
      status = model->stood != NULL ? model->stood(model->user, m, design, device, group->first + k)
                                    : DEA_OK;
    }
  }
  model->type->destroy(ctx, m);
  dea_monitor_set_free(&set);
  return keep_why(model, status == DEA_OK ? dea_arena_status(&model->monitors) : status);
}

/* Points at the times of a group, on the straight pieces between the steps of the study. */
static void set_times(struct dea_device_model *model, const struct dea_device_group *group,
                      const struct dea_curve *curve, double *time_s, double *values,
                      struct dea_load_point *points)
{
  for (size_t i = 0; i < curve->count; i++) {
    time_s[i] = curve->points[i].time_s;
  }
  model->monitors.ctx = model->ctx;
  for (size_t k = group->first; k < group->first + group->count && model->observed; k++) {
    points[k].monitors = dea_monitor_values_copy(&model->monitors, curve->points[0].monitors);
  }
  for (int c = 0; c < dea_column_count(model->ctx); c++) {
    for (size_t i = 0; i < curve->count; i++) {
      values[i] = dea_point_get(&curve->points[i], c);
    }
    for (size_t k = group->first; k < group->first + group->count; k++) {
      dea_point_set(&points[k], c,
                    dea_interpolate_linear(time_s, values, curve->count, model->voltage_V[k]));
    }
  }
}

/* Plays the waveform by study "transient". */
static dea_status play(struct dea_device_model *model, const struct dea_design *design,
                       const struct dea_device *device, const struct dea_device_group *group,
                       struct dea_load_point *points)
{
  static const char *const names[] = {"transient"};
  struct dea_context *ctx = model->ctx;
  struct dea_result *result;
  DEA_TRY(ctx, dea_result_create(ctx, design, device, &result));
  dea_status status = dea_study_run(ctx, model->type, names, 1, result);
  const struct dea_curve *curve = dea_result_find(result, model->type->name, names[0]);
  if (curve != NULL && curve->count > 0 && !is_fatal(status)) {
    double *both = dea_alloc(ctx, curve->count, 2 * sizeof *both);
    if (both != NULL) {
      set_times(model, group, curve, both, both + curve->count, points);
    }
    status = both != NULL && !model->monitors.failed ? status : DEA_E_MEMORY;
    dea_free(ctx, both);
  }
  dea_result_destroy(ctx, result);
  return keep_why(model, status);
}

static dea_status evaluate(struct dea_device_model *model, const double *p,
                           struct dea_load_point *points)
{
  struct dea_context *ctx = model->ctx;
  struct dea_design *design = NULL;
  struct dea_device *device = NULL;
  for (size_t k = 0; k < model->stop_count; k++) {
    points[k] = dea_load_point_empty();
  }
  const size_t errors = dea_finding_trial_begin(ctx);
  dea_status status = dea_device_params_build(ctx, &model->file, model->params, model->param_count,
                                              p, &design, &device);
  if (status == DEA_E_DESIGN) {
    keep_why(model, status);
    status = DEA_E_DOMAIN;
  } else if (status == DEA_OK && model->built != NULL) {
    status = model->built(model->user, design, device);
  }
  for (size_t g = 0; g < model->group_count && status == DEA_OK; g++) {
    status = model->groups[g].in_time ? play(model, design, device, &model->groups[g], points)
                                      : follow(model, design, device, &model->groups[g], points);
  }
  dea_finding_trial_end(ctx, errors);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  dea_progress(ctx, "sweeps of the device", ++model->evaluations, 0);
  return status;
}

/* ---- evaluations that are kept ---- */

static void drop_states(struct dea_device_model *model, struct dea_state *states)
{
  for (size_t k = 0; states != NULL && k < model->stop_count; k++) {
    drop_state(model, &states[k]);
  }
}

static void forget(struct dea_device_model *model)
{
  for (size_t k = 0; k < DEA_DEVICE_MEMO; k++) {
    dea_free(model->ctx, model->memo[k].points);
    model->memo[k].points = NULL;
  }
}

void dea_device_model_want(struct dea_device_model *model, const bool *wanted)
{
  const size_t size = model->stop_count * sizeof *model->wanted;
  if (memcmp(model->wanted, wanted, size) != 0) {
    memcpy(model->wanted, wanted, size);
    forget(model);
  }
}

void dea_device_model_end(struct dea_device_model *model)
{
  forget(model);
  dea_arena_free(&model->monitors);
  drop_states(model, model->states);
  dea_free(model->ctx, model->states);
  model->states = NULL;
  drop_states(model, model->start.states);
  dea_free(model->ctx, model->start.states);
  dea_free(model->ctx, model->start.points);
  model->start = (struct dea_device_start){0};
}

/* The design of numbers p becomes the one to begin from; where it fails at a voltage nobody does.
 */
static dea_status set_start(struct dea_device_model *model, const double *p)
{
  struct dea_device_start *start = &model->start;
  struct dea_context *ctx = model->ctx;
  start->there = false;
  if (start->states == NULL) {
    start->states = dea_alloc(ctx, model->stop_count, sizeof *start->states);
  }
  if (start->points == NULL) {
    start->points = dea_alloc(ctx, model->stop_count, sizeof *start->points);
  }
  DEA_TRY_MEMORY(start->states != NULL && start->points != NULL);
  drop_states(model, start->states);
  model->states = start->states;
  dea_status status = evaluate(model, p, start->points);
  model->states = NULL;
  DEA_TRY(ctx, status);
  if (model->why[0] != '\0') {
    drop_states(model, start->states);
  }
  memcpy(start->p, p, model->param_count * sizeof *p);
  start->there = true;
  return DEA_OK;
}

/* Whether the design to begin from has states. */
static bool has_states(const struct dea_device_model *model)
{
  bool any = false;
  for (size_t k = 0; k < model->stop_count; k++) {
    any = any || model->start.states[k].array_count > 0;
  }
  return any;
}

/* dea_device_model_sweep of a design to begin from; model->states is NULL. */
static dea_status sweep_from(struct dea_device_model *model, const double *from, const double *p,
                             struct dea_load_point *points)
{
  const size_t size = model->param_count * sizeof *p;
  const bool own = memcmp(from, p, size) == 0;
  if (own || !model->start.there || memcmp(model->start.p, from, size) != 0) {
    dea_status status = set_start(model, from);
    if (own && status == DEA_OK) {
      memcpy(points, model->start.points, model->stop_count * sizeof *points);
    }
    if (own || dea_status_ends(status)) {
      return status;
    }
    dea_context_clear(model->ctx);
    model->why[0] = '\0'; // that of the other design
  }
  if (model->start.there && has_states(model)) {
    model->from_start = true;
    model->doubtful = false;
    dea_status status = evaluate(model, p, points);
    model->from_start = false;
    if (status != DEA_OK || (!model->doubtful && model->why[0] == '\0')) {
      return status;
    }
    model->why[0] = '\0';
  }
  return evaluate(model, p, points);
}

dea_status dea_device_model_sweep(struct dea_device_model *model, const double *from,
                                  const double *p, struct dea_load_point *points)
{
  struct dea_state *states = model->states;
  bool *wanted = model->wanted;
  model->states = NULL;
  model->wanted = NULL;
  dea_status status = from != NULL && model->type->load != NULL ? sweep_from(model, from, p, points)
                                                                : evaluate(model, p, points);
  model->states = states;
  model->wanted = wanted;
  return status;
}

dea_status dea_device_model_points(struct dea_device_model *model, const double *p,
                                   const struct dea_load_point **out)
{
  for (size_t k = 0; k < DEA_DEVICE_MEMO; k++) {
    if (model->memo[k].points != NULL &&
        memcmp(model->memo[k].p, p, model->param_count * sizeof *p) == 0) {
      *out = model->memo[k].points;
      return DEA_OK;
    }
  }
  if (model->states == NULL && model->type->load != NULL) {
    model->states = dea_alloc(model->ctx, model->stop_count, sizeof *model->states);
    DEA_TRY_MEMORY(model->states != NULL);
  }
  struct dea_load_point *points = dea_alloc(model->ctx, model->stop_count, sizeof *points);
  DEA_TRY_MEMORY(points != NULL);
  DEA_TRY_ELSE(model->ctx, evaluate(model, p, points), dea_free(model->ctx, points));
  struct dea_device_memo *memo = &model->memo[model->memo_next++ % DEA_DEVICE_MEMO];
  dea_free(model->ctx, memo->points);
  memcpy(memo->p, p, model->param_count * sizeof *p);
  memo->points = points;
  *out = points;
  return DEA_OK;
}

#include "model/solid/adapter/standing.h"

#include "model/solid/adapter/state.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/equilibrium/carry.h"
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/mesh/transfer.h"

#include <math.h>

enum { VOLTAGE, LEFT_A_STATE, NUMBERS };
static const char own_name[] = "model";
static const double pi = 3.14159265358979323846;
static const double path_step = 0.05; // of the square of the voltage, or of path_unit
static const double path_step_most = 0.5;
static const double path_unit = 2; // of the solid's length: displacement that counts as much as
                                   // all of the voltage

static void end_history(struct dea_context *ctx, struct dea_standing *standing)
{
  dea_circuit_step_destroy(ctx, standing->driven);
  standing->driven = NULL;
}

void dea_standing_free(struct dea_context *ctx, struct dea_standing *standing)
{
  end_history(ctx, standing);
  dea_ending_free(&standing->ending);
  dea_free(ctx, standing->soft);
  standing->soft = NULL;
  standing->soft_count = 0;
}

// Equilibria -------------------------------------------------------------------------------------

dea_status dea_standing_solve(struct dea_context *ctx, struct dea_model *model, double voltage_V,
                              struct dea_load_point *out)
{
  struct dea_standing *standing = (struct dea_standing *)model;
  const struct dea_ending_owner *owner = &standing->ending.owner;
  const bool there = standing->as_made && voltage_V == standing->voltage_V;
  if (!there) {
    dea_standing_end_history(ctx, standing);
    DEA_TRY(ctx, dea_ending_go(ctx, &standing->ending, standing->voltage_V, voltage_V,
                               &standing->report));
  }
  DEA_TRY(ctx, owner->point(ctx, owner->model, standing->voltage_V, out));
  return DEA_OK;
}

const struct dea_event *dea_standing_limit(const struct dea_model *model)
{
  return dea_ending_limit(&((const struct dea_standing *)model)->ending);
}

const struct dea_event *dea_standing_passed(const struct dea_model *model)
{
  return dea_ending_passed(&((const struct dea_standing *)model)->ending);
}

// Path -------------------------------------------------------------------------------------------

/* Where its points go. */
struct path_sinks {
  const struct dea_path_options *options;
  const struct dea_standing_end *end;
  dea_point_sink points;
  dea_event_sink events; // NULL: not wanted
  void *user;
};

/* What the model says of a point of a path. */
static dea_status path_point(struct dea_context *ctx, struct dea_standing *standing,
                             const struct dea_continuation_point *at, struct dea_load_point *out)
{
  const struct dea_ending_owner *owner = &standing->ending.owner;
  standing->report.energy_J = at->energy_J;
  standing->report.unstable_modes = at->unstable_modes;
  DEA_TRY(ctx, owner->point(ctx, owner->model, at->voltage_V, out));
  return DEA_OK;
}

/* How far the solid is beyond the end, in its unit. */
static double beyond(const struct dea_standing *standing, const struct dea_standing_end *end)
{
  const struct dea_solid *solid = standing->ending.owner.solid;
  double sum = -end->value;
  if (end->weight == NULL) {
    return -1;
  }
  for (size_t i = 0; i < solid->problem.dofs; i++) {
    sum += end->weight[i] * solid->state.u[i];
  }
  return sum;
}

/* The limit point or bifurcation that the last step has passed, if it is not beyond the end; where
 * it cannot be closed in on there is none. */
static dea_status path_event(struct dea_context *ctx, struct dea_standing *standing,
                             struct dea_solid_continuation *path, const struct path_sinks *sinks,
                             const struct dea_continuation_point *after)
{
  struct dea_continuation_point at = {0};
  struct dea_event event;
  dea_status status = dea_solid_continuation_locate(ctx, path, &at);
  if (dea_solid_may_shorten(status) || status == DEA_E_ARGUMENT) {
    dea_context_clear(ctx);
    return DEA_OK;
  }
  DEA_TRY(ctx, status);
  if (beyond(standing, sinks->end) > 0) {
    return DEA_OK;
  }
  if (after->passed == DEA_CONTINUATION_BIFURCATION) {
    return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                           "model 3d: another branch crosses the path at %.4g kV; the path goes "
                           "on with %d unstable modes",
                           1e-3 * at.voltage_V, after->unstable_modes);
  }
  event.kind = after->slope < 0 ? DEA_EVENT_PULL_IN : DEA_EVENT_SNAP_BACK;
  DEA_TRY(ctx, path_point(ctx, standing, &at, &event.point));
  return sinks->events != NULL ? sinks->events(sinks->user, &event) : DEA_OK;
}

/* A point of a path into its sink. */
static dea_status put_point(struct dea_context *ctx, struct dea_standing *standing,
                            const struct dea_continuation_point *at, const struct path_sinks *sinks)
{
  struct dea_load_point point;
  DEA_TRY(ctx, path_point(ctx, standing, at, &point));
  DEA_TRY(ctx, sinks->points(sinks->user, &point));
  return DEA_OK;
}

/* The point where the step ends, or the path within it. */
static dea_status take_step(struct dea_context *ctx, struct dea_standing *standing,
                            struct dea_solid_continuation *path, struct dea_continuation_point *at,
                            const struct path_sinks *sinks, bool *ended)
{
  const struct dea_standing_end *end = sinks->end;
  const struct dea_continuation_point step = *at;
  *ended = beyond(standing, end) >= 0;
  if (!*ended) {
    DEA_TRY(ctx, put_point(ctx, standing, at, sinks));
  }
  if (step.passed != DEA_CONTINUATION_NOTHING) {
    DEA_TRY(ctx, path_event(ctx, standing, path, sinks, &step));
  }
  if (*ended) {
    DEA_TRY(ctx, dea_solid_continuation_across(ctx, path, end->weight, end->value, at));
    DEA_TRY(ctx, put_point(ctx, standing, at, sinks));
  }
  standing->voltage_V = at->voltage_V;
  *ended = *ended || at->voltage_V >= sinks->options->max_voltage_V;
  return DEA_OK;
}

/* Step by step to one of the ends. */
static dea_status follow_path(struct dea_context *ctx, struct dea_standing *standing,
                              struct dea_solid_continuation *path, const struct path_sinks *sinks)
{
  bool ended = false;
  for (size_t i = 1; i < sinks->options->max_points && !ended; i++) {
    struct dea_continuation_point at;
    if (dea_interrupted_anywhere(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted on the path");
    }
    dea_status status = dea_solid_continuation_step(ctx, path, &at);
    if (status == DEA_E_DOMAIN) { // 0 V, or the end of a law
      dea_context_clear(ctx);
      return DEA_OK;
    }
    DEA_TRY(ctx, status);
    DEA_TRY(ctx, take_step(ctx, standing, path, &at, sinks, &ended));
  }
  return DEA_OK;
}

dea_status dea_standing_path(struct dea_context *ctx, struct dea_standing *standing,
                             const struct dea_path_options *options,
                             const struct dea_standing_end *end, dea_point_sink points,
                             dea_event_sink events, void *user)
{
  struct dea_solid *solid = standing->ending.owner.solid;
  const struct dea_continuation_options steps = {path_step, path_step_most,
                                                 path_unit * solid->problem.length_m, false};
  const struct path_sinks sinks = {options, end, points, events, user};
  struct dea_solid_continuation *path = NULL;
  struct dea_load_point point;
  struct dea_solid_stand from;
  dea_standing_end_history(ctx, standing);
  const struct dea_solid_report report = standing->report;
  const double voltage_V = standing->voltage_V;
  DEA_TRY(ctx, standing->ending.owner.point(ctx, standing->ending.owner.model, standing->voltage_V,
                                            &point));
  DEA_TRY(ctx, points(user, &point));
  dea_status status = dea_solid_stand_keep(ctx, solid, &from);
  if (status == DEA_OK) {
    const double scale_V =
        isfinite(options->max_voltage_V) ? options->max_voltage_V : standing->ending.owner.step_V;
    status = dea_solid_continuation_create(ctx, solid, scale_V, &steps, &path);
  }
  if (status == DEA_OK) {
    status = follow_path(ctx, standing, path, &sinks);
  }
  if (path != NULL && !(status == DEA_OK && options->stays)) {
    dea_solid_stand_again(solid, &from);
    standing->report = report;
    standing->voltage_V = voltage_V;
  }
  dea_solid_continuation_destroy(ctx, path);
  dea_solid_stand_free(&from);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

// Other states -----------------------------------------------------------------------------------

dea_status dea_standing_soften(struct dea_context *ctx, struct dea_model *model, size_t count,
                               double *stiffness_N_per_m4)
{
  struct dea_standing *standing = (struct dea_standing *)model;
  struct dea_solid *solid = standing->ending.owner.solid;
  size_t moves = 3 * solid->problem.grid->node_count;
  dea_standing_end_history(ctx, standing);
  dea_standing_free(ctx, standing);
  if (count == 0 || count > DEA_SOFT_MODES_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "1 to %d soft modes can be asked for", DEA_SOFT_MODES_MAX);
  }
  standing->soft = dea_solid_alloc(ctx, count * moves, sizeof *standing->soft);
  if (standing->soft == NULL) {
    return DEA_E_MEMORY;
  }
  DEA_TRY(ctx, dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_VOLUME, count, stiffness_N_per_m4,
                                      standing->soft));
  standing->soft_count = count;
  return DEA_OK;
}

/* Share of a mode that a push keeps at a place: 1 in the middle of a sector, 1/2 on its border
 * where the next one is left out. */
static double kept_share(const struct dea_push *push, const double X[3])
{
  double share = 0;
  if (push->parts < 2) {
    return 1;
  }
  double at = atan2(X[1], X[0]) / (2 * pi) * push->parts;
  for (int k = 0; k < push->parts; k++) {
    double away = at - k - push->parts * round((at - k) / push->parts);
    if ((push->in >> k & 1) != 0 && fabs(away) < 1) {
      share += pow(cos(0.5 * pi * away), 2);
    }
  }
  return share;
}

/* The push as displacements [node_count][3]: of a mode, which is NULL for what is a fold. */
static void set_push(const struct dea_grid *grid, const struct dea_push *push, const double *mode,
                     const double *fold, double *out)
{
  double most = 0;
  for (size_t n = 0; n < grid->node_count; n++) {
    double share = kept_share(push, grid->X + 3 * n);
    for (size_t i = 3 * n; i < 3 * n + 3; i++) {
      out[i] = share * (mode != NULL ? mode[i] : fold[i]);
      most = fmax(most, fabs(out[i]));
    }
  }
  double scale = mode != NULL && most > 0 ? push->side * push->amplitude_m / most : 1;
  for (size_t i = 0; i < 3 * grid->node_count; i++) {
    out[i] *= scale;
  }
}

dea_status dea_standing_push(struct dea_context *ctx, struct dea_standing *standing,
                             const struct dea_push *push, const double *fold,
                             struct dea_load_point *out, bool *found)
{
  const struct dea_ending_owner *owner = &standing->ending.owner;
  const struct dea_grid *grid = owner->solid->problem.grid;
  bool folds = push->kind == DEA_PUSH_FOLD;
  size_t moves = 3 * grid->node_count;
  *found = standing->as_made = false;
  if (folds && fold == NULL) {
    return DEA_OK;
  }
  if ((!folds && push->mode >= standing->soft_count) || push->parts > DEA_PUSH_PARTS_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a push along mode %zu of %zu soft ones, in %d parts",
                    push->mode + 1, standing->soft_count, push->parts);
  }
  double *way = dea_solid_alloc(ctx, moves, sizeof *way);
  if (way == NULL) {
    return DEA_E_MEMORY;
  }
  set_push(grid, push, folds ? NULL : standing->soft + push->mode * moves, fold, way);
  dea_status status = dea_solid_push(ctx, owner->solid, way, NULL, NULL, &standing->report, found);
  dea_free(ctx, way);
  DEA_TRY(ctx, status);
  return *found ? owner->point(ctx, owner->model, standing->voltage_V, out) : DEA_OK;
}

dea_status dea_standing_carry(struct dea_context *ctx, struct dea_standing *standing,
                              const struct dea_standing *from, struct dea_load_point *out,
                              bool *found)
{
  const struct dea_ending_owner *owner = &standing->ending.owner;
  const struct dea_solid *other = from->ending.owner.solid;
  const struct dea_grid *grid = owner->solid->problem.grid;
  dea_standing_end_history(ctx, standing);
  *found = false;
  double *u = dea_solid_alloc(ctx, 3 * grid->node_count, sizeof *u);
  if (u == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = dea_grid_transfer(ctx, other->problem.grid, other->state.u, grid, u);
  if (status == DEA_OK) {
    status = dea_solid_carry(ctx, owner->solid, from->voltage_V, u, &standing->report, found);
  }
  dea_free(ctx, u);
  DEA_TRY(ctx, status);
  if (*found) {
    standing->voltage_V = from->voltage_V;
    standing->left_a_state = false;
    DEA_TRY(ctx, owner->point(ctx, owner->model, standing->voltage_V, out));
  }
  return DEA_OK;
}

// In time ----------------------------------------------------------------------------------------

void dea_standing_end_history(struct dea_context *ctx, struct dea_standing *standing)
{
  standing->as_made = false;
  if (standing->driven != NULL) {
    end_history(ctx, standing);
    standing->voltage_V = dea_solid_voltage(standing->ending.owner.solid);
  }
}

static dea_status report_time(struct dea_context *ctx, struct dea_standing *standing,
                              struct dea_load_point *out)
{
  const struct dea_ending_owner *owner = &standing->ending.owner;
  standing->voltage_V = dea_solid_voltage(owner->solid);
  DEA_TRY(ctx, owner->point(ctx, owner->model, standing->voltage_V, out));
  dea_circuit_step_point(standing->driven, out);
  out->stored_energy_J += standing->stored_J;
  out->energy_J = out->stored_energy_J - dea_circuit_step_charged_J(standing->driven);
  return DEA_OK;
}

dea_status dea_standing_begin(struct dea_context *ctx, struct dea_standing *standing,
                              const struct dea_driven_solid *driven,
                              const struct dea_time_options *time, struct dea_load_point *out)
{
  const struct dea_ending_owner *owner = &standing->ending.owner;
  dea_standing_end_history(ctx, standing);
  DEA_TRY(ctx, owner->point(ctx, owner->model, standing->voltage_V, out));
  DEA_TRY(ctx, dea_circuit_step_create(ctx, driven, time, &standing->driven));
  standing->stored_J = out->energy_J + dea_circuit_step_charged_J(standing->driven);
  DEA_TRY(ctx, report_time(ctx, standing, out));
  return DEA_OK;
}

dea_status dea_standing_advance(struct dea_context *ctx, struct dea_model *model,
                                const struct dea_time_step *step, struct dea_load_point *out,
                                double *error)
{
  struct dea_standing *standing = (struct dea_standing *)model;
  if (standing->driven == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a history in time has to begin first");
  }
  if (dea_interrupted_anywhere(ctx)) {
    return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted in a step in time");
  }
  DEA_TRY(ctx, dea_circuit_step_advance(ctx, standing->driven, step, &standing->report, error));
  DEA_TRY(ctx, report_time(ctx, standing, out));
  return DEA_OK;
}

void dea_standing_accept(struct dea_model *model)
{
  dea_circuit_step_accept(((struct dea_standing *)model)->driven);
}

// Saved states -----------------------------------------------------------------------------------

dea_status dea_standing_save(struct dea_context *ctx, const struct dea_standing *standing,
                             struct dea_state *out)
{
  const double own[NUMBERS] = {
      [VOLTAGE] = standing->voltage_V, [LEFT_A_STATE] = standing->left_a_state ? 1 : 0};
  *out = (struct dea_state){0};
  DEA_TRY(ctx, dea_solid_save(ctx, standing->ending.owner.solid, out));
  DEA_TRY(ctx, dea_state_add_numbers(ctx, out, own_name, own, NUMBERS));
  return DEA_OK;
}

dea_status dea_standing_load(struct dea_context *ctx, struct dea_model *model,
                             const struct dea_state *state)
{
  struct dea_standing *standing = (struct dea_standing *)model;
  const double *own = dea_state_find(state, own_name, NUMBERS);
  if (own == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the state is not one of model 3d");
  }
  standing->as_made = false;
  standing->ending.rate[0] = 0; // there is no step before
  DEA_TRY(ctx, dea_solid_load(ctx, standing->ending.owner.solid, state));
  standing->voltage_V = own[VOLTAGE];
  standing->left_a_state = own[LEFT_A_STATE] != 0;
  return DEA_OK;
}

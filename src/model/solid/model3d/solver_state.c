#include "model/solid/model3d/solver_state.h"

#include "model/solid/assembly/problem.h"
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/model3d/solid_state.h"

#include <math.h>

enum { VOLTAGE, LEFT_A_STATE, NUMBERS };
static const char own_name[] = "model";
static const double pi = 3.14159265358979323846;
static const double path_step = 0.05; // of the square of the voltage, or of path_unit
static const double path_step_most = 0.5;
static const double path_unit = 2; // of the solid's length: displacement that counts as much as
                                   // all of the voltage

static void end_history(struct dea_context *ctx, struct dea_solver_state *solver_state)
{
  dea_circuit_step_destroy(ctx, solver_state->driven);
  solver_state->driven = NULL;
}

void dea_solver_state_free(struct dea_context *ctx, struct dea_solver_state *solver_state)
{
  end_history(ctx, solver_state);
  dea_step_outcome_free(&solver_state->outcome);
  dea_free(ctx, solver_state->soft);
  solver_state->soft = NULL;
  solver_state->soft_count = 0;
}

// Equilibria -------------------------------------------------------------------------------------

dea_status dea_solver_state_solve(struct dea_context *ctx, struct dea_model *model,
                                  double voltage_V, struct dea_load_point *out)
{
  struct dea_solver_state *solver_state = (struct dea_solver_state *)model;
  const struct dea_step_outcome_owner *owner = &solver_state->outcome.owner;
  const bool there = solver_state->as_made && voltage_V == solver_state->voltage_V;
  if (!there) {
    dea_solver_state_end_history(ctx, solver_state);
    DEA_TRY(ctx, dea_step_outcome_go(ctx, &solver_state->outcome, solver_state->voltage_V,
                                     voltage_V, &solver_state->report));
  }
  return DEA_CHAIN(ctx, owner->point(ctx, owner->model, solver_state->voltage_V, out));
}

const struct dea_event *dea_solver_state_limit(const struct dea_model *model)
{
  return dea_step_outcome_limit(&((const struct dea_solver_state *)model)->outcome);
}

const struct dea_event *dea_solver_state_passed(const struct dea_model *model)
{
  return dea_step_outcome_passed(&((const struct dea_solver_state *)model)->outcome);
}

// Path -------------------------------------------------------------------------------------------

/* Where its points go. */
struct path_sinks {
  const struct dea_path_options *options;
  const struct dea_solver_state_end *end;
  dea_point_sink points;
  dea_event_sink events; // NULL: not wanted
  void *user;
};

/* What the model says of a point of a path. */
static dea_status path_point(struct dea_context *ctx, struct dea_solver_state *solver_state,
                             const struct dea_continuation_point *at, struct dea_load_point *out)
{
  const struct dea_step_outcome_owner *owner = &solver_state->outcome.owner;
  solver_state->report.energy_J = at->energy_J;
  solver_state->report.unstable_modes = at->unstable_modes;
  return DEA_CHAIN(ctx, owner->point(ctx, owner->model, at->voltage_V, out));
}

/* How far the solid is beyond the end, in its unit. */
static double beyond(const struct dea_solver_state *solver_state,
                     const struct dea_solver_state_end *end)
{
  const struct dea_solid *solid = solver_state->outcome.owner.solid;
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
static dea_status path_event(struct dea_context *ctx, struct dea_solver_state *solver_state,
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
  if (beyond(solver_state, sinks->end) > 0) {
    return DEA_OK;
  }
  if (after->passed == DEA_CONTINUATION_BIFURCATION) {
    return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                           "model 3d: another branch crosses the path at %.4g kV; the path goes "
                           "on with %d unstable modes",
                           1e-3 * at.voltage_V, after->unstable_modes);
  }
  event.kind = after->slope < 0 ? DEA_EVENT_PULL_IN : DEA_EVENT_SNAP_BACK;
  DEA_TRY(ctx, path_point(ctx, solver_state, &at, &event.point));
  return sinks->events != NULL ? sinks->events(sinks->user, &event) : DEA_OK;
}

/* A point of a path into its sink. */
static dea_status add_point(struct dea_context *ctx, struct dea_solver_state *solver_state,
                            const struct dea_continuation_point *at, const struct path_sinks *sinks)
{
  struct dea_load_point point;
  DEA_TRY(ctx, path_point(ctx, solver_state, at, &point));
  return DEA_CHAIN(ctx, sinks->points(sinks->user, &point));
}

/* The point where the step ends, or the path within it. */
static dea_status solve_step(struct dea_context *ctx, struct dea_solver_state *solver_state,
                             struct dea_solid_continuation *path, struct dea_continuation_point *at,
                             const struct path_sinks *sinks, bool *ended)
{
  const struct dea_solver_state_end *end = sinks->end;
  const struct dea_continuation_point step = *at;
  *ended = beyond(solver_state, end) >= 0;
  DEA_TRY(ctx, !*ended ? add_point(ctx, solver_state, at, sinks) : DEA_OK);
  if (step.passed != DEA_CONTINUATION_NOTHING) {
    DEA_TRY(ctx, path_event(ctx, solver_state, path, sinks, &step));
  }
  if (*ended) {
    DEA_TRY(ctx, dea_solid_continuation_across(ctx, path, end->weight, end->value, at));
    DEA_TRY(ctx, add_point(ctx, solver_state, at, sinks));
  }
  solver_state->voltage_V = at->voltage_V;
  *ended = *ended || at->voltage_V >= sinks->options->max_voltage_V;
  return DEA_OK;
}

/* Step by step to one of the ends. */
static dea_status follow_path(struct dea_context *ctx, struct dea_solver_state *solver_state,
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
    DEA_TRY(ctx, solve_step(ctx, solver_state, path, &at, sinks, &ended));
  }
  return DEA_OK;
}

dea_status dea_solver_state_path(struct dea_context *ctx, struct dea_solver_state *solver_state,
                                 const struct dea_path_options *options,
                                 const struct dea_solver_state_end *end, dea_point_sink points,
                                 dea_event_sink events, void *user)
{
  struct dea_solid *solid = solver_state->outcome.owner.solid;
  const struct dea_continuation_options steps = {path_step, path_step_most,
                                                 path_unit * solid->problem.length_m, false};
  const struct path_sinks sinks = {options, end, points, events, user};
  struct dea_solid_continuation *path = NULL;
  struct dea_load_point point;
  struct dea_solid_saved_state from;
  dea_solver_state_end_history(ctx, solver_state);
  const struct dea_solid_report report = solver_state->report;
  const double voltage_V = solver_state->voltage_V;
  DEA_TRY(ctx, solver_state->outcome.owner.point(ctx, solver_state->outcome.owner.model,
                                                 solver_state->voltage_V, &point));
  DEA_TRY(ctx, points(user, &point));
  dea_status status = dea_solid_save_state(ctx, solid, &from);
  if (status == DEA_OK) {
    const double scale_V = isfinite(options->max_voltage_V) ? options->max_voltage_V
                                                            : solver_state->outcome.owner.step_V;
    status = dea_solid_continuation_create(ctx, solid, scale_V, &steps, &path);
  }
  status = status == DEA_OK ? follow_path(ctx, solver_state, path, &sinks) : status;
  if (path != NULL && !(status == DEA_OK && options->stays)) {
    dea_solid_restore_state(solid, &from);
    solver_state->report = report;
    solver_state->voltage_V = voltage_V;
  }
  dea_solid_continuation_destroy(ctx, path);
  dea_solid_saved_state_free(&from);
  return DEA_CHAIN(ctx, status);
}

// Other states -----------------------------------------------------------------------------------

dea_status dea_solver_state_soften(struct dea_context *ctx, struct dea_model *model, size_t count,
                                   double *stiffness_N_per_m4)
{
  struct dea_solver_state *solver_state = (struct dea_solver_state *)model;
  struct dea_solid *solid = solver_state->outcome.owner.solid;
  size_t moves = 3 * solid->problem.grid->node_count;
  dea_solver_state_end_history(ctx, solver_state);
  dea_solver_state_free(ctx, solver_state);
  if (count == 0 || count > DEA_SOFT_MODES_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "1 to %d soft modes can be asked for", DEA_SOFT_MODES_MAX);
  }
  solver_state->soft = dea_solid_alloc(ctx, count * moves, sizeof *solver_state->soft);
  DEA_TRY_MEMORY(solver_state->soft != NULL);
  DEA_TRY(ctx, dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_VOLUME, count, stiffness_N_per_m4,
                                      solver_state->soft));
  solver_state->soft_count = count;
  return DEA_OK;
}

/* Share of a mode that a push keeps at a place: 1 in the middle of a sector, 1/2 on its border
 * where the next one is left out. */
static double kept_share(const struct dea_push *push, const double X[3])
{
  double fraction = 0;
  if (push->parts < 2) {
    return 1;
  }
  double at = atan2(X[1], X[0]) / (2 * pi) * push->parts;
  for (int k = 0; k < push->parts; k++) {
    double away = at - k - push->parts * round((at - k) / push->parts);
    if ((push->in >> k & 1) != 0 && fabs(away) < 1) {
      fraction += pow(cos(0.5 * pi * away), 2);
    }
  }
  return fraction;
}

/* The push as displacements [node_count][3]: of a mode, which is NULL for what is a fold. */
static void set_push(const struct dea_grid *grid, const struct dea_push *push, const double *mode,
                     const double *fold, double *out)
{
  double most = 0;
  for (size_t n = 0; n < grid->node_count; n++) {
    double fraction = kept_share(push, grid->X + 3 * n);
    for (size_t i = 3 * n; i < 3 * n + 3; i++) {
      out[i] = fraction * (mode != NULL ? mode[i] : fold[i]);
      most = fmax(most, fabs(out[i]));
    }
  }
  double scale = mode != NULL && most > 0 ? push->side * push->amplitude_m / most : 1;
  for (size_t i = 0; i < 3 * grid->node_count; i++) {
    out[i] *= scale;
  }
}

dea_status dea_solver_state_push(struct dea_context *ctx, struct dea_solver_state *solver_state,
                                 const struct dea_push *push, const double *fold,
                                 struct dea_load_point *out, bool *found)
{
  const struct dea_step_outcome_owner *owner = &solver_state->outcome.owner;
  const struct dea_grid *grid = owner->solid->problem.grid;
  bool folds = push->kind == DEA_PUSH_FOLD;
  size_t moves = 3 * grid->node_count;
  *found = solver_state->as_made = false;
  if (folds && fold == NULL) {
    return DEA_OK;
  }
  if ((!folds && push->mode >= solver_state->soft_count) || push->parts > DEA_PUSH_PARTS_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a push along mode %zu of %zu soft ones, in %d parts",
                    push->mode + 1, solver_state->soft_count, push->parts);
  }
  double *displacement = dea_solid_alloc(ctx, moves, sizeof *displacement);
  DEA_TRY_MEMORY(displacement != NULL);
  set_push(grid, push, folds ? NULL : solver_state->soft + push->mode * moves, fold, displacement);
  dea_status status =
      dea_solid_perturb(ctx, owner->solid, displacement, NULL, NULL, &solver_state->report, found);
  dea_free(ctx, displacement);
  DEA_TRY(ctx, status);
  return *found ? owner->point(ctx, owner->model, solver_state->voltage_V, out) : DEA_OK;
}

// In time ----------------------------------------------------------------------------------------

void dea_solver_state_end_history(struct dea_context *ctx, struct dea_solver_state *solver_state)
{
  solver_state->as_made = false;
  if (solver_state->driven != NULL) {
    end_history(ctx, solver_state);
    solver_state->voltage_V = dea_solid_voltage(solver_state->outcome.owner.solid);
  }
}

static dea_status report_time(struct dea_context *ctx, struct dea_solver_state *solver_state,
                              struct dea_load_point *out)
{
  const struct dea_step_outcome_owner *owner = &solver_state->outcome.owner;
  solver_state->voltage_V = dea_solid_voltage(owner->solid);
  DEA_TRY(ctx, owner->point(ctx, owner->model, solver_state->voltage_V, out));
  dea_circuit_step_point(solver_state->driven, out);
  out->stored_energy_J += solver_state->stored_J;
  out->energy_J = out->stored_energy_J - dea_circuit_step_charged_J(solver_state->driven);
  return DEA_OK;
}

dea_status dea_solver_state_begin(struct dea_context *ctx, struct dea_solver_state *solver_state,
                                  const struct dea_driven_solid *driven,
                                  const struct dea_time_options *time, struct dea_load_point *out)
{
  const struct dea_step_outcome_owner *owner = &solver_state->outcome.owner;
  dea_solver_state_end_history(ctx, solver_state);
  DEA_TRY(ctx, owner->point(ctx, owner->model, solver_state->voltage_V, out));
  DEA_TRY(ctx, dea_circuit_step_create(ctx, driven, time, &solver_state->driven));
  solver_state->stored_J = out->energy_J + dea_circuit_step_charged_J(solver_state->driven);
  return DEA_CHAIN(ctx, report_time(ctx, solver_state, out));
}

dea_status dea_solver_state_advance(struct dea_context *ctx, struct dea_model *model,
                                    const struct dea_time_step *step, struct dea_load_point *out,
                                    double *error)
{
  struct dea_solver_state *solver_state = (struct dea_solver_state *)model;
  if (solver_state->driven == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a history in time has to begin first");
  }
  if (dea_interrupted_anywhere(ctx)) {
    return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted in a step in time");
  }
  DEA_TRY(ctx,
          dea_circuit_step_advance(ctx, solver_state->driven, step, &solver_state->report, error));
  return DEA_CHAIN(ctx, report_time(ctx, solver_state, out));
}

void dea_solver_state_accept(struct dea_model *model)
{
  dea_circuit_step_accept(((struct dea_solver_state *)model)->driven);
}

// Saved states -----------------------------------------------------------------------------------

dea_status dea_solver_state_save(struct dea_context *ctx,
                                 const struct dea_solver_state *solver_state, struct dea_state *out)
{
  const double own[NUMBERS] = {
      [VOLTAGE] = solver_state->voltage_V, [LEFT_A_STATE] = solver_state->left_a_state ? 1 : 0};
  *out = (struct dea_state){0};
  DEA_TRY(ctx, dea_solid_save(ctx, solver_state->outcome.owner.solid, out));
  return DEA_CHAIN(ctx, dea_state_add_numbers(ctx, out, own_name, own, NUMBERS));
}

dea_status dea_solver_state_load(struct dea_context *ctx, struct dea_model *model,
                                 const struct dea_state *state)
{
  struct dea_solver_state *solver_state = (struct dea_solver_state *)model;
  const double *own = dea_state_find(state, own_name, NUMBERS);
  if (own == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the state is not one of model 3d");
  }
  solver_state->as_made = false;
  DEA_TRY(ctx, dea_solid_load(ctx, solver_state->outcome.owner.solid, state));
  solver_state->voltage_V = own[VOLTAGE];
  solver_state->left_a_state = own[LEFT_A_STATE] != 0;
  return DEA_OK;
}

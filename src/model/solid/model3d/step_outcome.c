/* A solid on its way to a voltage, and the verdict where it does not get there
 * (docs/theory/stops.md). */
#include "model/solid/model3d/solid_model.h"

#include "base/whole.h"
#include "model/make.h"
#include "model/solid/assembly/channels.h"
#include "model/solid/equilibrium/newton.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* More area at once than this, and a limit point may have been passed: along a path that goes on
 * the area stretch of a step is well below it, at pull-in it goes to where the law stiffens. */
static const double branch_jump = 1.5;
static const double no_tension =
    1e-6; // of the scale: a membrane that is slack has none to rounding

static const double field_step_V_per_m = 10e6; // a longer way is gone in such steps of V/H0

double dea_step_outcome_longest_V(const struct dea_step_outcome *e)
{
  return field_step_V_per_m * e->model->plies.thinnest_m;
}

/* What is small against the film's modulus is no tension. */
static double least_tension(const struct dea_step_outcome *e)
{
  const struct dea_plies *plies = &e->model->plies;
  return no_tension * (dea_part_material_modulus(&plies->part_materials[plies->film]) *
                       e->model->layout->plies[plies->film].thickness_m);
}

/* Evaluates the films where the solid is, once: it is looked at where a load step ends and where
 * the next one begins. */
static dea_status evaluate_film(struct dea_context *ctx, struct dea_step_outcome *e)
{
  struct dea_solid *s = e->model->solid;
  struct dea_solid_extremes film;
  const size_t dofs = s->problem.dofs, count = dofs + s->problem.channel_count + 1;
  const bool first = e->film_at[0] == NULL;
  e->memory.ctx = ctx;
  for (int i = 0; i < 2 && first; i++) {
    e->film_at[i] = dea_arena_alloc(&e->memory, count, sizeof *e->film_at[i]);
  }
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(&e->memory)));
  double *now = e->film_at[1];
  e->film_at[0][0] = first ? NAN : e->film_at[0][0];
  memcpy(now, s->state.u, dofs * sizeof *now);
  dea_solid_channel_voltages(s, now + dofs);
  if (memcmp(now, e->film_at[0], count * sizeof *now) == 0) {
    return DEA_OK;
  }
  dea_status status = dea_solid_extremes(s, e->model->plies.films, &film);
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "the film cannot be evaluated on the way");
  }
  e->film = film;
  e->film_at[1] = e->film_at[0];
  e->film_at[0] = now;
  return DEA_OK;
}

/* Keeps the smallest tension where the solid is, which tells where the film goes slack, and its
 * largest area stretch. */
static dea_status check_tension(struct dea_context *ctx, struct dea_step_outcome *e)
{
  double V = dea_solid_voltage(e->model->solid);
  DEA_TRY(ctx, evaluate_film(ctx, e));
  e->area = e->film.area;
  for (int i = 0; i < 2 && V != e->tension_V[2]; i++) {
    e->tension[i] = e->tension[i + 1];
    e->tension_V[i] = e->tension_V[i + 1];
  }
  e->tension[2] = e->film.min_tension_N_per_m;
  e->tension_V[2] = V;
  return DEA_OK;
}

/* Whether the film carries tension all over where it was looked at last. */
static bool is_taut(const struct dea_step_outcome *e)
{
  return e->tension[2] > least_tension(e);
}

/* The point where the solid is, as the event at which a solve ends. */
static dea_status get_event(struct dea_context *ctx, struct dea_step_outcome *e,
                            enum dea_event_kind kind)
{
  dea_status status =
      dea_solid_model_report(ctx, e->model, dea_solid_voltage(e->model->solid), &e->limit.point);
  e->limit.kind = kind;
  e->limited = status == DEA_OK;
  return status;
}

static void drop_limit(struct dea_step_outcome *e)
{
  dea_solid_saved_state_free(&e->at_limit);
  e->at_limit = (struct dea_solid_saved_state){.state = NULL};
}

void dea_step_outcome_free(struct dea_step_outcome *e)
{
  drop_limit(e);
  dea_arena_free(&e->memory);
  e->film_at[0] = e->film_at[1] = NULL;
}

/* The voltage at which two points that were looked at after each other have the tension 0 on the
 * line by the square of the voltage. NAN: none. */
static double slack_V(const struct dea_step_outcome *e, int first)
{
  const double *T = e->tension + first, *at_V = e->tension_V + first, square = at_V[1] * at_V[1];
  return T[0] != T[1] ? sqrt(square + T[1] * (square - at_V[0] * at_V[0]) / (T[0] - T[1])) : NAN;
}

/* Whether the tension of the film, which no step leads on from, is 0 closely beyond by its last two
 * points: the voltage of that as an event. */
static dea_status observe_slack_beyond(struct dea_context *ctx, struct dea_step_outcome *e,
                                       bool *slack)
{
  const double V = dea_solid_voltage(e->model->solid), beyond = slack_V(e, 1);
  const double near = 1 + dea_branch_jump_width;
  *slack = e->tension_V[2] == V && e->tension_V[1] != V && beyond >= V && beyond <= near * V;
  if (*slack) {
    DEA_TRY(ctx, get_event(ctx, e, DEA_EVENT_SLACK));
    e->limit.point.voltage_V = beyond;
  }
  return DEA_OK;
}

/* A point of the path on the way to where a solve ends. Where the film goes slack between two of
 * them: the voltage from their tensions, or those of the two before. */
static dea_status observe_point(struct dea_context *ctx, void *user, enum dea_solid_stop_kind where)
{
  struct dea_step_outcome *e = user;
  double V = dea_solid_voltage(e->model->solid);
  bool before = is_taut(e);
  bool thins = before || e->grew; // where it turns unstable: in one place
  if (where == DEA_STOP_LIMIT && !e->has_passed) {
    drop_limit(e);
    DEA_TRY(ctx, dea_solid_save_state(ctx, e->model->solid, &e->at_limit));
  }
  if (where == DEA_STOP_PASSED) {
    e->limited = false;
    return check_tension(ctx, e);
  }
  if (where == DEA_STOP_NEAR && !e->grew) {
    bool slack;
    dea_status status = observe_slack_beyond(ctx, e, &slack);
    if (status != DEA_OK || slack) { // it has no tension there
      return status;
    }
  }
  if (where == DEA_STOP_LIMIT || where == DEA_STOP_NEAR || (where == DEA_STOP_UNSTABLE && thins)) {
    return get_event(ctx, e, V >= e->from_V ? DEA_EVENT_PULL_IN : DEA_EVENT_SNAP_BACK);
  }
  if (where == DEA_STOP_UNSTABLE) {
    return DEA_OK;
  }
  DEA_TRY(ctx, check_tension(ctx, e));
  if (before && !is_taut(e) && !e->limited) {
    const double first_V = e->tension_V[1], last_V = e->tension_V[2];
    const bool compressed = e->tension[2] < -least_tension(e);
    const double at_V = slack_V(e, compressed ? 1 : 0); // a membrane has none from there on
    DEA_TRY(ctx, get_event(ctx, e, DEA_EVENT_SLACK));
    e->limit.point.voltage_V = fmin(fmax(at_V, fmin(first_V, last_V)), fmax(first_V, last_V));
  }
  return DEA_OK;
}

static dea_status observe_change(struct dea_context *ctx, void *user, struct dea_solid_change *out)
{
  struct dea_step_outcome *e = user;
  DEA_TRY(ctx, evaluate_film(ctx, e));
  out->grew = e->film.area > branch_jump * fmax(e->area, 1);
  e->grew |= out->grew;
  out->taut = e->film.min_tension_N_per_m > least_tension(e);
  return DEA_OK;
}

static bool was_taut(const void *user)
{
  return is_taut(user);
}

/* A film without tension that turned unstable, or that has lost it on the way that ended here. */
static dea_status fail_slack(struct dea_context *ctx, const struct dea_step_outcome *e,
                             double voltage_V, const struct dea_solid_stop *stop)
{
  char where[80] = "has no tension", state[120] = "it wrinkles";
  if (e->limited) {
    snprintf(where, sizeof where, "loses its tension at %.6g kV", 1e-3 * e->limit.point.voltage_V);
  }
  if (stop->kind == DEA_STOP_UNSTABLE) {
    snprintf(state, sizeof state, "from %.6g kV on it buckles, in %d mode%s of this mesh",
             1e-3 * stop->voltage_V, stop->unstable_modes, stop->unstable_modes == 1 ? "" : "s");
  } else if (e->model->mesh.membrane) {
    snprintf(state, sizeof state, "wrinkled, it thins without limit");
  }
  return dea_fail(ctx, DEA_E_SLACK,
                  "the film %s; %s. No state at %.6g kV was found on this mesh "
                  "(compute.solid.refinement, domain: disc)",
                  where, state, 1e-3 * voltage_V);
}

/* The verdict on a solve that failed on the way to a voltage (docs/theory/stops.md). */
static dea_status stopped(struct dea_context *ctx, struct dea_step_outcome *e, double voltage_V,
                          const struct dea_solid_stop *stop, dea_status status)
{
  char why[160];
  snprintf(why, sizeof why, "%s", dea_context_message(ctx));
  // the film is past a limit point where that is not the cause
  e->limited &= e->limit.kind == DEA_EVENT_SLACK || stop->kind != DEA_STOP_UNKNOWN;
  if (e->limited && e->limit.kind != DEA_EVENT_SLACK) {
    char stretch[60] = ""; // of a disc
    if (!isnan(e->limit.point.electrode_stretch)) {
      snprintf(stretch, sizeof stretch, " and an electrode stretch of %.5g",
               e->limit.point.electrode_stretch);
    }
    return dea_fail(
        ctx, DEA_E_NO_EQUILIBRIUM, "%s at %.6g kV%s: %s there is no stable equilibrium at %.6g kV",
        e->limit.kind == DEA_EVENT_PULL_IN ? "pull-in" : "snap-back", 1e-3 * stop->voltage_V,
        stretch, stop->kind == DEA_STOP_LIMIT ? "beyond it" : "the film thins in one place, and",
        1e-3 * voltage_V);
  }
  bool unsettled = stop->kind == DEA_STOP_UNSTABLE || status == DEA_E_NOT_CONVERGED;
  if (status == DEA_E_NOT_CONVERGED && !e->limited) {
    bool slack;
    dea_status seen = check_tension(ctx, e);
    seen = seen == DEA_OK ? observe_slack_beyond(ctx, e, &slack) : seen;
    if (seen != DEA_OK && !dea_solid_may_shorten(seen)) {
      return dea_fail_chain(ctx, seen, __func__, __FILE__, __LINE__);
    }
    if (seen != DEA_OK) { // the law ends there
      snprintf(why, sizeof why, "%s", dea_context_message(ctx));
      status = seen;
    }
  }
  if (e->limited || (unsettled && !is_taut(e))) {
    return fail_slack(ctx, e, voltage_V, stop);
  }
  if (status == DEA_E_INVERTED) {
    return dea_fail(ctx, status,
                    "at %.6g kV, on the way to %.6g kV, %s: a mesh that follows is finer "
                    "(compute.solid.refinement: %.3g)",
                    1e-3 * dea_solid_voltage(e->model->solid), 1e-3 * voltage_V, why,
                    fmax(e->model->settings.refinement, 1) + 1);
  }
  if (status == DEA_E_DOMAIN) {
    return dea_fail(ctx, status, "the law ends at %.6g kV, on the way to %.6g kV: %s",
                    1e-3 * dea_solid_voltage(e->model->solid), 1e-3 * voltage_V, why);
  }
  return dea_fail(ctx, status,
                  "the solver did not converge at %.6g kV, on the way to %.6g kV (%s); please "
                  "report the design. The points before are kept",
                  1e-3 * dea_solid_voltage(e->model->solid), 1e-3 * voltage_V, why);
}

/* A membrane that thins at once has no tension in that place, where nothing but the end of its law
 * holds its natural width (docs/theory/membrane.md): that is no state of the film. */
static dea_status refuse_thin(struct dea_context *ctx, struct dea_step_outcome *e, double voltage_V,
                              const struct dea_solid_saved_state *from)
{
  char stretch[60] = ""; // of a disc
  const double area = e->area;
  e->limit = e->passed;
  e->limited = true;
  e->has_passed = false;
  dea_solid_restore_state(e->model->solid, from);
  DEA_TRY(ctx, check_tension(ctx, e));
  if (!isnan(e->limit.point.electrode_stretch)) {
    snprintf(stretch, sizeof stretch, " and an electrode stretch of %.5g",
             e->limit.point.electrode_stretch);
  }
  return dea_fail(ctx, DEA_E_NO_EQUILIBRIUM,
                  "pull-in at %.6g kV%s: beyond it the film has no tension in one place and thins "
                  "there to the end of its law (to 1/%.3g at %.6g kV)",
                  1e-3 * e->limit.point.voltage_V, stretch, area, 1e-3 * voltage_V);
}

/* To a voltage, and what else the solid is to come to. *passed: past a limit point, at e->limit. */
static dea_status approach(struct dea_context *ctx, struct dea_step_outcome *e, double voltage_V,
                           struct dea_solid_report *report, struct dea_solid_stop *stop,
                           bool *passed)
{
  const struct dea_solid_watch watch = {observe_point, observe_change, was_taut, e};
  e->from_V = dea_solid_voltage(e->model->solid);
  e->limited = e->grew = *passed = false;
  DEA_TRY(ctx, check_tension(ctx, e));
  e->from_area = e->area;
  const bool taut = is_taut(e);
  DEA_TRY_STATUS(
      dea_solid_solve_incremental(ctx, e->model->solid, voltage_V, taut, &watch, report, stop));
  *passed = e->limited && e->limit.kind != DEA_EVENT_SLACK && taut && report->snapped;
  if (*passed && !e->has_passed) {
    e->passed = e->limit;
    e->has_passed = true;
  }
  if (!e->has_passed) {
    drop_limit(e);
  }
  e->limited = false;
  return check_tension(ctx, e);
}

/* One load step. */
static dea_status step(struct dea_context *ctx, struct dea_step_outcome *e, double voltage_V,
                       struct dea_solid_report *report)
{
  struct dea_solid_stop stop;
  struct dea_solid_saved_state from;
  bool passed = false;
  dea_status status = dea_solid_save_state(ctx, e->model->solid, &from);
  status = status == DEA_OK ? approach(ctx, e, voltage_V, report, &stop, &passed) : status;
  if (dea_solid_may_shorten(status) || status == DEA_E_NO_EQUILIBRIUM) {
    status = stopped(ctx, e, voltage_V, &stop, status);
  } else if (status == DEA_OK && passed) {
    const bool thin =
        e->model->mesh.membrane && !is_taut(e) && e->area > branch_jump * fmax(e->from_area, 1);
    status = thin ? refuse_thin(ctx, e, voltage_V, &from)
                  : dea_model_report_passed(ctx, "3d", e->from_V, voltage_V, &e->limit);
  }
  dea_solid_saved_state_free(&from);
  return status;
}

dea_status dea_step_outcome_move(struct dea_context *ctx, struct dea_step_outcome *e,
                                 struct dea_solid_report *report, double *fraction)
{
  struct dea_solid_stop stop = {.load_factor = NAN};
  bool passed;
  e->has_passed = false;
  drop_limit(e);
  dea_status status = approach(ctx, e, dea_solid_voltage(e->model->solid), report, &stop, &passed);
  *fraction = passed || status == DEA_E_NO_EQUILIBRIUM ? stop.load_factor : NAN;
  return status;
}

/* Where the way to a voltage has turned unstable and the solid has gone down from it. */
static dea_status report_snap(struct dea_context *ctx, double voltage_V)
{
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                         "model 3d: the state on the way to %.4g kV is unstable (buckling or "
                         "snapping); the sweep goes on from the stable one below it",
                         1e-3 * voltage_V);
}

dea_status dea_step_outcome_go(struct dea_context *ctx, struct dea_step_outcome *e, double from_V,
                               double voltage_V, struct dea_solid_report *report)
{
  double distance_V = voltage_V - from_V, at_V = from_V;
  const double step_V = dea_step_outcome_longest_V(e);
  int steps =
      isfinite(step_V) ? dea_whole(ceil(fabs(distance_V) / step_V - 1e-9), 1, INT_MAX - 1) : 1;
  e->limited = e->has_passed = false;
  drop_limit(e);
  for (int i = 1; i <= steps; i++) {
    if (dea_interrupted_anywhere(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted on the way to %.6g kV",
                      1e-3 * voltage_V);
    }
    double next_V = i == steps ? voltage_V : from_V + distance_V * i / steps;
    DEA_TRY(ctx, step(ctx, e, next_V, report));
    at_V = next_V;
    DEA_TRY(ctx, report->snapped ? report_snap(ctx, at_V) : DEA_OK);
    DEA_TRY(ctx, dea_solid_model_arrived(ctx, e->model, at_V));
  }
  return DEA_OK;
}

// What the model does ----------------------------------------------------------------------------

void dea_solid_model_end_history(struct dea_context *ctx, struct dea_model *model)
{
  model->at.as_made = false;
  if (model->at.driven != NULL) {
    dea_circuit_step_destroy(ctx, model->at.driven);
    model->at.driven = NULL;
    model->at.voltage_V = dea_solid_voltage(model->solid);
  }
}

dea_status dea_solid_model_solve(struct dea_context *ctx, struct dea_model *model, double voltage_V,
                                 struct dea_load_point *out)
{
  if (!model->at.as_made || voltage_V != model->at.voltage_V) {
    dea_solid_model_end_history(ctx, model);
    DEA_TRY(ctx, dea_step_outcome_go(ctx, &model->at.outcome, model->at.voltage_V, voltage_V,
                                     &model->at.report));
  }
  return DEA_CHAIN(ctx, dea_solid_model_report(ctx, model, model->at.voltage_V, out));
}

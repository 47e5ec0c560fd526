#include "model/solid/equilibrium/solve_incremental.h"

#include "model/solid/assembly/controls.h"
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/equilibrium/newton.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* One search for the cause, and where it starts. */
struct search {
  struct dea_solid *s;
  double *state, *from, *goal; // state and controls at its start, controls that are wanted
  const struct dea_solid_watch *watch;
  struct dea_solid_report *report;
  struct dea_solid_stop *stop;
  struct dea_solid_saved_state start; // where the approach began
  struct dea_solid_saved_state limit; // where the path turns back, once that is known
  bool slack;                         // the film has no tension all over where it began
  bool leapt;                         // a load step has gone past a limit point to another state
  bool snapped;                       // the solid has, on the way, to one that is not close by
  bool went_on;                       // the solid is at a stable equilibrium further on
  bool looks;     // it is known where the solid goes, and only asked what is on the way
  bool bent;      // it looks from a flat film to one that is no more
  bool left;      // its path has led out of the plane of a flat film, so that load steps may
  bool stuck;     // the path could not be followed to its end; where it looks the solid stays there
  double reached; // share of the way of the last point of the path
};

/* The sink looks at where the solid is. */
static dea_status see(struct dea_context *ctx, const struct search *a,
                      enum dea_solid_stop_kind where)
{
  return a->watch != NULL ? a->watch->points(ctx, a->watch->user, where) : DEA_OK;
}

/* Whether a film without tension has grown at once to where the solid is: nothing but the end of
 * its law holds it there, so that it is no state (docs/theory/membrane.md). steps: what brought it
 * there, which may have failed further on; returned if this look does not fail. */
static dea_status see_growth(struct dea_context *ctx, const struct search *a, dea_status steps,
                             bool *grew)
{
  *grew = false;
  if (!a->slack || a->watch == NULL || (steps != DEA_OK && !dea_solid_may_shorten(steps))) {
    return steps;
  }
  DEA_TRY(ctx, a->watch->grew(ctx, a->watch->user, grew));
  return steps;
}

// Flat films -------------------------------------------------------------------------------------

/* Sums of a component of displacements over the nodes of each column, in which what thins moves by
 * as much up as down: [*count], lent until the next call. */
static const double *sum_columns(struct dea_solid *s, const double *u, int component, size_t *count)
{
  const struct dea_grid *grid = s->problem.grid;
  double *sum = s->work.trial;
  *count = dea_grid_columns(grid);
  memset(sum, 0, *count * sizeof *sum);
  for (size_t n = 0; n < grid->node_count; n++) {
    if (grid->column[n] >= 0) { // -1: of a body
      sum[grid->column[n]] += u[3 * n + (size_t)component];
    }
  }
  return sum;
}

/* Largest height of a column's middle over where it is undeformed, by its nodes. */
static double deflection_m(struct dea_solid *s, const double *u)
{
  size_t count;
  const double *heights = sum_columns(s, u, 2, &count);
  double largest = 0;
  for (size_t c = 0; c < count; c++) {
    largest = fmax(largest, fabs(heights[c]));
  }
  return largest;
}

static bool is_flat(struct dea_solid *s, const double *u, double size_m)
{
  static const double flat = 1e-6;
  return deflection_m(s, u) < flat * size_m;
}

/* Heights above which a film is not flat any more. Below, they may be what rounding becomes where K
 * is nearly singular. */
static bool is_deflected(struct dea_solid *s, double size_m)
{
  static const double deflected = 1e-3;
  return deflection_m(s, s->state.u) > deflected * size_m;
}

bool dea_solid_left_plane(struct dea_solid *s, const struct dea_solid_saved_state *from,
                          double size_m)
{
  const bool pushed =
      // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a stand that was kept has its controls
      from->controls[0] == 0 &&
      !(s->found.extrapolated && is_flat(s, s->work.extrapolated, size_m));
  return !pushed && is_flat(s, from->state, size_m) && is_deflected(s, size_m);
}

// The path ----------------------------------------------------------------------------------------

/* Root of the mean square of the nodes' displacements there. */
static double size_m(const struct dea_solid *s, const struct dea_solid_saved_state *at)
{
  size_t count = 3 * s->problem.grid->node_count;
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    sum += at->state[i] * at->state[i];
  }
  return sqrt(3 * sum / (double)count);
}

/* Displacement that counts as much as the whole load: a share of that on the way, as far as the
 * displacements that are there tell, which go with the square of the voltage. */
static double unit_of(const struct dea_solid *s, const double *from, const double *goal)
{
  double sum = 0, before = from[0] * from[0], way = fabs(goal[0] * goal[0] - before);
  size_t count = 3 * s->problem.grid->node_count;
  for (size_t i = 0; i < count; i++) {
    sum += s->state.u[i] * s->state.u[i];
  }
  double grown = sqrt(sum / (double)count) * (way < before ? way / before : 1);
  return s->settings.approach_unit * fmax(grown, s->settings.approach_unit * s->problem.length_m);
}

/* The limit point or bifurcation that the last step has passed, or where it cannot be closed in on
 * that step. */
static dea_status take_stop(struct dea_context *ctx, const struct search *a,
                            enum dea_solid_stop_kind kind, struct dea_solid_continuation *path,
                            struct dea_continuation_point *at)
{
  a->stop->kind = kind;
  a->stop->unstable_modes = at->unstable_modes;
  dea_status status = dea_solid_continuation_locate(ctx, path, at);
  const bool located = status == DEA_OK;
  if (dea_solid_may_shorten(status) || status == DEA_E_ARGUMENT) {
    dea_context_clear(ctx);
    status = DEA_OK;
  }
  DEA_TRY(ctx, status);
  a->stop->voltage_V = at->voltage_V;
  a->stop->way = at->load;
  dea_solid_state_get(a->s, a->limit.state);
  dea_solid_controls_get(a->s, a->limit.controls);
  DEA_TRY(ctx, see(ctx, a, kind == DEA_STOP_LIMIT && !located ? DEA_STOP_NEAR : kind));
  return DEA_OK;
}

/* From a point beyond the goal to the equilibrium at it, from an unstable one down. */
static dea_status leave_path(struct dea_context *ctx, struct search *a,
                             const struct dea_continuation_point *at)
{
  struct dea_solid *s = a->s;
  struct dea_solid_report report = {0};
  if (at->load >= 1) {
    dea_solid_controls_set(s, a->goal);
  }
  dea_solid_forget(s);
  bool grew;
  dea_status status = see_growth(ctx, a, dea_solid_descend_unstable(ctx, s, 0, &report), &grew);
  if (status == DEA_OK && report.unstable_modes == 0 && !grew) {
    *a->report = report;
    a->went_on = true;
    return DEA_OK;
  }
  return status == DEA_OK ? dea_fail(ctx, DEA_E_NOT_CONVERGED, "it stays unstable") : status;
}

/* Whether a mode [dofs] leads out of the plane. */
static bool leaves_plane(struct dea_solid *s, const double *mode)
{
  double along = 0, across = 0;
  for (int k = 0; k < 3; k++) {
    size_t count;
    const double *sum = sum_columns(s, mode, k, &count);
    for (size_t c = 0; c < count; c++) {
      *(k < 2 ? &along : &across) += sum[c] * sum[c];
    }
  }
  return across > along;
}

/* A flat film in tension all over is held in its plane by it. Where the last step has made a mode
 * unstable in which it leaves the plane, that is one of the mesh, as are all that there are then,
 * and the path goes on (docs/theory/stops.md). *of_mesh: so many. */
static dea_status look_at_modes(struct dea_context *ctx, const struct search *a, int unstable,
                                int *of_mesh)
{
  struct dea_solid *s = a->s;
  double value;
  if (unstable <= *of_mesh || a->watch == NULL || !a->watch->taut(a->watch->user) ||
      is_deflected(s, s->problem.length_m)) {
    *of_mesh = unstable < *of_mesh ? unstable : *of_mesh;
    return DEA_OK;
  }
  double *mode = dea_solid_alloc(ctx, s->problem.dofs, sizeof *mode);
  if (mode == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = dea_solid_unstable_mode(ctx, s, &value, mode);
  if (status == DEA_OK && leaves_plane(s, mode)) {
    *of_mesh = unstable;
  }
  if (dea_solid_may_shorten(status)) {
    dea_context_clear(ctx);
    status = DEA_OK;
  }
  dea_free(ctx, mode);
  return status;
}

/* The flat film's path has come to the goal: the state there is its own, with the mesh's modes. */
static dea_status stay_flat(struct dea_context *ctx, struct search *a,
                            struct dea_solid_continuation *path)
{
  struct dea_solid *s = a->s;
  struct dea_continuation_point at;
  DEA_TRY(ctx, dea_solid_continuation_at(ctx, path, 1, &at));
  dea_solid_controls_set(s, a->goal); // what rounding leaves of it
  a->went_on = !is_deflected(s, s->problem.length_m);
  a->report->unstable_modes = at.unstable_modes;
  a->report->energy_J = at.energy_J;
  a->report->snapped = false;
  return DEA_OK;
}

/* From a limit point beyond the goal, which turns back behind it, to the goal. */
static dea_status return_to_goal(struct dea_context *ctx, struct search *a)
{
  *a->stop = (struct dea_solid_stop){.kind = DEA_STOP_UNKNOWN};
  dea_solid_restore_state(a->s, &a->limit);
  DEA_TRY(ctx, dea_load_steps_solve_to(ctx, a->s, a->goal, a->report));
  a->went_on = a->report->unstable_modes == 0;
  return see(ctx, a, DEA_STOP_PASSED);
}

/* Along the path until something has happened. */
static dea_status follow(struct dea_context *ctx, struct search *a,
                         struct dea_solid_continuation *path)
{
  static const double bent = 0.75; // slope over the first one, towards a limit point
  struct dea_continuation_point at = {0};
  const int points = a->s->settings.approach_points;
  double first = 0;
  int of_mesh = 0; // unstable modes that are no modes of the film
  for (int i = 0; i < (at.slope < bent * first ? 2 : 1) * points; i++) {
    DEA_TRY(ctx, dea_solid_continuation_step(ctx, path, &at));
    a->reached = at.load;
    first = i == 0 ? at.slope : first;
    if (at.passed == DEA_CONTINUATION_LIMIT) {
      DEA_TRY(ctx, take_stop(ctx, a, DEA_STOP_LIMIT, path, &at));
      return a->looks || a->stop->way < 1 ? DEA_OK : return_to_goal(ctx, a);
    }
    bool grew;
    DEA_TRY(ctx, see_growth(ctx, a, DEA_OK, &grew));
    DEA_TRY(ctx, grew ? dea_fail(ctx, DEA_E_NOT_CONVERGED, "the path thins at once") : DEA_OK);
    DEA_TRY(ctx, see(ctx, a, DEA_STOP_UNKNOWN));
    DEA_TRY(ctx, look_at_modes(ctx, a, at.unstable_modes, &of_mesh));
    const bool unstable = at.unstable_modes > of_mesh;
    if (a->looks && unstable) {
      DEA_TRY(ctx, take_stop(ctx, a, DEA_STOP_UNSTABLE, path, &at));
      return DEA_OK;
    }
    if (a->looks && at.load >= 1) {
      return a->bent ? stay_flat(ctx, a, path) : DEA_OK;
    }
    if (at.load >= 1 || unstable) {
      dea_status status = leave_path(ctx, a, &at);
      if (!dea_solid_may_shorten(status) || at.unstable_modes == 0) {
        return status;
      }
      dea_context_clear(ctx);
      DEA_TRY(ctx, take_stop(ctx, a, DEA_STOP_UNSTABLE, path, &at));
      return DEA_OK;
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the path is long");
}

/* From the equilibrium that the solid is at towards the goal by arc length. The solid is then
 * further on (a->went_on), or where it was. Fails only where no shorter step would help. */
static dea_status search_path(struct dea_context *ctx, struct search *a)
{
  const struct dea_solid_settings *o = &a->s->settings;
  struct dea_continuation_options options = {o->approach_step, o->approach_step_most, 0, true};
  struct dea_solid_continuation *path = NULL;
  dea_solid_state_get(a->s, a->state);
  dea_solid_controls_get(a->s, a->from);
  options.unit_m = unit_of(a->s, a->from, a->goal);
  a->went_on = a->stuck = false;
  a->reached = 0;
  *a->stop = (struct dea_solid_stop){.kind = DEA_STOP_UNKNOWN};
  dea_status status = dea_continuation_create_to(ctx, a->s, a->goal, &options, &path);
  if (status == DEA_OK) {
    status = follow(ctx, a, path);
  }
  dea_solid_continuation_destroy(ctx, path);
  a->stuck = dea_solid_may_shorten(status);
  if (!a->went_on && !(a->looks && a->stuck)) {
    dea_solid_state_set(a->s, a->state);
    dea_solid_controls_set(a->s, a->from);
    dea_solid_forget(a->s);
  }
  if (dea_solid_may_shorten(status)) {
    dea_context_clear(ctx);
    status = DEA_OK;
  }
  return status;
}

/* The first linear step on the way to that voltage is kept, for dea_solid_left_branch. */
static void predict_tangent(struct dea_solid *s, double voltage_V)
{
  s->found.predicts_tangent = true;
  s->found.extrapolated = false;
  s->found.extrapolated_V = voltage_V;
}

/* With a coupled field a taut film is solved in a few iterations, or leaps. */
static void take_fewer_iterations(struct dea_solid_settings *o)
{
  o->iterations = o->coupled_iterations < o->iterations ? o->coupled_iterations : o->iterations;
  o->iterations_free = o->iterations < o->iterations_free ? o->iterations : o->iterations_free;
}

/* A slack film has a long way down. */
static void take_more_iterations(struct dea_solid_settings *o)
{
  o->iterations = o->slack_iterations;
  o->iterations_free = o->slack_iterations_free;
}

/* Load steps, few and long ones. */
static dea_status try_steps(struct dea_context *ctx, struct search *a, double voltage_V, bool taut)
{
  struct dea_solid_settings *o = &a->s->settings;
  const struct dea_solid_settings own = *o;
  if (!taut) {
    take_more_iterations(o);
  } else if (a->s->problem.field != NULL) {
    take_fewer_iterations(o);
  }
  dea_status status =
      dea_load_steps_solve_within(ctx, a->s, voltage_V, o->approach_part, a->report);
  *o = own;
  return status;
}

static bool has_left(const struct search *a)
{
  return dea_solid_left_plane(a->s, &a->start, a->s->problem.length_m);
}

/* Load steps that have failed may have leapt on the way, or have left the plane of a flat film,
 * which its tension holds there as long as the path has any and stays in it. */
static void step_back(struct search *a, bool taut, bool grew)
{
  const bool left_branch = grew || (!a->report->snapped && dea_solid_left_branch(a->s, &a->start));
  if (grew || (taut && (left_branch || (!a->left && has_left(a))))) {
    dea_solid_restore_state(a->s, &a->start);
    a->leapt |= left_branch;
  }
}

/* Controls a share of the way: the square of the voltage, and all others, in proportion. */
static void set_between(const struct dea_solid *s, const double *from, const double *goal,
                        double share, double *out)
{
  for (size_t i = 1; i < s->work.load_steps.control_count; i++) {
    out[i] = from[i] + share * (goal[i] - from[i]);
  }
  out[0] = sqrt((1 - share) * from[0] * from[0] + share * goal[0] * goal[0]);
}

static dea_status end_at_limit(struct dea_context *ctx, const struct search *a)
{
  return dea_fail(ctx, DEA_E_NO_EQUILIBRIUM, "a limit point at %.6g kV", 1e-3 * a->stop->voltage_V);
}

/* Down in energy from the limit point that was found to a stable state a little beyond it. *beyond:
 * there is one, to which the film has not grown at once, and the solid is there; otherwise it is
 * where the search began. One that is close by is where a spot of the mesh has turned over. */
static dea_status pass_limit(struct dea_context *ctx, struct search *a, bool taut, bool *beyond)
{
  struct dea_solid *s = a->s;
  struct dea_solid_saved_state limit;
  struct dea_solid_report report = {0};
  bool grew = true, close = false;
  dea_solid_restore_state(s, &a->limit);
  DEA_TRY(ctx, dea_solid_save_state(ctx, s, &limit));
  set_between(s, a->from, a->goal, fmin(a->stop->way + s->settings.load_step_least, 1),
              a->limit.controls);
  const struct dea_solid_settings own = s->settings;
  if (!taut) {
    take_more_iterations(&s->settings);
  }
  dea_status status = dea_load_steps_solve_to(ctx, s, a->limit.controls, &report);
  s->settings = own;
  if (status == DEA_OK && report.unstable_modes == 0) {
    grew = false;
    status = a->watch != NULL ? a->watch->grew(ctx, a->watch->user, &grew) : DEA_OK;
    close = dea_solid_moved_m(s, &limit) < s->settings.limit_close * size_m(s, &limit);
  }
  memcpy(a->limit.controls, limit.controls,
         s->work.load_steps.control_count * sizeof *limit.controls);
  dea_solid_saved_state_free(&limit);
  *beyond = status == DEA_OK && !grew;
  if (*beyond) {
    a->snapped |= !close || !taut;
    s->found.extrapolated = false;
    *a->stop = (struct dea_solid_stop){.kind = DEA_STOP_UNKNOWN};
    return close ? see(ctx, a, DEA_STOP_PASSED) : DEA_OK;
  }
  dea_solid_state_set(s, a->state);
  dea_solid_controls_set(s, a->from);
  dea_solid_forget(s);
  if (dea_solid_may_shorten(status)) {
    dea_context_clear(ctx);
    status = DEA_OK;
  }
  return status;
}

// Closing in on where load steps end, of a path that cannot be followed ---------------------------

/* One load step to a share of the way from a->from; *there: it has found a stable state and leapt
 * past no other, and *last then is there too. */
static dea_status step_near(struct dea_context *ctx, struct search *a, double share,
                            struct dea_solid_saved_state *last, bool *there)
{
  struct dea_solid *s = a->s;
  struct dea_solid_report report = {0};
  set_between(s, a->from, a->goal, share, a->limit.controls);
  predict_tangent(s, a->limit.controls[0]);
  dea_status status = dea_load_steps_solve_to(ctx, s, a->limit.controls, &report);
  bool branch_jumps =
      status == DEA_OK && !a->slack && !report.snapped && dea_solid_left_branch(s, last);
  if (status == DEA_OK && a->slack) {
    status = see_growth(ctx, a, DEA_OK, &branch_jumps);
  }
  *there = status == DEA_OK && report.unstable_modes == 0 && !branch_jumps;
  a->leapt |= branch_jumps;
  if (!*there) {
    dea_solid_restore_state(s, last);
    if (dea_solid_may_shorten(status)) {
      dea_context_clear(ctx);
      status = DEA_OK;
    }
    return status;
  }
  report.snapped |= a->report->snapped;
  *a->report = report;
  dea_solid_state_get(s, last->state);
  dea_solid_controls_get(s, last->controls);
  return see(ctx, a, DEA_STOP_UNKNOWN);
}

/* From the last equilibrium that load steps have found on, in halves of what is left, until the
 * state on one side and the failure on the other are `leap_way` apart; then by the path, which
 * alone tells a limit point, or to the goal, where nothing has failed. *there: it is reached. */
static dea_status close_in(struct dea_context *ctx, struct search *a,
                           struct dea_solid_saved_state *last, bool *there)
{
  double low = 0, high = 1;
  *there = false;
  while (high - low > a->s->settings.branch_jump_way * (low > 0 ? high : 1)) {
    bool found;
    DEA_TRY(ctx, dea_solid_heed_interruption(ctx));
    double next = 0.5 * (low + high);
    DEA_TRY(ctx, step_near(ctx, a, next, last, &found));
    low = found ? next : low;
    high = found ? high : next;
  }
  if (high == 1) {
    return step_near(ctx, a, 1, last, there);
  }
  if (a->leapt) { // beyond it is another state, and no way to there
    *a->stop = (struct dea_solid_stop){DEA_STOP_LIMIT, dea_solid_voltage(a->s), low, 0};
    return see(ctx, a, DEA_STOP_NEAR);
  }
  return search_path(ctx, a);
}

/* All that load steps can, where the path says nothing. *on: the path goes on from where they have
 * closed in on what they do not get past. */
static dea_status end_by_steps(struct dea_context *ctx, struct search *a, double voltage_V,
                               bool taut, bool *on)
{
  struct dea_solid *s = a->s;
  char why[160];
  bool there = false;
  bool grew;
  dea_status status =
      dea_load_steps_solve_within(ctx, s, voltage_V, s->settings.approach_part_least, a->report);
  if (status == DEA_E_DOMAIN) { // no path leads there: closer to where the law ends
    dea_context_clear(ctx);
    status = dea_load_steps_solve(ctx, s, voltage_V, a->report);
  }
  status = see_growth(ctx, a, status, &grew);
  *on = false;
  if (!grew && (status != DEA_E_NOT_CONVERGED || !taut)) {
    return status;
  }
  snprintf(why, sizeof why, "%s", grew ? "it thins at once" : dea_context_message(ctx));
  status = DEA_E_NOT_CONVERGED;
  dea_context_clear(ctx);
  step_back(a, taut, grew);
  struct dea_solid_saved_state last;
  dea_status closed = dea_solid_save_state(ctx, s, &last);
  dea_solid_controls_get(s, a->from);
  dea_solid_controls_goal(s, voltage_V, a->goal);
  if (closed == DEA_OK) {
    closed = close_in(ctx, a, &last, &there);
  }
  s->found.extrapolated = false; // each of its steps has been looked at
  dea_solid_saved_state_free(&last);
  DEA_TRY(ctx, closed);
  *on = !there && (a->went_on || a->stop->kind == DEA_STOP_LIMIT);
  return there || *on ? DEA_OK : dea_fail(ctx, status, "%s", why);
}

/* Long load steps and the path in turn; where the path says nothing, all that load steps can. */
static dea_status go(struct dea_context *ctx, struct search *a, double voltage_V, bool taut)
{
  for (int i = 0; i < a->s->settings.approach_rounds; i++) {
    bool on;
    bool grew;
    dea_status status = see_growth(ctx, a, try_steps(ctx, a, voltage_V, taut), &grew);
    if (!grew && !dea_solid_may_shorten(status)) {
      return status;
    }
    dea_context_clear(ctx);
    step_back(a, taut, grew);
    dea_solid_controls_goal(a->s, voltage_V, a->goal);
    DEA_TRY(ctx, search_path(ctx, a));
    a->left |= a->went_on && has_left(a);
    a->s->found.extrapolated = a->s->found.extrapolated && !a->went_on; // it has been followed
    if (!a->went_on && a->stop->kind != DEA_STOP_LIMIT) {
      status = end_by_steps(ctx, a, voltage_V, taut, &on);
      if (status != DEA_OK || !on) {
        return status;
      }
    }
    if (a->stop->kind == DEA_STOP_LIMIT) {
      DEA_TRY(ctx, pass_limit(ctx, a, taut, &on));
      DEA_TRY(ctx, on ? DEA_OK : end_at_limit(ctx, a));
    }
  }
  bool on;
  DEA_TRY(ctx, end_by_steps(ctx, a, voltage_V, taut, &on));
  return on ? dea_fail(ctx, DEA_E_NOT_CONVERGED, "the path to there has too many turns") : DEA_OK;
}

/* Share of the way from some controls to others that the controls `at` are at: all go in
 * proportion, of the voltage its square. */
static double share_of(const struct dea_solid *s, const double *from, const double *goal,
                       const double *at)
{
  double most = fabs(goal[0] * goal[0] - from[0] * from[0]);
  double share =
      most > 0 ? (at[0] * at[0] - from[0] * from[0]) / (goal[0] * goal[0] - from[0] * from[0]) : 0;
  for (size_t i = 1; i < s->work.load_steps.control_count && !(most > 0); i++) {
    share = goal[i] != from[i] ? (at[i] - from[i]) / (goal[i] - from[i]) : share;
    most = fabs(goal[i] - from[i]);
  }
  return share;
}

dea_status dea_solid_solve_incremental(struct dea_context *ctx, struct dea_solid *s,
                                       double voltage_V, bool taut,
                                       const struct dea_solid_watch *watch,
                                       struct dea_solid_report *report, struct dea_solid_stop *stop)
{
  struct search a = {.s = s, .watch = watch, .report = report, .stop = stop, .slack = !taut};
  struct dea_arena memory = {.ctx = ctx};
  *stop = (struct dea_solid_stop){.kind = DEA_STOP_UNKNOWN};
  DEA_TRY(ctx, dea_solid_agree(ctx, dea_load_steps_prepare(ctx, s)));
  a.state = dea_arena_alloc(&memory, s->work.load_steps.state_count, sizeof *a.state);
  a.from = dea_arena_alloc(&memory, s->work.load_steps.control_count, sizeof *a.from);
  a.goal = dea_arena_alloc(&memory, s->work.load_steps.control_count, sizeof *a.goal);
  dea_status status = dea_solid_agree(ctx, memory.failed ? DEA_E_MEMORY : DEA_OK);
  if (status == DEA_OK) {
    status = dea_solid_save_state(ctx, s, &a.limit);
  }
  if (status == DEA_OK) {
    status = dea_solid_save_state(ctx, s, &a.start);
  }
  if (status == DEA_OK) {
    const int lost = s->settings.lost;
    s->settings.lost = s->settings.approach_lost;
    predict_tangent(s, voltage_V);
    status = go(ctx, &a, voltage_V, taut);
    report->snapped |= a.snapped;
    if (stop->kind == DEA_STOP_LIMIT) {
      stop->way = share_of(s, a.start.controls, a.goal, a.limit.controls);
    }
    s->settings.lost = lost;
  }
  dea_solid_saved_state_free(&a.limit);
  dea_solid_saved_state_free(&a.start);
  dea_arena_free(&memory);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

dea_status dea_solid_reach(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                           struct dea_solid_report *report)
{
  struct dea_solid_saved_state from;
  struct dea_solid_stop stop;
  char why[160];
  const dea_status failed = dea_load_steps_solve(ctx, s, voltage_V, report);
  const double way = report->way;
  if (!dea_solid_may_shorten(failed)) {
    return failed;
  }
  snprintf(why, sizeof why, "%s", dea_context_message(ctx));
  dea_context_clear(ctx);
  DEA_TRY(ctx, dea_solid_save_state(ctx, s, &from));
  dea_status status = dea_solid_solve_incremental(ctx, s, voltage_V, true, NULL, report, &stop);
  report->way = status == DEA_OK ? 1 : way;
  if (status == DEA_E_NO_EQUILIBRIUM) { // it is the limit point's
    dea_solid_restore_state(s, &from);
    report->limit = way + stop.way * (1 - way);
  } else if (dea_solid_may_shorten(status)) {
    dea_solid_restore_state(s, &from);
    dea_context_clear(ctx);
    status = dea_fail(ctx, failed, "%s", why);
  }
  dea_solid_saved_state_free(&from);
  return status;
}

// What load steps have gone past ------------------------------------------------------------------

dea_status dea_solid_save_state(struct dea_context *ctx, struct dea_solid *s,
                                struct dea_solid_saved_state *out)
{
  *out = (struct dea_solid_saved_state){.memory = {.ctx = ctx}};
  DEA_TRY(ctx, dea_solid_agree(ctx, dea_load_steps_prepare(ctx, s)));
  const struct dea_load_steps *steps = &s->work.load_steps;
  out->state = dea_arena_alloc(&out->memory, steps->state_count, sizeof *out->state);
  out->controls = dea_arena_alloc(&out->memory, steps->control_count, sizeof *out->controls);
  DEA_TRY(ctx, dea_solid_agree(ctx, dea_arena_status(&out->memory)));
  dea_solid_state_get(s, out->state);
  dea_solid_controls_get(s, out->controls);
  return DEA_OK;
}

void dea_solid_saved_state_free(struct dea_solid_saved_state *stand)
{
  dea_arena_free(&stand->memory);
}

double dea_solid_moved_m(const struct dea_solid *s, const struct dea_solid_saved_state *from)
{
  size_t count = 3 * s->problem.grid->node_count;
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    double way = s->state.u[i] - from->state[i];
    sum += way * way;
  }
  return sqrt(3 * sum / (double)count);
}

bool dea_solid_left_branch(const struct dea_solid *s, const struct dea_solid_saved_state *from)
{
  double V = dea_solid_voltage(s), from_V = from->controls[0], goal_V = s->found.extrapolated_V;
  double share = (V * V - from_V * from_V) / (goal_V * goal_V - from_V * from_V);
  double off = 0, way = 0;
  for (size_t i = 0; i < 3 * s->problem.grid->node_count && s->found.extrapolated; i++) {
    double step = share * s->work.extrapolated[i], beyond = s->state.u[i] - from->state[i] - step;
    off += beyond * beyond;
    way += step * step;
  }
  return off > way * s->settings.left_branch * s->settings.left_branch;
}

void dea_solid_restore_state(struct dea_solid *s, const struct dea_solid_saved_state *at)
{
  dea_solid_state_set(s, at->state);
  dea_solid_controls_set(s, at->controls);
  dea_solid_forget(s);
}

/* The solid on its side of a leap: near, which it leaps from, and far, where it leaps to. */
struct branch_jump_ends {
  struct dea_solid_saved_state near, far;
  double at[2]; // shares of the way
  double whole; // motion between them at first
  bool apart;   // the far one has no state, or the film has grown at once to it
};

/* The state that a step has come to takes the place of the end that it belongs to. */
static dea_status take_end(struct dea_context *ctx, const struct search *a, const double *controls,
                           struct branch_jump_ends *ends, bool *stays)
{
  struct dea_solid *s = a->s;
  bool grown = false;
  DEA_TRY(ctx, a->watch->grew(ctx, a->watch->user, &grown));
  *stays = !grown && dea_solid_moved_m(s, &ends->near) < dea_solid_moved_m(s, &ends->far);
  struct dea_solid_saved_state *end = *stays ? &ends->near : &ends->far;
  dea_solid_state_get(s, end->state);
  memcpy(end->controls, controls, s->work.load_steps.control_count * sizeof *controls);
  ends->apart = *stays ? ends->apart : grown;
  return *stays ? see(ctx, a, DEA_STOP_UNKNOWN) : DEA_OK;
}

/* Between both ends a share of the way; the solid is then at the near one. */
static dea_status halve_branch_jump(struct dea_context *ctx, const struct search *a,
                                    const double *from, double share, struct branch_jump_ends *ends)
{
  struct dea_solid_report report;
  bool stays = false;
  set_between(a->s, from, a->goal, share, a->from);
  dea_status status = dea_load_steps_solve_to(ctx, a->s, a->from, &report);
  if (dea_solid_may_shorten(status)) {
    dea_context_clear(ctx);
    ends->apart = true;
  } else {
    DEA_TRY(ctx, status);
    DEA_TRY(ctx, take_end(ctx, a, a->from, ends, &stays));
  }
  ends->at[stays ? 0 : 1] = share;
  if (!stays) {
    dea_solid_restore_state(a->s, &ends->near);
  }
  return DEA_OK;
}

/* Steps that grow from where the path ends, then halves. */
static dea_status bracket_branch_jump(struct dea_context *ctx, const struct search *a,
                                      const double *from, struct branch_jump_ends *ends)
{
  const double least = a->s->settings.branch_jump_way;
  double first = ends->at[0], by = first > 0 ? least : 0.5;
  while (ends->at[1] - ends->at[0] > 1.01 * least) {
    double low = ends->at[0], high = ends->at[1], next = low + by;
    DEA_TRY(ctx, dea_solid_heed_interruption(ctx));
    DEA_TRY(ctx, halve_branch_jump(ctx, a, from, next < high ? next : 0.5 * (low + high), ends));
    by = ends->at[1] < 1 ? 0.5 * (ends->at[1] - ends->at[0]) : 4 * by;
  }
  return DEA_OK;
}

/* Where the path says nothing of a leap - a membrane that goes slack has a corner, which arc length
 * does not get around, and a long step of it leaps itself - load steps do: the states on both sides
 * of a limit point stay apart however close their voltages come. The solid is then at the nearer
 * one. From the last point of the path; from, to: the ends of the way. */
static dea_status find_branch_jump(struct dea_context *ctx, struct search *a, const double *from,
                                   const struct dea_solid_saved_state *to)
{
  struct dea_solid *s = a->s;
  struct branch_jump_ends ends = {.at = {a->stuck ? a->reached : 0, 1}};
  dea_status status = dea_solid_save_state(ctx, s, &ends.near);
  if (status == DEA_OK) {
    dea_solid_restore_state(s, to);
    status = dea_solid_save_state(ctx, s, &ends.far);
    dea_solid_restore_state(s, &ends.near);
  }
  if (status == DEA_OK) {
    ends.whole = dea_solid_moved_m(s, &ends.far);
    status = see(ctx, a, DEA_STOP_UNKNOWN);
  }
  if (status == DEA_OK) {
    status = bracket_branch_jump(ctx, a, from, &ends);
  }
  bool branch_jumps =
      status == DEA_OK &&
      (ends.apart || dea_solid_moved_m(s, &ends.far) > s->settings.branch_jump_jump * ends.whole);
  if (branch_jumps) {
    *a->stop = (struct dea_solid_stop){DEA_STOP_LIMIT, dea_solid_voltage(s), ends.at[0], 0};
    status = see(ctx, a, DEA_STOP_NEAR);
  }
  dea_solid_saved_state_free(&ends.near);
  dea_solid_saved_state_free(&ends.far);
  return status;
}

/* At `from` with room for a search. */
static dea_status search_back(struct dea_context *ctx, struct search *a, bool leapt,
                              const struct dea_solid_saved_state *from,
                              const struct dea_solid_saved_state *now)
{
  struct dea_solid_saved_state capacity;
  dea_status status = dea_solid_save_state(ctx, a->s, &capacity);
  a->state = capacity.state;
  a->from = capacity.controls;
  a->goal = now->controls;
  if (status == DEA_OK) {
    status = dea_solid_save_state(ctx, a->s, &a->limit);
  }
  if (status == DEA_OK) {
    dea_solid_restore_state(a->s, from);
    status = search_path(ctx, a);
  }
  if (status == DEA_OK && a->stop->kind == DEA_STOP_UNKNOWN && !a->went_on && (a->stuck || leapt)) {
    status = find_branch_jump(ctx, a, from->controls, now);
  }
  dea_solid_saved_state_free(&a->limit);
  dea_solid_saved_state_free(&capacity);
  return status;
}

dea_status dea_solid_detect_missed_limit_point(struct dea_context *ctx, struct dea_solid *s,
                                               const struct dea_solid_saved_state *from, bool leapt,
                                               const struct dea_solid_watch *watch,
                                               struct dea_solid_report *report,
                                               struct dea_solid_stop *stop, bool *flat)
{
  struct search a = {.s = s, .watch = watch, .report = report, .stop = stop, .looks = true};
  struct dea_solid_saved_state now;
  *stop = (struct dea_solid_stop){.kind = DEA_STOP_UNKNOWN};
  dea_status status = dea_solid_save_state(ctx, s, &now);
  *flat = false;
  if (status == DEA_OK) {
    a.bent = dea_solid_left_plane(s, from, s->problem.length_m);
    status = search_back(ctx, &a, leapt, from, &now);
    *flat = status == DEA_OK && a.went_on;
    if (!*flat) {
      dea_solid_restore_state(s, &now);
    }
  }
  dea_solid_saved_state_free(&now);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

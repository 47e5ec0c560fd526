#include "model/solid/equilibrium/solve_incremental.h"

#include "model/solid/assembly/controls.h"
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/equilibrium/newton.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_DIVERGENT = 12 };          // a shorter step or the path costs less than the rest of them
static const double path_share = 0.5; // of the increment: a shorter step costs more than the path
static const double slack_share = 0.25;  // of the increment: steps of a slack film take long
enum { MAX_ROUNDS = 12 };                // of load steps and path in turn
enum { COUPLED_ITERATIONS = 15 };        // a taut film with a coupled field takes few, or jumps
static const double path_unit = 0.1;     // of the displacement: counts as much as the increment
static const double path_step = 0.5;     // of the increment: first step on the path
static const double max_path_step = 4;   // of the increment
static const double spot_share = 0.1;    // of the displacement: less moves a spot of the mesh alone
static const double max_off_tangent = 1; // of the tangent step: farther off lies another branch

/* To controls that are wanted. */
struct search {
  struct dea_arena memory; // of the controls
  struct dea_solid *s;
  const struct dea_solid_watch *watch;
  struct dea_solid_report *report;
  struct dea_solid_stop *stop;
  double *begin, *goal;               // [control_count] of the first equilibrium; wanted
  double *at, *bad, *next;            // [control_count] of a load step; where one failed; work
  struct dea_solid_saved_state start; // the equilibrium that load steps or the path begin at
  struct dea_solid_saved_state limit; // where the path turns back or turns unstable
  bool taut;                          // the film has tension all over where it began
  bool snapped;          // the solid has, in this increment, to a state that is not close by
  bool jumped;           // a load step has, past a limit point
  bool went_on, arrived; // the path leads to a stable equilibrium; that is the goal's
  bool left;             // it may lead out of the plane of a flat film
};

/* Where the solid is. */
static void keep_state(const struct search *a, const struct dea_solid_saved_state *out)
{
  dea_solid_state_get(a->s, out->state);
  dea_solid_controls_get(a->s, out->controls);
}

/* The sink looks at where the solid is. */
static dea_status report_point(struct dea_context *ctx, const struct search *a,
                               enum dea_solid_stop_kind where)
{
  return a->watch->points(ctx, a->watch->user, where);
}

/* How the film has changed from the last point that the sink has looked at to where the solid is. A
 * slack one that has grown at once is in no state: nothing but the end of its law holds it there
 * (docs/theory/membrane.md). A taut one may have gone past a limit point. */
static dea_status find_change(struct dea_context *ctx, const struct search *a,
                              struct dea_solid_change *out)
{
  *out = (struct dea_solid_change){.taut = true};
  return a->watch->change(ctx, a->watch->user, out);
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
  return dea_largest(count, heights);
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

/* Whether a film that was flat at the start, and that the voltage does not push across, is no more.
 * It does not push where the film was flat under one, or where the first linear step from 0 V
 * leaves it flat. */
static bool left_plane(const struct search *a)
{
  struct dea_solid *s = a->s;
  const double size_m = s->problem.length_m;
  const bool pushed =
      // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a state that was saved has its
      // controls
      a->start.controls[0] == 0 &&
      !(s->found.extrapolated && is_flat(s, s->work.extrapolated, size_m));
  return !pushed && is_flat(s, a->start.state, size_m) && is_deflected(s, size_m);
}

/* Keeps that the path has led there. */
static void note_left_plane(struct search *a)
{
  if (left_plane(a)) {
    a->left = a->snapped = true;
  }
}

// The path ----------------------------------------------------------------------------------------

/* Root of the mean square of the nodes' displacements from others; NULL: from 0. */
static double moved_m(const struct dea_solid *s, const double *u, const double *from)
{
  size_t count = 3 * s->problem.grid->node_count;
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    const double by = from != NULL ? u[i] - from[i] : u[i];
    sum += by * by;
  }
  return sqrt(3 * sum / (double)count);
}

/* Displacement that counts as much as the whole load: a fraction of that in this increment, as far
 * as the displacements that are there tell, which go with the square of the voltage. */
static double unit_of(const struct dea_solid *s, const double *from, const double *goal)
{
  double before = from[0] * from[0], length = fabs(goal[0] * goal[0] - before);
  double grown = moved_m(s, s->state.u, NULL) / sqrt(3) * (length < before ? length / before : 1);
  return path_unit * fmax(grown, path_unit * s->problem.length_m);
}

/* The limit point or bifurcation that the last step has passed, or where it cannot be closed in on
 * that step. */
static dea_status record_stop(struct dea_context *ctx, struct search *a,
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
  a->stop->load_factor = at->load;
  keep_state(a, &a->limit);
  return report_point(ctx, a, kind == DEA_STOP_LIMIT && !located ? DEA_STOP_NEAR : kind);
}

/* From a point beyond the goal to the equilibrium at it, from an unstable one down. */
static dea_status leave_path(struct dea_context *ctx, struct search *a,
                             const struct dea_continuation_point *at)
{
  struct dea_solid *s = a->s;
  struct dea_solid_report report = {0};
  dea_status status = DEA_OK;
  dea_solid_forget(s);
  if (at->load >= 1) {
    dea_solid_controls_set(s, a->goal);
    if (dea_solid_controls_increment(s, a->goal)) {
      status = dea_solid_prescribed_increment(ctx, s, &report);
    }
  }
  struct dea_solid_change change = {.grew = false};
  status = status == DEA_OK ? dea_solid_descend_unstable(ctx, s, 0, &report) : status;
  status = status == DEA_OK ? find_change(ctx, a, &change) : status;
  if (status == DEA_OK && report.unstable_modes == 0 && !change.grew) {
    *a->report = report;
    a->went_on = true;
    a->arrived = at->load >= 1;
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
static dea_status check_modes(struct dea_context *ctx, const struct search *a, int unstable,
                              int *of_mesh)
{
  struct dea_solid *s = a->s;
  double value;
  if (unstable <= *of_mesh || !a->watch->taut(a->watch->user) ||
      is_deflected(s, s->problem.length_m)) {
    *of_mesh = unstable < *of_mesh ? unstable : *of_mesh;
    return DEA_OK;
  }
  double *mode = dea_solid_alloc(ctx, s->problem.dofs, sizeof *mode);
  DEA_TRY_MEMORY(mode != NULL);
  dea_status status = dea_solid_unstable_mode(ctx, s, &value, mode);
  if (status == DEA_OK && leaves_plane(s, mode)) {
    *of_mesh = unstable;
  }
  status = dea_solid_excuse(ctx, status);
  dea_free(ctx, mode);
  return status;
}

/* The flat film's path has come to the goal: the state there is its own, with the mesh's modes. */
static dea_status stay_flat(struct dea_context *ctx, struct search *a,
                            struct dea_solid_continuation *path)
{
  struct dea_continuation_point at;
  DEA_TRY(ctx, dea_solid_continuation_at(ctx, path, 1, &at));
  dea_solid_controls_set(a->s, a->goal); // what rounding leaves of it
  a->went_on = a->arrived = true;
  *a->report =
      (struct dea_solid_report){.unstable_modes = at.unstable_modes, .energy_J = at.energy_J};
  return DEA_OK;
}

/* From a limit point beyond the goal, which turns back behind it, to the goal. */
static dea_status return_to_goal(struct dea_context *ctx, struct search *a)
{
  *a->stop = (struct dea_solid_stop){.kind = DEA_STOP_UNKNOWN};
  dea_solid_restore_state(a->s, &a->limit);
  DEA_TRY(ctx, dea_load_steps_solve_to(ctx, a->s, a->goal, 1, a->report));
  a->went_on = a->report->unstable_modes == 0;
  return report_point(ctx, a, DEA_STOP_PASSED);
}

/* Along the path until something has happened. */
static dea_status follow(struct dea_context *ctx, struct search *a,
                         struct dea_solid_continuation *path)
{
  static const double bent = 0.75; // slope over the first one, towards a limit point
  struct dea_continuation_point at = {0};
  const int points = a->s->settings.arc_max_points;
  double first = 0;
  int of_mesh = 0; // unstable modes that are no modes of the film
  for (int i = 0; i < (at.slope < bent * first ? 2 : 1) * points; i++) {
    DEA_TRY(ctx, dea_solid_continuation_step(ctx, path, &at));
    first = i == 0 ? at.slope : first;
    if (at.passed == DEA_CONTINUATION_LIMIT) {
      DEA_TRY(ctx, record_stop(ctx, a, DEA_STOP_LIMIT, path, &at));
      return a->stop->load_factor < 1 ? DEA_OK : return_to_goal(ctx, a);
    }
    struct dea_solid_change change;
    DEA_TRY(ctx, find_change(ctx, a, &change));
    DEA_TRY(ctx,
            change.grew ? dea_fail(ctx, DEA_E_NOT_CONVERGED, "the path thins at once") : DEA_OK);
    DEA_TRY(ctx, report_point(ctx, a, DEA_STOP_UNKNOWN));
    DEA_TRY(ctx, check_modes(ctx, a, at.unstable_modes, &of_mesh));
    const bool unstable = at.unstable_modes > of_mesh;
    if (at.load >= 1 && !unstable && of_mesh > 0 && !is_deflected(a->s, a->s->problem.length_m)) {
      return stay_flat(ctx, a, path);
    }
    if (at.load >= 1 || unstable) {
      dea_status status = leave_path(ctx, a, &at);
      if (!dea_solid_may_shorten(status) || at.unstable_modes == 0) {
        return status;
      }
      dea_context_clear(ctx);
      return record_stop(ctx, a, DEA_STOP_UNSTABLE, path, &at);
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the path is long");
}

/* From the equilibrium that the solid is at towards the goal by arc length. The solid is then
 * further on (a->went_on), or where it was. Fails only where no shorter step would help. */
static dea_status search_path(struct dea_context *ctx, struct search *a)
{
  struct dea_continuation_options options = {path_step, max_path_step, 0, true};
  struct dea_solid_continuation *path = NULL;
  keep_state(a, &a->start);
  options.unit_m = unit_of(a->s, a->start.controls, a->goal);
  a->went_on = false;
  *a->stop = (struct dea_solid_stop){.kind = DEA_STOP_UNKNOWN};
  dea_status status = dea_continuation_create_to(ctx, a->s, a->goal, &options, &path);
  status = status == DEA_OK ? follow(ctx, a, path) : status;
  dea_solid_continuation_destroy(ctx, path);
  if (a->went_on) {
    note_left_plane(a);
  } else {
    dea_solid_restore_state(a->s, &a->start);
  }
  return dea_solid_excuse(ctx, status);
}

// Load steps --------------------------------------------------------------------------------------

/* Controls at a fraction of the increment: the square of the voltage, and all others, in
 * proportion.
 */
static void set_between(const struct dea_solid *s, const double *from, const double *goal,
                        double fraction, double *out)
{
  for (size_t i = 1; i < s->work.load_steps.control_count; i++) {
    out[i] = from[i] + fraction * (goal[i] - from[i]);
  }
  out[0] = sqrt((1 - fraction) * from[0] * from[0] + fraction * goal[0] * goal[0]);
}

/* Share of the increment from some controls to others that the controls `at` are at. */
static double share_of(const struct dea_solid *s, const double *from, const double *goal,
                       const double *at)
{
  double most = fabs(goal[0] * goal[0] - from[0] * from[0]);
  double fraction =
      most > 0 ? (at[0] * at[0] - from[0] * from[0]) / (goal[0] * goal[0] - from[0] * from[0]) : 0;
  for (size_t i = 1; i < s->work.load_steps.control_count && !(most > 0); i++) {
    fraction = goal[i] != from[i] ? (at[i] - from[i]) / (goal[i] - from[i]) : fraction;
    most = fabs(goal[i] - from[i]);
  }
  return fraction;
}

/* Whether load steps from the start have come farther from where the tangent there leads than a
 * path of equilibria does, up to its limit point (docs/theory/stops.md). */
static bool left_branch(const struct search *a, double fraction)
{
  const struct dea_solid *s = a->s;
  double off = 0, length = 0;
  for (size_t i = 0; i < 3 * s->problem.grid->node_count && s->found.extrapolated; i++) {
    double step = fraction * s->work.extrapolated[i],
           beyond = s->state.u[i] - a->start.state[i] - step;
    off += beyond * beyond;
    length += step * step;
  }
  return off > length * max_off_tangent * max_off_tangent;
}

/* Whether load steps from the start have stayed on the path that they began on; otherwise the solid
 * is back there. goal: of their first linear step. */
static dea_status check_branch(struct dea_context *ctx, struct search *a, const double *goal,
                               bool *stays)
{
  struct dea_solid *s = a->s;
  struct dea_solid_change change;
  dea_status status = find_change(ctx, a, &change);
  dea_solid_controls_get(s, a->next);
  bool left = change.grew || (a->taut && change.taut && !a->report->snapped &&
                              left_branch(a, share_of(s, a->start.controls, goal, a->next)));
  a->jumped |= left;
  left |= a->taut && change.taut && !a->left && left_plane(a);
  if (left || status != DEA_OK) { // or beyond what the law knows
    dea_solid_restore_state(s, &a->start);
  }
  *stays = !left && status == DEA_OK;
  return status;
}

/* Load steps to controls, the shortest one `least` of the increment, with the limits of the film:
 * with a coupled field a taut one is solved in a few iterations, or jumps; a slack one has a long
 * way down.
 */
static dea_status solve_steps(struct dea_context *ctx, const struct search *a, const double *goal,
                              double least, struct dea_solid_report *report)
{
  struct dea_solid_settings *o = &a->s->settings;
  const struct dea_solid_settings own = *o;
  if (!a->taut) {
    o->newton_max_iterations *= 2;
    o->newton_max_nonmonotone *= 2;
  } else if (a->s->problem.field != NULL) {
    o->newton_max_iterations = COUPLED_ITERATIONS < o->newton_max_iterations
                                   ? COUPLED_ITERATIONS
                                   : o->newton_max_iterations;
    o->newton_max_nonmonotone = o->newton_max_iterations < o->newton_max_nonmonotone
                                    ? o->newton_max_iterations
                                    : o->newton_max_nonmonotone;
  }
  dea_status status = dea_load_steps_solve_to(ctx, a->s, goal, least, report);
  *o = own;
  return status;
}

/* Such load steps, which are looked at: where they fail the solid is at their last equilibrium, or
 * where they began if that is not on the path from there (false: *stays). */
static dea_status solve_to(struct dea_context *ctx, struct search *a, const double *goal,
                           double least, bool *stays)
{
  keep_state(a, &a->start);
  a->s->found.predicts_tangent = true; // the first linear step is kept
  a->s->found.extrapolated = false;
  dea_status ended = solve_steps(ctx, a, goal, least, a->report);
  dea_status status =
      ended == DEA_OK || dea_solid_may_shorten(ended) ? check_branch(ctx, a, goal, stays) : DEA_OK;
  return status == DEA_OK ? ended : status;
}

/* Down in energy from the limit point that was found to a stable state a little beyond it. *beyond:
 * there is one, to which the film has not grown at once, and the solid is there; otherwise it is
 * where the search began. One that is close by is where a spot of the mesh has turned over. */
static dea_status pass_limit(struct dea_context *ctx, struct search *a, bool *beyond)
{
  struct dea_solid *s = a->s;
  const struct dea_solid_settings *o = &s->settings;
  struct dea_solid_change change = {.grew = true};
  struct dea_solid_report report;
  bool close = false;
  dea_solid_restore_state(s, &a->limit);
  set_between(s, a->start.controls, a->goal, fmin(a->stop->load_factor + o->load_step_min, 1),
              a->next);
  dea_status status = solve_steps(ctx, a, a->next, 1, &report);
  if (status == DEA_OK && report.unstable_modes == 0) {
    status = find_change(ctx, a, &change);
    close = moved_m(s, s->state.u, a->limit.state) < spot_share * moved_m(s, a->limit.state, NULL);
  }
  *beyond = status == DEA_OK && !change.grew;
  if (*beyond) {
    a->snapped |= !close || !a->taut;
    a->stop->load_factor = share_of(s, a->begin, a->goal, a->limit.controls);
    a->stop->kind = DEA_STOP_UNKNOWN;
    return close ? report_point(ctx, a, DEA_STOP_PASSED) : DEA_OK;
  }
  dea_solid_restore_state(s, &a->start);
  return dea_solid_excuse(ctx, status);
}

/* One load step to a->at. *there: it has found a stable state on its path; otherwise the solid is
 * where it began, and *ended is why. */
static dea_status step_near(struct dea_context *ctx, struct search *a, dea_status *ended,
                            bool *there)
{
  const struct dea_solid_report before = *a->report;
  bool stays = true;
  *ended = solve_to(ctx, a, a->at, 1, &stays);
  *there = *ended == DEA_OK && stays && a->report->unstable_modes == 0;
  if (*there) {
    a->report->snapped |= before.snapped;
    keep_state(a, &a->start);
    return report_point(ctx, a, DEA_STOP_UNKNOWN);
  }
  dea_solid_restore_state(a->s, &a->start);
  *a->report = before;
  return *ended == DEA_OK || dea_solid_may_shorten(*ended) ? DEA_OK : *ended;
}

/* How close load steps come to where they end: of a slack film they take long, but not where its
 * law ends. */
static double closest(const struct search *a, dea_status last)
{
  const struct dea_solid_settings *o = &a->s->settings;
  return a->taut ? dea_branch_jump_width : last == DEA_E_DOMAIN ? o->load_step_min : slack_share;
}

/* Where the path says nothing - a membrane that goes slack has a corner, which arc length does not
 * get around - load steps close in, in halves of what is left, on where they fail or leave their
 * path. *last, why: of the last failure. */
static dea_status halve_steps(struct dea_context *ctx, struct search *a, dea_status *last,
                              char why[160])
{
  const size_t size = a->s->work.load_steps.control_count * sizeof *a->bad;
  double least = closest(a, *last);
  bool failed = false, there = false;
  memcpy(a->bad, a->goal, size);
  for (double apart = 1; apart > 0.5 * least && (apart > least || !failed); apart /= 2) {
    dea_status ended;
    DEA_TRY(ctx, dea_solid_check_interruption(ctx));
    set_between(a->s, a->start.controls, a->bad, apart > least ? 0.5 : 1, a->at);
    DEA_TRY(ctx, step_near(ctx, a, &ended, &there));
    if (!there) {
      failed = true;
      memcpy(a->bad, a->at, size);
    }
    if (ended != DEA_OK) {
      *last = ended;
      snprintf(why, 160, "%s", dea_context_message(ctx));
      dea_context_clear(ctx);
    }
    least = closest(a, *last);
  }
  a->arrived = there && !failed;
  return DEA_OK;
}

/* By such steps to the goal, or to where they end, and by the path from close by. Where that says
 * nothing either, but load steps have left it, there is another state beyond and no way to there: a
 * limit point, or what acts as one. */
static dea_status close_in(struct dea_context *ctx, struct search *a)
{
  dea_status last = DEA_E_NOT_CONVERGED;
  char why[160] = "load steps leave the path of equilibria";
  DEA_TRY(ctx, halve_steps(ctx, a, &last, why));
  if (a->arrived) {
    return DEA_OK;
  }
  DEA_TRY(ctx, a->taut && last == DEA_E_NOT_CONVERGED ? search_path(ctx, a) : DEA_OK);
  if (a->went_on || a->stop->kind == DEA_STOP_LIMIT) {
    return DEA_OK;
  }
  if (!a->jumped) {
    return dea_fail(ctx, last, "%s", why);
  }
  *a->stop = (struct dea_solid_stop){DEA_STOP_LIMIT, dea_solid_voltage(a->s), 0, 0};
  keep_state(a, &a->limit);
  return report_point(ctx, a, DEA_STOP_NEAR);
}

/* Long load steps and the path in turn. */
static dea_status go(struct dea_context *ctx, struct search *a)
{
  for (int i = 0; i < MAX_ROUNDS; i++) {
    bool stays = false, on = true;
    dea_status status = solve_to(ctx, a, a->goal, path_share, &stays);
    if (status == DEA_OK && stays) {
      note_left_plane(a);
      return DEA_OK;
    }
    DEA_TRY(ctx, status == DEA_OK || dea_solid_may_shorten(status) ? DEA_OK : status);
    dea_context_clear(ctx);
    DEA_TRY(ctx, search_path(ctx, a));
    if (!a->went_on && a->stop->kind != DEA_STOP_LIMIT) {
      a->left = true; // nothing tells that the film stays in its plane
      DEA_TRY(ctx, close_in(ctx, a));
    }
    if (a->arrived) {
      return DEA_OK;
    }
    DEA_TRY(ctx, a->stop->kind == DEA_STOP_LIMIT ? pass_limit(ctx, a, &on) : DEA_OK);
    DEA_TRY(ctx, on ? DEA_OK
                    : dea_fail(ctx, DEA_E_NO_EQUILIBRIUM, "a limit point at %.6g kV",
                               1e-3 * a->stop->voltage_V));
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the path to there has too many turns");
}

static dea_status search_create(struct dea_context *ctx, struct search *a)
{
  dea_solid_alloc_doubles(&a->memory, a->s->work.load_steps.control_count,
                          (double **[]){&a->goal, &a->next, &a->bad, &a->at, &a->begin, NULL});
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(&a->memory)));
  DEA_TRY(ctx, dea_solid_save_state(ctx, a->s, &a->limit));
  return DEA_CHAIN(ctx, dea_solid_save_state(ctx, a->s, &a->start));
}

dea_status dea_solid_solve_incremental(struct dea_context *ctx, struct dea_solid *s,
                                       double voltage_V, bool taut,
                                       const struct dea_solid_watch *watch,
                                       struct dea_solid_report *report, struct dea_solid_stop *stop)
{
  struct search a = {
      .memory = {.ctx = ctx}, .s = s, .watch = watch, .report = report, .stop = stop, .taut = taut};
  *stop = (struct dea_solid_stop){.kind = DEA_STOP_UNKNOWN};
  *report = (struct dea_solid_report){.load_factor = 0};
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_load_steps_prepare(ctx, s)));
  dea_status status = search_create(ctx, &a);
  if (status == DEA_OK) {
    const int divergent = s->settings.max_divergent;
    s->settings.max_divergent = MAX_DIVERGENT;
    dea_solid_controls_get(s, a.begin);
    dea_solid_controls_goal(s, voltage_V, a.goal);
    status = go(ctx, &a);
    report->snapped |= a.snapped;
    if (stop->kind == DEA_STOP_LIMIT) {
      stop->load_factor = share_of(s, a.begin, a.goal, a.limit.controls);
    }
    dea_solid_controls_get(s, a.next);
    report->load_factor = status == DEA_OK ? 1 : share_of(s, a.begin, a.goal, a.next);
    s->settings.max_divergent = divergent;
  }
  dea_solid_saved_state_free(&a.limit);
  dea_solid_saved_state_free(&a.start);
  dea_arena_free(&a.memory);
  return DEA_CHAIN(ctx, status);
}

#include "model/solid/equilibrium/continuation.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/controls.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/assembly/potential.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/equilibrium/modified_newton.h"
#include "model/solid/equilibrium/newton.h"
#include "model/solid/equilibrium/presolve_check.h"

#include <math.h>
#include <string.h>

enum { MAX_ATTEMPTS = 16 };   // at one step, each half as long
enum { MANY_ITERATIONS = 8 }; // above which the next step is shorter
static const double max_off =
    0.3; // of the step: a point farther from its prediction is of another path
static const double aimed_off = 0.08;   // of the step: distance that steps aim at
static const double min_bend = 0.02;    // of a unit tangent, below which a path is an arc
static const double min_step = 1e-6;    // of the first step
static const double stol = 1e-10;       // of the solid's length
static const double rough_rtol = 1e-4;  // of the step, on the way to an event
static const double plane_rtol = 1e-9;  // of the step
static const double theta_share = 1e-2; // of volume_tol: there kappa theta is no pressure any more
static const double bulk_factor = 16;  // of kappa in the corrector; a power of 2 leaves no rounding
static const double difference = 1e-5; // of tau: the force is linear in it
static const double predicting_rate =
    0.3;                              // of the residual before: falls less where stresses mislead
enum { MAX_HIDDEN = 3 };              // steps in a row that rounding hides
enum { MAX_ROUNDS = 20 };             // of regula falsi
static const double zero_rtol = 1e-8; // of what it was
static const double singular_offset = 0.03; // of the bracket: first distance from a singular point
enum { MAX_OFFSETS = 4 };                   // attempts, each twice as far from it

/* An equilibrium on the path. */
struct dea_continuation_path_point {
  double *state; // [state_count]
  struct dea_continuation_point point;
};

/* A plane in the space of displacements and load, which a point is looked for in:
 * weight . (u - u0) + load (tau - tau0) = length. */
struct dea_continuation_plane {
  double *weight;   // [dofs] metric times the unit normal's displacements
  double load;      // the unit normal's load
  const double *u0; // [dofs]
  double tau0, length;
  double enough; // a step that is this fraction of the length is the last one
};

struct dea_solid_continuation {
  struct dea_arena memory; // of all arrays
  struct dea_solid *s;
  double *metric;            // [dofs] of displacements: sum of metric du^2 + d tau^2 = ds^2
  double *from, *goal, *now; // [control_count] at tau = 0 and 1, and as they are
  double *held_rate;         // [dofs] of what is prescribed, by tau
  double load, energy_J;     // tau and energy of the solid as it is
  struct dea_continuation_path_point before, last, next, critical;
  double *tangent, tangent_load; // of the path at last; [dofs]
  struct dea_continuation_plane plane;
  double *rate, *right, *start, *mode; // [dofs] each: work; mode: critical one, unit size
  double *span, *bulge;                // [state_count] work
  double step, step_most, step_least;
  bool rough;                        // points on the way need not be exact
  bool arc;                          // its last two points make a parabola, which is followed
  enum dea_continuation_event event; // between before and last
};

/* Length of a displacement in the metric. */
static double size_of(const struct dea_solid_continuation *t, const double *du)
{
  double sum = 0;
  for (size_t i = 0; i < t->s->problem.dofs; i++) {
    sum += t->metric[i] * du[i] * du[i];
  }
  return sqrt(sum);
}

/* Sets all controls to those at tau, held components go along. DEA_E_DOMAIN below 0 V. */
static dea_status set_controls(struct dea_context *ctx, struct dea_solid_continuation *t,
                               double tau)
{
  struct dea_solid *s = t->s;
  double square = t->from[0] * t->from[0] * (1 - tau) + t->goal[0] * t->goal[0] * tau;
  double least = -1e-9 * fmax(t->from[0] * t->from[0], t->goal[0] * t->goal[0]);
  if (square < least) {
    return dea_fail(ctx, DEA_E_DOMAIN, "the path ends at 0 V");
  }
  for (size_t i = 1; i < s->work.load_steps.control_count; i++) {
    t->now[i] = t->from[i] + tau * (t->goal[i] - t->from[i]);
  }
  t->now[0] = sqrt(fmax(square, 0));
  t->load = tau;
  dea_solid_controls_set(s, t->now);
  if (dea_solid_controls_increment(s, t->now)) {
    dea_add(s->problem.dofs, 1, s->work.increment, s->state.u);
  }
  return DEA_OK;
}

/* The same, and the potentials of a coupled field are those of the displacements there. */
static dea_status set_load(struct dea_context *ctx, struct dea_solid_continuation *t, double tau)
{
  struct dea_solid *s = t->s;
  DEA_TRY(ctx, set_controls(ctx, t, tau));
  dea_status status = dea_solid_solve_potential(ctx, s, s->state.voltage_V, s->state.u);
  return status == DEA_OK
             ? DEA_OK
             : dea_fail(ctx, status, "an element on the path has no energy at its end");
}

/* The plane of the weight that is set. */
static void lay_plane(struct dea_solid_continuation *t, double load,
                      const struct dea_continuation_path_point *from, double length, double enough)
{
  t->plane.load = load;
  t->plane.u0 = from->state;
  t->plane.tau0 = from->point.load;
  t->plane.length = length;
  t->plane.enough = enough;
}

/* A plane across a direction of any length, at a distance from a point of the path. enough: a step
 * that is this fraction of the distance is the last one. */
static void set_plane(struct dea_solid_continuation *t, const double *direction, double load,
                      const struct dea_continuation_path_point *from, double distance,
                      double enough)
{
  double size = hypot(size_of(t, direction), load);
  size = size > 0 ? size : 1;
  for (size_t i = 0; i < t->s->problem.dofs; i++) {
    t->plane.weight[i] = t->metric[i] * direction[i] / size;
  }
  lay_plane(t, load / size, from, distance, enough);
}

/* ---- corrector: an equilibrium in a plane, Newton on displacements and load together ---- */

/* t->right = -dg/d tau at the displacements as they are, where g is assembled, by a difference: g
 * is linear in the square of the voltage and in dead loads. Leaves g as it is. */
static dea_status force_rate(struct dea_context *ctx, struct dea_solid_continuation *t)
{
  struct dea_solid *s = t->s;
  const size_t size = s->problem.dofs * sizeof(double);
  double energy, tau = t->load, by = difference;
  memcpy(t->rate, s->work.g, size);
  if (set_load(ctx, t, tau + by) != DEA_OK) {
    dea_context_clear(ctx);
    by = -by;
    DEA_TRY(ctx, set_load(ctx, t, tau + by));
  }
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_FORCE, &energy));
  for (size_t i = 0; i < s->problem.dofs; i++) {
    t->right[i] = (t->rate[i] - s->work.g[i]) / by;
  }
  memcpy(s->work.g, t->rate, size);
  return DEA_CHAIN(ctx, set_load(ctx, t, tau));
}

/* t->rate = du/d tau with the factor that is there, from t->right. */
static dea_status displacement_rate(struct dea_context *ctx, struct dea_solid_continuation *t)
{
  DEA_TRY(ctx, dea_solid_solve_linear(ctx, t->s, t->right, t->rate));
  dea_add(t->s->problem.dofs, 1, t->held_rate, t->rate);
  dea_solid_bodies_transfer(t->s, t->rate); // those of held_rate belong to where the path began
  return DEA_OK;
}

/* What the plane's equation is off by. */
static double off_plane(const struct dea_solid_continuation *t)
{
  const struct dea_continuation_plane *plane = &t->plane;
  double off = plane->load * (t->load - plane->tau0) - plane->length;
  for (size_t i = 0; i < t->s->problem.dofs; i++) {
    off += plane->weight[i] * (t->s->state.u[i] - plane->u0[i]);
  }
  return off;
}

/* step and *dtau: the Newton step of g = 0 and of the plane's equation, with K factorised. */
static dea_status bordered_step(struct dea_context *ctx, struct dea_solid_continuation *t,
                                double *dtau)
{
  struct dea_solid *s = t->s;
  const struct dea_solid_problem *p = &s->problem;
  const struct dea_continuation_plane *plane = &t->plane;
  double off = off_plane(t), along = plane->load;
  DEA_TRY(ctx, displacement_rate(ctx, t));
  DEA_TRY(ctx, dea_solid_linear_step(ctx, s));
  for (size_t i = 0; i < p->dofs; i++) {
    off += plane->weight[i] * s->work.step[i];
    along += plane->weight[i] * t->rate[i];
  }
  if (along == 0) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the path does not cross the plane");
  }
  *dtau = -off / along;
  dea_add(p->dofs, *dtau, t->rate, s->work.step);
  return DEA_OK;
}

/* The longest fraction of the step, of 1, 1/2, 1/4 and 1/8, that turns no element inside out; the
 * last where all do. */
static double share_with_energy(struct dea_solid *s)
{
  double fraction = 1, energy;
  for (;; fraction /= 2) {
    for (size_t i = 0; i < s->problem.dofs; i++) {
      s->work.trial[i] = s->state.u[i] + fraction * s->work.step[i];
    }
    if (dea_solid_energy(s, s->work.trial, s->state.voltage_V, &energy) == DEA_OK ||
        fraction < 0.2) {
      return fraction;
    }
  }
}

/* One iteration, unless *there: it is at an equilibrium in the plane. *residual: that of the
 * iteration before, INFINITY at first, then of this one; *small: the step was; *hidden: from the
 * energy, by rounding. The first one always steps: a prediction whose residual is small all the
 * same is off by more than an equilibrium, along soft modes, and so would be all that start from
 * it. Where the residual does not fall, the stresses that a linear step leads to are not those of
 * its end, and the tangent takes those that there are. */
static dea_status correct_once(struct dea_context *ctx, struct dea_solid_continuation *t,
                               double *residual, bool *there, bool *small, bool *hidden)
{
  struct dea_solid *s = t->s;
  const struct dea_solid_settings *o = &s->settings;
  double dtau = 0, most = 0, before = *residual;
  int negative;
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_TANGENT, &t->energy_J));
  *residual = dea_solid_residual(s);
  bool constrained = dea_solid_theta_max(s) < theta_share * o->volume_tol;
  *there = isfinite(before) && constrained && *residual < o->arc_rtol &&
           fabs(off_plane(t)) < plane_rtol * fabs(t->plane.length);
  if (*there) {
    return DEA_OK;
  }
  DEA_TRY(ctx, force_rate(ctx, t));
  DEA_TRY(ctx, dea_solid_factorise(ctx, s, DEA_FACTOR_EXACT, &negative));
  DEA_TRY(ctx, bordered_step(ctx, t, &dtau));
  *hidden = constrained && !dea_solid_resolved(s, dea_solid_dot(s, s->work.g, s->work.step));
  double fraction = share_with_energy(s);
  bool stresses = *residual < predicting_rate * before;
  DEA_TRY(ctx,
          dea_solid_predict(ctx, s, s->state.voltage_V, s->work.step, fraction, stresses, true));
  for (size_t i = 0; i < s->problem.dofs; i++) {
    s->state.u[i] += fraction * s->work.step[i];
    most = fmax(most, fabs(s->work.step[i]));
  }
  double size = hypot(size_of(t, s->work.step), dtau);
  *small = (constrained && most < stol * s->problem.length_m) ||
           (fraction == 1 && size < t->plane.enough * fabs(t->plane.length));
  DEA_TRY(ctx, set_load(ctx, t, t->load + fraction * dtau));
  dea_context_counters(ctx)->newton_iterations++;
  dea_context_counters(ctx)->line_searches += fraction < 1;
  return DEA_OK;
}

/* With a large kappa, multipliers that are pressures and predicted stresses this is Newton's
 * method on displacements, pressures and load. */
static dea_status correct(struct dea_context *ctx, struct dea_solid_continuation *t,
                          int *iterations)
{
  const struct dea_solid_settings *o = &t->s->settings;
  double residual = INFINITY;
  int in_a_row = 0; // hidden steps
  for (*iterations = 1; *iterations <= o->arc_max_iterations; ++*iterations) {
    bool there = false, small = false, hidden = false;
    DEA_TRY(ctx, dea_solid_check_interruption(ctx));
    DEA_TRY(ctx, correct_once(ctx, t, &residual, &there, &small, &hidden));
    in_a_row = hidden ? in_a_row + 1 : 0;
    if ((there || in_a_row >= MAX_HIDDEN || (small && *iterations > 1)) &&
        dea_solid_update_loads(t->s) <= 1) {
      return DEA_OK;
    }
  }
  *iterations = o->arc_max_iterations;
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no equilibrium in the plane (residual %.1e)",
                  residual);
}

/* The solid to the equilibrium in t->plane. *iterations: that it took. */
static dea_status solve_in_plane(struct dea_context *ctx, struct dea_solid_continuation *t,
                                 int *iterations)
{
  t->s->state.bulk_factor *= bulk_factor;
  dea_status status = correct(ctx, t, iterations);
  t->s->state.bulk_factor /= bulk_factor;
  t->s->found.predicted_fits = false;
  return status;
}

/* ---- points of the path ---- */

/* At an equilibrium: unstable modes, and t->rate = du/d tau along the path. */
static dea_status find_rate(struct dea_context *ctx, struct dea_solid_continuation *t, int *modes)
{
  struct dea_solid *s = t->s;
  s->found.predicted_fits = s->found.factor_fits = false;
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_FORCE, &t->energy_J));
  dea_solid_keep_scales(s);
  dea_solid_change_bulk_modulus(s, DEA_SOLID_STIFF);
  double energy;
  dea_status status = dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_TANGENT, &energy);
  status = status == DEA_OK ? force_rate(ctx, t) : status;
  dea_solid_change_bulk_modulus(s, 1.0 / DEA_SOLID_STIFF);
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, dea_solid_factorise(ctx, s, DEA_FACTOR_EXACT, modes));
  return DEA_CHAIN(ctx, displacement_rate(ctx, t));
}

/* The place of the solid as it is; along: a displacement and load that the path's sense makes a
 * positive product with. Sets the tangent when it is wanted. */
static dea_status record_point(struct dea_context *ctx, struct dea_solid_continuation *t,
                               const double *along, double along_load, bool tangent,
                               struct dea_continuation_path_point *place)
{
  struct dea_solid *s = t->s;
  double product = along_load;
  DEA_TRY(ctx, find_rate(ctx, t, &place->point.unstable_modes));
  for (size_t i = 0; i < s->problem.dofs; i++) {
    product += t->metric[i] * along[i] * t->rate[i];
  }
  place->point.slope = copysign(1 / hypot(size_of(t, t->rate), 1), product);
  place->point.load = t->load;
  place->point.voltage_V = s->state.voltage_V;
  place->point.energy_J = t->energy_J;
  dea_solid_state_get(s, place->state);
  for (size_t i = 0; i < s->problem.dofs && tangent; i++) {
    t->tangent[i] = place->point.slope * t->rate[i];
  }
  t->tangent_load = tangent ? place->point.slope : t->tangent_load;
  return DEA_OK;
}

/* Puts the solid to a place. */
static dea_status return_to(struct dea_context *ctx, struct dea_solid_continuation *t,
                            const struct dea_continuation_path_point *place)
{
  dea_solid_state_set(t->s, place->state);
  dea_solid_forget(t->s);
  return DEA_CHAIN(ctx, set_load(ctx, t, place->point.load));
}

/* From an equilibrium by du [dofs] and dtau, pressures and predicted stresses along. */
static dea_status predict_from(struct dea_context *ctx, struct dea_solid_continuation *t,
                               const double *du, double dtau)
{
  struct dea_solid *s = t->s;
  double energy;
  s->found.predicted_fits = false;
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_FORCE, &energy)); // for theta
  dea_solid_change_bulk_modulus(s, DEA_SOLID_STIFF);
  dea_status status = dea_solid_predict(ctx, s, s->state.voltage_V, du, 1, true, true);
  s->state.bulk_factor /= DEA_SOLID_STIFF; // the multipliers are those of the end of the step
  DEA_TRY(ctx, status);
  dea_add(s->problem.dofs, 1, du, s->state.u);
  return DEA_CHAIN(ctx, set_load(ctx, t, t->load + dtau));
}

/* ---- steps along the tangent ---- */

/* Distance of where the solid is to the prediction that t->start and tau are, both from last. */
static double distance_from(struct dea_solid_continuation *t, const double *predicted, double tau)
{
  double sum = (t->load - tau) * (t->load - tau);
  for (size_t i = 0; i < t->s->problem.dofs; i++) {
    double off = t->s->state.u[i] - predicted[i];
    sum += t->metric[i] * off * off;
  }
  return sqrt(sum);
}

/* How far the tangent at t->next is from that of the circle through both points with the tangent at
 * t->last: 0 for an arc, twice the distance from the prediction for a parallel path. t->rate
 * belongs to t->next. */
static double bend(const struct dea_solid_continuation *t)
{
  double chord_load = t->next.point.load - t->last.point.load, size = chord_load * chord_load;
  double tangents = t->tangent_load, first = chord_load * t->tangent_load, second = chord_load;
  for (size_t i = 0; i < t->s->problem.dofs; i++) {
    double chord = t->next.state[i] - t->last.state[i];
    size += t->metric[i] * chord * chord;
    first += t->metric[i] * chord * t->tangent[i];
    second += t->metric[i] * chord * t->rate[i];
    tangents += t->metric[i] * t->tangent[i] * t->rate[i];
  }
  double square =
      2 + 2 * t->next.point.slope * tangents - 4 * first * t->next.point.slope * second / size;
  return sqrt(fmax(square, 0));
}

/* How far the parabola through the last two points is beside the tangent at the last one, as a
 * fraction of the step: x^2 (before - last + h tangent), with h the distance between them along the
 * tangent and x = step / h. *load: of tau. */
static double curve(const struct dea_solid_continuation *t, double *h, double *load)
{
  *h = (t->last.point.load - t->before.point.load) * t->tangent_load;
  for (size_t i = 0; i < t->s->problem.dofs; i++) {
    *h += t->metric[i] * (t->last.state[i] - t->before.state[i]) * t->tangent[i];
  }
  double x = t->step / *h, square;
  *load = x * x * (t->before.point.load - t->last.point.load + *h * t->tangent_load);
  square = *load * *load;
  for (size_t i = 0; i < t->s->problem.dofs; i++) {
    double parabola = x * x * (t->before.state[i] - t->last.state[i] + *h * t->tangent[i]);
    square += t->metric[i] * parabola * parabola;
  }
  return sqrt(square) / t->step;
}

/* From the prediction along the tangent to that on the parabola, pressures too. The stresses stay
 * those that the step along the tangent leads to. */
static dea_status follow_curve(struct dea_context *ctx, struct dea_solid_continuation *t)
{
  struct dea_solid *s = t->s;
  const size_t dofs = s->problem.dofs;
  const double *last = t->last.state, *before = t->before.state;
  double h, load;
  if (!t->arc || !(curve(t, &h, &load) < max_off)) {
    return DEA_OK;
  }
  const double square = t->step * t->step / (h * h);
  for (size_t i = 0; i < dofs; i++) {
    s->state.u[i] += square * (before[i] - last[i] + h * t->tangent[i]);
  }
  for (size_t i = 0; i < dea_solid_pressure_count(s); i++) {
    double *p = &s->state.multiplier[i], rate = (*p - last[dofs + i]) / t->step;
    *p += square * (before[dofs + i] - last[dofs + i] + h * rate);
  }
  return DEA_CHAIN(ctx, set_load(ctx, t, t->load + load));
}

/* A point at t->step into t->next; *off: how far from the prediction by the tangent, over the step.
 */
static dea_status attempt_step(struct dea_context *ctx, struct dea_solid_continuation *t,
                               double *off, int *iterations)
{
  struct dea_solid *s = t->s;
  DEA_TRY(ctx, return_to(ctx, t, &t->last));
  for (size_t i = 0; i < s->problem.dofs; i++) {
    t->start[i] = t->step * t->tangent[i];
  }
  DEA_TRY(ctx, predict_from(ctx, t, t->start, t->step * t->tangent_load));
  memcpy(t->start, s->state.u, s->problem.dofs * sizeof *t->start);
  double tau = t->load;
  DEA_TRY(ctx, follow_curve(ctx, t));
  set_plane(t, t->tangent, t->tangent_load, &t->last, t->step, t->rough ? rough_rtol : 0);
  DEA_TRY(ctx, solve_in_plane(ctx, t, iterations));
  *off = distance_from(t, t->start, tau) / t->step;
  if (*off < max_off) {
    t->next.point.arc = t->last.point.arc + t->step;
    DEA_TRY(ctx, record_point(ctx, t, t->tangent, t->tangent_load, false, &t->next));
    if (bend(t) < fmax(*off, min_bend)) {
      return DEA_OK;
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the path is left for another one");
}

/* The new point becomes the last one. */
static void accept_point(struct dea_solid_continuation *t)
{
  struct dea_continuation_path_point old = t->before;
  t->before = t->last;
  t->last = t->next;
  t->next = old;
  for (size_t i = 0; i < t->s->problem.dofs; i++) {
    t->tangent[i] = t->last.point.slope * t->rate[i];
  }
  t->tangent_load = t->last.point.slope;
  t->event = t->before.point.slope * t->last.point.slope < 0 ? DEA_CONTINUATION_LIMIT
             : t->before.point.unstable_modes != t->last.point.unstable_modes
                 ? DEA_CONTINUATION_BIFURCATION
                 : DEA_CONTINUATION_NOTHING;
  t->arc = t->rough;
}

dea_status dea_solid_continuation_step(struct dea_context *ctx, struct dea_solid_continuation *t,
                                       struct dea_continuation_point *point)
{
  double off = 0;
  int iterations = 0, all = 0;
  dea_status status = DEA_OK;
  for (int i = 0; i < MAX_ATTEMPTS; i++) {
    dea_context_clear(ctx);
    iterations = 0;
    status = attempt_step(ctx, t, &off, &iterations);
    all += iterations;
    dea_context_counters(ctx)->load_steps += status == DEA_OK;
    dea_context_counters(ctx)->rejected_steps += status != DEA_OK;
    if (!dea_solid_may_shorten(status) || t->step < 2 * t->step_least) {
      break;
    }
    t->step /= 2;
  }
  if (status != DEA_OK) {
    char why[200];
    strncpy(why, dea_context_message(ctx), sizeof why - 1);
    why[sizeof why - 1] = '\0';
    dea_context_clear(ctx);
    DEA_TRY(ctx, return_to(ctx, t, &t->last));
    return dea_fail(ctx, status, "the path cannot be followed beyond a load of %.6g (%s)",
                    t->last.point.load, why);
  }
  accept_point(t);
  *point = t->last.point;
  point->passed = t->event;
  point->iterations = all;
  double longer = off > 0 ? fmin(sqrt(aimed_off / off), 2) : 2;
  longer = iterations > MANY_ITERATIONS ? fmin(longer, 0.7) : longer;
  t->step = fmin(t->step * fmax(longer, 0.5), t->step_most);
  return DEA_OK;
}

/* Offset of the guess from the chord between the point before and the last one: bulge x (x - 1) at
 * a fraction x of the chord. */
struct bulge {
  double *state; // [state_count]
  double load;
};

/* The equilibrium in the plane that is set, from the guess at a fraction of the chord; bulge: NULL
 * for a guess on the chord. */
static dea_status solve_between(struct dea_context *ctx, struct dea_solid_continuation *t,
                                double fraction, const struct bulge *bulge)
{
  const struct dea_continuation_path_point *from = &t->before, *to = &t->last;
  const double parabola = fraction * (fraction - 1);
  int iterations;
  for (size_t i = 0; i < t->s->work.load_steps.state_count; i++) {
    t->critical.state[i] = from->state[i] + fraction * (to->state[i] - from->state[i]) +
                           (bulge != NULL ? parabola * bulge->state[i] : 0);
  }
  t->critical.point.load = from->point.load + fraction * (to->point.load - from->point.load) +
                           (bulge != NULL ? parabola * bulge->load : 0);
  DEA_TRY(ctx, return_to(ctx, t, &t->critical));
  return DEA_CHAIN(ctx, solve_in_plane(ctx, t, &iterations));
}

/* The same, and what is known of it. */
static dea_status find_between(struct dea_context *ctx, struct dea_solid_continuation *t,
                               double fraction, struct dea_continuation_point *point)
{
  const double from = t->before.point.arc, to = t->last.point.arc;
  DEA_TRY(ctx, solve_between(ctx, t, fraction, NULL));
  t->critical.point.arc = from + fraction * (to - from);
  DEA_TRY(ctx, record_point(ctx, t, t->tangent, t->tangent_load, false, &t->critical));
  *point = t->critical.point;
  return DEA_OK;
}

dea_status dea_solid_continuation_at(struct dea_context *ctx, struct dea_solid_continuation *t,
                                     double load, struct dea_continuation_point *point)
{
  const double from = t->before.point.load, span = load - from;
  memset(t->start, 0, t->s->problem.dofs * sizeof *t->start);
  set_plane(t, t->start, 1, &t->before, span, 0);
  return DEA_CHAIN(ctx, find_between(ctx, t, span / (t->last.point.load - from), point));
}

dea_status dea_solid_continuation_across(struct dea_context *ctx, struct dea_solid_continuation *t,
                                         const double *weight, double value,
                                         struct dea_continuation_point *point)
{
  double from = 0, to = 0;
  for (size_t i = 0; i < t->s->problem.dofs; i++) {
    from += weight[i] * t->before.state[i];
    to += weight[i] * t->last.state[i];
  }
  memcpy(t->plane.weight, weight, t->s->problem.dofs * sizeof *weight);
  lay_plane(t, 0, &t->before, value - from, 0);
  return DEA_CHAIN(ctx, find_between(ctx, t, (value - from) / (to - from), point));
}

/* ---- creation ---- */

/* Memory and metric. */
static dea_status allocate_path(struct dea_context *ctx, struct dea_solid *s,
                                const struct dea_continuation_options *options,
                                struct dea_solid_continuation *t)
{
  const struct dea_solid_problem *p = &s->problem;
  t->memory.ctx = ctx;
  dea_solid_alloc_doubles(&t->memory, p->dofs,
                          (double **[]){&t->metric, &t->held_rate, &t->tangent, &t->plane.weight,
                                        &t->rate, &t->right, &t->start, &t->mode, NULL});
  dea_solid_alloc_doubles(&t->memory, s->work.load_steps.control_count,
                          (double **[]){&t->from, &t->goal, &t->now, NULL});
  dea_solid_alloc_doubles(&t->memory, s->work.load_steps.state_count,
                          (double **[]){&t->before.state, &t->last.state, &t->critical.state,
                                        &t->next.state, &t->span, &t->bulge, NULL});
  DEA_TRY_MEMORY(!dea_solid_allreduce_any(t->memory.failed));
  double volume = 0;
  dea_solid_lump_volume(s, t->metric);
  for (size_t i = 0; i < p->dofs; i++) {
    volume += t->metric[i] / 3;
  }
  for (size_t i = 0; i < p->dofs; i++) {
    t->metric[i] /= volume * options->unit_m * options->unit_m;
  }
  t->step = fabs(options->step);
  t->step_least = min_step * t->step;
  t->step_most = options->step_most > 0 ? options->step_most : INFINITY;
  t->rough = options->rough;
  return DEA_OK;
}

/* The equilibrium that the solid is at or slides into. */
static dea_status settle(struct dea_context *ctx, struct dea_solid_continuation *t)
{
  struct dea_solid *s = t->s;
  const struct dea_solid_settings *o = &s->settings;
  struct dea_solid_report report = {0};
  s->found.predicted_fits = false;
  DEA_TRY(ctx, dea_solid_solve_potential(ctx, s, s->state.voltage_V, s->state.u));
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_FORCE, &t->energy_J));
  double residual = sqrt(dea_solid_dot(s, s->work.g, s->work.g));
  if (!(residual < o->newton_rtol * s->found.force_scale_N) ||
      dea_solid_theta_max(s) >= o->volume_tol || dea_solid_update_loads(s) > 1) {
    DEA_TRY(ctx, dea_solid_equilibrate(ctx, s, &report));
  }
  return DEA_OK;
}

/* The controls and the place to start from. */
static dea_status begin_path(struct dea_context *ctx, struct dea_solid_continuation *t,
                             const double *goal, double sense)
{
  struct dea_solid *s = t->s;
  DEA_TRY(ctx, dea_solid_check(ctx, s));
  DEA_TRY(ctx, settle(ctx, t));
  dea_solid_controls_get(s, t->from);
  memcpy(t->goal, goal, s->work.load_steps.control_count * sizeof(double));
  dea_solid_controls_increment(s, t->from);
  memcpy(t->held_rate, s->work.increment, s->problem.dofs * sizeof(double));
  dea_solid_controls_increment(s, t->goal);
  for (size_t i = 0; i < s->problem.dofs; i++) {
    t->held_rate[i] = s->work.increment[i] - t->held_rate[i];
  }
  return DEA_CHAIN(ctx, record_point(ctx, t, t->tangent, sense, true, &t->last));
}

dea_status dea_continuation_create_to(struct dea_context *ctx, struct dea_solid *s,
                                      const double *goal,
                                      const struct dea_continuation_options *options,
                                      struct dea_solid_continuation **out)
{
  *out = NULL;
  struct dea_solid_continuation *t = dea_solid_alloc(ctx, 1, sizeof *t);
  DEA_TRY_MEMORY(t != NULL);
  t->s = s;
  dea_status status = allocate_path(ctx, s, options, t);
  status = status == DEA_OK ? begin_path(ctx, t, goal, options->step) : status;
  DEA_TRY_ELSE(ctx, status, dea_solid_continuation_destroy(ctx, t));
  *out = t;
  return DEA_OK;
}

dea_status dea_solid_continuation_create(struct dea_context *ctx, struct dea_solid *s,
                                         double voltage_V,
                                         const struct dea_continuation_options *options,
                                         struct dea_solid_continuation **out)
{
  *out = NULL;
  if (!(options->unit_m > 0) || !(fabs(options->step) > 0)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a path takes a step and a unit of displacement");
  }
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_load_steps_prepare(ctx, s)));
  double *goal = s->work.load_steps.controls_goal;
  dea_solid_controls_goal(s, voltage_V, goal);
  return DEA_CHAIN(ctx, dea_continuation_create_to(ctx, s, goal, options, out));
}

void dea_solid_continuation_destroy(struct dea_context *ctx, struct dea_solid_continuation *t)
{
  if (t != NULL) {
    dea_arena_free(&t->memory);
    dea_free(ctx, t);
  }
}

/* ---- limit points and bifurcations ---- */

/* Between the point before and the last one: the direction from one to the other, fractions of it
 * that bracket the critical point, and what is to be 0 there. */
struct bracket {
  double *span; // [state_count]
  struct bulge bulge;
  double span_load, length, at[2], value[2];
  size_t mode; // of a bifurcation: the place of the critical one among all
};

/* What is 0 at the critical point, where the solid is; t->mode then is the critical mode. */
static dea_status measure_critical(struct dea_context *ctx, struct dea_solid_continuation *t,
                                   const struct bracket *b, double *value)
{
  struct dea_solid *s = t->s;
  DEA_TRY(ctx, record_point(ctx, t, b->span, b->span_load, false, &t->critical));
  *value = t->critical.point.slope;
  if (t->event == DEA_CONTINUATION_LIMIT) {
    return DEA_OK;
  }
  size_t count = b->mode + 1, dofs = 3 * s->problem.grid->node_count;
  double values[DEA_MODES_MAX];
  double *vectors = dea_solid_alloc(ctx, count * dofs, sizeof *vectors);
  DEA_TRY_MEMORY(vectors != NULL);
  dea_status status = dea_solid_modes_lowest(ctx, s, DEA_MODES_BY_VOLUME, count, values, vectors);
  *value = values[b->mode];
  memcpy(t->mode, vectors + b->mode * dofs, dofs * sizeof *t->mode);
  dea_free(ctx, vectors);
  return status;
}

/* The bow of the parabola whose tangent at the far end is the path's. */
static void bow_by_tangent(const struct dea_solid_continuation *t, struct bracket *b)
{
  double along = t->tangent_load * b->span_load;
  for (size_t i = 0; i < t->s->problem.dofs; i++) {
    along += t->metric[i] * t->tangent[i] * b->span[i];
  }
  const double whole = b->length * b->length / along;
  memset(b->bulge.state, 0, t->s->work.load_steps.state_count * sizeof *b->bulge.state);
  for (size_t i = 0; i < t->s->problem.dofs && along > 0; i++) {
    b->bulge.state[i] = whole * t->tangent[i] - b->span[i];
  }
  b->bulge.load = along > 0 ? whole * t->tangent_load - b->span_load : 0;
}

/* The bulge of that through the point which was found at a fraction of the span. */
static void bow_by_point(const struct dea_solid_continuation *t, struct bracket *b, double fraction)
{
  const struct dea_continuation_path_point *at = &t->critical, *from = &t->before;
  const double parabola = fraction * (fraction - 1);
  for (size_t i = 0; i < t->s->work.load_steps.state_count; i++) {
    b->bulge.state[i] = (at->state[i] - from->state[i] - fraction * b->span[i]) / parabola;
  }
  b->bulge.load = (at->point.load - from->point.load - fraction * b->span_load) / parabola;
}

/* The equilibrium at a fraction of the span. */
static dea_status solve_at_share(struct dea_context *ctx, struct dea_solid_continuation *t,
                                 const struct bracket *b, double fraction)
{
  set_plane(t, b->span, b->span_load, &t->before, fraction * b->length, 0);
  t->critical.point.arc = t->before.point.arc + fraction * b->length;
  return DEA_CHAIN(ctx, solve_between(ctx, t, fraction, &b->bulge));
}

/* The same beside the fraction where there is none at it: where a mode other than the path's loses
 * its stiffness K is singular on the plane too, and what rounding leaves along the mode grows. */
static dea_status solve_near_share(struct dea_context *ctx, struct dea_solid_continuation *t,
                                   const struct bracket *b, double *fraction)
{
  dea_status status = solve_at_share(ctx, t, b, *fraction);
  bool first_half = *fraction - b->at[0] < b->at[1] - *fraction;
  double by = (first_half ? singular_offset : -singular_offset) * (b->at[1] - b->at[0]),
         from = *fraction;
  for (int i = 0; i < MAX_OFFSETS && dea_solid_may_shorten(status); i++, by *= 2) {
    dea_context_clear(ctx);
    *fraction = from + by;
    status = solve_at_share(ctx, t, b, *fraction);
  }
  return status;
}

static double next_share(const struct bracket *b)
{
  return b->at[0] + (b->at[1] - b->at[0]) * b->value[0] / (b->value[0] - b->value[1]);
}

/* Regula falsi, with the older end's value halved while it stays (Illinois), until the next
 * fraction would be this one. A value between the two ends that is larger than at both is that of a
 * K which is singular to rounding: there it is. */
static dea_status close_in(struct dea_context *ctx, struct dea_solid_continuation *t,
                           struct bracket *b)
{
  const struct dea_solid_settings *o = &t->s->settings;
  double seen[2] = {fabs(b->value[0]), fabs(b->value[1])}, first = fmax(seen[0], seen[1]);
  double value = NAN, fraction = next_share(b);
  double enough = t->event == DEA_CONTINUATION_LIMIT ? o->limit_point_rtol : o->bifurcation_rtol;
  int stays = -1;
  for (int i = 0; i < MAX_ROUNDS; i++) {
    DEA_TRY(ctx, solve_near_share(ctx, t, b, &fraction));
    DEA_TRY(ctx, measure_critical(ctx, t, b, &value));
    int end = (value < 0) == (b->value[0] < 0) ? 0 : 1;
    b->at[end] = fraction;
    b->value[end] = value;
    if (stays == 1 - end) {
      b->value[1 - end] /= 2;
    }
    stays = 1 - end;
    bow_by_point(t, b, fraction);
    double next = next_share(b);
    if (fabs(next - fraction) < enough || fabs(value) < zero_rtol * first ||
        fabs(value) > fmax(seen[0], seen[1])) {
      return DEA_OK;
    }
    seen[end] = fabs(value);
    fraction = next;
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the critical point could not be closed in on");
}

static dea_status locate_between(struct dea_context *ctx, struct dea_solid_continuation *t,
                                 struct bracket *b)
{
  const struct dea_continuation_path_point *ends[2] = {&t->before, &t->last};
  const int modes[2] = {t->before.point.unstable_modes, t->last.point.unstable_modes};
  for (size_t i = 0; i < t->s->work.load_steps.state_count; i++) {
    b->span[i] = ends[1]->state[i] - ends[0]->state[i];
  }
  b->span_load = ends[1]->point.load - ends[0]->point.load;
  b->length = hypot(size_of(t, b->span), b->span_load);
  bow_by_tangent(t, b);
  b->at[1] = 1;
  b->mode = (size_t)(modes[0] < modes[1] ? modes[0] : modes[1]);
  if (t->event == DEA_CONTINUATION_BIFURCATION && b->mode >= DEA_MODES_MAX) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "%zu modes are unstable already", b->mode);
  }
  for (int k = 0; k < 2; k++) {
    b->value[k] = ends[k]->point.slope;
    if (t->event == DEA_CONTINUATION_BIFURCATION) {
      DEA_TRY(ctx, return_to(ctx, t, ends[k]));
      DEA_TRY(ctx, measure_critical(ctx, t, b, &b->value[k]));
    }
  }
  if (b->value[0] * b->value[1] > 0) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no change of sign between the two points");
  }
  return DEA_CHAIN(ctx, close_in(ctx, t, b));
}

dea_status dea_solid_continuation_locate(struct dea_context *ctx, struct dea_solid_continuation *t,
                                         struct dea_continuation_point *point)
{
  struct bracket b = {.span = t->span, .bulge.state = t->bulge};
  if (t->event == DEA_CONTINUATION_NOTHING) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the last step has passed no critical point");
  }
  dea_status status = locate_between(ctx, t, &b);
  if (status != DEA_OK) {
    dea_solid_state_set(t->s, t->last.state);
    dea_solid_forget(t->s);
    set_controls(NULL, t, t->last.point.load); // where it was
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *point = t->critical.point;
  point->passed = t->event;
  return DEA_OK;
}

/* An equilibrium in a plane: Newton on displacements and load together (docs/theory/branches.md).
 */
#include "model/solid/equilibrium/continuation.h"

#include <math.h>
#include <string.h>

enum { ITERATIONS_MAX = 15, HIDDEN_MANY = 3 };

static const double residual_small = 1e-8; // of the sum of element forces: what kappa leaves
static const double harder = 16;           // kappa on the way
static const double step_small = 1e-10;    // of the solid's length
static const double plane_small = 1e-9;    // of the distance to the plane
static const double theta_small = 1e-2 * DEA_SOLID_THETA_SMALL; // kappa theta is no pressure then
static const double difference = 1e-5;                          // of tau, for the force by tau

dea_status dea_continuation_load(struct dea_context *ctx, struct dea_solid_continuation *t,
                                 double tau)
{
  struct dea_solid *s = t->s;
  double square = t->from[0] * t->from[0] * (1 - tau) + t->goal[0] * t->goal[0] * tau;
  double least = -1e-9 * fmax(t->from[0] * t->from[0], t->goal[0] * t->goal[0]);
  if (square < least) {
    return dea_fail(ctx, DEA_E_DOMAIN, "the path ends at 0 V");
  }
  for (size_t i = 1; i < s->path.control_count; i++) {
    t->now[i] = t->from[i] + tau * (t->goal[i] - t->from[i]);
  }
  t->now[0] = sqrt(fmax(square, 0));
  t->load = tau;
  dea_solid_controls_set(s, t->now);
  if (dea_solid_controls_increment(s, t->now)) {
    for (size_t i = 0; i < s->dofs; i++) {
      s->u[i] += s->drive[i];
    }
  }
  return DEA_OK;
}

/* t->right = -dg/d tau at the displacements as they are, by a difference: g is linear in the square
 * of the voltage and in dead loads. */
static dea_status force_rate(struct dea_context *ctx, struct dea_solid_continuation *t)
{
  struct dea_solid *s = t->s;
  double energy, tau = t->load, by = difference;
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->voltage_V, DEA_FORCE, &energy));
  memcpy(t->right, s->g, s->dofs * sizeof(double));
  if (dea_continuation_load(ctx, t, tau + by) != DEA_OK) {
    dea_context_clear(ctx);
    by = -by;
    DEA_TRY(ctx, dea_continuation_load(ctx, t, tau + by));
  }
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->voltage_V, DEA_FORCE, &energy));
  for (size_t i = 0; i < s->dofs; i++) {
    t->right[i] = (t->right[i] - s->g[i]) / by;
  }
  DEA_TRY(ctx, dea_continuation_load(ctx, t, tau));
  return DEA_OK;
}

/* t->rate = du/d tau with the factor that is there, from t->right. */
static dea_status displacement_rate(struct dea_context *ctx, struct dea_solid_continuation *t)
{
  DEA_TRY(ctx, dea_solid_solve_linear(ctx, t->s, t->right, t->rate));
  for (size_t i = 0; i < t->s->dofs; i++) {
    t->rate[i] += t->held_rate[i];
  }
  return DEA_OK;
}

dea_status dea_continuation_evaluate(struct dea_context *ctx, struct dea_solid_continuation *t,
                                     int *modes)
{
  struct dea_solid *s = t->s;
  s->predicted_fits = s->factor_fits = false;
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->voltage_V, DEA_FORCE, &t->energy_J));
  dea_solid_raise_bulk_modulus(s);
  double energy;
  dea_status status = force_rate(ctx, t);
  if (status == DEA_OK) {
    status = dea_solid_assemble(ctx, s, s->voltage_V, DEA_TANGENT, &energy);
  }
  dea_solid_restore_bulk_modulus(s);
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, dea_solid_factorise(ctx, s, modes));
  DEA_TRY(ctx, displacement_rate(ctx, t));
  return DEA_OK;
}

/* What the plane's equation is off by. */
static double off_plane(const struct dea_solid_continuation *t)
{
  const struct dea_continuation_plane *plane = &t->plane;
  double off = plane->load * (t->load - plane->tau0) - plane->length;
  for (size_t i = 0; i < t->s->dofs; i++) {
    off += plane->weight[i] * (t->s->u[i] - plane->u0[i]);
  }
  return off;
}

/* s->step and *dtau: the Newton step of g = 0 and of the plane's equation, with K factorised. */
static dea_status bordered(struct dea_context *ctx, struct dea_solid_continuation *t, double *dtau)
{
  struct dea_solid *s = t->s;
  const struct dea_continuation_plane *plane = &t->plane;
  double off = off_plane(t), along = plane->load;
  DEA_TRY(ctx, displacement_rate(ctx, t));
  for (size_t i = 0; i < s->dofs; i++) {
    s->trial[i] = -s->g[i];
  }
  DEA_TRY(ctx, dea_solid_solve_linear(ctx, s, s->trial, s->step));
  for (size_t i = 0; i < s->dofs; i++) {
    off += plane->weight[i] * s->step[i];
    along += plane->weight[i] * t->rate[i];
  }
  if (along == 0) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the path does not cross the plane");
  }
  *dtau = -off / along;
  for (size_t i = 0; i < s->dofs; i++) {
    s->step[i] += *dtau * t->rate[i];
  }
  return DEA_OK;
}

/* One iteration, unless *there: it is at an equilibrium in the plane. *small: the step was;
 * *hidden: from the energy, by rounding. */
static dea_status iterate(struct dea_context *ctx, struct dea_solid_continuation *t,
                          double *residual, bool *there, bool *small, bool *hidden)
{
  struct dea_solid *s = t->s;
  double dtau = 0, size = 0;
  int negative;
  DEA_TRY(ctx, force_rate(ctx, t));
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->voltage_V, DEA_TANGENT, &t->energy_J));
  *residual = sqrt(dea_solid_dot(s, s->g, s->g)) / (s->force_scale > 0 ? s->force_scale : 1);
  bool constrained = dea_solid_theta_max(s) < theta_small;
  *there = constrained && *residual < residual_small &&
           fabs(off_plane(t)) < plane_small * fabs(t->plane.length);
  if (*there) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_solid_factorise(ctx, s, &negative));
  DEA_TRY(ctx, bordered(ctx, t, &dtau));
  *hidden = constrained && !dea_solid_resolved(s, dea_solid_dot(s, s->g, s->step));
  DEA_TRY(ctx, dea_solid_predict(ctx, s, s->voltage_V, s->step, 1, true, true));
  for (size_t i = 0; i < s->dofs; i++) {
    s->u[i] += s->step[i];
    size = fmax(size, fabs(s->step[i]));
  }
  *small = constrained && size < step_small * s->length_m;
  DEA_TRY(ctx, dea_continuation_load(ctx, t, t->load + dtau));
  return DEA_OK;
}

/* With a large kappa, multipliers that are pressures and predicted stresses this is Newton's
 * method on displacements, pressures and load. */
static dea_status newton(struct dea_context *ctx, struct dea_solid_continuation *t, int *iterations)
{
  double residual = 0;
  int in_a_row = 0; // hidden steps
  for (*iterations = 1; *iterations <= ITERATIONS_MAX; ++*iterations) {
    bool there = false, small = false, hidden = false;
    DEA_TRY(ctx, iterate(ctx, t, &residual, &there, &small, &hidden));
    in_a_row = hidden ? in_a_row + 1 : 0;
    if ((there || in_a_row >= HIDDEN_MANY || (small && *iterations > 1)) &&
        dea_solid_update_loads(t->s) <= 1) {
      return DEA_OK;
    }
  }
  *iterations = ITERATIONS_MAX;
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no equilibrium in the plane (residual %.1e)",
                  residual);
}

dea_status dea_continuation_correct(struct dea_context *ctx, struct dea_solid_continuation *t,
                                    int *iterations)
{
  dea_solid_scale_bulk_modulus(t->s, harder);
  dea_status status = newton(ctx, t, iterations);
  dea_solid_scale_bulk_modulus(t->s, 1 / harder);
  t->s->predicted_fits = false;
  return status;
}

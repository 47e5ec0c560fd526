/* An equilibrium in a plane: Newton on displacements and load together (docs/theory/branches.md).
 */
#include "model/solid/solve/trace.h"

#include <math.h>
#include <string.h>

enum { ITERATIONS_MAX = 15, FAR = 4 };

static const double residual_small = 1e-9; // of the sum of element forces
static const double step_small = 1e-10;    // of the solid's length
static const double difference = 1e-5;     // of tau, for the force by tau

dea_status dea_trace_load(struct dea_context *ctx, struct dea_solid_trace *t, double tau)
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
  if (dea_solid_controls_drive(s, t->now)) {
    for (size_t i = 0; i < s->dofs; i++) {
      s->u[i] += s->drive[i];
    }
  }
  return DEA_OK;
}

/* t->right = -dg/d tau at the displacements as they are, by a difference: g is linear in the square
 * of the voltage and in dead loads. */
static dea_status force_rate(struct dea_context *ctx, struct dea_solid_trace *t)
{
  struct dea_solid *s = t->s;
  double energy, tau = t->load, by = difference;
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->voltage_V, DEA_FORCE, &energy));
  memcpy(t->right, s->g, s->dofs * sizeof(double));
  if (dea_trace_load(ctx, t, tau + by) != DEA_OK) {
    dea_context_clear(ctx);
    by = -by;
    DEA_TRY(ctx, dea_trace_load(ctx, t, tau + by));
  }
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->voltage_V, DEA_FORCE, &energy));
  for (size_t i = 0; i < s->dofs; i++) {
    t->right[i] = (t->right[i] - s->g[i]) / by;
  }
  DEA_TRY(ctx, dea_trace_load(ctx, t, tau));
  return DEA_OK;
}

/* t->rate = du/d tau with the factor that is there, from t->right. */
static dea_status displacement_rate(struct dea_context *ctx, struct dea_solid_trace *t)
{
  DEA_TRY(ctx, dea_solid_solve_linear(ctx, t->s, t->right, t->rate));
  for (size_t i = 0; i < t->s->dofs; i++) {
    t->rate[i] += t->held_rate[i];
  }
  return DEA_OK;
}

dea_status dea_trace_look(struct dea_context *ctx, struct dea_solid_trace *t, int *modes)
{
  struct dea_solid *s = t->s;
  s->predicted_fits = s->factor_fits = false;
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->voltage_V, DEA_FORCE, &t->energy_J));
  dea_solid_stiffen(s);
  double energy;
  dea_status status = force_rate(ctx, t);
  if (status == DEA_OK) {
    status = dea_solid_assemble(ctx, s, s->voltage_V, DEA_TANGENT, &energy);
  }
  dea_solid_unstiffen(s);
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, dea_solid_factorise(ctx, s, modes));
  DEA_TRY(ctx, displacement_rate(ctx, t));
  return DEA_OK;
}

/* s->step and *dtau: the Newton step of g = 0 and of the plane's equation, with K factorised. */
static dea_status bordered(struct dea_context *ctx, struct dea_solid_trace *t, double *dtau)
{
  struct dea_solid *s = t->s;
  const struct dea_trace_plane *plane = &t->plane;
  double off = plane->load * (t->load - plane->tau0) - plane->length;
  double along = plane->load;
  DEA_TRY(ctx, displacement_rate(ctx, t));
  for (size_t i = 0; i < s->dofs; i++) {
    s->trial[i] = -s->g[i];
  }
  DEA_TRY(ctx, dea_solid_solve_linear(ctx, s, s->trial, s->step));
  for (size_t i = 0; i < s->dofs; i++) {
    off += plane->weight[i] * (s->u[i] + s->step[i] - plane->u0[i]);
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

/* One iteration. stresses: whether the next one predicts them. *size: largest displacement. */
static dea_status iterate(struct dea_context *ctx, struct dea_solid_trace *t, bool stresses,
                          double *residual, double *theta, double *size)
{
  struct dea_solid *s = t->s;
  double dtau = 0;
  int negative;
  DEA_TRY(ctx, force_rate(ctx, t));
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->voltage_V, DEA_TANGENT, &t->energy_J));
  *residual = sqrt(dea_solid_dot(s, s->g, s->g)) / (s->force_scale > 0 ? s->force_scale : 1);
  *theta = dea_solid_theta_max(s);
  DEA_TRY(ctx, dea_solid_factorise(ctx, s, &negative));
  DEA_TRY(ctx, bordered(ctx, t, &dtau));
  DEA_TRY(ctx, dea_solid_predict(ctx, s, s->voltage_V, s->step, 1, stresses, true));
  *size = 0;
  for (size_t i = 0; i < s->dofs; i++) {
    s->u[i] += s->step[i];
    *size = fmax(*size, fabs(s->step[i]));
  }
  DEA_TRY(ctx, dea_trace_load(ctx, t, t->load + dtau));
  return DEA_OK;
}

dea_status dea_trace_correct(struct dea_context *ctx, struct dea_solid_trace *t, int *iterations)
{
  struct dea_solid *s = t->s;
  double residual = 0, theta = 0, size = 0;
  for (*iterations = 1; *iterations <= ITERATIONS_MAX; ++*iterations) {
    DEA_TRY(ctx, iterate(ctx, t, *iterations < FAR, &residual, &theta, &size));
    bool there = *iterations > 1 && theta < DEA_SOLID_THETA_SMALL &&
                 (residual < residual_small || size < step_small * s->length_m);
    if (there && dea_solid_update_loads(s) <= 1) {
      return DEA_OK;
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no equilibrium in the plane (residual %.1e)",
                  residual);
}

/* Minimum of the energy at fixed multipliers: Newton with shift and line search. */
#include "model/solid/solve/internal.h"

#include <math.h>
#include <string.h>

enum { NEWTON_MAX = 60, SHIFTS_MAX = 40, HALVINGS_MAX = 30 };

static const double residual_small = 1e-9; // of the sum of element forces
static const double energy_small = 1e-11;  // change of the energy that rounding hides

/* Moves u along the step as far as the energy falls enough (Armijo). A fall that the energy cannot
 * resolve is not looked for: the whole step is taken. */
static dea_status line_search(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                              double energy)
{
  double slope = dea_solid_dot(s, s->g, s->step), length = 1;
  bool resolved = -slope > energy_small * s->energy_scale;
  for (int i = 0; i < HALVINGS_MAX; i++, length /= 2) {
    double trial_energy;
    for (size_t k = 0; k < s->dofs; k++) {
      s->trial[k] = s->u[k] + length * s->step[k];
    }
    if (dea_solid_settle(ctx, s, voltage_V, s->trial) == DEA_OK &&
        dea_solid_energy(s, s->trial, voltage_V, &trial_energy) == DEA_OK &&
        (!resolved || trial_energy <= energy + 1e-4 * length * slope)) {
      memcpy(s->u, s->trial, s->dofs * sizeof(double));
      return DEA_OK;
    }
  }
  return DEA_E_NOT_CONVERGED;
}

/* Factor of K, shifted until it is positive definite; *unshifted: negative pivots without shift. */
static dea_status factorise_definite(struct dea_context *ctx, struct dea_solid *s, int *unshifted,
                                     struct dea_solid_report *report)
{
  int negative;
  double amount = s->last_shift > 0 ? s->last_shift / 4 : 1e-4, total = 0;
  DEA_TRY(ctx, dea_solid_factorise(ctx, s, unshifted));
  report->factorisations++;
  negative = *unshifted;
  for (int i = 0; negative > 0; i++) {
    if (i == SHIFTS_MAX) {
      return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no shift makes the tangent positive definite");
    }
    DEA_TRY(ctx, dea_solid_shift(ctx, s, amount - total));
    total = amount;
    s->last_shift = amount;
    amount *= 4;
    DEA_TRY(ctx, dea_solid_factorise(ctx, s, &negative));
    report->factorisations++;
    report->shifted++;
  }
  return DEA_OK;
}

dea_status dea_solid_minimise(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                              struct dea_solid_report *report)
{
  DEA_TRY(ctx, dea_solid_settle(ctx, s, voltage_V, s->u));
  for (int i = 0; i < NEWTON_MAX; i++) {
    DEA_TRY(ctx, dea_solid_assemble(ctx, s, voltage_V, DEA_TANGENT, &report->energy_J));
    report->residual =
        sqrt(dea_solid_dot(s, s->g, s->g)) / (s->force_scale > 0 ? s->force_scale : 1);
    if (report->residual < residual_small && i > 0) {
      return DEA_OK;
    }
    DEA_TRY(ctx, factorise_definite(ctx, s, &report->unstable_modes, report));
    for (size_t k = 0; k < s->dofs; k++) {
      s->trial[k] = -s->g[k];
    }
    DEA_TRY(ctx, dea_solid_solve_linear(ctx, s, s->trial, s->step));
    report->iterations++;
    if (line_search(ctx, s, voltage_V, report->energy_J) != DEA_OK) {
      return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the line search found no lower energy");
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no equilibrium after %d iterations (residual %.1e)",
                  NEWTON_MAX, report->residual);
}

dea_status dea_solid_drive(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                           struct dea_solid_report *report)
{
  double energy;
  int unshifted;
  DEA_TRY(ctx, dea_solid_settle(ctx, s, voltage_V, s->u));
  s->driven = true;
  dea_status status = dea_solid_assemble(ctx, s, voltage_V, DEA_TANGENT, &energy);
  s->driven = false;
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, factorise_definite(ctx, s, &unshifted, report));
  for (size_t i = 0; i < s->dofs; i++) {
    s->trial[i] = -s->g[i];
  }
  DEA_TRY(ctx, dea_solid_solve_linear(ctx, s, s->trial, s->step));
  // where the whole of the linear step leads too far the held components go their way all the same
  for (double length = 1; length > 0.1; length /= 2) {
    for (size_t i = 0; i < s->dofs; i++) {
      s->trial[i] = s->u[i] + s->drive[i] + length * s->step[i];
    }
    if (dea_solid_energy(s, s->trial, voltage_V, &energy) == DEA_OK) {
      memcpy(s->u, s->trial, s->dofs * sizeof(double));
      return DEA_OK;
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the prescribed displacements invert an element");
}

double dea_solid_update_multipliers(struct dea_solid *s)
{
  double largest = 0;
  for (size_t e = 0; e < s->grid->element_count; e++) {
    const struct dea_layer *layer = &s->layers[s->layer[e]];
    for (int m = 0; m < s->shape.pressures && layer->law != NULL; m++) {
      size_t at = e * (size_t)s->shape.pressures + (size_t)m;
      s->multiplier[at] += layer->kappa_Pa * s->theta[at];
      largest = fmax(largest, fabs(s->theta[at]));
    }
  }
  return largest;
}

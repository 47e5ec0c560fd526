/* Equilibria: factorisation, Newton, multipliers, steps of the voltage. */
#include "model/solid/solve/internal.h"

#include <math.h>
#include <string.h>

enum { NEWTON_MAX = 60, OUTER_MAX = 12, SHIFTS_MAX = 40, HALVINGS_MAX = 30 };

static const double residual_small = 1e-9;    // of the sum of element forces
static const double theta_small = 1e-7;       // of J - 1
static const double energy_small = 1e-11;     // change of the energy that rounding hides
static const double step_smallest = 1.0 / 64; // of a voltage step asked for

/* ---- linear algebra ---- */

static dea_status factorise(struct dea_context *ctx, struct dea_solid *s, int *negative)
{
  MatFactorInfo info;
  PetscInt minus, zero, plus;
  MatFactorInfoInitialize(&info);
  if (!s->analysed) {
    DEA_TRY(ctx, dea_solid_petsc(
                     ctx, MatGetFactor(s->K, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, &s->factor),
                     "MatGetFactor"));
    MatMumpsSetIcntl(s->factor, 24, 1); // null pivots and
    MatMumpsSetIcntl(s->factor, 13, 1); // no parallel root, so that the inertia is counted
    DEA_TRY(ctx, dea_solid_petsc(ctx, MatCholeskyFactorSymbolic(s->factor, s->K, NULL, &info),
                                 "MatCholeskyFactorSymbolic"));
    s->analysed = true;
  }
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatCholeskyFactorNumeric(s->factor, s->K, &info),
                               "MatCholeskyFactorNumeric"));
  DEA_TRY(ctx,
          dea_solid_petsc(ctx, MatGetInertia(s->factor, &minus, &zero, &plus), "MatGetInertia"));
  *negative = (int)(minus + zero);
  return DEA_OK;
}

/* K += amount times the metric. */
static dea_status shift(struct dea_context *ctx, struct dea_solid *s, double amount)
{
  PetscScalar *values;
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecGetArray(s->right, &values), "VecGetArray"));
  for (size_t i = 0; i < s->dofs; i++) {
    values[i] = amount * s->metric[i];
  }
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecRestoreArray(s->right, &values), "VecRestoreArray"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatDiagonalSet(s->K, s->right, ADD_VALUES), "MatDiagonalSet"));
  return DEA_OK;
}

/* step = -K^-1 g with the present factor. */
static dea_status solve_linear(struct dea_context *ctx, struct dea_solid *s)
{
  PetscScalar *values;
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecGetArray(s->right, &values), "VecGetArray"));
  for (size_t i = 0; i < s->dofs; i++) {
    values[i] = -s->g[i];
  }
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecRestoreArray(s->right, &values), "VecRestoreArray"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatSolve(s->factor, s->right, s->solution), "MatSolve"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecGetArray(s->solution, &values), "VecGetArray"));
  memcpy(s->step, values, s->dofs * sizeof(double));
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecRestoreArray(s->solution, &values), "VecRestoreArray"));
  return DEA_OK;
}

/* ---- Newton ---- */

/* Moves u along the step as far as the energy falls enough (Armijo). A fall that the energy cannot
 * resolve is not looked for: the whole step is taken. */
static dea_status line_search(struct dea_solid *s, double voltage_V, double energy)
{
  double slope = dea_solid_dot(s, s->g, s->step), length = 1;
  bool resolved = -slope > energy_small * s->energy_scale;
  for (int i = 0; i < HALVINGS_MAX; i++, length /= 2) {
    double trial_energy;
    for (size_t k = 0; k < s->dofs; k++) {
      s->trial[k] = s->u[k] + length * s->step[k];
    }
    if (dea_solid_energy(s, s->trial, voltage_V, &trial_energy) == DEA_OK &&
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
  DEA_TRY(ctx, factorise(ctx, s, unshifted));
  report->factorisations++;
  negative = *unshifted;
  for (int i = 0; negative > 0; i++) {
    if (i == SHIFTS_MAX) {
      return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no shift makes the tangent positive definite");
    }
    DEA_TRY(ctx, shift(ctx, s, amount - total));
    total = amount;
    s->last_shift = amount;
    amount *= 4;
    DEA_TRY(ctx, factorise(ctx, s, &negative));
    report->factorisations++;
    report->shifted++;
  }
  return DEA_OK;
}

/* Minimum of the energy with the multipliers as they are. */
static dea_status minimise(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                           struct dea_solid_report *report)
{
  for (int i = 0; i < NEWTON_MAX; i++) {
    DEA_TRY(ctx, dea_solid_assemble(ctx, s, voltage_V, &report->energy_J));
    report->residual =
        sqrt(dea_solid_dot(s, s->g, s->g)) / (s->force_scale > 0 ? s->force_scale : 1);
    if (report->residual < residual_small && i > 0) {
      return DEA_OK;
    }
    DEA_TRY(ctx, factorise_definite(ctx, s, &report->unstable_modes, report));
    DEA_TRY(ctx, solve_linear(ctx, s));
    report->iterations++;
    if (line_search(s, voltage_V, report->energy_J) != DEA_OK) {
      return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the line search found no lower energy");
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no equilibrium after %d iterations (residual %.1e)",
                  NEWTON_MAX, report->residual);
}

/* The multipliers take over kappa theta; returns the largest theta. */
static double update_multipliers(struct dea_solid *s)
{
  double largest = 0;
  for (size_t e = 0; e < s->grid->element_count; e++) {
    const struct dea_hex_layer *layer = &s->layers[s->layer[e]];
    for (int m = 0; m < s->shape.pressures && layer->law != NULL; m++) {
      size_t at = e * (size_t)s->shape.pressures + (size_t)m;
      s->multiplier[at] += layer->kappa_Pa * s->theta[at];
      largest = fmax(largest, fabs(s->theta[at]));
    }
  }
  return largest;
}

/* A start for the voltage from the last two equilibria: displacements and pressures go about with
 * V^2. false: too far, or an element would be inverted; nothing has changed then. */
static bool predict(struct dea_solid *s, double voltage_V)
{
  double span = s->voltage_V * s->voltage_V - s->voltage_before_V * s->voltage_before_V;
  double rise = voltage_V * voltage_V - s->voltage_V * s->voltage_V, energy;
  if (s->solved < 2 || !(fabs(rise) <= 2.5 * fabs(span)) || span == 0) {
    return false;
  }
  for (size_t i = 0; i < s->dofs; i++) {
    s->trial[i] = s->u[i] + rise / span * (s->u[i] - s->before[i]);
  }
  if (dea_solid_energy(s, s->trial, voltage_V, &energy) != DEA_OK) {
    return false;
  }
  memcpy(s->u, s->trial, s->dofs * sizeof(double));
  const double *pressure_before = s->before + s->dofs;
  for (size_t i = 0; i < dea_solid_pressure_count(s); i++) {
    s->multiplier[i] += rise / span * (s->multiplier[i] - pressure_before[i]);
  }
  return true;
}

/* One voltage, without smaller steps; the solid stays as it was when it fails. */
static dea_status solve_at(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                           double *keep, struct dea_solid_report *report)
{
  size_t pressures = dea_solid_pressure_count(s);
  memcpy(keep, s->u, s->dofs * sizeof *keep);
  memcpy(keep + s->dofs, s->multiplier, pressures * sizeof *keep);
  predict(s, voltage_V);
  dea_status status = DEA_OK;
  for (int i = 0; i < OUTER_MAX && status == DEA_OK; i++) {
    status = minimise(ctx, s, voltage_V, report);
    if (status == DEA_OK) {
      report->theta_max = update_multipliers(s);
      if (report->theta_max < theta_small) {
        break;
      }
    }
  }
  if (status != DEA_OK) {
    memcpy(s->u, keep, s->dofs * sizeof *keep);
    memcpy(s->multiplier, keep + s->dofs, pressures * sizeof *keep);
    return status;
  }
  memcpy(s->before, keep, (s->dofs + pressures) * sizeof *keep);
  s->voltage_before_V = s->voltage_V;
  s->voltage_V = voltage_V;
  s->solved += s->solved < 2;
  return DEA_OK;
}

dea_status dea_solid_solve(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                           struct dea_solid_report *report)
{
  *report = (struct dea_solid_report){0};
  double *keep = dea_alloc(ctx, s->dofs + dea_solid_pressure_count(s), sizeof *keep);
  if (keep == NULL) {
    return DEA_E_MEMORY;
  }
  double whole = voltage_V - s->voltage_V, part = whole;
  dea_status status;
  do {
    bool last = fabs(voltage_V - s->voltage_V) <= fabs(part) * (1 + 1e-9);
    status = solve_at(ctx, s, last ? voltage_V : s->voltage_V + part, keep, report);
    if (status == DEA_OK && last) {
      break;
    }
    part *= status == DEA_OK ? 1 : 0.5;
  } while (fabs(part) >= step_smallest * fabs(whole) && whole != 0);
  dea_free(ctx, keep);
  return status;
}

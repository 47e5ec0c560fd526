/* From one voltage to the next: prediction, multipliers, smaller steps. */
#include "model/solid/solve/internal.h"

#include <math.h>
#include <string.h>

enum { OUTER_MAX = 12 };

static const double theta_small = 1e-7;       // of J - 1
static const double step_smallest = 1.0 / 64; // of a voltage step asked for

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
    status = dea_solid_minimise(ctx, s, voltage_V, report);
    if (status == DEA_OK) {
      report->theta_max = dea_solid_update_multipliers(s);
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
  DEA_TRY(ctx, dea_solid_check(ctx, s));
  double *keep = dea_alloc(ctx, s->dofs + dea_solid_pressure_count(s), sizeof *keep);
  dea_status status = dea_solid_agree(ctx, s, keep != NULL ? DEA_OK : DEA_E_MEMORY);
  if (status != DEA_OK) {
    dea_free(ctx, keep);
    return status;
  }
  double whole = voltage_V - s->voltage_V, part = whole;
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

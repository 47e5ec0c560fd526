#include "model/solid/adapter/compliance.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/potential.h"
#include "model/solid/equilibrium/adjoint.h"
#include "model/solid/equilibrium/modes.h"

#include <math.h>
#include <string.h>

enum { COORDINATE, VOLTAGE, ANSWERS };

struct work {
  struct dea_solid *solid;
  struct dea_adjoint *adjoint;
  double *rate; // [dofs] dR/dV
  double voltage_V;
};

/* Residuals and energy are of second degree in the voltage, so that central differences over any
 * step are exact: dR/dV, and of the energy at fixed unknowns the first and the second slope. */
static dea_status find_rate(struct dea_context *ctx, struct work *w, double by_energy[2])
{
  struct dea_solid *s = w->solid;
  const double step_V = fmax(fabs(w->voltage_V), 1e3);
  double energy_J[3] = {0};
  dea_status status = DEA_OK;
  for (int side = -1; side <= 1 && status == DEA_OK; side++) {
    s->state.voltage_V = w->voltage_V + side * step_V;
    status = dea_adjoint_assemble(ctx, w->adjoint, s->state.voltage_V, &energy_J[side + 1]);
    for (size_t i = 0; i < s->problem.dofs; i++) {
      w->rate[i] += side * s->work.g[i] / (2 * step_V);
    }
  }
  s->state.voltage_V = w->voltage_V;
  DEA_TRY(ctx, status);
  by_energy[0] = (energy_J[2] - energy_J[0]) / (2 * step_V);
  by_energy[1] = (energy_J[2] - 2 * energy_J[1] + energy_J[0]) / (step_V * step_V);
  return DEA_OK;
}

/* The frequency of the mode that has the largest part of the coordinate's compliance, the sum of
 * (phi . slope)^2/omega^2, with that in out->mode_share. */
static dea_status find_mode(struct dea_context *ctx, struct work *w, const double *slope,
                            double *mode, struct dea_compliance *out)
{
  enum { MODES = 6 };
  const size_t dofs = w->solid->problem.dofs;
  double square[MODES], largest = 0, *vector = dea_solid_alloc(ctx, MODES * dofs, sizeof *vector);
  dea_status status = vector == NULL ? DEA_E_MEMORY
                                     : dea_solid_modes_whole(ctx, w->solid, DEA_MODES_BY_MASS,
                                                             MODES, square, vector);
  for (size_t k = 0; k < MODES && status == DEA_OK; k++) {
    const double along = dea_solid_dot(w->solid, vector + k * dofs, slope);
    if (square[k] > 0 && along * along / square[k] > largest) {
      largest = along * along / square[k];
      out->mode_share = largest;
      out->frequency_Hz = sqrt(square[k]) / (2 * acos(-1.0));
      memcpy(mode, vector + k * dofs, dofs * sizeof *mode);
    }
  }
  dea_free(ctx, vector);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

/* du/dF = K^-1 q_u / copies, du/dV = -K^-1 R_V. */
static dea_status find(struct dea_context *ctx, struct work *w, double copies, const double *slope,
                       const double *mode, struct dea_compliance *out)
{
  const size_t size = w->solid->problem.dofs * sizeof(double);
  static const bool wanted[ANSWERS] = {true, true};
  double by_energy[2] = {0};
  DEA_TRY(ctx, find_rate(ctx, w, by_energy));
  memcpy(dea_adjoint_slope(w->adjoint, COORDINATE), slope, size);
  memcpy(dea_adjoint_slope(w->adjoint, VOLTAGE), w->rate, size);
  DEA_TRY(ctx, dea_adjoint_solve(ctx, w->adjoint, wanted));
  const double *by_force = dea_adjoint_answer(w->adjoint, COORDINATE),
               *by_rate = dea_adjoint_answer(w->adjoint, VOLTAGE);
  const double compliance = dea_solid_dot(w->solid, by_force, slope);
  out->by_force = compliance / copies;
  out->by_voltage = -dea_solid_dot(w->solid, by_force, w->rate);
  out->charge_by_force = -dea_solid_dot(w->solid, by_rate, slope);
  out->charge_C = -copies * by_energy[0];
  out->charge_by_voltage = copies * (dea_solid_dot(w->solid, by_rate, w->rate) - by_energy[1]);
  if (mode != NULL) { // du/dV has the part -phi (phi . R_V)/omega^2 of it
    const double along = dea_solid_dot(w->solid, mode, slope), square = along * along;
    out->voltage_share = -out->mode_share / square * along *
                         dea_solid_dot(w->solid, mode, w->rate) / out->by_voltage;
    out->mode_share /= compliance;
  }
  return DEA_OK;
}

dea_status dea_compliance_find(struct dea_context *ctx, struct dea_solid *solid, double copies,
                               double voltage_V, const double *slope, bool with_mass,
                               struct dea_compliance *out)
{
  struct work w = {.solid = solid, .voltage_V = voltage_V};
  double energy_J;
  out->frequency_Hz = out->mode_share = out->voltage_share = NAN;
  w.rate = dea_solid_alloc(ctx, 2 * solid->problem.dofs, sizeof *w.rate);
  double *mode = w.rate + solid->problem.dofs;
  dea_status status = w.rate == NULL ? DEA_E_MEMORY : DEA_OK;
  if (status == DEA_OK && with_mass) { // first: it needs a factor of its own
    status = find_mode(ctx, &w, slope, mode, out);
  }
  status = status == DEA_OK ? dea_adjoint_create(ctx, solid, ANSWERS, &w.adjoint) : status;
  status = status == DEA_OK ? find(ctx, &w, copies, slope, with_mass ? mode : NULL, out) : status;
  dea_solid_hold_potential(solid, voltage_V, solid->state.u);
  if (status == DEA_OK) { // reactions are those of the equilibrium again
    status = dea_solid_assemble(ctx, solid, voltage_V, DEA_FORCE, &energy_J);
  }
  dea_adjoint_destroy(ctx, w.adjoint);
  dea_free(ctx, w.rate);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

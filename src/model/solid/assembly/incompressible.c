#include "model/solid/assembly/incompressible.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/matrix.h"

#include <math.h>

double dea_solid_theta_max(const struct dea_solid *s)
{
  return dea_largest(dea_solid_pressure_count(s), s->state.theta);
}

void dea_solid_update_multipliers(struct dea_solid *s)
{
  size_t pressures = (size_t)s->problem.elements.pressures;
  for (size_t i = 0; i < dea_solid_pressure_count(s); i++) {
    s->state.multiplier[i] += dea_solid_bulk_modulus(s, i / pressures) * s->state.theta[i];
  }
}

void dea_solid_change_bulk_modulus(struct dea_solid *s, double factor)
{
  size_t pressures = (size_t)s->problem.elements.pressures;
  for (size_t i = 0; i < dea_solid_pressure_count(s); i++) {
    double kappa_Pa = dea_solid_bulk_modulus(s, i / pressures);
    s->state.multiplier[i] -= (factor - 1) * kappa_Pa * s->state.theta[i];
  }
  s->state.bulk_factor *= factor;
}

dea_status dea_solid_assemble_forces(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                                     double *energy)
{
  static const double dropped = 0x1p-100; // so little of kappa that kappa theta is no pressure
  s->state.bulk_factor *= dropped;
  dea_status status = dea_solid_assemble(ctx, s, voltage_V, DEA_FORCE, energy);
  s->state.bulk_factor /= dropped;
  return status;
}

dea_status dea_solid_assemble_stiff(struct dea_context *ctx, struct dea_solid *s)
{
  double energy;
  s->found.predicted_fits = s->found.factor_fits = false;
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_FORCE, &energy)); // for theta
  dea_solid_change_bulk_modulus(s, DEA_SOLID_STIFF);
  dea_status status = dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_TANGENT, &energy);
  dea_solid_change_bulk_modulus(s, 1.0 / DEA_SOLID_STIFF);
  return DEA_CHAIN(ctx, status);
}

dea_status dea_solid_factor_stiff(struct dea_context *ctx, struct dea_solid *s, int *negative)
{
  DEA_TRY(ctx, dea_solid_assemble_stiff(ctx, s));
  return DEA_CHAIN(ctx, dea_solid_factorise(ctx, s, DEA_FACTOR_EXACT, negative));
}

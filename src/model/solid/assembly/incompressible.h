/* How J = 1 is brought in: multipliers, the bulk modulus kappa, and the tangent of the solid as
 * good as incompressible, whose inertia counts the unstable modes (docs/theory/branches.md). */
#pragma once

#include "model/solid/assembly/problem.h"

/* kappa is raised by that where unstable modes are counted; a power of 2 leaves no rounding. */
enum { DEA_SOLID_STIFF = 128 };

/* Largest theta of the last assembly. */
double dea_solid_theta_max(const struct dea_solid *s);
/* The multipliers take over kappa theta. */
void dea_solid_update_multipliers(struct dea_solid *s);
/* Another kappa of all part materials, factor (a power of 2) times the present one, at the same
 * pressures; theta has to belong to u. With DEA_SOLID_STIFF the solid is as good as incompressible.
 */
void dea_solid_change_bulk_modulus(struct dea_solid *s, double factor);
/* Energy and forces at the pressures that the multipliers are, without those of kappa theta; theta
 * is still found. */
dea_status dea_solid_assemble_forces(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                                     double *energy);
/* K with a kappa so large that its inertia is that of the incompressible solid, at u. */
dea_status dea_solid_assemble_stiff(struct dea_context *ctx, struct dea_solid *s);
/* That, and its factor. */
dea_status dea_solid_factor_stiff(struct dea_context *ctx, struct dea_solid *s, int *negative);

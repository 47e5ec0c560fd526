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
/* Another kappa of all part materials, factor (a power of 2) times the present one. */
void dea_solid_scale_bulk_modulus(struct dea_solid *s, double factor);
/* kappa so small that kappa theta is no pressure, but theta is still found, and back. */
void dea_solid_drop_bulk_modulus(struct dea_solid *s);
void dea_solid_restore_dropped_bulk_modulus(struct dea_solid *s);
/* kappa so large that the solid is as good as incompressible, at the same pressures, and back;
 * theta has to belong to u. at_pressure: back with multipliers that are the
 * pressures by themselves. */
void dea_solid_raise_bulk_modulus(struct dea_solid *s);
void dea_solid_restore_bulk_modulus(struct dea_solid *s);
void dea_solid_restore_bulk_modulus_at_pressure(struct dea_solid *s);
/* K with a kappa so large that its inertia is that of the incompressible solid, at u. */
dea_status dea_solid_assemble_stiff(struct dea_context *ctx, struct dea_solid *s);
/* That, and its factor. */
dea_status dea_solid_factor_stiff(struct dea_context *ctx, struct dea_solid *s, int *negative);

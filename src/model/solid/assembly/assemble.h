/* Energy, forces and tangent of the whole solid. */
#pragma once

#include "model/solid/assembly/problem.h"

/* The terms of inertia in the potential of a step (motion/time.h):
 * c/2 (u - u*) . M (u - u*) + d . u. */
struct dea_solid_inertia {
  double factor;    // c [1/s^2]
  double *around;   // [node_count][3] u* [m]
  double *constant; // [node_count][3] d [N]
  double *away;     // [node_count][3] u - u* of the last evaluation
  double *force;    // [node_count][3] M (u - u*) of the last evaluation
};

/* Makes problem.spring if there are elements that need it. */
dea_status dea_solid_create_springs(struct dea_context *ctx, struct dea_solid *s);
/* What they add to v . K v, v [dofs]. */
double dea_solid_springs_curvature(const struct dea_solid *s, const double *v);

/* Energy at displacements u, dead loads included; sets those of followers of bodies. DEA_E_DOMAIN
 * for an inverted element. */
dea_status dea_solid_energy(struct dea_solid *s, double *u, double voltage_V, double *energy);

/* At the state: energy and, up to the level, g and K; also theta, reactions and the scales. With
 * found.predicted_fits K has the predicted stresses. */
dea_status dea_solid_assemble(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                              enum dea_eval_order level, double *energy);
/* The scales of that assembly count as those of an equilibrium. */
void dea_solid_keep_scales(struct dea_solid *s);

/* Before pieces of loads are evaluated at u. */
void dea_solid_loads_prepare(const struct dea_solid *s, const double *u);

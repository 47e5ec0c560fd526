/* The terms of inertia in the potential of a step (time.h): c/2 (u - u*) . M (u - u*) + d . u. */
#ifndef DEA_MODEL_SOLID_ASSEMBLY_INERTIA_H
#define DEA_MODEL_SOLID_ASSEMBLY_INERTIA_H

#include "model/solid/assembly/solid.h"

struct dea_solid_inertia {
  double factor;             // c [1/s^2]
  double *around, *constant; // u* [m] and d [N], [node_count][3]
  double *away, *force;      // u - u* and M (u - u*) of the last evaluation
};

/* Adds the energy at displacements u; nothing to do without inertia. */
dea_status dea_solid_inertia_energy(const struct dea_solid *solid, const double *u, double *energy);
/* Adds energy and force at the solid's displacements to its own, and c M to its tangent. */
dea_status dea_solid_inertia_add(struct dea_context *ctx, struct dea_solid *solid,
                                 enum dea_eval_order level, double *energy);

#endif

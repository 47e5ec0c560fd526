/* Inertia of a solid: the consistent mass matrix of its layers' densities
 * (docs/theory/vibration.md). It does not depend on the state. */
#ifndef DEA_MODEL_SOLID_ASSEMBLY_MASS_H
#define DEA_MODEL_SOLID_ASSEMBLY_MASS_H

#include "model/solid/assembly/solid.h"

/* out = M v, [node_count][3] both and not the same memory, what is held included: the forces that
 * accelerations v take, or momenta. All ranks call it and get the whole. */
dea_status dea_solid_mass_apply(struct dea_context *ctx, const struct dea_solid *solid,
                                const double *v, double *out);

#endif

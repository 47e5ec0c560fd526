/* Softest modes of a solid at its last equilibrium (docs/theory/branches.md).
 *
 * Modes solve K v = lambda M v, K the tangent and M the volume lumped to the nodes: lambda [N/m per
 * m^3] is the stiffness of the mode per volume that moves, negative for an unstable one. */
#ifndef DEA_MODEL_SOLID_EQUILIBRIUM_MODES_H
#define DEA_MODEL_SOLID_EQUILIBRIUM_MODES_H

#include "model/solid/assembly/solid.h"

enum { DEA_MODES_MAX = 64 };

/* The `count` lowest modes at the last equilibrium, ascending. value: [count]; vector: [count][3
 * node_count], v . M v = 1, and the component of largest size is positive; NULL: not wanted.
 * DEA_E_ARGUMENT for a count of 0 or above DEA_MODES_MAX, DEA_E_NOT_CONVERGED when they cannot be
 * had, among that when more than DEA_MODES_MAX are unstable. */
dea_status dea_solid_modes(struct dea_context *ctx, struct dea_solid *solid, size_t count,
                           double *value, double *vector);

/* One unstable mode at the equilibrium [3 node_count]: the lowest unless more than DEA_MODES_MAX
 * are. */
dea_status dea_solid_unstable_mode(struct dea_context *ctx, struct dea_solid *solid, double *value,
                                   double *vector);
/* A mode v [count] with its sign so that its largest component is positive. */
void dea_mode_orient(size_t count, double *v);

#endif

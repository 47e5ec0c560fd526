/* Softest modes of a solid at its last equilibrium (docs/theory/branches.md, vibration.md).
 *
 * Modes solve K v = lambda B v with the tangent K of the solid as good as incompressible. With the
 * volume lumped to the nodes as B, lambda [N/m per m^3] is the stiffness of the mode per volume
 * that moves; with the consistent mass it is the square of an angular frequency. It is negative for
 * an unstable mode. */
#pragma once

#include "model/solid/assembly/solid.h"

enum { DEA_MODES_MAX = 200 };

/* What B is. */
enum dea_mode_metric { DEA_MODES_BY_VOLUME, DEA_MODES_BY_MASS };

/* The `count` lowest modes at the last equilibrium, ascending. value: [count]; vector: [count][3
 * node_count], v . B v = 1, and the component of largest size is positive; NULL: not wanted. That
 * none is missing is counted by the inertia of K - sigma B. DEA_E_ARGUMENT for a count of 0 or
 * above DEA_MODES_MAX, or without mass; DEA_E_NOT_CONVERGED when they cannot be had, among that
 * when there are fewer or more than DEA_MODES_MAX are unstable. */
dea_status dea_solid_modes_lowest(struct dea_context *ctx, struct dea_solid *solid,
                                  enum dea_mode_metric metric, size_t count, double *value,
                                  double *vector);
/* The same with the potentials that a coupled field has along each: vector [count][dofs]. */
dea_status dea_solid_modes_whole(struct dea_context *ctx, struct dea_solid *solid,
                                 enum dea_mode_metric metric, size_t count, double *value,
                                 double *vector);
/* How many modes have a lambda below that. */
dea_status dea_solid_modes_below(struct dea_context *ctx, struct dea_solid *solid,
                                 enum dea_mode_metric metric, double value, size_t *count);
/* One unstable mode at the equilibrium by volume [3 node_count]: the lowest unless more than
 * DEA_MODES_MAX are. */
dea_status dea_solid_unstable_mode(struct dea_context *ctx, struct dea_solid *solid, double *value,
                                   double *vector);

/* Stability of a solid at its last equilibrium: its softest modes, and the way from an unstable
 * equilibrium to a stable one (docs/theory/branches.md).
 *
 * Modes solve K v = lambda M v, K the tangent and M the volume lumped to the nodes: lambda [N/m per
 * m^3] is the stiffness of the mode per volume that moves, negative for an unstable one. */
#ifndef DEA_MODEL_SOLID_SOLVE_BRANCH_H
#define DEA_MODEL_SOLID_SOLVE_BRANCH_H

#include "model/solid/solve/solid.h"

enum { DEA_MODES_MAX = 64 };

/* The `count` lowest modes at the last equilibrium, ascending. value: [count]; vector: [count][3
 * node_count], v . M v = 1, and the component of largest size is positive; NULL: not wanted.
 * DEA_E_ARGUMENT for a count of 0 or above DEA_MODES_MAX, DEA_E_NOT_CONVERGED when they cannot be
 * had, among that when more than DEA_MODES_MAX are unstable. */
dea_status dea_solid_modes(struct dea_context *ctx, struct dea_solid *solid, size_t count,
                           double *value, double *vector);

/* From an unstable equilibrium down along its most unstable mode v to a stable one, at the same
 * voltage and loads. side: 1 along v, -1 against it, 0 where the energy is lower (along v when that
 * is equal). Goes on until there is no unstable mode. The solid stays where it was with
 * DEA_E_NOT_CONVERGED. Nothing to do at a stable one. *report: as of a solve. */
dea_status dea_solid_leave(struct dea_context *ctx, struct dea_solid *solid, int side,
                           struct dea_solid_report *report);

/* Whether solves stay at an unstable equilibrium that they have found; at first they leave it. */
void dea_solid_stay(struct dea_solid *solid, bool stay);

#endif

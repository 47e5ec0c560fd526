/* Displacements of one mesh at the nodes of another of the same body. */
#pragma once

#include "model/solid/mesh/grid.h"

/* out [to->node_count][3]: u [from->node_count][3], by the basis of the element of `from` that a
 * node of `to` is in, or nearest to where curved edges of the two differ; its local coordinates
 * then end at the element's. Orders of the two may differ. DEA_E_ARGUMENT, with a message, where a
 * node is farther from all elements than a fifth of one's half-width. */
dea_status dea_grid_transfer(struct dea_context *ctx, const struct dea_grid *from, const double *u,
                             const struct dea_grid *to, double *out);

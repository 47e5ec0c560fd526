/* Dead force of a support (docs/theory/loads.md). */
#pragma once

#include "model/solid/actuator/layout_mesh.h"

/* Adds its consistent nodal forces, or the sector's part of them: spread evenly over the plies'
 * sides along an edge, of the elements within it where there are any, or over their volume. room:
 * [node_count of the plane mesh]; force: [nodes][3] [N]. */
dea_status dea_dead_force_add(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                              const struct dea_layout_support *support, bool *marked,
                              double *force);

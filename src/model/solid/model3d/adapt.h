/* Sizes of elements by what each adds to an estimated error (docs/theory/trust.md, "Adaptive
 * refinement"). */
#pragma once

#include "model/solid/actuator/layout_mesh.h"

/* part: [element_count], as dea_recover_errors; wanted: error that the next mesh should have, > 0.
 * at: [quad_count of the plane mesh] x, y, size [m]. */
dea_status dea_adapt_sizes(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                           const double *part, double wanted, double (*at)[3]);

/* Meshes that follow the numbers of their layout (docs/theory/gradients.md, "Shapes"). */
#pragma once

#include "model/solid/actuator/layout_mesh.h"

/* The mesh of another layout with the elements of `like`, which outlives it, where the layouts
 * differ in numbers of their parts and shapes only: at other heights and, in the plane, where the
 * shapes take them: nodes on outlines stay on them, the others are pulled along. DEA_E_ARGUMENT,
 * with the reason, where it cannot be that: outlines have other pieces than they had, come apart,
 * lose the symmetry of the sector, or fold an element. On failure out is empty. */
dea_status dea_mesh_follow(struct dea_context *ctx, const struct dea_layout *layout,
                           const struct dea_model_settings *settings,
                           const struct dea_layout_mesh *like, struct dea_layout_mesh *out);

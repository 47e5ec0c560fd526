/* Shapes of a design as regions. */
#pragma once

#include "design/design.h"
#include "device/layout.h"

/* Makes a region of each shape, in their order; the list is the layout's, and its length is set.
 * What is wrong is a finding at its place; a shape that could not be made, or is made of such a
 * one, leaves an empty region. */
dea_status dea_shape_regions_build(struct dea_context *ctx, const struct dea_design *design,
                                   struct dea_layout *layout);

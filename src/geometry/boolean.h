/* Union, difference and intersection of regions. Arcs stay exact (docs/theory/geometry.md). */
#pragma once

#include "geometry/region.h"

enum dea_boolean { DEA_UNION, DEA_DIFFERENCE, DEA_INTERSECTION };

/* Path of the module that does it with GEOS into out[size]; false when it is not here. */
bool dea_boolean_find(char *out, size_t size);

/* a united with b, without b, or what both have in common, added to an empty region. Contours of a
 * may overlap, and those of b: an array of copies united with nothing (b NULL) becomes one region.
 * The result can be empty. Points nearer than DEA_GEOMETRY_SNAP times the size of both are one;
 * what has less than that in width is no region; regions that only touch stay apart.
 *
 * A contour that crosses itself, and edges so near to each other that it cannot be told on which
 * side they lie: dea_region_fault. DEA_E_UNSUPPORTED without GEOS. On failure out is empty. */
dea_status dea_region_combine(struct dea_context *ctx, enum dea_boolean what,
                              const struct dea_region *a, const struct dea_region *b,
                              struct dea_region *out);

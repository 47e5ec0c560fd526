/* What the module that knows GEOS does for boolean.c: union, difference and intersection of
 * polygons. */
#pragma once

#include "geometry/boolean.h"

/* Closed rings of points, the first one not repeated. Of several with one polygon's number, which
 * follow each other, the first is the outline and the others are its holes. */
struct dea_rings {
  double (*point)[2]; // owned
  size_t *end;        // [count] number of the point after a ring's last; owned
  size_t *polygon;    // [count] owned
  size_t count;
};

struct dea_overlay_type {
  /* The polygons of a may overlap, and so may those of b: their union is meant. What in the result
   * is no polygon is left out. out: owned by the caller, also after a failure. DEA_E_DESIGN with
   * GEOS' words when it does not take the polygons. */
  dea_status (*overlay)(struct dea_context *ctx, enum dea_boolean what, const struct dea_rings *a,
                        const struct dea_rings *b, struct dea_rings *out);
};

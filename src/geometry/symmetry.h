/* Rotations and reflections that map regions onto themselves. */
#pragma once

#include "geometry/region.h"

/* What regions share: rotations by 2 pi/order about the centre, and reflections in `mirrors` lines
 * through it, none or as many as the order. */
struct dea_symmetry {
  double centre_m[2]; // of the area of all
  size_t order;       // 1: no rotation; 0: every one, and every line is a mirror
  size_t mirrors;     // 0 when order is 0
  double mirror_rad;  // direction of the first mirror line, in [0, pi/order), if mirrors > 0
  double step_rad;    // from one mirror line to the next
};

/* Of regions[count], each with a label that the image must share (a channel, a material); not empty
 * as a whole. Every point of a boundary comes within tolerance_m of its image; 0: 1e-6 of the size
 * of all. Found from the geometry, whatever vertices stand for it. DEA_E_MEMORY is the only
 * failure.
 */
dea_status dea_symmetry_find(struct dea_context *ctx, const struct dea_region *const regions[],
                             const int labels[], size_t count, double tolerance_m,
                             struct dea_symmetry *out);

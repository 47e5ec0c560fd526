/* Whether the parts of a layout lie where they can. */
#pragma once

#include "device/layout.h"

/* Adds a finding for each part that lies where it cannot: an electrode beyond its ply, electrodes
 * of different channels that lie on or touch each other, what lies nowhere; and a warning for those
 * that are too near for voltages up to `highest_V`. Fails only for memory. */
dea_status dea_layout_check(struct dea_context *ctx, const struct dea_layout *layout,
                            double highest_V);

/* Area that two regions have in common; NAN where it cannot be told. */
double dea_layout_overlap_m2(const struct dea_layout *layout, size_t a, size_t b);
/* Area of a ply between electrodes of different channels in the flat state, at most where what they
 * have in common cannot be told. */
double dea_layout_active_area_m2(const struct dea_layout *layout, size_t ply);
/* Whether a point lies in a region or on its boundary. */
bool dea_layout_holds(const struct dea_layout *layout, size_t region, const double x_m[2]);

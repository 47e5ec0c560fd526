/* Points by their place: the one that was added before at the same place, or nearly so. */
#pragma once

#include "base/context.h"

/* Zero-initialise with the context and the tolerance >= 0, which is the distance up to which points
 * are one; for 0 also the order of magnitude of the distance between points, in cell_m. As with
 * struct dea_text, what could not be added for want of memory is left out and `failed` stays set.
 */
struct dea_point_map {
  struct dea_context *ctx;
  double tolerance_m, cell_m; // cell_m: 0: twice the tolerance
  double (*point)[2];         // [count]; owned
  size_t *next, *head;        // chains of points whose cells fall together; owned
  size_t count, capacity, heads;
  bool failed;
};

/* Number of the first point within the tolerance; SIZE_MAX when there is none. */
size_t dea_point_map_find(const struct dea_point_map *map, const double x_m[2]);
/* The same; adds the point when there is none. 0 when that fails. */
size_t dea_point_map_add(struct dea_point_map *map, const double x_m[2]);
void dea_point_map_free(struct dea_point_map *map);

/* The pieces of regions in one list, with a tree to find those that are near. */
#pragma once

#include "base/arena.h"
#include "geometry/box_tree.h"
#include "geometry/region.h"

struct dea_pieces {
  struct dea_arena arena;
  struct dea_piece *piece;  // [count]
  size_t *contour;          // [count] number of its contour, counted over all regions
  size_t *next;             // [count] the piece that follows in its contour
  struct dea_vertex *start; // [count] vertex that it starts at
  size_t count;
  double size_m; // diagonal of the box of all
  double snap_m; // DEA_GEOMETRY_SNAP times it
  struct dea_box_tree tree;
};

/* Pieces of regions[count], NULL for none. */
dea_status dea_pieces_build(struct dea_context *ctx, const struct dea_region *const regions[],
                            size_t count, struct dea_pieces *out);
void dea_pieces_free(struct dea_pieces *pieces);
/* Pieces whose boxes come nearer than snap_m to a box, one a call, as dea_box_tree_next. */
bool dea_pieces_next(const struct dea_pieces *pieces, const double box[4], size_t *cursor,
                     size_t *found);

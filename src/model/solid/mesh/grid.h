/* Structured meshes of layered plates: mapped blocks of quadrilaterals, extruded through layers. */
#ifndef DEA_MODEL_SOLID_MESH_GRID_H
#define DEA_MODEL_SOLID_MESH_GRID_H

#include "model/solid/element/element.h"

/* A block of a plate: [0, 1]^2 mapped into the plane. */
struct dea_block {
  void (*map)(const void *self, double s, double t, double x[2]);
  const void *self;
  const double *cuts_s, *cuts_t; // ascending from 0 to 1, [count_s + 1], [count_t + 1]
  size_t count_s, count_t;       // elements
  int region;                    // of its elements
};

/* One ply of a stack, from bottom to top. Of thickness 0 it is a surface of membranes: (order +
 * 1)^2 nodes at its level, which are those of the solid elements there. */
struct dea_ply {
  double thickness_m;
  size_t count; // elements through it, 1 of a surface; 0: the ply is not there
  int order_z;
};

struct dea_grid {
  int order, order_z; // in the plane, through a ply with a thickness
  size_t node_count, element_count;
  double *X;         // [node_count][3]
  int *nodes;        // [element_count][DEA_HEX_NODES_MAX], the first dea_grid_nodes_of used
  int *region, *ply; // [element_count]
  int *levels;       // [element_count] of (order + 1)^2 nodes each; 1 of a surface
  enum dea_element_kind *kind; // [element_count] hexahedra and membranes, unless changed
};

/* Nodes of an element. */
int dea_grid_nodes_of(const struct dea_grid *grid, size_t element);

/* Plate of blocks (joined where their edge nodes coincide) through plies that start at z =
 * bottom_m. All plies have the same order_z. present: whether a region has a ply; NULL: all have
 * all. length_m: a typical length of the plate, nodes closer than 1e-9 of it are one. out: owned by
 * the caller, NULL on failure. */
dea_status dea_grid_create(struct dea_context *ctx, int order, const struct dea_block *blocks,
                           size_t block_count, const struct dea_ply *plies, size_t ply_count,
                           bool (*present)(int region, int ply), double bottom_m, double length_m,
                           struct dea_grid **out);
/* The same where a ply need not lie on the one before it in the list: skips[] says how many it
 * passes over, [ply_count]; NULL: none. */
dea_status dea_grid_create_skipping(struct dea_context *ctx, int order,
                                    const struct dea_block *blocks, size_t block_count,
                                    const struct dea_ply *plies, size_t ply_count,
                                    const size_t *skips, bool (*present)(int region, int ply),
                                    double bottom_m, double length_m, struct dea_grid **out);
void dea_grid_destroy(struct dea_context *ctx, struct dea_grid *grid);

/* The node nearest to a place [m]. */
size_t dea_grid_nearest(const struct dea_grid *grid, const double X_m[3]);

/* Least of all elements' smallest Jacobian in the plane (at the nodes) over the mean one of the
 * element: 1 for a parallelogram, 0 or less for an element that is folded. */
double dea_grid_smallest_jacobian(const struct dea_grid *grid);

#endif

/* Meshes of layered plates: plane meshes of quadrilaterals, extruded through plies. */
#pragma once

#include "base/arena.h"
#include "model/solid/element/element.h"
#include "model/solid/mesh/plane_mesh.h"

/* One ply of a stack, from bottom to top. Of thickness 0 it is a surface of membranes: (order +
 * 1)^2 nodes at its level, which are those of the solid elements there. */
struct dea_ply {
  double thickness_m;
  size_t count; // elements through it, 1 of a surface; 0: the ply is not there
  int order_z;
};

/* A stack of plies that starts at z = bottom_m. All plies have the same order_z. */
struct dea_stack {
  const struct dea_ply *plies; // [count]
  size_t count;
  /* A ply need not lie on the one before it in the list: how many it passes over, [count]; NULL:
   * none. */
  const size_t *skips;
  /* The ply that one fills the place beside, as thick as it and at its height: they have nodes in
   * common where they meet, [count]; SIZE_MAX: none; NULL: none of all. */
  const size_t *beside;
  /* Where a ply is cut into its elements, [count][its count + 1] from 0 to 1; NULL, or NULL of a
   * ply: into equal ones. */
  const double *const *cuts;
  bool (*present)(const void *self, int region, int ply); // a ply in a region; NULL: all in all
  const void *self;
  double bottom_m;
};

struct dea_grid {
  struct dea_arena memory; // of all arrays
  int order, order_z;      // in the plane, through a ply with a thickness
  size_t node_count, element_count;
  double *X;         // [node_count][3]
  int *column;       // [node_count] node of the plane mesh that it was extruded from; -1: of none
  int *nodes;        // [element_count][DEA_HEX_NODES_MAX], the first dea_grid_nodes_of used
  int *region, *ply; // [element_count]
  int *levels;       // [element_count] of (order + 1)^2 nodes each; 1 of a surface
  enum dea_element_kind *kind; // [element_count] hexahedra and membranes, unless changed
};

/* What column [node_count] counts in: one more than the largest. A plane mesh may have more nodes
 * than the grid, where regions have no plies. */
size_t dea_grid_columns(const struct dea_grid *grid);

/* Nodes of an element. */
int dea_grid_nodes_of(const struct dea_grid *grid, size_t element);

/* Plate of a plane mesh through plies. Nodes above each other have consecutive numbers, elements
 * those of their ply. out: owned by the caller, NULL on failure. */
dea_status dea_grid_extrude(struct dea_context *ctx, const struct dea_plane_mesh *mesh,
                            const struct dea_stack *stack, struct dea_grid **out);
/* The same of blocks, which dea_blocks_mesh makes one plane mesh, and plies that lie on each other.
 * present: called without a self. */
dea_status dea_grid_create(struct dea_context *ctx, int order, const struct dea_block *blocks,
                           size_t block_count, const struct dea_ply *plies, size_t ply_count,
                           bool (*present)(const void *self, int region, int ply), double bottom_m,
                           double length_m, struct dea_grid **out);
/* An empty one to be filled: all numbers 0, hexahedra. out: owned by the caller, NULL on failure.
 */
dea_status dea_grid_allocate(struct dea_context *ctx, int order, int order_z, size_t node_count,
                             size_t element_count, struct dea_grid **out);
void dea_grid_destroy(struct dea_context *ctx, struct dea_grid *grid);

/* Nodes without elements behind those that there are, at X [count][3]: for rigid bodies. *first:
 * the number of the first one. */
dea_status dea_grid_add_nodes(struct dea_context *ctx, struct dea_grid *grid, size_t count,
                              const double *X_m, size_t *first);

/* The node nearest to a place [m]. */
size_t dea_grid_nearest(const struct dea_grid *grid, const double X_m[3]);

/* As dea_plane_mesh_smallest_jacobian, in the plane. */
double dea_grid_smallest_jacobian(const struct dea_grid *grid);

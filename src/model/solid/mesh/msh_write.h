/* Meshes for other programs: Gmsh's format 2.2 in ASCII. */
#pragma once

#include "model/solid/mesh/grid.h"

enum { DEA_MSH_GROUPS_MAX = 256 };

/* Physical groups of a mesh, by their numbers from 0; -1: of none. What is flat has one dimension
 * less. */
struct dea_msh_groups {
  const char *const *name; // [count]
  size_t count;
  int (*part)(const void *self, int region, int ply); // of an element
  /* Of the lower or upper face of a solid element of that part; NULL: none. */
  int (*face)(const void *self, int part, bool top);
  /* Of a side that looks along the plane: a face of a solid element, an edge of a flat one; NULL:
   * none. */
  int (*side)(const void *self, const struct dea_grid *grid, const int *nodes, int count);
  int without_sides; // a part whose flat elements have no sides of a group; -1: none
  const void *self;
};

/* Writes second-order hexahedra (27 nodes) and flat elements (9), in m, and the faces (9) and edges
 * (3) that are of a group. DEA_E_ARGUMENT when the elements are not of order 2. */
dea_status dea_msh_write(struct dea_context *ctx, const struct dea_msh_groups *groups,
                         const struct dea_grid *grid, const char *path);

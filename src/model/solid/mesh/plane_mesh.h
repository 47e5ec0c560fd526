/* Plane meshes of quadrilaterals: of mapped blocks, or free ones with named groups (.msh files,
 * gmsh). Extruded through plies they are the mesh of a layered device (grid.h). */
#pragma once

#include "geometry/point_map.h"

/* Nodes of an element lie at the products of Gauss-Lobatto points, first local axis fastest; local
 * axes turn counter-clockwise. */
struct dea_plane_mesh {
  int order;
  size_t node_count, quad_count;
  double *x;   // [node_count][2], m
  int *quads;  // [quad_count][(order + 1)^2]
  int *region; // [quad_count], of free meshes 0 <= region < region_count

  /* Of free meshes, otherwise 0 and NULL. A region is what lies in the same groups: `within` says
   * in which. Groups may overlap. */
  size_t group_count, region_count;
  const char **group;      // [group_count], names of surfaces, interned
  unsigned char *within;   // [region_count][group_count], 0 or 1
  size_t curve_count;      // named curves
  const char **curve;      // [curve_count]
  size_t edge_count;       // sides of elements on named curves; one that is on two is there twice
  int *edges, *edge_curve; // [edge_count][order + 1] nodes in their order along it; [edge_count]
};

/* With so many nodes and elements, all numbers 0; owned by the caller, NULL for want of memory. */
struct dea_plane_mesh *dea_plane_mesh_create(struct dea_context *ctx, int order, size_t node_count,
                                             size_t quad_count);
/* Gives it the points for its nodes, in place of those that it has; the map is empty then.
 * DEA_E_MEMORY of a map that has failed. */
dea_status dea_plane_mesh_set_nodes(struct dea_context *ctx, struct dea_plane_mesh *mesh,
                                    struct dea_point_map *nodes);
/* NULL is fine. */
void dea_plane_mesh_destroy(struct dea_context *ctx, struct dea_plane_mesh *mesh);

/* A group, a named curve; SIZE_MAX when there is none of that name. */
size_t dea_plane_mesh_group(const struct dea_plane_mesh *mesh, const char *name);
size_t dea_plane_mesh_curve(const struct dea_plane_mesh *mesh, const char *name);

/* For those who make one: add a name (copied), and find the number of the region that lies in the
 * groups where within[group_count] is 1, added when it is new. */
dea_status dea_plane_mesh_add_group(struct dea_context *ctx, struct dea_plane_mesh *mesh,
                                    const char *name);
dea_status dea_plane_mesh_add_curve(struct dea_context *ctx, struct dea_plane_mesh *mesh,
                                    const char *name);
dea_status dea_plane_mesh_region(struct dea_context *ctx, struct dea_plane_mesh *mesh,
                                 const unsigned char *within, int *out);
/* Takes groups, regions, curves and edges away. */
void dea_plane_mesh_forget_names(struct dea_context *ctx, struct dea_plane_mesh *mesh);

/* Mean of an element's nodes. */
void dea_plane_mesh_middle(const struct dea_plane_mesh *mesh, size_t e, double out[2]);
/* Least of all elements' smallest Jacobian (at the nodes) over the mean one of the element: 1 for a
 * parallelogram, 0 or less for an element that is folded. worst: the element; may be NULL. */
double dea_plane_mesh_smallest_jacobian(const struct dea_plane_mesh *mesh, size_t *worst);

/* A block: [0, 1]^2 mapped into the plane. */
struct dea_block {
  void (*map)(const void *self, double s, double t, double x[2]);
  const void *self;
  const double *cuts_s, *cuts_t; // ascending from 0 to 1, [count_s + 1], [count_t + 1]
  size_t count_s, count_t;       // elements
  int region;                    // of its elements
};

/* Blocks, joined where their edge nodes coincide. length_m: a typical length, nodes closer than
 * 1e-9 of it are one. out: owned by the caller, NULL on failure. */
dea_status dea_blocks_mesh(struct dea_context *ctx, int order, const struct dea_block *blocks,
                           size_t block_count, double length_m, struct dea_plane_mesh **out);

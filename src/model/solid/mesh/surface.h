/* Surfaces of a solid: faces of its elements, on which loads act (docs/theory/loads.md). */
#pragma once

#include "model/solid/element/membrane.h"
#include "model/solid/mesh/grid.h"

/* Sides of an element: both ends of its first and second local axis, and of the thickness. */
enum dea_face {
  DEA_FACE_FIRST_LOW,
  DEA_FACE_FIRST_HIGH,
  DEA_FACE_SECOND_LOW,
  DEA_FACE_SECOND_HIGH,
  DEA_FACE_BOTTOM,
  DEA_FACE_TOP,
};

/* Faces of one side of elements. Nodes: first local axis of the face fastest; the axes run so that
 * X,1 x X,2 points out of the element. */
struct dea_surface {
  const struct dea_grid *grid; // lent
  size_t face_count;
  int order[2];   // along the axes of the face
  int face_nodes; // (order[0] + 1) (order[1] + 1)
  int *nodes;     // [face_count][DEA_FACE_NODES_MAX], the first face_nodes used
  int *element;   // [face_count]
};

/* The side of all elements that `select` wants, by their region and ply and the middle of the
 * face's nodes; NULL: of all. An element of a surface is its own bottom and top and has no other.
 * DEA_E_ARGUMENT when there is none. memory: of it; the grid outlives it. */
dea_status
dea_surface_create(struct dea_context *ctx, const struct dea_grid *grid, enum dea_face side,
                   bool (*select)(const void *self, int region, int ply, const double middle[3]),
                   const void *self, struct dea_arena *memory, struct dea_surface **out);

/* Values of a field v [node_count of the grid][3] at the nodes of a face, [face_nodes][3]. */
void dea_face_gather(const struct dea_surface *surface, size_t face, const double *v, double *out);
/* X,1 x X,2 at a point of a face from its nodes' places [face_nodes][3]. */
void dea_face_normal(const struct dea_face_shape *shape, int point, const double *X,
                     double normal[3]);
/* Reference area of each point times its weight [face_count][points]; NULL for want of memory. */
double *dea_surface_weights(struct dea_arena *memory, const struct dea_surface *surface,
                            const struct dea_face_shape *shape);
/* Reference area [m^2]. */
double dea_surface_area(const struct dea_surface *surface);

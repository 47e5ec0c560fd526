/* Rows of thin elements along named curves of a plane mesh, where what is extruded from it has
 * layers as wide as it is thick (docs/theory/mesh.md, "Edge layers"). */
#pragma once

#include "model/solid/mesh/plane_mesh.h"

struct dea_edge_layers {
  const double *width_m; // [curve_count] of all rows together, 0: none along that curve
  const bool *rigid;     // [group_count] a group inside of which there are none
  size_t rows;
};

/* On both sides of the curves: the other elements make room for them. They are narrower where those
 * are short; where they would be bad elements the mesh stays as it is. */
dea_status dea_edge_layers_add(struct dea_context *ctx, struct dea_plane_mesh *mesh,
                               const struct dea_edge_layers *layers);

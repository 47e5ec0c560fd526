/* The basis of a membrane: flat quadrilaterals of three unknowns a node (docs/theory/membrane.md).
 */
#pragma once

#include "model/solid/element/element.h"
#include "model/solid/point/membrane_point.h"

enum {
  DEA_FLAT_NODES_MAX = DEA_ELEMENT_LEVEL_MAX,
  DEA_FLAT_DOFS_MAX = 3 * DEA_FLAT_NODES_MAX,
};

/* Basis of one order. Nodes and Gauss points: first local axis fastest, as in a level of a
 * hexahedron. */
struct dea_flat_shape {
  int order, nodes, gauss;
  double value[DEA_FLAT_NODES_MAX][DEA_FLAT_NODES_MAX];    // at a Gauss point
  double slope[DEA_FLAT_NODES_MAX][2][DEA_FLAT_NODES_MAX]; // there, by the local axes
  double weight[DEA_FLAT_NODES_MAX];
  double node_at[DEA_FLAT_NODES_MAX][2]; // local coordinates in [-1, 1]
};

/* order: 1 to DEA_HEX_ORDER_MAX; DEA_E_ARGUMENT otherwise. */
dea_status dea_flat_shape_create(int order, struct dea_flat_shape *out);

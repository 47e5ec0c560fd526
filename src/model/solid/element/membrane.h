/* The basis of flat quadrilaterals: of a membrane, of three unknowns a node
 * (docs/theory/membrane.md), and of the faces of other elements. */
#pragma once

#include "model/solid/element/element.h"
#include "model/solid/point/membrane_point.h"

enum { DEA_FACE_NODES_MAX = DEA_ELEMENT_LEVEL_MAX, DEA_FACE_POINTS_MAX = 25 };

/* Nodal basis at local coordinates, and its slopes by them. order: as below. */
void dea_face_basis(const int order[2], const double at[2], double value[DEA_FACE_NODES_MAX],
                    double slope[2][DEA_FACE_NODES_MAX]);

/* Basis at points of a rule. Nodes and points: first local axis fastest, as in a level of a
 * hexahedron. */
struct dea_face_shape {
  int order[2], nodes, points;
  double value[DEA_FACE_POINTS_MAX][DEA_FACE_NODES_MAX];
  double slope[DEA_FACE_POINTS_MAX][2][DEA_FACE_NODES_MAX]; // by the local axes
  double weight[DEA_FACE_POINTS_MAX];
};
/* Element: as many Gauss points as nodes. Gauss: exact for products of three displacements and two
 * of their slopes less. Nodes: the Gauss-Lobatto points, at which the nodes are. */
enum dea_face_rule { DEA_FACE_ELEMENT, DEA_FACE_GAUSS, DEA_FACE_AT_NODES };
/* order: along the local axes, 1 to DEA_HEX_ORDER_MAX. */
void dea_face_shape_create(const int order[2], enum dea_face_rule rule, struct dea_face_shape *out);

/* The basis of a hexahedron. */
#pragma once

#include "model/solid/element/element.h"

/* Basis along one axis: [0] values, [1] slopes. pairs: products of node n and node m at a Gauss
 * point, [n nodes + m][kind nodes + Gauss point]; kinds: value by slope, value by value, slope by
 * value, slope by slope. */
enum { DEA_HEX_KIND_01, DEA_HEX_KIND_00, DEA_HEX_KIND_10, DEA_HEX_KIND_11, DEA_HEX_KINDS };
struct dea_hex_line {
  double at_gauss[2][DEA_HEX_LINE_MAX][DEA_HEX_LINE_MAX]; // [Gauss point][node]
  double at_node[2][DEA_HEX_LINE_MAX][DEA_HEX_LINE_MAX];  // [node][Gauss point]
  double pairs[DEA_HEX_LINE_MAX * DEA_HEX_LINE_MAX][DEA_HEX_KINDS * DEA_HEX_LINE_MAX];
};

/* Basis of one element shape: in-plane order and order through the thickness. Nodes: first local
 * axis fastest, Gauss points alike. */
struct dea_hex_shape {
  int order, order_z;
  int nodes, gauss, pressures;
  double value[DEA_HEX_GAUSS_MAX][DEA_HEX_NODES_MAX];
  double slope[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX]; // by the local axes
  double pressure[DEA_HEX_GAUSS_MAX][DEA_HEX_PRESSURES_MAX];
  double weight[DEA_HEX_GAUSS_MAX];
  double node_at[DEA_HEX_NODES_MAX][3]; // local coordinates in [-1, 1]
  struct dea_hex_line line[2]; // of the axes in the plane, of the one through the thickness
};

/* order, order_z: 1 to DEA_HEX_ORDER_MAX; DEA_E_ARGUMENT otherwise. */
dea_status dea_hex_shape_create(int order, int order_z, struct dea_hex_shape *out);

/* Layered hexahedra: one kinematics for film, glue and fibre (docs/theory/solid.md).
 *
 * Symbol   meaning                                                        unit
 * X, u     place in the stretched flat film, displacement                 m
 * F        dx/dX, x = X + u                                               1
 * G        pre-stretch of a layer, diagonal, det G = 1: W sees F G        1
 * J        det F                                                          1
 * theta    projection of J - 1 on the element's pressure polynomials      1
 * kappa    bulk modulus of the projected part                             Pa
 * kappa_s  bulk modulus of the pointwise part (stabilisation)             Pa
 *
 * Energy of an element, per volume of the stretched flat film:
 *
 *   W(F G) + p0 (J - 1) + kappa_s/2 ((J^2 - 1)/2 - ln J) + p_k theta + kappa/2 theta^2
 *     - (eps/2)(V/h)^2 |F_1 x F_2|^2
 *
 * p0 frees the flat layer of thickness stress; p_k is a multiplier per element that an outer loop
 * moves until theta vanishes. */
#ifndef DEA_MODEL_SOLID_ELEMENT_HEX_H
#define DEA_MODEL_SOLID_ELEMENT_HEX_H

#include "model/solid/point/constituent.h"

#include <stddef.h>

enum {
  DEA_HEX_ORDER_MAX = 3,
  DEA_HEX_LINE_MAX = 4,       // nodes on a line: order + 1
  DEA_HEX_NODES_MAX = 64,     // of an element
  DEA_HEX_GAUSS_MAX = 64,     // the same rule in each direction
  DEA_HEX_PRESSURES_MAX = 10, // polynomials of total degree order - 1
  DEA_HEX_DOFS_MAX = 3 * DEA_HEX_NODES_MAX,
  DEA_ELEMENT_DOFS_MAX = 4 * DEA_HEX_NODES_MAX, // with a potential
};

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

/* Result of one element of any kind. g: [dofs], K: [dofs][dofs] row by row, dofs node by node;
 * theta: see above, of a hexahedron with a law. */
struct dea_element_result {
  double energy_J;
  double g[DEA_ELEMENT_DOFS_MAX];
  double K[DEA_ELEMENT_DOFS_MAX * DEA_ELEMENT_DOFS_MAX];
  double theta[DEA_HEX_PRESSURES_MAX];
  double volume_m3;
};

/* X, u: [nodes][3]; multiplier: [pressures] p_k. voltage_V: 0 where there is no electrode. Of *out,
 * what the level asks for is set, and theta and volume always. DEA_E_DOMAIN for an inverted element
 * or beyond the law's domain. */
dea_status dea_hex_evaluate(const struct dea_hex_shape *shape, const struct dea_constituent *layer,
                            const double *X, const double *u, const double *multiplier,
                            double voltage_V, enum dea_eval_order level,
                            struct dea_element_result *out);

/* Stresses that a linear step leads to, which a tangent at the end of the step may hold in place of
 * those that are there (docs/theory/branches.md): [pressures] pressures, then [gauss][6] second
 * Piola-Kirchhoff stresses. */
size_t dea_hex_predicted_count(const struct dea_hex_shape *shape);
/* Those at u + share step, from the tangent at u. stresses: false for the pressures only. Arguments
 * and errors as in dea_hex_evaluate. */
dea_status dea_hex_predict(const struct dea_hex_shape *shape, const struct dea_constituent *layer,
                           const double *X, const double *u, const double *multiplier,
                           double voltage_V, const double *step, double share, bool stresses,
                           double *predicted);
/* dea_hex_evaluate to DEA_TANGENT with predicted stresses in K; energy and force are what they are.
 */
dea_status dea_hex_evaluate_predicted(const struct dea_hex_shape *shape,
                                      const struct dea_constituent *layer, const double *X,
                                      const double *u, const double *multiplier, double voltage_V,
                                      const double *predicted, struct dea_element_result *out);

/* What a shift of K and a norm of displacements are made of. laplace: [nodes][nodes], int grad N_a
 * . grad N_b [m]; volume: [nodes], the element's volume lumped to its nodes [m^3], all positive. */
dea_status dea_hex_metric(const struct dea_hex_shape *shape, const double *X, double *laplace,
                          double *volume);

/* Membrane state of a film element at its in-plane Gauss points, averaged through the thickness. */
struct dea_hex_membrane {
  int count;
  double area[DEA_HEX_GAUSS_MAX];    // |F_1 x F_2|, current over reference area
  double tension[DEA_HEX_GAUSS_MAX]; // smaller principal force per current length [N/m]
};
/* Arguments as in dea_hex_evaluate; one element through the thickness of the layer, thickness_m. */
dea_status dea_hex_membrane_eval(const struct dea_hex_shape *shape,
                                 const struct dea_constituent *layer, const double *X,
                                 const double *u, const double *multiplier, double voltage_V,
                                 struct dea_hex_membrane *out);

#endif

/* The film as a surface: flat quadrilaterals of three unknowns a node, incompressible by
 * construction (docs/theory/membrane.md).
 *
 * Symbol   meaning                                                                     unit
 * F        dx/dX, its in-plane columns F_1, F_2; F[2 i + J] here                       1
 * G        pre-stretch, diagonal; C_JL = G_J F_J . F_L G_L                             1
 * x1, x2   eigenvalues of C, x1 >= x2: squares of the stretches l1, l2                 1
 * f        energy per volume of film, with field; S = 2 df/dC                          Pa
 *
 * Energy of an element: thickness_m times the integral of f over its area. */
#ifndef DEA_MODEL_SOLID_ELEMENT_MEMBRANE_H
#define DEA_MODEL_SOLID_ELEMENT_MEMBRANE_H

#include "model/solid/element/hex.h"
#include "model/solid/point/tension.h"

enum {
  DEA_FLAT_NODES_MAX = (DEA_HEX_ORDER_MAX + 1) * (DEA_HEX_ORDER_MAX + 1),
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

/* Gradients [2][node] by X [nodes][3] at a Gauss point and its reference area; 0 for an inverted
 * element. */
double dea_flat_gradients(const struct dea_flat_shape *shape, int q, const double *X,
                          double gradient[2][DEA_FLAT_NODES_MAX]);

/* In-plane columns of F at a Gauss point as F[2 i + J]; returns the point's reference area, 0 for
 * an inverted element, of which F is not set. */
double dea_flat_columns(const struct dea_flat_shape *shape, int q, const double *X, const double *u,
                        double F[6]);

/* Whether a flat element can be of this layer: DEA_E_UNSUPPORTED without an isotropic law. */
dea_status dea_membrane_check(const struct dea_constituent *layer);

/* The layer between the mid-surface of a film and what is bonded on it, h/2 thick: free of stress
 * at rest, with the shear compliance of the film from there to its bonded face (theory). film:
 * relaxed (dea_constituent_relax). Statuses of dea_membrane_check. */
dea_status dea_membrane_bond(const struct dea_constituent *film, struct dea_constituent *bond);

/* Energy per volume, first Piola-Kirchhoff stress P[2 i + J] and tangent A[6 (2 i + J) + 2 k + L]
 * by F, and the larger and smaller principal tension: Cauchy stress times current over reference
 * thickness. */
struct dea_membrane_point {
  double W, P[6], A[36];
  double area;          // current over reference area of the film itself: |F_1 x F_2| if taut
  double tension_Pa[2]; // per current length of the film itself
  enum dea_tension_state state; // DEA_TAUT when the layer is not relaxed
};

/* field_V_per_m: V/h, 0 where there is none. DEA_E_DOMAIN beyond the law's domain. */
dea_status dea_membrane_point(const struct dea_constituent *layer, const double F[6],
                              double field_V_per_m, struct dea_membrane_point *out);

/* X, u: [nodes][3]; X lies in a plane of constant z. voltage_V: 0 where there is no electrode. Of
 * *out, energy_J, g and K ([nodes][3]) up to the level, volume_m3, and theta, which is 0.
 * DEA_E_DOMAIN for an element inverted in the reference or beyond the law's domain. */
dea_status dea_membrane_evaluate(const struct dea_flat_shape *shape,
                                 const struct dea_constituent *layer, const double *X,
                                 const double *u, double voltage_V, enum dea_eval_order level,
                                 struct dea_element_result *out);

/* Area and smaller tension at the Gauss points. */
dea_status dea_membrane_state(const struct dea_flat_shape *shape,
                              const struct dea_constituent *layer, const double *X, const double *u,
                              double voltage_V, struct dea_hex_membrane *out);

/* A stiffness [N/m] for each node, whatever the state: the integral of 4 mu h |grad N|^2, with mu
 * the law's shear modulus at rest. out: [nodes]. */
dea_status dea_membrane_stiffness(const struct dea_flat_shape *shape,
                                  const struct dea_constituent *layer, const double *X,
                                  double *out);

/* As dea_hex_metric: laplace [nodes][nodes], thickness_m times the integral of grad N_a . grad N_b
 * [m]; volume: [nodes], equal shares of the element's [m^3]. */
dea_status dea_membrane_metric(const struct dea_flat_shape *shape,
                               const struct dea_constituent *layer, const double *X,
                               double *laplace, double *volume);

#endif

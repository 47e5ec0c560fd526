/* Layered hexahedra: one kinematics for film, glue and fibre (docs/theory/solid.md).
 *
 * Symbol   meaning                                                        unit
 * X, u     place in the stretched flat film, displacement                 m
 * F        dx/dX, x = X + u                                               1
 * G        pre-stretch of a part material, diagonal, det G = 1: W sees F G        1
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
 * p0 frees the flat film of thickness stress; p_k is a multiplier per element that an outer loop
 * moves until theta vanishes. */
#pragma once

#include "model/solid/element/hex_shape.h"

/* State at a Gauss point. */
struct dea_hex_point {
  double F[9], cof[9], J, weight; // weight: reference volume of the point [m^3]
  double local[9];                // dxi_a/dX_J as [3 a + J]
};

/* State at every Gauss point. DEA_E_DOMAIN for an inverted element. */
dea_status dea_hex_find_points(const struct dea_hex_shape *shape, const double *X, const double *u,
                               struct dea_hex_point *points);

/* The same, and the gradient H_iJ = dv_i/dX_J of a motion v [nodes][3]. */
dea_status dea_hex_find_motion(const struct dea_hex_shape *shape, const double *X, const double *u,
                               const double *v, struct dea_hex_point *points, double (*H)[9]);

/* The same, and gradients by X at every Gauss point, as rows [q][J][node]. */
dea_status dea_hex_kinematics(const struct dea_hex_shape *shape, const double *X, const double *u,
                              double (*gradient)[3][DEA_HEX_NODES_MAX],
                              struct dea_hex_point *points);

/* Electric state of a Gauss point: the field E = -c Grad psi, w = cof(F) E, rows H_m = F_m x E, and
 * rows A_k = eps_kmi w_i F_m. */
struct dea_hex_field {
  double E[3], w[3], H[3][3], A[3][3];
};
/* From gradients at the point, as rows [J][node], potentials psi [nodes] and their scale c. */
void dea_hex_field_at(const struct dea_hex_shape *shape, const struct dea_hex_point *at,
                      double gradient[3][DEA_HEX_NODES_MAX], const double *psi, double scale,
                      struct dea_hex_field *out);

/* Projection of J - 1 on the pressure polynomials phi: theta = M^-1 moment with moment = int phi
 * (J - 1) and M = int phi phi = L L^T, L kept in `factor`. */
dea_status dea_hex_project(const struct dea_hex_shape *shape, const struct dea_hex_point *points,
                           double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX],
                           double *moment, double *theta);

/* What the hexahedron can do (element.h), for the kinds that go on from it. */
dea_status dea_hex_create(int order, int order_z, struct dea_element *out);
dea_status dea_hex_evaluate(const struct dea_element *element, const struct dea_element_input *in,
                            enum dea_eval_order order, struct dea_element_result *out);
dea_status dea_hex_constraint(const struct dea_element *element, const struct dea_element_input *in,
                              double *b, double *L);
dea_status dea_hex_predict(const struct dea_element *element, const struct dea_element_input *in,
                           const double *step, double fraction, bool stresses, double *predicted);
dea_status dea_hex_masses(const struct dea_element *element,
                          const struct dea_part_material *part_material, const double *X,
                          double *kilograms);
/* element->type->motion, but for a potential, with what dea_hex_find_motion has found. */
dea_status dea_hex_motion_at(const struct dea_element *element, const struct dea_element_input *in,
                             const struct dea_element_motion *motion,
                             const struct dea_hex_point *points, double (*H)[9], double *stiffness,
                             double *mass);
dea_status dea_hex_metric(const struct dea_element *element,
                          const struct dea_part_material *part_material, const double *X,
                          double *laplace, double *volume);
dea_status dea_hex_strains(const struct dea_element *element, const struct dea_element_input *in,
                           struct dea_element_strains *out);
/* One element through the thickness of the part material, thickness_m. */
dea_status dea_hex_membrane_state(const struct dea_element *element,
                                  const struct dea_element_input *in,
                                  struct dea_membrane_state *out);
dea_status dea_hex_recover(const struct dea_element *element, const struct dea_element_input *in,
                           struct dea_recovered *out);
dea_status dea_hex_state(const struct dea_element *element, const struct dea_element_input *in,
                         bool stress, struct dea_element_state *out);

/* The members of such a kind's type that are the hexahedron's. */
#define DEA_HEX_MEMBERS                                                                            \
  .with_potential = DEA_ELEMENT_POTENTIAL_HEXAHEDRON, .basis_size = sizeof(struct dea_hex_shape),  \
  .create = dea_hex_create, .predict = dea_hex_predict, .constraint = dea_hex_constraint,          \
  .masses = dea_hex_masses, .metric = dea_hex_metric, .strains = dea_hex_strains,                  \
  .membrane_state = dea_hex_membrane_state, .recover = dea_hex_recover, .state = dea_hex_state

/* What the files of the hexahedron share: the state at its Gauss points. */
#ifndef DEA_MODEL_SOLID_ELEMENT_HEX_POINTS_H
#define DEA_MODEL_SOLID_ELEMENT_HEX_POINTS_H

#include "model/solid/element/hex.h"

struct dea_hex_point {
  double F[9], cof[9], J, weight; // weight: reference volume of the point [m^3]
  double local[9];                // dxi_a/dX_J as [3 a + J]
};

/* State at every Gauss point. DEA_E_DOMAIN for an inverted element. */
dea_status dea_hex_find_points(const struct dea_hex_shape *shape, const double *X, const double *u,
                               struct dea_hex_point *points);

/* The same, and gradients by X at every Gauss point, as rows [q][J][node]. */
dea_status dea_hex_kinematics(const struct dea_hex_shape *shape, const double *X, const double *u,
                              double (*gradient)[3][DEA_HEX_NODES_MAX],
                              struct dea_hex_point *points);

/* Projection of J - 1 on the pressure polynomials phi: theta = M^-1 moment with moment = int phi
 * (J - 1) and M = int phi phi = L L^T, L kept in `factor`. */
dea_status dea_hex_project(const struct dea_hex_shape *shape, const struct dea_hex_point *points,
                           double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX],
                           double *moment, double *theta);

#endif

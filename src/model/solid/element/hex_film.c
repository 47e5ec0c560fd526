/* What a film element tells of itself after a solve. */
#include "model/solid/element/hex_points.h"
#include "model/solid/point/viscous.h"

#include <math.h>
#include <string.h>

/* Smaller principal value of the membrane force N_iJ (per reference length) in the current tangent
 * plane: T = N F^T / |F_1 x F_2| on an orthonormal basis of that plane. */
static double smaller_tension(const double N[6], const double F[9], double area)
{
  double e[2][3], length = sqrt(F[0] * F[0] + F[3] * F[3] + F[6] * F[6]), along = 0, rest = 0;
  for (int i = 0; i < 3; i++) {
    e[0][i] = F[3 * i] / length;
    along += e[0][i] * F[3 * i + 1];
  }
  for (int i = 0; i < 3; i++) {
    e[1][i] = F[3 * i + 1] - along * e[0][i];
    rest += e[1][i] * e[1][i];
  }
  double T[2][2] = {{0, 0}, {0, 0}};
  for (int i = 0; i < 3; i++) {
    e[1][i] /= sqrt(rest);
  }
  for (int a = 0; a < 2; a++) {
    for (int b = 0; b < 2; b++) {
      for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
          double NF = N[2 * i] * F[3 * j] + N[2 * i + 1] * F[3 * j + 1];
          T[a][b] += e[a][i] * NF * e[b][j] / area;
        }
      }
    }
  }
  double shear = 0.5 * (T[0][1] + T[1][0]), half = 0.5 * (T[0][0] - T[1][1]);
  return 0.5 * (T[0][0] + T[1][1]) - sqrt(half * half + shear * shear);
}

dea_status dea_hex_membrane_eval(const struct dea_hex_shape *shape,
                                 const struct dea_constituent *layer, const double *X,
                                 const double *u, const double *multiplier, double voltage_V,
                                 struct dea_hex_membrane *out)
{
  struct dea_hex_point state[DEA_HEX_GAUSS_MAX];
  double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX], moment[DEA_HEX_PRESSURES_MAX];
  double theta[DEA_HEX_PRESSURES_MAX];
  dea_status status = dea_hex_find_points(shape, X, u, state);
  if (status == DEA_OK) {
    status = dea_hex_project(shape, state, factor, moment, theta);
  }
  out->count = (shape->order + 1) * (shape->order + 1);
  for (int p = 0; p < out->count && status == DEA_OK; p++) {
    double N[6] = {0}, F[9] = {0}, weights = 0;
    for (int q = p; q < shape->gauss && status == DEA_OK; q += out->count) {
      struct dea_point point;
      const struct dea_hex_point *at = &state[q];
      double pressure = 0, w = shape->weight[q];
      for (int m = 0; m < shape->pressures; m++) {
        pressure += shape->pressure[q][m] * (multiplier[m] + layer->kappa_Pa * theta[m]);
      }
      status = dea_constituent_stress(layer, at->F, at->cof, at->J, pressure,
                                      voltage_V / layer->thickness_m, &point);
      if (status == DEA_OK) {
        dea_viscous_add(layer, q, at->F, at->cof, at->J, false, &point);
      }
      for (int i = 0; i < 3; i++) {
        N[2 * i] += w * layer->thickness_m * point.P[3 * i];
        N[2 * i + 1] += w * layer->thickness_m * point.P[3 * i + 1];
      }
      for (int a = 0; a < 9; a++) {
        F[a] += w * at->F[a];
      }
      weights += w;
    }
    for (int a = 0; a < 9; a++) {
      F[a] /= weights;
    }
    for (int a = 0; a < 6; a++) {
      N[a] /= weights;
    }
    double normal[3] = {F[3] * F[7] - F[6] * F[4], F[6] * F[1] - F[0] * F[7],
                        F[0] * F[4] - F[3] * F[1]};
    out->area[p] = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    out->tension[p] = smaller_tension(N, F, out->area[p]);
  }
  return status;
}

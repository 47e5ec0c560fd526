/* Values of one flat element at its nodes. */
#include "model/solid/recovery/recover.h"

#include "model/solid/recovery/recover_fit.h"

#include <math.h>
#include <string.h>

/* F whole: its third column along the normal, such that J = 1; returns |F_1 x F_2|. */
static double complete(const double F[6], double out[9])
{
  const double normal[3] = {F[2] * F[5] - F[4] * F[3], F[4] * F[1] - F[0] * F[5],
                            F[0] * F[3] - F[2] * F[1]};
  double square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
  for (int i = 0; i < 3; i++) {
    out[3 * i] = F[2 * i];
    out[3 * i + 1] = F[2 * i + 1];
    out[3 * i + 2] = normal[i] / square;
  }
  return sqrt(square);
}

static dea_status evaluate_point(const struct dea_constituent *layer, const double F[6],
                                 double field_V_per_m, double values[DEA_FIT_VALUES], double P[6])
{
  static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
  struct dea_membrane_point point;
  dea_status status = dea_membrane_point(layer, F, field_V_per_m, &point);
  if (status != DEA_OK || !(complete(F, values) > 0)) {
    return status != DEA_OK ? status : DEA_E_DOMAIN;
  }
  memcpy(P, point.P, sizeof point.P);
  for (int m = 0; m < 6; m++) { // P F^T, J = 1
    const double *p = point.P + 2 * row[m], *f = F + 2 * column[m];
    values[9 + m] = p[0] * f[0] + p[1] * f[1];
  }
  values[16] = fabs(field_V_per_m) * point.area;
  double eps =
      layer->permittivity_F_per_m + layer->permittivity_slope_F_per_m * (sqrt(point.area) - 1);
  values[15] = point.W + 0.5 * eps * values[16] * values[16];
  return DEA_OK;
}

dea_status dea_flat_recover(const struct dea_flat_shape *shape, const struct dea_constituent *layer,
                            const double *X, const double *u, double voltage_V,
                            struct dea_recovered *out)
{
  double values[DEA_FLAT_NODES_MAX][DEA_FIT_VALUES], P[DEA_FLAT_NODES_MAX][6], F[6];
  double field = voltage_V != 0 ? voltage_V / layer->thickness_m : 0;
  struct dea_fit fit;
  out->volume_m3 = out->volume_error = 0;
  for (int q = 0; q < shape->gauss; q++) {
    double area = dea_flat_columns(shape, q, X, u, F);
    dea_status status = area > 0 ? evaluate_point(layer, F, field, values[q], P[q]) : DEA_E_DOMAIN;
    if (status != DEA_OK) {
      return status;
    }
    out->volume_m3 += layer->thickness_m * area;
  }
  dea_fit_create(shape->order, 0, &fit);
  dea_recovered_set(&fit, values, out);
  memset(out->force, 0, sizeof out->force);
  for (int node = 0; node < out->plane_nodes; node++) {
    for (int q = 0; q < shape->gauss; q++) {
      double share = fit.plane[node % fit.n][q % fit.n] * fit.plane[node / fit.n][q / fit.n];
      for (int m = 0; m < 6; m++) {
        out->force[node][m] += share * layer->thickness_m * P[q][m];
      }
    }
  }
  return DEA_OK;
}

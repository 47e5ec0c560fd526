#include "model/solid/element/hex_points.h"

#include "model/solid/element/hex_tensor.h"

#include <math.h>
#include <string.h>

/* From the slopes of X and u by the local axes, slope[a] = {dX/dxi_a, du/dxi_a}. */
static dea_status find_point(double weight, const double *slope[3], struct dea_hex_point *at)
{
  double map[9], cof[9];
  for (int a = 0; a < 3; a++) {
    for (int i = 0; i < 3; i++) {
      map[3 * i + a] = slope[a][i];
    }
  }
  double volume = dea_cofactors(map, cof);
  if (!(volume > 0)) {
    return DEA_E_DOMAIN;
  }
  for (int a = 0; a < 3; a++) {
    for (int J = 0; J < 3; J++) {
      at->local[3 * a + J] = cof[3 * J + a] / volume;
    }
  }
  for (int i = 0; i < 3; i++) {
    for (int J = 0; J < 3; J++) {
      at->F[3 * i + J] = (i == J ? 1 : 0) + slope[0][3 + i] * at->local[J] +
                         slope[1][3 + i] * at->local[3 + J] + slope[2][3 + i] * at->local[6 + J];
    }
  }
  at->J = dea_cofactors(at->F, at->cof);
  at->weight = weight * volume;
  return at->J > 0 ? DEA_OK : DEA_E_DOMAIN;
}

dea_status dea_hex_find_points(const struct dea_hex_shape *s, const double *X, const double *u,
                               struct dea_hex_point *points)
{
  double values[DEA_HEX_NODES_MAX][6], slopes[3 * DEA_HEX_GAUSS_MAX * 6];
  for (int n = 0; n < s->nodes; n++) {
    memcpy(values[n], X + 3 * n, 3 * sizeof *X);
    memcpy(values[n] + 3, u + 3 * n, 3 * sizeof *u);
  }
  dea_hex_slopes(s, 6, values[0], slopes);
  for (int q = 0; q < s->gauss; q++) {
    const double *slope[3] = {slopes + 6 * q, slopes + 6 * (s->gauss + q),
                              slopes + 6 * (2 * s->gauss + q)};
    dea_status status = find_point(s->weight[q], slope, &points[q]);
    if (status != DEA_OK) {
      return status;
    }
  }
  return DEA_OK;
}

dea_status dea_hex_kinematics(const struct dea_hex_shape *s, const double *X, const double *u,
                              double (*gradient)[3][DEA_HEX_NODES_MAX],
                              struct dea_hex_point *points)
{
  dea_status status = dea_hex_find_points(s, X, u, points);
  for (int q = 0; q < s->gauss && status == DEA_OK; q++) {
    for (int J = 0; J < 3; J++) {
      const double *l = points[q].local + J;
      for (int n = 0; n < s->nodes; n++) {
        gradient[q][J][n] =
            l[0] * s->slope[q][0][n] + l[3] * s->slope[q][1][n] + l[6] * s->slope[q][2][n];
      }
    }
  }
  return status;
}

dea_status dea_hex_project(const struct dea_hex_shape *s, const struct dea_hex_point *points,
                           double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX],
                           double *moment, double *theta)
{
  int m = s->pressures;
  memset(moment, 0, (size_t)m * sizeof *moment);
  for (int a = 0; a < m; a++) {
    memset(factor[a], 0, sizeof factor[a]);
  }
  for (int q = 0; q < s->gauss; q++) {
    for (int a = 0; a < m; a++) {
      double f = points[q].weight * s->pressure[q][a];
      moment[a] += f * (points[q].J - 1);
      for (int b = 0; b <= a; b++) {
        factor[a][b] += f * s->pressure[q][b];
      }
    }
  }
  for (int a = 0; a < m; a++) { // Cholesky of a matrix of at most ten rows, and L theta' = moment
    theta[a] = moment[a];
    for (int b = 0; b <= a; b++) {
      double sum = factor[a][b];
      for (int c = 0; c < b; c++) {
        sum -= factor[a][c] * factor[b][c];
      }
      if (a == b && !(sum > 0)) {
        return DEA_E_DOMAIN;
      }
      factor[a][b] = a == b ? sqrt(sum) : sum / factor[b][b];
      theta[a] -= b < a ? factor[a][b] * theta[b] : 0;
    }
    theta[a] /= factor[a][a];
  }
  for (int a = m - 1; a >= 0; a--) { // L^T theta = theta'
    for (int b = a + 1; b < m; b++) {
      theta[a] -= factor[b][a] * theta[b];
    }
    theta[a] /= factor[a][a];
  }
  return DEA_OK;
}

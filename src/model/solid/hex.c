#include "model/solid/hex_points.h"

#include <cblas.h>
#include <math.h>
#include <string.h>

enum { G_ROWS_MAX = 3 * DEA_HEX_GAUSS_MAX };

dea_status dea_hex_kinematics(const struct dea_hex_shape *s, const double *X, const double *u,
                              double (*gradient)[3][DEA_HEX_NODES_MAX], struct dea_hex_point *state)
{
  for (int q = 0; q < s->gauss; q++) {
    double map[9] = {0}, cof[9];
    for (int a = 0; a < 3; a++) {
      for (int n = 0; n < s->nodes; n++) {
        for (int i = 0; i < 3; i++) {
          map[3 * i + a] += X[3 * n + i] * s->slope[q][a][n];
        }
      }
    }
    double volume = dea_cofactors(map, cof);
    if (!(volume > 0)) {
      return DEA_E_DOMAIN;
    }
    for (int J = 0; J < 3; J++) {
      const double *c = cof + 3 * J; // dxi_a/dX_J = cof_Ja / det
      for (int n = 0; n < s->nodes; n++) {
        gradient[q][J][n] =
            (c[0] * s->slope[q][0][n] + c[1] * s->slope[q][1][n] + c[2] * s->slope[q][2][n]) /
            volume;
      }
    }
    struct dea_hex_point *at = &state[q];
    memset(at->F, 0, sizeof at->F);
    at->F[0] = at->F[4] = at->F[8] = 1;
    for (int J = 0; J < 3; J++) {
      for (int n = 0; n < s->nodes; n++) {
        for (int i = 0; i < 3; i++) {
          at->F[3 * i + J] += u[3 * n + i] * gradient[q][J][n];
        }
      }
    }
    at->J = dea_cofactors(at->F, at->cof);
    at->weight = s->weight[q] * volume;
    if (!(at->J > 0)) {
      return DEA_E_DOMAIN;
    }
  }
  return DEA_OK;
}

dea_status dea_hex_project(const struct dea_hex_shape *s, const struct dea_hex_point *state,
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
      double f = state[q].weight * s->pressure[q][a];
      moment[a] += f * (state[q].J - 1);
      for (int b = 0; b <= a; b++) {
        factor[a][b] += f * s->pressure[q][b];
      }
    }
  }
  for (int a = 0; a < m; a++) { // Cholesky of a matrix of at most ten rows
    for (int b = 0; b <= a; b++) {
      double sum = factor[a][b];
      for (int c = 0; c < b; c++) {
        sum -= factor[a][c] * factor[b][c];
      }
      if (a == b && !(sum > 0)) {
        return DEA_E_DOMAIN;
      }
      factor[a][b] = a == b ? sqrt(sum) : sum / factor[b][b];
    }
  }
  memcpy(theta, moment, (size_t)m * sizeof *theta);
  cblas_dtrsv(CblasRowMajor, CblasLower, CblasNoTrans, CblasNonUnit, m, factor[0],
              DEA_HEX_PRESSURES_MAX, theta, 1);
  cblas_dtrsv(CblasRowMajor, CblasLower, CblasTrans, CblasNonUnit, m, factor[0],
              DEA_HEX_PRESSURES_MAX, theta, 1);
  return DEA_OK;
}

/* Work space of a tangent: rows (q, J). */
struct tangent_work {
  double D[6][G_ROWS_MAX][DEA_HEX_NODES_MAX]; // w A_aJkL g_L for the pairs a <= k
  double block[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
  double b[DEA_HEX_PRESSURES_MAX][DEA_HEX_DOFS_MAX]; // int phi cof : grad N
};

static const int block_row[6] = {0, 0, 0, 1, 1, 2}, block_column[6] = {0, 1, 2, 1, 2, 2};

static void tangent_point(const struct dea_hex_shape *s, int q, const struct dea_hex_point *at,
                          const double A[81], double gradient[3][DEA_HEX_NODES_MAX],
                          struct tangent_work *work)
{
  for (int pair = 0; pair < 6; pair++) {
    int a = block_row[pair], k = block_column[pair];
    for (int J = 0; J < 3; J++) {
      const double *row = A + 9 * (3 * a + J) + 3 * k;
      double *to = work->D[pair][3 * q + J];
      double c0 = at->weight * row[0], c1 = at->weight * row[1], c2 = at->weight * row[2];
      for (int n = 0; n < s->nodes; n++) {
        to[n] = c0 * gradient[0][n] + c1 * gradient[1][n] + c2 * gradient[2][n];
      }
    }
  }
}

static void tangent_collect(const struct dea_hex_shape *s, const struct dea_layer *layer,
                            double (*gradient)[3][DEA_HEX_NODES_MAX],
                            double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX],
                            struct tangent_work *work, double *K)
{
  int n = s->nodes, dofs = 3 * n;
  for (int pair = 0; pair < 6; pair++) {
    int a = block_row[pair], k = block_column[pair];
    cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, n, n, 3 * s->gauss, 1, gradient[0][0],
                DEA_HEX_NODES_MAX, work->D[pair][0], DEA_HEX_NODES_MAX, 0, work->block, n);
    for (int i = 0; i < n; i++) {
      for (int j = 0; j < n; j++) {
        K[(3 * i + a) * dofs + 3 * j + k] = work->block[i * n + j];
        K[(3 * j + k) * dofs + 3 * i + a] = work->block[i * n + j];
      }
    }
  }
  if (layer->law != NULL && layer->kappa_Pa > 0) { // kappa b^T M^-1 b
    cblas_dtrsm(CblasRowMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, s->pressures,
                dofs, 1, factor[0], DEA_HEX_PRESSURES_MAX, work->b[0], DEA_HEX_DOFS_MAX);
    cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, dofs, dofs, s->pressures, layer->kappa_Pa,
                work->b[0], DEA_HEX_DOFS_MAX, work->b[0], DEA_HEX_DOFS_MAX, 1, K, dofs);
  }
}

/* Adds one Gauss point to g. */
static void add_force(const struct dea_hex_shape *s, const struct dea_hex_point *at,
                      const double P[9], double gradient[3][DEA_HEX_NODES_MAX], double *g)
{
  for (int n = 0; n < s->nodes; n++) {
    for (int i = 0; i < 3; i++) {
      double push = 0;
      for (int J = 0; J < 3; J++) {
        push += P[3 * i + J] * gradient[J][n];
      }
      g[3 * n + i] += at->weight * push;
    }
  }
}

/* Adds one Gauss point to b. */
static void add_squeeze(const struct dea_hex_shape *s, int q, const struct dea_hex_point *at,
                        double gradient[3][DEA_HEX_NODES_MAX], struct tangent_work *work)
{
  for (int n = 0; n < s->nodes; n++) {
    for (int i = 0; i < 3; i++) {
      double squeeze = 0;
      for (int J = 0; J < 3; J++) {
        squeeze += at->cof[3 * i + J] * gradient[J][n];
      }
      for (int m = 0; m < s->pressures; m++) {
        work->b[m][3 * n + i] += at->weight * s->pressure[q][m] * squeeze;
      }
    }
  }
}

/* Pressure of the projected part at a Gauss point. */
static double pressure_at(const struct dea_hex_shape *s, const struct dea_layer *layer, int q,
                          const double *multiplier, const double *theta)
{
  double pressure = 0;
  for (int m = 0; m < s->pressures; m++) {
    pressure += s->pressure[q][m] * (multiplier[m] + layer->kappa_Pa * theta[m]);
  }
  return pressure;
}

dea_status dea_hex_evaluate(const struct dea_hex_shape *shape, const struct dea_layer *layer,
                            const double *X, const double *u, const double *multiplier,
                            double voltage_V, enum dea_level level, struct dea_element_result *out)
{
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX];
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX], moment[DEA_HEX_PRESSURES_MAX];
  struct tangent_work work;
  bool projected = layer->law != NULL;
  double field = voltage_V != 0 ? voltage_V / layer->thickness_m : 0;
  dea_status status = dea_hex_kinematics(shape, X, u, gradient, points);
  if (status == DEA_OK && projected) {
    status = dea_hex_project(shape, points, factor, moment, out->theta);
  }
  if (status != DEA_OK) {
    return status;
  }
  memset(out->g, 0, 3 * (size_t)shape->nodes * sizeof out->g[0]);
  memset(work.b, 0, level == DEA_TANGENT ? sizeof work.b : 0);
  out->energy_J = out->volume_m3 = 0;
  for (int m = 0; m < shape->pressures && projected; m++) {
    out->energy_J += (multiplier[m] + 0.5 * layer->kappa_Pa * out->theta[m]) * moment[m];
  }
  for (int q = 0; q < shape->gauss; q++) {
    const struct dea_hex_point *at = &points[q];
    struct dea_point point;
    double pressure = projected ? pressure_at(shape, layer, q, multiplier, out->theta) : 0;
    status = dea_layer_point(layer, at->F, at->cof, at->J, pressure, field, &point);
    if (status != DEA_OK) {
      return status;
    }
    out->energy_J += at->weight * point.W;
    out->volume_m3 += at->weight;
    if (level >= DEA_FORCE) {
      add_force(shape, at, point.P, gradient[q], out->g);
    }
    if (level >= DEA_TANGENT) {
      add_squeeze(shape, q, at, gradient[q], &work);
      tangent_point(shape, q, at, point.A, gradient[q], &work);
    }
  }
  if (level >= DEA_TANGENT) {
    tangent_collect(shape, layer, gradient, factor, &work, out->K);
  }
  return DEA_OK;
}

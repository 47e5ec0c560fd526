#include "model/solid/hex.h"

#include "base/quadrature.h"

#include <cblas.h>
#include <math.h>
#include <string.h>

enum { G_ROWS_MAX = 3 * DEA_HEX_GAUSS_MAX };

/* ---- shape ---- */

static void fill_point(struct dea_hex_shape *s, int q, const double at[3], const double *nodes,
                       const double *nodes_z)
{
  double v[3][DEA_HEX_ORDER_MAX + 1], d[3][DEA_HEX_ORDER_MAX + 1];
  size_t n = (size_t)s->order + 1, nz = (size_t)s->order_z + 1;
  dea_lagrange(n, nodes, at[0], v[0], d[0]);
  dea_lagrange(n, nodes, at[1], v[1], d[1]);
  dea_lagrange(nz, nodes_z, at[2], v[2], d[2]);
  int node = 0;
  for (size_t k = 0; k < nz; k++) {
    for (size_t j = 0; j < n; j++) {
      for (size_t i = 0; i < n; i++, node++) {
        s->value[q][node] = v[0][i] * v[1][j] * v[2][k];
        s->slope[q][0][node] = d[0][i] * v[1][j] * v[2][k];
        s->slope[q][1][node] = v[0][i] * d[1][j] * v[2][k];
        s->slope[q][2][node] = v[0][i] * v[1][j] * d[2][k];
      }
    }
  }
  s->pressures = 0;
  for (int c = 0; c < s->order_z; c++) { // xi^a eta^b zeta^c, total degree below the order
    for (int b = 0; b + c < s->order; b++) {
      for (int a = 0; a + b + c < s->order; a++) {
        s->pressure[q][s->pressures++] = pow(at[0], a) * pow(at[1], b) * pow(at[2], c);
      }
    }
  }
}

dea_status dea_hex_shape_create(int order, int order_z, struct dea_hex_shape *out)
{
  memset(out, 0, sizeof *out);
  if (order < 1 || order > DEA_HEX_ORDER_MAX || order_z < 1 || order_z > DEA_HEX_ORDER_MAX) {
    return DEA_E_ARGUMENT;
  }
  int n = order + 1, nz = order_z + 1;
  double nodes[DEA_HEX_ORDER_MAX + 1], nodes_z[DEA_HEX_ORDER_MAX + 1];
  double x[DEA_HEX_ORDER_MAX + 1], w[DEA_HEX_ORDER_MAX + 1];
  double z[DEA_HEX_ORDER_MAX + 1], wz[DEA_HEX_ORDER_MAX + 1];
  out->order = order;
  out->order_z = order_z;
  out->nodes = out->gauss = n * n * nz;
  dea_lobatto_nodes((size_t)order, nodes);
  dea_lobatto_nodes((size_t)order_z, nodes_z);
  dea_gauss_rule((size_t)n, x, w);
  dea_gauss_rule((size_t)nz, z, wz);
  for (int k = 0, q = 0; k < nz; k++) {
    for (int j = 0; j < n; j++) {
      for (int i = 0; i < n; i++, q++) {
        fill_point(out, q, (const double[3]){x[i], x[j], z[k]}, nodes, nodes_z);
        out->weight[q] = w[i] * w[j] * wz[k];
        out->node_at[q][0] = nodes[i]; // as many nodes as Gauss points, in the same order
        out->node_at[q][1] = nodes[j];
        out->node_at[q][2] = nodes_z[k];
      }
    }
  }
  return DEA_OK;
}

/* ---- material point of a layer ---- */

static double determinant(const double F[9], double cof[9])
{
  cof[0] = F[4] * F[8] - F[5] * F[7];
  cof[1] = F[5] * F[6] - F[3] * F[8];
  cof[2] = F[3] * F[7] - F[4] * F[6];
  cof[3] = F[2] * F[7] - F[1] * F[8];
  cof[4] = F[0] * F[8] - F[2] * F[6];
  cof[5] = F[1] * F[6] - F[0] * F[7];
  cof[6] = F[1] * F[5] - F[2] * F[4];
  cof[7] = F[2] * F[3] - F[0] * F[5];
  cof[8] = F[0] * F[4] - F[1] * F[3];
  return F[0] * cof[0] + F[1] * cof[1] + F[2] * cof[2];
}

/* A += f d2J/dF2: eps_ikm eps_JLN F_mN. */
static void add_second_of_J(double f, const double F[9], double A[81])
{
  for (int i = 0; i < 3; i++) {
    int k1 = (i + 1) % 3, k2 = (i + 2) % 3;
    for (int J = 0; J < 3; J++) {
      int L1 = (J + 1) % 3, L2 = (J + 2) % 3;
      double *row = A + 9 * (3 * i + J);
      row[3 * k1 + L1] += f * F[3 * k2 + L2];
      row[3 * k1 + L2] -= f * F[3 * k2 + L1];
      row[3 * k2 + L1] -= f * F[3 * k1 + L2];
      row[3 * k2 + L2] += f * F[3 * k1 + L1];
    }
  }
}

/* W = mu/2 (I1 - 3 - 2 ln J) + lambda/2 ln^2 J. */
static void compressible(const struct dea_hex_layer *layer, const double F[9], const double cof[9],
                         double J, struct dea_point *out)
{
  double mu = layer->lame_mu_Pa, lambda = layer->lame_lambda_Pa, l = log(J), I1 = 0, inverse[9];
  for (int a = 0; a < 9; a++) {
    I1 += F[a] * F[a];
    inverse[a] = cof[a] / J; // F^-T
  }
  out->W = 0.5 * mu * (I1 - 3 - 2 * l) + 0.5 * lambda * l * l;
  for (int a = 0; a < 9; a++) {
    out->P[a] = mu * (F[a] - inverse[a]) + lambda * l * inverse[a];
    for (int b = 0; b < 9; b++) {
      int crossed_a = 3 * (a / 3) + b % 3, crossed_b = 3 * (b / 3) + a % 3;
      out->A[9 * a + b] = (a == b ? mu : 0) + lambda * inverse[a] * inverse[b] +
                          (mu - lambda * l) * inverse[crossed_a] * inverse[crossed_b];
    }
  }
}

/* -(k/2) |F_1 x F_2|^2; |F_1 x F_2|^2 = |F_1|^2 |F_2|^2 - (F_1 . F_2)^2 of the in-plane columns. */
static void add_electric(double k, const double F[9], struct dea_point *out)
{
  double c[2][3], m[2][2];
  for (int J = 0; J < 2; J++) {
    for (int i = 0; i < 3; i++) {
      c[J][i] = F[3 * i + J];
    }
  }
  for (int J = 0; J < 2; J++) {
    for (int L = 0; L < 2; L++) {
      m[J][L] = c[J][0] * c[L][0] + c[J][1] * c[L][1] + c[J][2] * c[L][2];
    }
  }
  out->W -= 0.5 * k * (m[0][0] * m[1][1] - m[0][1] * m[0][1]);
  for (int J = 0; J < 2; J++) {
    int O = 1 - J; // the other column
    for (int i = 0; i < 3; i++) {
      out->P[3 * i + J] -= k * (m[O][O] * c[J][i] - m[0][1] * c[O][i]);
      double *row = out->A + 9 * (3 * i + J);
      for (int p = 0; p < 3; p++) {
        row[3 * p + J] -= k * ((i == p ? m[O][O] : 0) - c[O][i] * c[O][p]);
        row[3 * p + O] -= k * (2 * c[J][i] * c[O][p] - c[O][i] * c[J][p] - (i == p ? m[0][1] : 0));
      }
    }
  }
}

/* Elastic part with the pre-stretch: P_iJ = P(FG)_iJ G_J, and so twice for A. */
static dea_status elastic(const struct dea_hex_layer *layer, const double F[9], const double cof[9],
                          double J, struct dea_point *out)
{
  if (layer->law == NULL) {
    compressible(layer, F, cof, J, out);
    return DEA_OK;
  }
  static const double fibre[3] = {1, 0, 0};
  const double *G = layer->pre_stretch;
  double FG[9];
  for (int a = 0; a < 9; a++) {
    FG[a] = F[a] * G[a % 3];
  }
  dea_status status = dea_point_elastic(layer->law, layer->param, FG, fibre, out);
  for (int a = 0; a < 9; a++) {
    out->P[a] *= G[a % 3];
    for (int b = 0; b < 9; b++) {
      out->A[9 * a + b] *= G[a % 3] * G[b % 3];
    }
  }
  return status;
}

dea_status dea_hex_layer_relax(struct dea_hex_layer *layer)
{
  static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  struct dea_point point;
  layer->p0_Pa = 0;
  if (layer->law == NULL) {
    return DEA_OK;
  }
  dea_status status = elastic(layer, one, one, 1, &point);
  layer->p0_Pa = -point.P[8];
  layer->kappa_s_Pa =
      0.5 * fabs(layer->p0_Pa); // above the third that it takes, docs/theory/solid.md
  return status;
}

/* ---- element ---- */

struct gauss_state {
  double F[9], cof[9], J, weight;
};

/* Gradients by X at every Gauss point, as rows [q][J][node], and F there. */
static dea_status kinematics(const struct dea_hex_shape *s, const double *X, const double *u,
                             double (*gradient)[3][DEA_HEX_NODES_MAX], struct gauss_state *state)
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
    double volume = determinant(map, cof);
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
    struct gauss_state *at = &state[q];
    memset(at->F, 0, sizeof at->F);
    at->F[0] = at->F[4] = at->F[8] = 1;
    for (int J = 0; J < 3; J++) {
      for (int n = 0; n < s->nodes; n++) {
        for (int i = 0; i < 3; i++) {
          at->F[3 * i + J] += u[3 * n + i] * gradient[q][J][n];
        }
      }
    }
    at->J = determinant(at->F, at->cof);
    at->weight = s->weight[q] * volume;
    if (!(at->J > 0)) {
      return DEA_E_DOMAIN;
    }
  }
  return DEA_OK;
}

/* Projection of J - 1: theta = M^-1 int phi (J - 1), with M = L L^T kept in `factor`. */
static dea_status project(const struct dea_hex_shape *s, const struct gauss_state *state,
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

static void tangent_point(const struct dea_hex_shape *s, int q, const struct gauss_state *at,
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

static void tangent_collect(const struct dea_hex_shape *s, const struct dea_hex_layer *layer,
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

/* Adds one Gauss point to energy, g and b. */
static void add_point(const struct dea_hex_shape *s, int q, const struct gauss_state *at,
                      const double P[9], double gradient[3][DEA_HEX_NODES_MAX], double *g,
                      struct tangent_work *work)
{
  for (int n = 0; n < s->nodes; n++) {
    for (int i = 0; i < 3; i++) {
      double push = 0, squeeze = 0;
      for (int J = 0; J < 3; J++) {
        push += P[3 * i + J] * gradient[J][n];
        squeeze += at->cof[3 * i + J] * gradient[J][n];
      }
      g[3 * n + i] += at->weight * push;
      for (int m = 0; m < s->pressures; m++) {
        work->b[m][3 * n + i] += at->weight * s->pressure[q][m] * squeeze;
      }
    }
  }
}

/* Stress and tangent of everything at one Gauss point. pressure: of the projected part. */
static dea_status point_of(const struct dea_hex_layer *layer, const struct gauss_state *at,
                           double pressure, double voltage_V, struct dea_point *point)
{
  dea_status status = elastic(layer, at->F, at->cof, at->J, point);
  if (status != DEA_OK) {
    return status;
  }
  if (layer->law != NULL) {
    double excess = at->J - 1, p = layer->p0_Pa + layer->kappa_s_Pa * excess;
    point->W += layer->p0_Pa * excess + 0.5 * layer->kappa_s_Pa * excess * excess;
    p += pressure;
    for (int a = 0; a < 9; a++) {
      point->P[a] += p * at->cof[a];
      for (int b = 0; b < 9; b++) {
        point->A[9 * a + b] += layer->kappa_s_Pa * at->cof[a] * at->cof[b];
      }
    }
    add_second_of_J(p, at->F, point->A);
  }
  if (voltage_V != 0 && layer->permittivity_F_per_m > 0) {
    double field = voltage_V / layer->thickness_m;
    add_electric(layer->permittivity_F_per_m * field * field, at->F, point);
  }
  return DEA_OK;
}

dea_status dea_hex_evaluate(const struct dea_hex_shape *shape, const struct dea_hex_layer *layer,
                            const double *X, const double *u, const double *multiplier,
                            double voltage_V, bool want_tangent, struct dea_hex_result *out)
{
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX];
  struct gauss_state state[DEA_HEX_GAUSS_MAX];
  double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX], moment[DEA_HEX_PRESSURES_MAX];
  struct tangent_work work;
  int dofs = 3 * shape->nodes;
  bool projected = layer->law != NULL;
  dea_status status = kinematics(shape, X, u, gradient, state);
  if (status == DEA_OK && projected) {
    status = project(shape, state, factor, moment, out->theta);
  }
  if (status != DEA_OK) {
    return status;
  }
  memset(out->g, 0, (size_t)dofs * sizeof out->g[0]);
  memset(work.b, 0, sizeof work.b);
  out->energy_J = out->volume_m3 = 0;
  for (int m = 0; m < shape->pressures && projected; m++) {
    out->energy_J += (multiplier[m] + 0.5 * layer->kappa_Pa * out->theta[m]) * moment[m];
  }
  for (int q = 0; q < shape->gauss; q++) {
    double pressure = 0;
    for (int m = 0; m < shape->pressures && projected; m++) {
      pressure += shape->pressure[q][m] * (multiplier[m] + layer->kappa_Pa * out->theta[m]);
    }
    struct dea_point point;
    status = point_of(layer, &state[q], pressure, voltage_V, &point);
    if (status != DEA_OK) {
      return status;
    }
    out->energy_J += state[q].weight * point.W;
    out->volume_m3 += state[q].weight;
    if (want_tangent) {
      add_point(shape, q, &state[q], point.P, gradient[q], out->g, &work);
      tangent_point(shape, q, &state[q], point.A, gradient[q], &work);
    }
  }
  if (want_tangent) {
    tangent_collect(shape, layer, gradient, factor, &work, out->K);
  }
  return DEA_OK;
}

/* Stresses at the end of a linear step, and what the solver measures displacements with. */
#include "model/solid/element/hex_points.h"
#include "model/solid/point/viscous.h"

#include <string.h>

size_t dea_hex_predicted_count(const struct dea_hex_shape *shape)
{
  return (size_t)(shape->pressures + 6 * shape->gauss);
}

/* H_iJ = sum_n step_ni dN_n/dX_J at a Gauss point. */
static void step_gradient(const struct dea_hex_shape *s, double gradient[3][DEA_HEX_NODES_MAX],
                          const double *step, double H[9])
{
  memset(H, 0, 9 * sizeof *H);
  for (int J = 0; J < 3; J++) {
    for (int n = 0; n < s->nodes; n++) {
      for (int i = 0; i < 3; i++) {
        H[3 * i + J] += step[3 * n + i] * gradient[J][n];
      }
    }
  }
}

static double product(const double a[9], const double b[9])
{
  double sum = 0;
  for (int k = 0; k < 9; k++) {
    sum += a[k] * b[k];
  }
  return sum;
}

/* M^-1 moment with M = L L^T. */
static void solve_moments(const struct dea_hex_shape *s,
                          double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX],
                          double *moment)
{
  for (int a = 0; a < s->pressures; a++) {
    for (int b = 0; b < a; b++) {
      moment[a] -= factor[a][b] * moment[b];
    }
    moment[a] /= factor[a][a];
  }
  for (int a = s->pressures - 1; a >= 0; a--) {
    for (int b = a + 1; b < s->pressures; b++) {
      moment[a] -= factor[b][a] * moment[b];
    }
    moment[a] /= factor[a][a];
  }
}

/* S + share F^-1 (dP - H S) at a point: dS of dP = H S + F dS. */
static dea_status predict_point(const struct dea_constituent *layer, int q,
                                const struct dea_hex_point *at, double pressure,
                                double pressure_change, double field, const double H[9],
                                double share, double out[6])
{
  struct dea_point point;
  double S[9], dP[9], dS[9];
  dea_status status = dea_constituent_point(layer, at->F, at->cof, at->J, pressure, field, &point);
  if (status != DEA_OK) {
    return status;
  }
  dea_viscous_add(layer, q, at->F, at->cof, at->J, true, &point);
  dea_constituent_second_stress(at->cof, at->J, point.P, S);
  for (int i = 0; i < 3; i++) {
    for (int B = 0; B < 3; B++) {
      int a = 3 * i + B;
      dP[a] = product(point.A + 9 * a, H) + pressure_change * at->cof[a];
      for (int A = 0; A < 3; A++) {
        dP[a] -= H[3 * i + A] * S[3 * A + B];
      }
    }
  }
  dea_constituent_second_stress(at->cof, at->J, dP, dS);
  for (int a = 0; a < 9; a++) {
    S[a] += share * dS[a];
  }
  const double ordered[6] = {
      S[0], S[4], S[8], 0.5 * (S[5] + S[7]), 0.5 * (S[2] + S[6]), 0.5 * (S[1] + S[3])};
  memcpy(out, ordered, sizeof ordered);
  return DEA_OK;
}

dea_status dea_hex_predict(const struct dea_hex_shape *s, const struct dea_constituent *layer,
                           const double *X, const double *u, const double *multiplier,
                           double voltage_V, const double *step, double share, bool stresses,
                           double *predicted)
{
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX], H[DEA_HEX_GAUSS_MAX][9];
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX], moment[DEA_HEX_PRESSURES_MAX];
  double theta[DEA_HEX_PRESSURES_MAX] = {0}, change[DEA_HEX_PRESSURES_MAX] = {0};
  double field = voltage_V != 0 ? voltage_V / layer->thickness_m : 0;
  bool projected = layer->law != NULL;
  dea_status status = dea_hex_kinematics(s, X, u, gradient, points);
  if (status == DEA_OK && projected) {
    status = dea_hex_project(s, points, factor, moment, theta);
  }
  for (int q = 0; q < s->gauss && status == DEA_OK; q++) {
    step_gradient(s, gradient[q], step, H[q]);
    double squeeze = points[q].weight * product(points[q].cof, H[q]);
    for (int m = 0; m < s->pressures && projected; m++) {
      change[m] += s->pressure[q][m] * squeeze;
    }
  }
  if (status == DEA_OK && projected) {
    solve_moments(s, factor, change);
  }
  double kappa = projected ? layer->kappa_Pa : 0;
  for (int m = 0; m < s->pressures; m++) {
    predicted[m] = projected ? multiplier[m] + kappa * (theta[m] + share * change[m]) : 0;
  }
  for (int q = 0; q < s->gauss && status == DEA_OK && stresses; q++) {
    double pressure = 0, pressure_change = 0;
    for (int m = 0; m < s->pressures && projected; m++) {
      pressure += s->pressure[q][m] * (multiplier[m] + kappa * theta[m]);
      pressure_change += s->pressure[q][m] * kappa * change[m];
    }
    status = predict_point(layer, q, &points[q], pressure, pressure_change, field, H[q], share,
                           predicted + s->pressures + 6 * q);
  }
  return status;
}

dea_status dea_hex_metric(const struct dea_hex_shape *s, const double *X, double *laplace,
                          double *volume)
{
  static const double rest[DEA_HEX_DOFS_MAX] = {0};
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX], whole = 0, sum = 0;
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  dea_status status = dea_hex_kinematics(s, X, rest, gradient, points);
  if (status != DEA_OK) {
    return status;
  }
  size_t nodes = (size_t)s->nodes;
  memset(laplace, 0, nodes * nodes * sizeof *laplace);
  memset(volume, 0, nodes * sizeof *volume);
  for (int q = 0; q < s->gauss; q++) {
    double w = points[q].weight;
    whole += w;
    for (size_t a = 0; a < nodes; a++) {
      const double *x = gradient[q][0], *y = gradient[q][1], *z = gradient[q][2];
      for (size_t b = 0; b < nodes; b++) {
        laplace[a * nodes + b] += w * (x[a] * x[b] + y[a] * y[b] + z[a] * z[b]);
      }
      volume[a] += w * s->value[q][a] * s->value[q][a]; // the diagonal of the mass matrix
    }
  }
  for (size_t a = 0; a < nodes; a++) {
    sum += volume[a];
  }
  for (size_t a = 0; a < nodes; a++) {
    volume[a] *= whole / sum;
  }
  return DEA_OK;
}

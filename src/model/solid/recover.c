/* Values of one element at its nodes. */
#include "model/solid/recover.h"

#include "base/quadrature.h"
#include "model/solid/hex_points.h"

#include <math.h>
#include <string.h>

enum { LINE_MAX = DEA_HEX_ORDER_MAX + 1, VALUES = 16 };

/* Legendre polynomials up to degree 2. */
static double legendre(int degree, double x)
{
  return degree == 0 ? 1 : degree == 1 ? x : 0.5 * (3 * x * x - 1);
}

/* Along one axis: the value at node i of the polynomial of that degree which is nearest to values
 * at the Gauss points q (in the mean square) is the sum over q of fit[i][q] times them. */
static void fit_line(int order, int degree, double fit[LINE_MAX][LINE_MAX])
{
  double nodes[LINE_MAX], x[LINE_MAX], w[LINE_MAX];
  dea_lobatto_nodes((size_t)order, nodes);
  dea_gauss_rule((size_t)order + 1, x, w);
  for (int i = 0; i <= order; i++) {
    for (int q = 0; q <= order; q++) {
      fit[i][q] = 0;
      for (int a = 0; a <= degree; a++) {
        fit[i][q] += (a + 0.5) * legendre(a, nodes[i]) * legendre(a, x[q]) * w[q];
      }
    }
  }
}

/* Both fits of an element: in its plane one degree below the displacements; through the thickness
 * too, but at least linear, since a plate that bends has stresses linear in z. */
struct fit {
  int n, nz; // Gauss points, and nodes, along the axes
  double plane[LINE_MAX][LINE_MAX], z[LINE_MAX][LINE_MAX];
};

static void fit_element(const struct dea_hex_shape *shape, struct fit *out)
{
  out->n = shape->order + 1;
  out->nz = shape->order_z + 1;
  fit_line(shape->order, shape->order - 1, out->plane);
  fit_line(shape->order_z, shape->order_z > 1 ? shape->order_z - 1 : 1, out->z);
}

/* Values at a node (i, j, k) from those at the Gauss points, [gauss][VALUES]. */
static void fit_node(const struct fit *fit, int i, int j, int k, double (*at)[VALUES],
                     double out[VALUES])
{
  memset(out, 0, VALUES * sizeof *out);
  for (int c = 0, q = 0; c < fit->nz; c++) {
    for (int b = 0; b < fit->n; b++) {
      for (int a = 0; a < fit->n; a++, q++) {
        double share = fit->plane[i][a] * fit->plane[j][b] * fit->z[k][c];
        for (int v = 0; v < VALUES; v++) {
          out[v] += share * at[q][v];
        }
      }
    }
  }
}

/* sigma = P F^T / J as xx yy zz xy yz zx. */
static void true_stress(const double P[9], const double F[9], double J, double out[6])
{
  static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
  for (int m = 0; m < 6; m++) {
    const double *p = P + 3 * row[m], *f = F + 3 * column[m];
    out[m] = (p[0] * f[0] + p[1] * f[1] + p[2] * f[2]) / J;
  }
}

/* Elastic energy alone: that of the point without the terms of pressure. */
static double elastic_energy(const struct dea_layer *layer, double W, double J)
{
  double excess = J - 1;
  return layer->law == NULL ? W
                            : W - layer->p0_Pa * excess - 0.5 * layer->kappa_s_Pa * excess * excess;
}

/* Values of one Gauss point: F, stress, energy; and P for the membrane force. */
static dea_status evaluate_point(const struct dea_hex_shape *s, const struct dea_layer *layer,
                                 const struct dea_hex_point *at, int q, const double *pressures,
                                 double field_V_per_m, double values[VALUES], double P[9])
{
  struct dea_point point;
  double pressure = 0;
  for (int m = 0; m < s->pressures; m++) {
    pressure += s->pressure[q][m] * pressures[m];
  }
  dea_status status =
      dea_layer_point(layer, at->F, at->cof, at->J, pressure, field_V_per_m, &point);
  if (status != DEA_OK) {
    return status;
  }
  memcpy(values, at->F, sizeof at->F);
  memcpy(P, point.P, 9 * sizeof *P);
  true_stress(point.P, at->F, at->J, values + 9);
  if (field_V_per_m != 0) {
    status = dea_layer_point(layer, at->F, at->cof, at->J, 0, 0, &point);
  }
  values[15] = elastic_energy(layer, point.W, at->J);
  return status;
}

/* P through the thickness of the element, at the plane nodes. The two fits along the plane are
 * those of the stress. */
static void membrane_force(const struct dea_hex_shape *s, const struct fit *fit, double thickness_m,
                           double (*P)[9], struct dea_recovered *out)
{
  double x[LINE_MAX], w[LINE_MAX];
  dea_gauss_rule((size_t)fit->nz, x, w);
  memset(out->force, 0, sizeof out->force);
  for (int node = 0; node < out->plane_nodes; node++) {
    int i = node % fit->n, j = node / fit->n;
    for (int q = 0; q < s->gauss; q++) {
      int a = q % fit->n, b = q / fit->n % fit->n, c = q / (fit->n * fit->n);
      double share = fit->plane[i][a] * fit->plane[j][b] * 0.5 * w[c] * thickness_m;
      for (int m = 0; m < 3; m++) {
        out->force[node][2 * m] += share * P[q][3 * m];
        out->force[node][2 * m + 1] += share * P[q][3 * m + 1];
      }
    }
  }
}

dea_status dea_hex_recover(const struct dea_hex_shape *shape, const struct dea_layer *layer,
                           const double *X, const double *u, const double *multiplier,
                           double voltage_V, struct dea_recovered *out)
{
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX];
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX], moment[DEA_HEX_PRESSURES_MAX];
  double pressures[DEA_HEX_PRESSURES_MAX], values[DEA_HEX_GAUSS_MAX][VALUES];
  double P[DEA_HEX_GAUSS_MAX][9];
  struct fit fit;
  double field = layer->thickness_m > 0 ? voltage_V / layer->thickness_m : 0;
  *out = (struct dea_recovered){.nodes = shape->nodes};
  dea_status status = dea_hex_kinematics(shape, X, u, gradient, points);
  if (status == DEA_OK) {
    status = dea_hex_project(shape, points, factor, moment, pressures);
  }
  for (int m = 0; m < shape->pressures && status == DEA_OK; m++) {
    pressures[m] =
        layer->law == NULL ? 0 : multiplier[m] + layer->kappa_Pa * pressures[m]; // of theta
  }
  for (int q = 0; q < shape->gauss && status == DEA_OK; q++) {
    status = evaluate_point(shape, layer, &points[q], q, pressures, field, values[q], P[q]);
    out->volume_m3 += points[q].weight;
    out->volume_error = fmax(out->volume_error, fabs(points[q].J - 1));
  }
  if (status != DEA_OK) {
    return status;
  }
  fit_element(shape, &fit);
  out->plane_nodes = fit.n * fit.n;
  for (int node = 0; node < shape->nodes; node++) {
    double at[VALUES];
    fit_node(&fit, node % fit.n, node / fit.n % fit.n, node / out->plane_nodes, values, at);
    memcpy(out->F[node], at, sizeof out->F[node]);
    memcpy(out->stress[node], at + 9, sizeof out->stress[node]);
    out->energy[node] = at[15];
  }
  membrane_force(shape, &fit, X[3 * (shape->nodes - 1) + 2] - X[2], P, out);
  return DEA_OK;
}

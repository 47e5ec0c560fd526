/* Values of one hexahedron at its nodes. */
#include "model/solid/element/hex.h"

#include "base/quadrature.h"
#include "model/solid/element/fit.h"

#include <math.h>
#include <string.h>

/* sigma = P F^T / J as xx yy zz xy yz zx. */
static void true_stress(const double P[9], const double F[9], double J, double out[6])
{
  static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
  for (int m = 0; m < 6; m++) {
    const double *p = P + 3 * row[m], *f = F + 3 * column[m];
    out[m] = (p[0] * f[0] + p[1] * f[1] + p[2] * f[2]) / J;
  }
}

static void cross(const double a[3], const double b[3], double out[3])
{
  for (int i = 0; i < 3; i++) {
    out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
  }
}

/* P -= d/dF of (eps/2) |w|^2, w = cof(F) E (docs/theory/coupled.md): with F_N the columns of F that
 * is eps times eps_JLN E_J (F_N x w). Returns |w|, the field at J = 1. */
static double add_electric(double eps, const struct dea_hex_point *at, const double E[3],
                           double P[9])
{
  double w[3], turned[3][3];
  for (int i = 0; i < 3; i++) {
    w[i] = at->cof[3 * i] * E[0] + at->cof[3 * i + 1] * E[1] + at->cof[3 * i + 2] * E[2];
  }
  for (int N = 0; N < 3; N++) {
    const double column[3] = {at->F[N], at->F[3 + N], at->F[6 + N]};
    cross(column, w, turned[N]);
  }
  for (int L = 0; L < 3; L++) {
    int N = (L + 1) % 3, J = (L + 2) % 3; // even: J L N, odd: N L J
    for (int k = 0; k < 3; k++) {
      P[3 * k + L] -= eps * (E[J] * turned[N][k] - E[N] * turned[J][k]);
    }
  }
  return sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
}

/* Field E in the stretched flat film from potentials c psi. */
static void coupled_field(const struct dea_hex_shape *s, double gradient[3][DEA_HEX_NODES_MAX],
                          const double *psi, double c, double E[3])
{
  for (int J = 0; J < 3; J++) {
    E[J] = 0;
    for (int n = 0; n < s->nodes; n++) {
      E[J] -= c * psi[n] * gradient[J][n];
    }
  }
}

/* Values of one Gauss point, and P for the membrane force. E: of a coupled field, NULL for a thin
 * film with thin_V_per_m. */
static dea_status evaluate_point(const struct dea_constituent *constituent,
                                 const struct dea_hex_point *at, double pressure,
                                 double thin_V_per_m, const double *E,
                                 double values[DEA_FIT_VALUES], double P[9])
{
  struct dea_point point;
  dea_status status =
      dea_constituent_stress(constituent, at->F, at->cof, at->J, pressure, 0, &point);
  values[15] = point.W; // elastic alone: without the terms of pressure
  double slope, curvature;
  values[15] -= constituent->p0_Pa * (at->J - 1) +
                dea_constituent_pointwise(constituent, at->J, &slope, &curvature);
  if (status == DEA_OK && E == NULL && thin_V_per_m != 0) { // electrostriction included
    status =
        dea_constituent_stress(constituent, at->F, at->cof, at->J, pressure, thin_V_per_m, &point);
  }
  if (status != DEA_OK) {
    return status;
  }
  const double *c = at->cof;
  memcpy(P, point.P, 9 * sizeof *P);
  values[16] = fabs(thin_V_per_m) * sqrt(c[2] * c[2] + c[5] * c[5] + c[8] * c[8]); // |F_1 x F_2|
  if (E != NULL) {
    values[16] = add_electric(constituent->permittivity_F_per_m, at, E, P);
  }
  memcpy(values, at->F, sizeof at->F);
  true_stress(P, at->F, at->J, values + 9);
  return DEA_OK;
}

/* P through the thickness of the element, at the plane nodes; along the plane as the stress. */
static void membrane_force(const struct dea_hex_shape *s, const struct dea_fit *fit,
                           double thickness_m, double (*P)[9], struct dea_recovered *out)
{
  double x[DEA_FIT_LINE_MAX], w[DEA_FIT_LINE_MAX];
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

dea_status dea_hex_recover(const struct dea_element *element, const struct dea_element_input *in,
                           struct dea_recovered *out)
{
  const struct dea_hex_shape *shape = element->basis;
  const struct dea_constituent *constituent = in->constituent;
  bool coupled = element->type->per_node > 3;
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX];
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX], moment[DEA_HEX_PRESSURES_MAX];
  double theta[DEA_HEX_PRESSURES_MAX], values[DEA_HEX_GAUSS_MAX][DEA_FIT_VALUES];
  double P[DEA_HEX_GAUSS_MAX][9];
  struct dea_fit fit;
  double thin_V_per_m =
      !coupled && constituent->thickness_m > 0 ? in->voltage_V / constituent->thickness_m : 0;
  out->volume_m3 = out->volume_error = 0;
  dea_status status = dea_hex_kinematics(shape, in->X, in->u, gradient, points);
  if (status == DEA_OK) {
    status = dea_hex_project(shape, points, factor, moment, theta);
  }
  for (int q = 0; q < shape->gauss && status == DEA_OK; q++) {
    double pressure = 0, E[3];
    for (int m = 0; m < shape->pressures; m++) {
      pressure += shape->pressure[q][m] * (in->multiplier[m] + constituent->kappa_Pa * theta[m]);
    }
    if (coupled) {
      coupled_field(shape, gradient[q], in->potential, in->potential_V_per_m, E);
    }
    status = evaluate_point(constituent, &points[q], pressure, thin_V_per_m, coupled ? E : NULL,
                            values[q], P[q]);
    out->volume_m3 += points[q].weight;
    out->volume_error = fmax(out->volume_error, fabs(points[q].J - 1));
  }
  if (status != DEA_OK) {
    return status;
  }
  dea_fit_create(shape->order, shape->order_z, &fit);
  dea_recovered_set(&fit, values, out);
  membrane_force(shape, &fit, in->X[3 * (shape->nodes - 1) + 2] - in->X[2], P, out);
  return DEA_OK;
}

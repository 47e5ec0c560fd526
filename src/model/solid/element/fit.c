#include "model/solid/element/fit.h"

#include "base/quadrature.h"

#include <string.h>

/* Legendre polynomials up to degree 2. */
static double legendre(int degree, double x)
{
  return degree == 0 ? 1 : degree == 1 ? x : 0.5 * (3 * x * x - 1);
}

static void fit_line(int order, int degree, double fit[DEA_FIT_LINE_MAX][DEA_FIT_LINE_MAX])
{
  double nodes[DEA_FIT_LINE_MAX], x[DEA_FIT_LINE_MAX], w[DEA_FIT_LINE_MAX];
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

void dea_fit_create(int order, int order_z, struct dea_gauss_fit *out)
{
  out->n = order + 1;
  out->nz = order_z + 1;
  fit_line(order, order - 1, out->plane);
  if (order_z > 0) {
    fit_line(order_z, order_z > 1 ? order_z - 1 : 1, out->z);
  } else {
    out->z[0][0] = 1;
  }
}

void dea_fit_node(const struct dea_gauss_fit *fit, int node, double (*at)[DEA_FIT_VALUES],
                  double out[DEA_FIT_VALUES])
{
  int i = node % fit->n, j = node / fit->n % fit->n, k = node / (fit->n * fit->n);
  memset(out, 0, DEA_FIT_VALUES * sizeof *out);
  for (int c = 0, q = 0; c < fit->nz; c++) {
    for (int b = 0; b < fit->n; b++) {
      for (int a = 0; a < fit->n; a++, q++) {
        double share = fit->plane[i][a] * fit->plane[j][b] * fit->z[k][c];
        for (int v = 0; v < DEA_FIT_VALUES; v++) {
          out[v] += share * at[q][v];
        }
      }
    }
  }
}

void dea_recovered_set(const struct dea_gauss_fit *fit, double (*at)[DEA_FIT_VALUES],
                       struct dea_recovered *out)
{
  out->plane_nodes = fit->n * fit->n;
  out->nodes = out->plane_nodes * fit->nz;
  for (int node = 0; node < out->nodes; node++) {
    double value[DEA_FIT_VALUES];
    dea_fit_node(fit, node, at, value);
    memcpy(out->F[node], value, sizeof out->F[node]);
    memcpy(out->stress[node], value + 9, sizeof out->stress[node]);
    out->energy[node] = value[15];
    out->field[node] = value[16];
  }
}

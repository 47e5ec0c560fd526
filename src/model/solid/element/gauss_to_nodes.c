#include "model/solid/element/gauss_to_nodes.h"

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

static void back_line(int order, double fit[DEA_FIT_LINE_MAX][DEA_FIT_LINE_MAX])
{
  size_t count = (size_t)order + 1;
  double nodes[DEA_FIT_LINE_MAX], x[DEA_FIT_LINE_MAX], w[DEA_FIT_LINE_MAX];
  double slope[DEA_FIT_LINE_MAX];
  dea_lobatto_nodes((size_t)order, nodes);
  dea_gauss_rule(count, x, w);
  for (size_t q = 0; q < count; q++) {
    dea_lagrange(count, nodes, x[q], fit[q], slope);
  }
}

void dea_fit_create(int order, int order_z, bool back, struct dea_gauss_fit *out)
{
  out->n = order + 1;
  out->nz = order_z + 1;
  if (back) {
    back_line(order, out->plane);
    back_line(order_z, out->z);
  } else {
    fit_line(order, order - 1, out->plane);
    fit_line(order_z, order_z > 1 ? order_z - 1 : order_z, out->z);
  }
}

/* Along the second axis of [outer][n][inner], in place, by strips of the third; rows of a table of
 * struct dea_gauss_fit. */
static void fit_axis(const double *fit, int outer, int n, int inner, double *values)
{
  enum { STRIP = 16 };
  for (int o = 0; o < outer; o++) {
    for (int from = 0, count; from < inner; from += count) {
      double sum[DEA_FIT_LINE_MAX][STRIP] = {{0}}, *line = values + o * n * inner + from;
      count = inner - from < STRIP ? inner - from : STRIP;
      for (int i = 0; i < n; i++) {
        for (int q = 0; q < n; q++) {
          for (int x = 0; x < count; x++) {
            sum[i][x] += fit[i * DEA_FIT_LINE_MAX + q] * line[q * inner + x];
          }
        }
      }
      for (int i = 0; i < n; i++) {
        memcpy(line + i * inner, sum[i], (size_t)count * sizeof *line);
      }
    }
  }
}

void dea_fit_nodes(const struct dea_gauss_fit *fit, int width, const double *at, double *out)
{
  int n = fit->n, nz = fit->nz;
  memcpy(out, at, (size_t)(n * n * nz * width) * sizeof *out);
  fit_axis(fit->plane[0], nz * n, n, width, out);
  fit_axis(fit->plane[0], nz, n, n * width, out);
  fit_axis(fit->z[0], 1, nz, n * n * width, out);
}

static void set_force(const struct dea_gauss_fit *fit, double thickness_m, const double *P,
                      int columns, struct dea_recovered *out)
{
  double x[DEA_FIT_LINE_MAX], w[DEA_FIT_LINE_MAX];
  dea_gauss_rule((size_t)fit->nz, x, w);
  memset(out->force, 0, sizeof out->force);
  for (int node = 0; node < out->plane_nodes; node++) {
    int i = node % fit->n, j = node / fit->n;
    for (int q = 0; q < out->nodes; q++) { // as many points
      int a = q % fit->n, b = q / fit->n % fit->n, c = q / (fit->n * fit->n);
      double weight = fit->plane[i][a] * fit->plane[j][b] * 0.5 * w[c] * thickness_m;
      for (int m = 0; m < 6; m++) {
        out->force[node][m] += weight * P[(3 * q + m / 2) * columns + m % 2];
      }
    }
  }
}

void dea_recovered_set(const struct dea_gauss_fit *fit, double (*at)[DEA_FIT_VALUES],
                       double thickness_m, const double *P, int columns, struct dea_recovered *out)
{
  double value[DEA_HEX_NODES_MAX][DEA_FIT_VALUES];
  out->plane_nodes = fit->n * fit->n;
  out->nodes = out->plane_nodes * fit->nz;
  dea_fit_nodes(fit, DEA_FIT_VALUES, at[0], value[0]);
  for (int node = 0; node < out->nodes; node++) {
    memcpy(out->F[node], value[node], sizeof out->F[node]);
    memcpy(out->stress[node], value[node] + 9, sizeof out->stress[node]);
    out->energy[node] = value[node][15];
    out->field[node] = value[node][16];
  }
  set_force(fit, thickness_m, P, columns, out);
}

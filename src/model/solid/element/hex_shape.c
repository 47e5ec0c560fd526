#include "model/solid/element/hex_shape.h"

#include "base/quadrature.h"

#include <math.h>
#include <string.h>

static void fill_line(int count, const double *nodes, const double *gauss,
                      struct dea_hex_line *line)
{
  for (int q = 0; q < count; q++) {
    dea_lagrange((size_t)count, nodes, gauss[q], line->at_gauss[0][q], line->at_gauss[1][q]);
    for (int d = 0; d < 2; d++) {
      for (int n = 0; n < count; n++) {
        line->at_node[d][n][q] = line->at_gauss[d][q][n];
      }
    }
    for (int kind = 0; kind < DEA_HEX_KINDS; kind++) {
      const double *of_n = line->at_gauss[kind >= DEA_HEX_KIND_10][q];
      const double *of_m = line->at_gauss[kind == DEA_HEX_KIND_01 || kind == DEA_HEX_KIND_11][q];
      for (int nm = 0; nm < count * count; nm++) {
        line->pairs[nm][kind * count + q] = of_n[nm / count] * of_m[nm % count];
      }
    }
  }
}

/* Basis and pressures at the point (i, j, k) of the rule. */
static void fill_point(struct dea_hex_shape *s, int q, const int point[3], const double at[3])
{
  const struct dea_hex_line *line = &s->line[0], *line_z = &s->line[1];
  int node = 0;
  for (int k = 0; k <= s->order_z; k++) {
    double z = line_z->at_gauss[0][point[2]][k], dz = line_z->at_gauss[1][point[2]][k];
    for (int j = 0; j <= s->order; j++) {
      double y = line->at_gauss[0][point[1]][j], dy = line->at_gauss[1][point[1]][j];
      for (int i = 0; i <= s->order; i++, node++) {
        double x = line->at_gauss[0][point[0]][i], dx = line->at_gauss[1][point[0]][i];
        s->value[q][node] = x * y * z;
        s->slope[q][0][node] = dx * y * z;
        s->slope[q][1][node] = x * dy * z;
        s->slope[q][2][node] = x * y * dz;
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
  double nodes[DEA_HEX_LINE_MAX], nodes_z[DEA_HEX_LINE_MAX];
  double x[DEA_HEX_LINE_MAX], w[DEA_HEX_LINE_MAX];
  double z[DEA_HEX_LINE_MAX], wz[DEA_HEX_LINE_MAX];
  out->order = order;
  out->order_z = order_z;
  out->nodes = out->gauss = n * n * nz;
  dea_lobatto_nodes((size_t)order, nodes);
  dea_lobatto_nodes((size_t)order_z, nodes_z);
  dea_gauss_rule((size_t)n, x, w);
  dea_gauss_rule((size_t)nz, z, wz);
  fill_line(n, nodes, x, &out->line[0]);
  fill_line(nz, nodes_z, z, &out->line[1]);
  for (int k = 0, q = 0; k < nz; k++) {
    for (int j = 0; j < n; j++) {
      for (int i = 0; i < n; i++, q++) {
        fill_point(out, q, (const int[3]){i, j, k}, (const double[3]){x[i], x[j], z[k]});
        out->weight[q] = w[i] * w[j] * wz[k];
        out->node_at[q][0] = nodes[i]; // as many nodes as Gauss points, in the same order
        out->node_at[q][1] = nodes[j];
        out->node_at[q][2] = nodes_z[k];
      }
    }
  }
  return DEA_OK;
}

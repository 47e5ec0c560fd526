#include "model/solid/hex.h"

#include "base/quadrature.h"

#include <math.h>
#include <string.h>

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

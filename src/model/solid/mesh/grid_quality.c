/* How well shaped the elements of an extruded plate are. */
#include "model/solid/mesh/grid.h"

#include "base/quadrature.h"

#include <math.h>

/* Slopes of the one-dimensional basis at its own nodes: [at][node]. */
static void slopes_at_nodes(int order, double slope[DEA_HEX_ORDER_MAX + 1][DEA_HEX_ORDER_MAX + 1])
{
  double nodes[DEA_HEX_ORDER_MAX + 1], value[DEA_HEX_ORDER_MAX + 1];
  dea_lobatto_nodes((size_t)order, nodes);
  for (int i = 0; i <= order; i++) {
    dea_lagrange((size_t)order + 1, nodes, nodes[i], value, slope[i]);
  }
}

double dea_grid_smallest_jacobian(const struct dea_grid *grid)
{
  double slope[DEA_HEX_ORDER_MAX + 1][DEA_HEX_ORDER_MAX + 1], smallest = INFINITY;
  int per = grid->order + 1;
  slopes_at_nodes(grid->order, slope);
  for (size_t e = 0; e < grid->element_count; e++) {
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX; // the lower face comes first
    double least = INFINITY, sum = 0;
    for (int at = 0; at < per * per; at++) {
      int i = at % per, j = at / per;
      double map[2][2] = {{0, 0}, {0, 0}}; // by the local axes
      for (int k = 0; k < per; k++) {
        const double *along = grid->X + 3 * nodes[per * j + k];
        const double *up = grid->X + 3 * nodes[per * k + i];
        for (int c = 0; c < 2; c++) {
          map[0][c] += slope[i][k] * along[c];
          map[1][c] += slope[j][k] * up[c];
        }
      }
      double area = map[0][0] * map[1][1] - map[0][1] * map[1][0];
      least = fmin(least, area);
      sum += area;
    }
    smallest = fmin(smallest, least / fabs(sum / (per * per)));
  }
  return smallest;
}

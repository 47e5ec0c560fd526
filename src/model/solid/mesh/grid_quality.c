/* How well shaped the elements of a plane mesh are, or of a plate that was made from one. */
#include "model/solid/mesh/grid.h"

#include "base/quadrature.h"

#include <math.h>

/* Slopes of the one-dimensional basis at its own nodes: [at][node]. */
struct slopes {
  double at[DEA_HEX_ORDER_MAX + 1][DEA_HEX_ORDER_MAX + 1];
};

static void slopes_at_nodes(int order, struct slopes *slope)
{
  double nodes[DEA_HEX_ORDER_MAX + 1], value[DEA_HEX_ORDER_MAX + 1];
  dea_lobatto_nodes((size_t)order, nodes);
  for (int i = 0; i <= order; i++) {
    dea_lagrange((size_t)order + 1, nodes, nodes[i], value, slope->at[i]);
  }
}

/* Smallest Jacobian of a quadrilateral over the mean one. The nodes' places are `stride` apart. */
static double quality_of(int order, const struct slopes *slope, const int *nodes, const double *X,
                         int stride)
{
  int per = order + 1;
  double least = INFINITY, sum = 0;
  for (int at = 0; at < per * per; at++) {
    int i = at % per, j = at / per;
    double map[2][2] = {{0, 0}, {0, 0}}; // by the local axes
    for (int k = 0; k < per; k++) {
      const double *along = X + stride * nodes[per * j + k];
      const double *up = X + stride * nodes[per * k + i];
      for (int c = 0; c < 2; c++) {
        map[0][c] += slope->at[i][k] * along[c];
        map[1][c] += slope->at[j][k] * up[c];
      }
    }
    double area = map[0][0] * map[1][1] - map[0][1] * map[1][0];
    least = fmin(least, area);
    sum += area;
  }
  return least / fabs(sum / (per * per));
}

double dea_grid_smallest_jacobian(const struct dea_grid *grid)
{
  struct slopes slope;
  double smallest = INFINITY;
  slopes_at_nodes(grid->order, &slope);
  for (size_t e = 0; e < grid->element_count; e++) { // the lower face comes first
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
    smallest = fmin(smallest, quality_of(grid->order, &slope, nodes, grid->X, 3));
  }
  return smallest;
}

double dea_plane_mesh_smallest_jacobian(const struct dea_plane_mesh *mesh, size_t *worst)
{
  struct slopes slope;
  double smallest = INFINITY;
  size_t per_quad = (size_t)((mesh->order + 1) * (mesh->order + 1));
  slopes_at_nodes(mesh->order, &slope);
  for (size_t e = 0; e < mesh->quad_count; e++) {
    double quality = quality_of(mesh->order, &slope, mesh->quads + e * per_quad, mesh->x, 2);
    if (!(quality >= smallest)) {
      smallest = quality;
      if (worst != NULL) {
        *worst = e;
      }
    }
  }
  return smallest;
}

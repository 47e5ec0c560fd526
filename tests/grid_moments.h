/* Mass, centre and moments of what a grid is made of. */
#pragma once

#include "model/solid/mesh/grid.h"
#include "solid_element.h"
#include "testing.h"

#include <string.h>

enum { MOMENTS = 6 };

static struct dea_hex_shape shape;
static struct dea_flat_shape flat;

/* What v . M v adds up to for v = 1, x, y, z, and for the products 1 x and x y. */
static void add_moments(int nodes, const double *X, const double *mass, double sum[MOMENTS])
{
  for (int a = 0; a < nodes; a++) {
    for (int b = 0; b < nodes; b++) {
      const double *x = X + 3 * a, *y = X + 3 * b;
      const double at[MOMENTS] = {1, x[0] * y[0], x[1] * y[1], x[2] * y[2], x[0], x[0] * y[1]};
      for (int i = 0; i < MOMENTS; i++) {
        sum[i] += mass[a * nodes + b] * at[i];
      }
    }
  }
}

/* Those of all elements of a grid. */
static void grid_moments(const struct dea_grid *grid, const struct dea_part_material *layers,
                         int (*layer_of)(const void *self, int region, int ply), const void *self,
                         double sum[MOMENTS])
{
  for (size_t e = 0; e < grid->element_count; e++) {
    double X[DEA_HEX_DOFS_MAX], mass[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
    const struct dea_part_material *layer = &layers[layer_of(self, grid->region[e], grid->ply[e])];
    int nodes = dea_grid_nodes_of(grid, e);
    for (int n = 0; n < nodes; n++) {
      memcpy(X + 3 * n, grid->X + 3 * grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n],
             3 * sizeof *X);
    }
    const struct dea_element element = grid->levels[e] == 1 ? membrane(&flat) : hexahedron(&shape);
    assert_int_equal(element.type->mass(&element, layer, X, mass), DEA_OK);
    add_moments(nodes, X, mass, sum);
  }
}

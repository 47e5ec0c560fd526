/* The node at a place, of which a test knows that there is one. */
#pragma once

#include "model/solid/mesh/grid.h"
#include "testing.h"

#include <math.h>

static inline size_t node_near(const struct dea_grid *grid, double x, double y, double z)
{
  const double place[3] = {x, y, z};
  size_t n = dea_grid_nearest(grid, place);
  const double *X = grid->X + 3 * n;
  assert_true(hypot(hypot(X[0] - x, X[1] - y), X[2] - z) < 1e-9);
  return n;
}

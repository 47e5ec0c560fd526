/* Second derivatives in the plane of what is linear within each element (docs/theory/trust.md,
 * "Neighbours' slopes"). */
#pragma once

#include "model/solid/mesh/grid.h"

enum { DEA_RECOVER_LEVELS = 4 }; // of nodes of an element, at most

/* Values at the nodes of elements of order 2, of tensors of 9 components and of scalars; neighbours
 * are elements of the same group. mirror: [nodes] unit normal of the mirror plane in which alone a
 * node moves, zeros where there is none; NULL: none. */
struct dea_recover_second {
  const struct dea_grid *grid;
  const int *group; // [elements]
  const double (*mirror)[3];
  size_t tensors;      // of one node
  size_t scalars;      // behind them
  size_t nodes;        // of one element, at most
  const double *value; // [elements][nodes][9 tensors + scalars]
};

/* c: [elements][2 axes][DEA_RECOVER_LEVELS][9 tensors + scalars], what is c P_2 along that axis,
 * P_2 the Legendre polynomial; 0 where no neighbour tells. */
dea_status dea_recover_second(struct dea_context *ctx, const struct dea_recover_second *in,
                              double *c);

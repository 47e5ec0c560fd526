/* Nodes found by their place, so that rounding cannot part two that are meant to be one. */
#pragma once

#include "base/context.h"

struct dea_places {
  double *x; // [count][2], lent, with room for all that will be asked for
  size_t count;
  double close; // nodes closer than that along both axes are one
  size_t table_size;
  int *table; // node of a hash slot, -1: empty
};

/* x: room for [room][2], lent until dea_places_release. DEA_E_MEMORY. */
dea_status dea_places_create(struct dea_context *ctx, double *x, size_t capacity, double close,
                             struct dea_places *out);
/* Forgets all nodes. */
void dea_places_empty(struct dea_places *places);
void dea_places_release(struct dea_context *ctx, struct dea_places *places);

/* Node at a place, made when there is none. */
int dea_places_node(struct dea_places *places, const double x[2]);

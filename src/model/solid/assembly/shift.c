/* The shift of K, sigma times int grad : grad of the displacements: an equal tension sigma in all
 * directions (docs/theory/branches.md); and the sizes that go with it. */
#include "model/solid/assembly/internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* L of an element [nodes][nodes] and its volume. */
static dea_status metric_of(const struct dea_solid *s, size_t e, double *laplace, double *lumped,
                            double *volume)
{
  double X[DEA_HEX_DOFS_MAX] = {0};
  int count = dea_solid_places(s, e, X);
  dea_status status =
      s->grid->flat[e] ? dea_membrane_metric(&s->flat, &s->layers[s->layer[e]], X, laplace, lumped)
                       : dea_hex_metric(&s->shape, X, laplace, lumped);
  *volume = 0;
  for (int n = 0; n < count && status == DEA_OK; n++) {
    *volume += lumped[n];
  }
  return status;
}

static dea_status laplace_of(const struct dea_solid *s, size_t e, double *laplace)
{
  double lumped[DEA_HEX_NODES_MAX] = {0}, volume;
  return metric_of(s, e, laplace, lumped, &volume);
}

dea_status dea_solid_shift(struct dea_context *ctx, struct dea_solid *s, double amount_Pa)
{
  DEA_TRY(ctx, dea_solid_add_scalar(ctx, s, s->K, amount_Pa, laplace_of));
  return DEA_OK;
}

void dea_solid_masses(const struct dea_solid *s, double *mass)
{
  memset(mass, 0, s->dofs * sizeof *mass);
  for (size_t e = 0; e < s->grid->element_count; e++) {
    double laplace[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX], lumped[DEA_HEX_NODES_MAX] = {0}, volume;
    const int *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
    metric_of(s, e, laplace, lumped, &volume);
    for (int n = 0; n < dea_grid_nodes_of(s->grid, e, s->shape.nodes); n++) {
      for (int i = 0; i < 3; i++) {
        mass[3 * nodes[n] + i] += lumped[n];
      }
    }
  }
}

void dea_solid_sizes(struct dea_solid *s)
{
  double squares = 0, extent[3];
  s->modulus_Pa = INFINITY;
  for (size_t e = 0; e < s->grid->element_count; e++) {
    double laplace[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX], lumped[DEA_HEX_NODES_MAX] = {0}, whole;
    double modulus = dea_constituent_modulus(&s->layers[s->layer[e]]);
    metric_of(s, e, laplace, lumped, &whole); // 0 for an inverted one: dea_solid_check speaks of it
    squares += modulus * modulus * whole * whole;
    s->modulus_Pa = fmin(s->modulus_Pa, modulus);
  }
  s->energy_floor = DBL_EPSILON * sqrt(squares);
  s->length_m = INFINITY;
  for (int i = 0; i < 3; i++) {
    double least = INFINITY, most = -INFINITY;
    for (size_t n = 0; n < s->grid->node_count; n++) {
      least = fmin(least, s->grid->X[3 * n + (size_t)i]);
      most = fmax(most, s->grid->X[3 * n + (size_t)i]);
    }
    extent[i] = most - least;
    s->length_m = extent[i] > 0 ? fmin(s->length_m, extent[i]) : s->length_m;
  }
}

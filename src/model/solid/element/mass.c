#include "model/solid/element/mass.h"

#include "model/solid/element/hex_points.h"

#include <string.h>

/* mass += kilograms N_a N_b. */
static void add_point(int nodes, double kilograms, const double *value, double *mass)
{
  for (int a = 0; a < nodes; a++) {
    for (int b = 0; b < nodes; b++) {
      mass[a * nodes + b] += kilograms * value[a] * value[b];
    }
  }
}

dea_status dea_hex_mass(const struct dea_hex_shape *s, const struct dea_constituent *layer,
                        const double *X, double *mass)
{
  static const double rest[DEA_HEX_DOFS_MAX] = {0};
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  dea_status status = dea_hex_find_points(s, X, rest, points);
  memset(mass, 0, (size_t)(s->nodes * s->nodes) * sizeof *mass);
  for (int q = 0; q < s->gauss && status == DEA_OK; q++) {
    add_point(s->nodes, layer->density_kg_per_m3 * points[q].weight, s->value[q], mass);
  }
  return status;
}

dea_status dea_membrane_mass(const struct dea_flat_shape *s, const struct dea_constituent *layer,
                             const double *X, double *mass)
{
  double per_area = layer->density_kg_per_m3 * layer->thickness_m;
  double gradient[2][DEA_FLAT_NODES_MAX];
  memset(mass, 0, (size_t)(s->nodes * s->nodes) * sizeof *mass);
  for (int q = 0; q < s->gauss; q++) {
    double area = dea_flat_gradients(s, q, X, gradient);
    if (!(area > 0)) {
      return DEA_E_DOMAIN;
    }
    add_point(s->nodes, per_area * area, s->value[q], mass);
  }
  return DEA_OK;
}

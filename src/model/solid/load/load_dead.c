/* Dead loads: consistent nodal forces. */
#include "model/solid/load/loads.h"

#include <math.h>
#include <string.h>

dea_status dea_load_gravity(const struct dea_grid *grid, const struct dea_element_set *elements,
                            double (*density_kg_per_m3)(const void *self, int region, int ply),
                            const void *self, const double acceleration_m_per_s2[3], double *force)
{
  // rows of the mass of what has one kilogram per volume, or per area of a surface: int N_a
  static const struct dea_part_material unit = {.density_kg_per_m3 = 1, .thickness_m = 1};
  double X[DEA_HEX_DOFS_MAX], mass[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
  for (size_t e = 0; e < grid->element_count; e++) {
    double density = density_kg_per_m3(self, grid->region[e], grid->ply[e]);
    const struct dea_element *element = &elements->of[grid->kind[e]];
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
    for (int n = 0; n < element->nodes; n++) {
      memcpy(X + 3 * n, grid->X + 3 * nodes[n], 3 * sizeof *X);
    }
    dea_status status = element->type->mass(element, &unit, X, mass);
    if (status != DEA_OK) {
      return status;
    }
    for (int ab = 0; ab < element->nodes * element->nodes; ab++) {
      for (int i = 0; i < 3; i++) {
        force[3 * nodes[ab / element->nodes] + i] += density * acceleration_m_per_s2[i] * mass[ab];
      }
    }
  }
  return DEA_OK;
}

void dea_load_traction(const struct dea_surface *surface, const double traction_Pa[3],
                       double *force)
{
  struct dea_face_shape shape;
  dea_face_shape_create(surface, DEA_FACE_GAUSS, &shape);
  for (size_t f = 0; f < surface->face_count; f++) {
    const int *nodes = surface->nodes + f * DEA_FACE_NODES_MAX;
    double X[3 * DEA_FACE_NODES_MAX], normal[3];
    dea_face_gather(surface, f, surface->grid->X, X);
    for (int q = 0; q < shape.points; q++) {
      dea_face_normal(&shape, q, X, normal);
      double area = shape.weight[q] *
                    sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
      for (int n = 0; n < shape.nodes; n++) {
        for (int i = 0; i < 3; i++) {
          force[3 * nodes[n] + i] += traction_Pa[i] * area * shape.value[q][n];
        }
      }
    }
  }
}

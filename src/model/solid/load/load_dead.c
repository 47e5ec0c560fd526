/* Dead loads: consistent nodal forces. */
#include "model/solid/load/loads.h"

#include <math.h>
#include <string.h>

void dea_load_traction(const struct dea_surface *surface, const double traction_Pa[3],
                       double *force)
{
  struct dea_face_shape shape;
  dea_face_shape_create(surface->order, DEA_FACE_GAUSS, &shape);
  for (size_t f = 0; f < surface->face_count; f++) {
    const int *nodes = surface->nodes + f * DEA_FACE_NODES_MAX;
    double X[3 * DEA_FACE_NODES_MAX], normal[3];
    dea_face_gather(surface, f, surface->grid->X, X);
    for (int q = 0; q < shape.points; q++) {
      dea_face_normal(&shape, q, X, normal);
      double area = shape.weight[q] * sqrt(dea_dot(normal, normal));
      for (int n = 0; n < shape.nodes; n++) {
        for (int i = 0; i < 3; i++) {
          force[3 * nodes[n] + i] += traction_Pa[i] * area * shape.value[q][n];
        }
      }
    }
  }
}

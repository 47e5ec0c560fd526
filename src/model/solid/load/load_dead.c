/* Dead loads: consistent nodal forces. */
#include "model/solid/load/loads.h"

#include <math.h>

/* Adds f int N dV of an element. */
static void add_body_force(const struct dea_hex_shape *s, const double *X, const double f[3],
                           const int *nodes, double *force)
{
  for (int q = 0; q < s->gauss; q++) {
    double map[9] = {0}, cof[9];
    for (int a = 0; a < 3; a++) {
      for (int n = 0; n < s->nodes; n++) {
        for (int i = 0; i < 3; i++) {
          map[3 * i + a] += X[3 * nodes[n] + i] * s->slope[q][a][n];
        }
      }
    }
    double volume = s->weight[q] * dea_cofactors(map, cof);
    for (int n = 0; n < s->nodes; n++) {
      for (int i = 0; i < 3; i++) {
        force[3 * nodes[n] + i] += f[i] * volume * s->value[q][n];
      }
    }
  }
}

/* The same of a flat element, f per area. The basis in the plane is that of the hexahedron summed
 * through its levels; its rule has the weight 2 through the thickness. */
static void add_sheet_force(const struct dea_hex_shape *s, const double *X, const double f[3],
                            const int *nodes, double *force)
{
  int per = (s->order + 1) * (s->order + 1);
  for (int q = 0; q < s->gauss; q++) {
    double map[4] = {0}, value[DEA_FACE_NODES_MAX] = {0};
    for (int n = 0; n < s->nodes; n++) {
      value[n % per] += s->value[q][n];
      for (int a = 0; a < 4; a++) {
        map[a] += X[3 * nodes[n % per] + a / 2] * s->slope[q][a % 2][n];
      }
    }
    double area = 0.5 * s->weight[q] * (map[0] * map[3] - map[1] * map[2]);
    for (int n = 0; n < per; n++) {
      for (int i = 0; i < 3; i++) {
        force[3 * nodes[n] + i] += f[i] * area * value[n];
      }
    }
  }
}

void dea_load_gravity(const struct dea_grid *grid, const struct dea_hex_shape *shape,
                      double (*density_kg_per_m3)(const void *self, int region, int sheet),
                      const void *self, const double acceleration_m_per_s2[3], double *force)
{
  for (size_t e = 0; e < grid->element_count; e++) {
    double density = density_kg_per_m3(self, grid->region[e], grid->sheet[e]), f[3];
    for (int i = 0; i < 3; i++) {
      f[i] = density * acceleration_m_per_s2[i];
    }
    (grid->flat[e] ? add_sheet_force : add_body_force)(shape, grid->X, f,
                                                       grid->nodes + e * DEA_HEX_NODES_MAX, force);
  }
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

dea_status dea_load_point(struct dea_context *ctx, const struct dea_grid *grid, const double X_m[3],
                          double within_m, const double force_N[3], double *force)
{
  size_t nearest = dea_grid_nearest(grid, X_m);
  const double *X = grid->X + 3 * nearest;
  double distance = hypot(hypot(X[0] - X_m[0], X[1] - X_m[1]), X[2] - X_m[2]);
  if (!(distance <= within_m)) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "no node within %.3g mm of the point force at (%.4g, %.4g, %.4g) mm",
                    1e3 * within_m, 1e3 * X_m[0], 1e3 * X_m[1], 1e3 * X_m[2]);
  }
  for (size_t i = 0; i < 3; i++) {
    force[3 * nearest + i] += force_N[i];
  }
  return DEA_OK;
}

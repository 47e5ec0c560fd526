#include "model/solid/adapter/disc_points.h"

#include "model/solid/adapter/solid_fields.h"
#include "model/solid/assembly/problem.h"

#include <math.h>
#include <string.h>

/* A node, and the one at its mirror image by the middle plane. */
static void find_pair(const struct dea_grid *grid, const double place[3], size_t out[2])
{
  out[0] = dea_grid_nearest(grid, place);
  const double *X = grid->X + 3 * out[0];
  const double mirrored[3] = {X[0], X[1], -X[2]};
  out[1] = dea_grid_nearest(grid, mirrored);
}

void dea_disc_points_find(const struct dea_layout_mesh *mesh, struct dea_disc_points *out)
{
  const struct dea_fibre_disc *p = &mesh->plate;
  double a = p->electrode_radius, half = dea_fibre_disc_angle(p) / p->sectors;
  const double centre[3] = {0}, edge[3] = {a * cos(half), a * sin(half), 0};
  const double tip[3] = {p->tip_radius, 0, 0.5 * p->film_thickness};
  *out = (struct dea_disc_points){.has_fibres = p->fibres > 0, .radius_m = a};
  find_pair(mesh->grid, centre, out->centre);
  find_pair(mesh->grid, edge, out->edge);
  out->tip = dea_grid_nearest(mesh->grid, tip);
  const double *X = mesh->grid->X + 3 * out->edge[0];
  out->outwards[0] = X[0] / hypot(X[0], X[1]);
  out->outwards[1] = X[1] / hypot(X[0], X[1]);
}

void dea_disc_points_describe(const struct dea_disc_points *p, const double *u,
                              struct dea_load_point *out)
{
  const double *v = u + 3 * p->edge[0], *w = u + 3 * p->edge[1], *n = p->outwards;
  double outwards = 0.5 * ((v[0] + w[0]) * n[0] + (v[1] + w[1]) * n[1]);
  out->electrode_stretch = 1 + outwards / p->radius_m;
  out->electrode_edge_u_m = outwards;
  out->centre_z_m = 0.5 * (u[3 * p->centre[0] + 2] + u[3 * p->centre[1] + 2]);
  out->fibre_tip_z_m = p->has_fibres ? u[3 * p->tip + 2] : NAN;
}

bool dea_disc_points_weigh(const struct dea_disc_points *p, const char *key, double *weight)
{
  bool stretch = strcmp(key, "electrode_stretch") == 0;
  if (strcmp(key, "centre_z_m") == 0) {
    weight[3 * p->centre[0] + 2] += 0.5;
    weight[3 * p->centre[1] + 2] += 0.5;
  } else if (strcmp(key, "fibre_tip_z_m") == 0) {
    weight[3 * p->tip + 2] += 1;
  } else if (stretch || strcmp(key, "electrode_edge_u_m") == 0) {
    for (int i = 0; i < 4; i++) {
      weight[3 * p->edge[i / 2] + (size_t)(i % 2)] +=
          0.5 * p->outwards[i % 2] / (stretch ? p->radius_m : 1);
    }
  } else {
    return false;
  }
  return true;
}

dea_status dea_disc_points_errors(struct dea_context *ctx, const struct dea_disc_points *points,
                                  struct dea_solid *solid, struct dea_load_point *out)
{
  enum { CENTRE, TIP, EDGE, COUNT };
  static const char *const keys[COUNT] = {"centre_z_m", "fibre_tip_z_m", "electrode_edge_u_m"};
  size_t dofs = solid->problem.dofs;
  double error_m[COUNT], *weights;
  struct dea_solid_quantity each[COUNT];
  if (!dea_load_point_trusted(out) || out->voltage_V == 0) {
    return DEA_OK;
  }
  weights = dea_solid_alloc(ctx, COUNT * dofs, sizeof *weights);
  if (weights == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t k = 0; k < COUNT; k++) {
    each[k] = (struct dea_solid_quantity){.weight = weights + k * dofs};
    dea_disc_points_weigh(points, keys[k], weights + k * dofs);
  }
  dea_status status = dea_solid_errors(ctx, solid, each, COUNT, error_m, NULL);
  dea_free(ctx, weights);
  if (status == DEA_OK) {
    out->centre_z_error_m = error_m[CENTRE];
    out->fibre_tip_z_error_m = points->has_fibres ? error_m[TIP] : NAN;
    out->electrode_edge_u_error_m = error_m[EDGE];
  }
  return status;
}

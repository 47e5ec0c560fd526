/* A middle surface with a known shape that no model computed: a sector of a disc between its planes
 * of symmetry, an electrode in the middle, half a wedge-shaped fibre along the first plane. */
#pragma once

#include "result/field_mesh.h"

#include <math.h>
#include <string.h>

enum { FAKE_FOLD = 3, FAKE_RINGS = 6, FAKE_TURNS = 4 };
static const double fake_radius_m = 12e-3, fake_electrode_m = 4e-3; // rings 0 and 1

/* Displacement upwards; the voltage scales it. */
static inline double fake_height_m(double x, double y, double voltage_V)
{
  double r = hypot(x, y) / fake_radius_m, angle = atan2(y, x);
  double bump = 1 - r * r;
  return 1e-9 * voltage_V * bump * bump * (1 + r * r * cos(2 * FAKE_FOLD * angle));
}

/* Elements of order 2, each with points of its own. NULL for want of memory. */
static inline struct dea_field_mesh *fake_surface(struct dea_context *ctx, double voltage_V)
{
  static const struct dea_mesh_field
      displacement = {.name = "displacement_m",
                      .unit = "m",
                      .meaning = "displacement",
                      .kind = DEA_MESH_VECTOR,
                      .components = 3},
      tension = {.name = "tension_N_per_m", .unit = "N/m", .meaning = "tension", .components = 2},
      between = {.name = "between_electrodes", .unit = "1", .components = 1, .of_cells = true},
      under = {.name = "under_fibre", .unit = "1", .components = 1, .of_cells = true};
  const double pi = 3.14159265358979324;
  double *u = NULL, *N = NULL, *on = NULL, *below = NULL;
  size_t cells = FAKE_RINGS * FAKE_TURNS;
  struct dea_field_mesh *mesh;
  int *nodes = NULL;
  if (dea_field_mesh_create(ctx, 9 * cells, &mesh) != DEA_OK) {
    return NULL;
  }
  mesh->fold = FAKE_FOLD;
  mesh->fibres = FAKE_FOLD;
  if (dea_field_mesh_add_block(ctx, mesh, 2, 0, cells, &nodes) != DEA_OK ||
      dea_field_mesh_add(ctx, mesh, &displacement, &u) != DEA_OK ||
      dea_field_mesh_add(ctx, mesh, &tension, &N) != DEA_OK ||
      dea_field_mesh_add(ctx, mesh, &between, &on) != DEA_OK ||
      dea_field_mesh_add(ctx, mesh, &under, &below) != DEA_OK) {
    dea_field_mesh_destroy(ctx, mesh);
    return NULL;
  }
  for (int p = 0; p < 9 * (int)cells; p++) {
    int cell = p / 9, ring = cell / FAKE_TURNS, turn = cell % FAKE_TURNS;
    double r = fake_radius_m * (2 * ring + p % 3) / (2 * FAKE_RINGS);
    double angle = pi / FAKE_FOLD * (2 * turn + p % 9 / 3) / (2 * FAKE_TURNS);
    double *X = mesh->X + 3 * p;
    nodes[p] = p;
    X[0] = r * cos(angle);
    X[1] = r * sin(angle);
    u[3 * p] = 1e-3 * X[0];
    u[3 * p + 1] = 1e-3 * X[1];
    u[3 * p + 2] = fake_height_m(X[0], X[1], voltage_V);
    N[2 * p] = 35;
    N[2 * p + 1] = 34;
    on[cell] = ring < 2;
    below[cell] = ring >= 2 && turn == 0;
  }
  return mesh;
}

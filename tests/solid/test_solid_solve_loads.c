/* A pressure in a solve, against a closed form. */
// ctest: solid
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/load/loads.h"
#include "solid_block.h"

#include "solid_fixture.h"

static const struct block slab = {{1, 1, 2}, {1, 1, 4}, 2, 2};
static struct dea_grid *grid;
static struct dea_solid *solid;
static struct dea_solid_report report;

static int on_planes(const void *self, const double X[3])
{
  return (X[0] < 1e-9 ? 1 : 0) | (X[1] < 1e-9 ? 2 : 0) | (X[2] < 1e-9 ? 4 : 0);
}

static void slab_create(const struct dea_part_material *layer,
                        int (*held)(const void *self, const double X[3]))
{
  grid = block_grid(ctx, &slab);
  solid = block_solid(ctx, grid, slab.order_z, layer, held);
}

static void slab_destroy(void)
{
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* Faces on the outside of the slab. */
static bool outside(const void *self, int region, int ply, const double middle[3])
{
  bool inside = true;
  for (int i = 0; i < 3; i++) {
    inside = inside && middle[i] > 1e-9 && middle[i] < slab.size[i] - 1e-9;
  }
  return !inside;
}

static struct dea_surface *side_create(enum dea_face side)
{
  struct dea_surface *surface;
  assert_int_equal(dea_surface_create(ctx, grid, side, outside, NULL, &surface), DEA_OK);
  return surface;
}

/* All around, with three mirror planes through the origin of the pressure's volume: a cube stays
 * one of stretch l, and the Cauchy stress (mu (l^2 - 1) + lambda ln l^3)/l^3 is -p. */
TEST(test_pressure_all_around)
{
  const struct dea_part_material soft = dea_part_material_bonded((const double[]){8e5 / 3, 1. / 3});
  static const double origin[3] = {0, 0, 0}, p = 1.5e5;
  static const enum dea_face sides[] = {DEA_FACE_FIRST_HIGH, DEA_FACE_SECOND_HIGH, DEA_FACE_TOP};
  struct dea_surface *surface[3];
  struct dea_pressure *pressure[3];
  slab_create(&soft, on_planes);
  for (int i = 0; i < 3; i++) {
    surface[i] = side_create(sides[i]);
    assert_int_equal(dea_pressure_create(ctx, surface[i], origin, &pressure[i]), DEA_OK);
    dea_pressure_set(pressure[i], p);
    const struct dea_solid_load load = dea_pressure_load(pressure[i]);
    assert_int_equal(dea_solid_add_load(ctx, solid, &load), DEA_OK);
  }
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
  double l = 1;
  for (int i = 0; i < 50; i++) { // Newton
    double f = 1e5 * (l * l - 1) + 6e5 * log(l) + p * l * l * l;
    l -= f / (2e5 * l + 6e5 / l + 3 * p * l * l);
  }
  for (size_t n = 0; n < 3 * grid->node_count; n++) {
    assert_close(dea_solid_displacement(solid)[n], (l - 1) * grid->X[n], 1e-7, 1e-8);
  }
  slab_destroy();
  for (int i = 0; i < 3; i++) {
    assert_close(dea_pressure_get(pressure[i]), p, 0, 0);
    dea_pressure_destroy(ctx, pressure[i]);
    dea_surface_destroy(ctx, surface[i]);
  }
}

TESTS(solid_set_up, solid_tear_down)

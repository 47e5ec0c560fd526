/* A film whose two pre-stretches lie at an angle to the axes, on meshes that are turned with it. */
// ctest: solid
#include "model/solid/equilibrium/load_steps.h"
#include "solid_block.h"

#include "solid_fixture.h" // after: its context shadows no name of the headers above

#include <string.h>

static const double width_m = 10e-3, edge_m = 4e-3, h_m = 70e-6, stretch[2] = {1.3, 1.1};
enum { COUNT = 4 };

/* A square in two strips, of which the second is between electrodes, turned about the origin. */
struct strip {
  double from, to, angle;
};

static void strip_map(const void *self, double s, double t, double x[2])
{
  const struct strip *strip = self;
  double a = strip->from + s * (strip->to - strip->from), b = width_m * t;
  x[0] = cos(strip->angle) * a - sin(strip->angle) * b;
  x[1] = sin(strip->angle) * a + cos(strip->angle) * b;
}

static struct dea_grid *turned_grid(double angle, double thickness_m)
{
  static const double cuts[COUNT + 1] = {0, 0.25, 0.5, 0.75, 1};
  const struct strip strips[2] = {{0, edge_m, angle}, {edge_m, width_m, angle}};
  struct dea_block quads[2];
  for (int i = 0; i < 2; i++) {
    quads[i] = (struct dea_block){strip_map, &strips[i], cuts, cuts, COUNT, COUNT, i};
  }
  const struct dea_ply ply = {thickness_m, 1, 2};
  struct dea_grid *grid;
  assert_int_equal(dea_grid_create(ctx, 2, quads, 2, &ply, 1, NULL, 0, width_m, &grid), DEA_OK);
  return grid;
}

static struct dea_part_material film(double angle)
{
  double c = cos(angle), s = sin(angle);
  struct dea_part_material out = {.law = dea_law_find("yeoh"),
                                  .param = {178.4e3, -6e3, 4.2e3},
                                  .pre_stretch = {stretch[0] * c * c + stretch[1] * s * s,
                                                  stretch[0] * s * s + stretch[1] * c * c,
                                                  1 / (stretch[0] * stretch[1])},
                                  .pre_shear = (stretch[0] - stretch[1]) * s * c,
                                  .kappa_Pa = 4e7,
                                  .permittivity_F_per_m = 2.5e-11,
                                  .permittivity_slope_F_per_m = -0.3e-11,
                                  .thickness_m = h_m};
  assert_int_equal(dea_part_material_relax(&out), DEA_OK);
  return out;
}

static double angle_of_test;

/* The outer edge, by the distance from the square's middle along its sides. */
static int held(const void *self, const double X[3])
{
  double c = cos(angle_of_test), s = sin(angle_of_test), half = 0.5 * width_m;
  double a = c * X[0] + s * X[1] - half, b = -s * X[0] + c * X[1] - half;
  return fmax(fabs(a), fabs(b)) > half * (1 - 1e-9) ? 1 | 2 | 4 : 0;
}

static bool second(const void *self, int region, int ply)
{
  return region == 1;
}

/* Displacements of all nodes at 3 kV; owned by the caller. */
static double *solve(double angle, double thickness_m, size_t *count)
{
  struct dea_grid *grid = turned_grid(angle, thickness_m);
  struct dea_part_material layer = film(angle);
  struct dea_solid_report report;
  struct dea_solid *solid;
  angle_of_test = angle;
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 1,
                                            .part_materials = &layer,
                                            .active = second,
                                            .held = held};
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 3e3, &report), DEA_OK);
  double *u = dea_alloc(ctx, 3 * grid->node_count, sizeof *u);
  assert_non_null(u);
  memcpy(u, dea_solid_displacement(solid), 3 * grid->node_count * sizeof *u);
  *count = grid->node_count;
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
  return u;
}

/* What a film does that is turned with all it has is what it did, turned. */
static void check_turned(double thickness_m)
{
  const double angle = 37 * acos(-1.0) / 180, c = cos(angle), s = sin(angle);
  size_t count, turned_count;
  double *u = solve(0, thickness_m, &count), *v = solve(angle, thickness_m, &turned_count);
  double most = 0;
  assert_int_equal(count, turned_count);
  for (size_t i = 0; i < 3 * count; i++) {
    most = fmax(most, fabs(u[i]));
  }
  assert_true(most > 30e-6);
  for (size_t n = 0; n < count; n++) {
    assert_close(v[3 * n], c * u[3 * n] - s * u[3 * n + 1], 0, 1e-9 * most);
    assert_close(v[3 * n + 1], s * u[3 * n] + c * u[3 * n + 1], 0, 1e-9 * most);
    assert_close(v[3 * n + 2], u[3 * n + 2], 0, 1e-9 * most);
  }
  dea_free(ctx, u);
  dea_free(ctx, v);
}

TEST(test_turned_film)
{
  check_turned(h_m);
}

TEST(test_turned_membrane)
{
  check_turned(0);
}

TESTS(solid_set_up, solid_tear_down)

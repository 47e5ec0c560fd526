/* States carried to a mesh: elements that are inverted there are turned back, held components and
 * stiff parts stay, and the state that is found is the one that was carried: a film between clamps
 * that has buckled under voltage, on either side, against the closed form. */
// ctest: solid
#include "failing_allocator.h"
#include "solid_block.h"

#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/transfer_solution.h"
#include "solid_fixture.h"

#include <stdlib.h>

/* Units: mu = eps = 1. */
static struct block strip = {{1, 0.1, 0.01}, {16, 1, 1}, 3, 2};
static struct dea_grid *grid;
static struct dea_solid *solid;
static double *u;

static int clamped_in_plane_strain(const void *self, const double X[3])
{
  const struct block *block = self;
  return 2 | (X[0] < 1e-9 || X[0] > block->size[0] - 1e-9 ? 7 : 0);
}

/* The second part material is of the same law, and `stiff` times as stiff. */
static double stiff = 1;
static int iterations; // of a descent; 0: as many as by default

static dea_status try(struct dea_context *with)
{
  struct dea_solid_settings settings = dea_solid_settings_default();
  struct dea_part_material layers[2];
  for (int i = 0; i < 2; i++) {
    layers[i] = dea_part_material_bonded((const double[]){2, 0});
    dea_part_material_set_law(&layers[i], dea_law_find("neo-hookean"),
                              (const double[]){i == 0 ? 1 : stiff});
    layers[i].kappa_Pa = 100;
    layers[i].permittivity_F_per_m = 1;
    layers[i].thickness_m = strip.size[2];
    assert_int_equal(dea_part_material_relax(&layers[i]), DEA_OK);
  }
  settings.newton_max_iterations = iterations > 0 ? iterations : settings.newton_max_iterations;
  const struct dea_solid_options options = {.order_z = strip.order_z,
                                            .part_material_count = 2,
                                            .part_materials = layers,
                                            .part_material_of = layer_of_region,
                                            .active = everywhere,
                                            .held = clamped_in_plane_strain,
                                            .self = &strip,
                                            .settings = &settings};
  return dea_solid_create(with, grid, &options, &solid);
}

static void create(void)
{
  grid = block_grid(ctx, &strip);
  for (size_t e = 0; e < grid->element_count; e++) {
    grid->region[e] = grid->X[3 * (size_t)grid->nodes[e * DEA_HEX_NODES_MAX]] > 0.499;
  }
  assert_int_equal(try(ctx), DEA_OK);
  u = calloc(3 * grid->node_count, sizeof *u);
  assert_non_null(u);
}

static void destroy(void)
{
  free(u);
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* Plate of an incompressible solid: the voltage at which it buckles (test_solid_solve_trace.c). */
static double critical_V(void)
{
  const double pi = acos(-1), h = strip.size[2];
  return sqrt(4 * pi * pi / 3) * h * h;
}

/* The buckled shape, in thicknesses, of lines that stay normal to it. */
static void bend(double amplitude)
{
  const double pi = acos(-1), h = strip.size[2];
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    u[3 * n] = -amplitude * h * pi * sin(2 * pi * X[0]) * (X[2] - 0.5 * h);
    u[3 * n + 2] = amplitude * h * 0.5 * (1 - cos(2 * pi * X[0]));
  }
}

/* Takes the nodes at one place beyond those at the next. */
static void crease(double x)
{
  const double element = 1.0 / 16;
  for (size_t n = 0; n < grid->node_count; n++) {
    u[3 * n] += fabs(grid->X[3 * n] - x) < 1e-9 ? 1.2 * element : 0;
  }
}

/* Whether nothing is found from there as it is. */
static bool is_lost(void)
{
  struct dea_solid_report report = {0};
  bool found;
  assert_int_equal(dea_solid_perturb(ctx, solid, u, NULL, NULL, &report, &found), DEA_OK);
  return !found;
}

static double middle_z(void)
{
  const double X[3] = {0.5, 0, 0.5 * strip.size[2]};
  return dea_solid_displacement(solid)[3 * dea_grid_nearest(grid, X) + 2];
}

/* From a shape with inverted elements, from which as it is nothing is found, to the branch of its
 * side, A^2 = (4/3) h^2 (r - 1) of a plate whose voltage to buckle is a percent off at most
 * (test_solid_solve_trace.c). (The first that the solid is asked for is an assembly that fails: K
 * has to keep its room.) */
TEST(test_either_side)
{
  const double h = strip.size[2], r = 1.8, voltage_V = sqrt(r) * critical_V();
  struct dea_solid_report report = {0};
  bool found;
  create();
  for (int side = 1; side >= -1; side -= 2) {
    bend(side * 0.8);
    crease(0.25);
    crease(0.6875);
    assert_true(is_lost());
    assert_ok(dea_solid_transfer_solution(ctx, solid, voltage_V, u, &report, &found));
    assert_true(found);
    assert_int_equal(report.unstable_modes, 0);
    assert_close(dea_solid_voltage(solid), voltage_V, 1e-12, 0);
    assert_true(side * middle_z() > 0);
    assert_close(pow(middle_z() / h, 2), 4.0 / 3 * (r - 1), 0.01 * r / (r - 1), 0);
  }
  destroy();
}

/* Few iterations are not enough for a shape that is far from balance, but for one that is held near
 * to it until it has come into balance. */
TEST(test_held)
{
  const double h = strip.size[2], r = 1.8, voltage_V = sqrt(r) * critical_V();
  struct dea_solid_report report = {0};
  bool found;
  iterations = 30;
  create();
  iterations = 0;
  bend(0.8);
  crease(0.25);
  assert_int_equal(dea_solid_transfer_solution(ctx, solid, voltage_V, u, &report, &found), DEA_OK);
  assert_true(found);
  assert_close(pow(middle_z() / h, 2), 4.0 / 3 * (r - 1), 0.01 * r / (r - 1), 0);
  destroy();
}

static void carry_it(struct dea_context *failing)
{
  struct dea_solid_report report = {0};
  bool found;
  solid = NULL;
  dea_status status = try(failing);
  if (status == DEA_OK) {
    status = dea_solid_transfer_solution(failing, solid, critical_V(), u, &report, &found);
  }
  failing_check(failing, status);
  dea_solid_destroy(failing, solid);
}

TEST(test_each_allocation)
{
  const struct block fine = strip;
  strip.count[0] = 8;
  strip.order = 2;
  create();
  bend(0.3);
  dea_solid_destroy(ctx, solid);
  assert_true(failing_each(carry_it) > 20);
  solid = NULL;
  destroy();
  strip = fine;
}

TESTS(solid_set_up, solid_tear_down)

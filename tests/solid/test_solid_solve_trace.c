/* Paths of solids by arc-length, against closed forms: the limit point of a free film under voltage
 * and what comes after it, a film between clamps that buckles under voltage, a strip that is pushed
 * together. */
// ctest: solid
#include "failing_allocator.h"
#include "solid_block.h"

#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "solid_fixture.h"

#include <string.h>

/* Units: mu = eps = 1. */
static struct dea_grid *grid;
static struct dea_solid *solid;
static struct dea_solid_continuation *trace;

/* law: NULL for a compressible solid with E = 2 mu and Poisson's ratio 0. */
static dea_status try(struct dea_context *with, const struct block *block, const char *law,
                      int (*held)(const void *self, const double X[3]))
{
  static const double mu_1[] = {2, 0};
  struct dea_part_material layer = dea_part_material_bonded(mu_1);
  if (law != NULL) {
    dea_part_material_set_law(&layer, dea_law_find(law), (const double[]){1});
    layer.kappa_Pa = 100;
    layer.permittivity_F_per_m = 1;
  }
  layer.thickness_m = block->size[2];
  assert_int_equal(dea_part_material_relax(&layer), DEA_OK);
  const struct dea_solid_options options = {.order_z = block->order_z,
                                            .part_material_count = 1,
                                            .part_materials = &layer,
                                            .active = everywhere,
                                            .held = held,
                                            .self = block};
  return dea_solid_create(with, grid, &options, &solid);
}

static void create(const struct block *block, const char *law,
                   int (*held)(const void *self, const double X[3]))
{
  grid = block_grid(ctx, block);
  assert_int_equal(try(ctx, block, law, held), DEA_OK);
}

static void begin(double voltage_V, const struct dea_continuation_options *options)
{
  assert_int_equal(dea_solid_continuation_create(ctx, solid, voltage_V, options, &trace), DEA_OK);
}

static void start(double voltage_V, double step, double step_most, double unit_m)
{
  begin(voltage_V, &(struct dea_continuation_options){step, step_most, unit_m, false});
}

static struct dea_continuation_point step(void)
{
  struct dea_continuation_point point;
  assert_ok(dea_solid_continuation_step(ctx, trace, &point));
  return point;
}

static struct dea_continuation_point locate(void)
{
  struct dea_continuation_point point;
  assert_ok(dea_solid_continuation_locate(ctx, trace, &point));
  return point;
}

static void destroy(void)
{
  dea_solid_continuation_destroy(ctx, trace);
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* A displacement of the node nearest to a place. */
static double displacement_at(double x, double y, double z, size_t component)
{
  const double X[3] = {x, y, z};
  return dea_solid_displacement(solid)[3 * dea_grid_nearest(grid, X) + component];
}

/* ---- a free film: (V/h)^2 eps/mu = lambda^-2 - lambda^-8, largest at lambda = 2^(1/3) ---- */

static const struct block film = {{1, 1, 0.1}, {1, 1, 1}, 2, 2};

/* Both sides of it. (Modes are counted too early by elements of order 2, whose areas change by
 * squares of x and y without the volume being asked: from lambda = 1.15 on, 2 % below the limit.)
 */
TEST(test_free_film_through_its_limit_point)
{
  int limits = 0;
  double stretch = 1;
  create(&film, "neo-hookean", on_planes);
  start(0.7 * film.size[2], 0.1, 0, 1);
  for (int i = 0; i < 40 && stretch < 2; i++) {
    struct dea_continuation_point point = step();
    stretch = 1 + displacement_at(1, 1, 0, 0);
    double field = point.voltage_V / film.size[2];
    assert_close(field * field, pow(stretch, -2) - pow(stretch, -8), 1e-5, 0);
    assert_true(stretch > 1.15 || point.unstable_modes == 0);
    assert_true(stretch < cbrt(2) || point.unstable_modes > 0);
    assert_true(point.slope * (cbrt(2) - stretch) > 0);
    if (point.passed == DEA_CONTINUATION_LIMIT) {
      struct dea_continuation_point limit = locate();
      limits++;
      assert_close(1 + displacement_at(1, 1, 0, 0), cbrt(2), 1e-5, 0);
      assert_close(limit.voltage_V / film.size[2], sqrt(pow(2, -2.0 / 3) - pow(2, -8.0 / 3)), 1e-7,
                   0);
    }
  }
  assert_int_equal(limits, 1);
  assert_true(stretch > 2);
  destroy();
}

/* The same path downwards: it ends at 0 V, and says so. */

TEST(test_a_path_ends_without_voltage)
{
  struct dea_solid_report report;
  struct dea_continuation_point point;
  dea_status status = DEA_OK;
  create(&film, "neo-hookean", on_planes);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0.5 * film.size[2], &report), DEA_OK);
  start(0.6 * film.size[2], -0.1, 0, 1);
  for (int i = 0; i < 60 && status == DEA_OK; i++) {
    status = dea_solid_continuation_step(ctx, trace, &point);
  }
  assert_int_equal(status, DEA_E_DOMAIN);
  assert_non_null(strstr(dea_context_message(ctx), "0 V"));
  assert_close(1 + displacement_at(1, 1, 0, 0), 1, 0, 1e-3);
  dea_context_clear(ctx);
  // the solid is at the last point, and solves go on from there
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
  assert_close(displacement_at(1, 1, 0, 0), 0, 0, 1e-9);
  destroy();
}

/* ---- a film in plane strain between clamps: the field pushes with eps (V/h)^2 h ---- */

static const struct block strip = {{1, 0.1, 0.01}, {16, 1, 1}, 3, 2};

static int clamped_in_plane_strain(const void *self, const double X[3])
{
  const struct block *block = self;
  return 2 | (X[0] < 1e-9 || X[0] > block->size[0] - 1e-9 ? 7 : 0);
}

static double middle_z(void)
{
  return displacement_at(0.5, 0, 0.005, 2);
}

/* Plate of an incompressible solid: D = mu h^3/3, critical push 4 pi^2 D/L^2. */
TEST(test_film_buckles_under_voltage)
{
  const double h = strip.size[2], pi = acos(-1);
  const double critical = 4 * pi * pi / 3 * h * h, goal = sqrt(2 * critical) * h; // L = 1
  struct dea_continuation_point point = {0};
  create(&strip, "neo-hookean", clamped_in_plane_strain);
  start(goal, 0.1, 0.2, h);
  while (point.passed == DEA_CONTINUATION_NOTHING && point.load < 1) {
    point = step();
    assert_close(middle_z(), 0, 0, 1e-9 * h);
  }
  assert_int_equal(point.passed, DEA_CONTINUATION_BIFURCATION);
  struct dea_continuation_point fork = locate();
  assert_close(fork.load, 0.5, 1e-2, 0);
  destroy();
}

/* ---- a strip that is pushed together by its end ---- */

static int clamped_ends(const void *self, const double X[3])
{
  const struct block *block = self;
  return X[0] < 1e-9 || X[0] > block->size[0] - 1e-9 ? 7 : 0;
}

/* Euler's strain pi^2/3 (h/L)^2, by prescribed displacements. */
TEST(test_strip_buckles_at_eulers_strain)
{
  const double h = strip.size[2], euler = acos(-1) * acos(-1) / 3 * h * h;
  const double to[3] = {-1.6 * euler, 0, 0};
  struct dea_continuation_point point = {0};
  create(&strip, NULL, clamped_ends);
  for (size_t n = 0; n < grid->node_count; n++) {
    if (grid->X[3 * n] > 1 - 1e-9) {
      assert_int_equal(dea_solid_prescribe(ctx, solid, n, 7, to), DEA_OK);
    }
  }
  start(0, 0.2, 0.3, h);
  while (point.passed == DEA_CONTINUATION_NOTHING && point.load < 1) {
    point = step();
  }
  assert_int_equal(point.passed, DEA_CONTINUATION_BIFURCATION);
  point = locate();
  assert_close(point.load, 1 / 1.6, 1e-2, 0);
  assert_close(displacement_at(1, 0, 0, 0), -1.6 * euler * point.load, 1e-9, 0);
  destroy();
}

/* Through the first critical point and back to it. */
static void trace_it(struct dea_context *failing)
{
  static const struct dea_continuation_options options = {0.3, 0, 1, false};
  struct dea_continuation_point point = {0};
  struct dea_solid_report report;
  trace = NULL;
  dea_status status = try(failing, &film, "neo-hookean", on_planes);
  if (status == DEA_OK) {
    status = dea_load_steps_solve(failing, solid, 0.65 * film.size[2], &report);
  }
  if (status == DEA_OK) {
    status = dea_solid_continuation_create(failing, solid, 0.7 * film.size[2], &options, &trace);
  }
  while (status == DEA_OK && point.passed == DEA_CONTINUATION_NOTHING) {
    status = dea_solid_continuation_step(failing, trace, &point);
  }
  if (status == DEA_OK) {
    status = dea_solid_continuation_locate(failing, trace, &point);
  }
  failing_check(failing, status);
  dea_solid_continuation_destroy(failing, trace);
  dea_solid_destroy(failing, solid);
}

TEST(test_each_allocation)
{
  grid = block_grid(ctx, &film);
  assert_true(failing_each(trace_it) > 40);
  dea_grid_destroy(ctx, grid);
}

TESTS(solid_set_up, solid_tear_down)

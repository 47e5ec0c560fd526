/* Supports that move, their reactions, and a way that cannot be gone at once. */
// ctest: solid
#include "solid_block.h"

#include "model/solid/equilibrium/load_steps.h"
#include "solid_fixture.h"

#include <string.h>

static const double mu = 1e5;
static const double length = 2;
static const struct block bar = {{2, 1, 1}, {3, 1, 1}, 2, 2};
static struct dea_part_material soft; // of modulus mu, Poisson's ratio 0

/* Along the bar only, so that it cannot buckle. */
static int along(const void *self, const double X[3])
{
  return (X[0] < 1e-9 ? 1 : 0) | 2 | 4;
}

static bool at_end(const struct dea_grid *grid, size_t n)
{
  return grid->X[3 * n] > length - 1e-9;
}

static void pull_end(struct dea_solid *solid, const struct dea_grid *grid, double way)
{
  for (size_t n = 0; n < grid->node_count; n++) {
    if (at_end(grid, n)) {
      assert_int_equal(dea_solid_prescribe(ctx, solid, n, 1, (const double[3]){way, 0, 0}), DEA_OK);
    }
  }
}

static double reaction(const struct dea_solid *solid, const struct dea_grid *grid)
{
  double sum = 0;
  for (size_t n = 0; n < grid->node_count; n++) {
    sum += at_end(grid, n) ? dea_solid_reaction(solid)[3 * n] : 0;
  }
  return sum;
}

/* Nominal stress of a bar of W = mu/2 (I1 - 3 - 2 ln J), which keeps its width. */
static double stress(double stretch)
{
  return mu * (stretch - 1 / stretch);
}

/* Pulled to twice its length and pushed back to half of it, each in one call: the end is where it
 * was asked to be, its reaction is the closed form, and the rest follows at once. */
TEST(test_bar_is_pulled_and_pushed)
{
  static const double stretch[] = {1.001, 2, 0.5, 1};
  struct dea_grid *grid = block_grid(ctx, &bar);
  struct dea_solid *solid = block_solid(ctx, grid, bar.order_z, &soft, on_planes);
  struct dea_solid_report report;
  for (size_t i = 0; i < 4; i++) {
    pull_end(solid, grid, length * (stretch[i] - 1));
    assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
    assert_close(report.load_factor, 1, 0, 0);
    assert_close(reaction(solid, grid), stress(stretch[i]), 1e-8, 1e-8 * mu);
    assert_true(report.iterations <= 12);
    for (size_t n = 0; n < grid->node_count; n++) {
      const double *u = dea_solid_displacement(solid) + 3 * n;
      assert_close(u[0], (stretch[i] - 1) * grid->X[3 * n], 0, 1e-8);
      assert_close(u[1], 0, 0, 1e-8);
    }
  }
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* Local axes of the end: -y, x, z. */
static bool turned_end(const void *self, const double X[3], double Q[9])
{
  static const double turn[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  memcpy(Q, turn, sizeof turn);
  return X[0] > length - 1e-9;
}

static int on_planes_turned(const void *self, const double X[3])
{
  int held = on_planes(self, X);
  return X[0] > length - 1e-9 ? (held & 2) >> 1 | (held & 4) : held;
}

/* The same with the end in local axes, of which the second is the bar's. */
TEST(test_prescribed_in_local_axes)
{
  struct dea_grid *grid = block_grid(ctx, &bar);
  const struct dea_solid_options options = {.order_z = bar.order_z,
                                            .part_material_count = 1,
                                            .part_materials = &soft,
                                            .held = on_planes_turned,
                                            .frame = turned_end};
  struct dea_solid *solid;
  struct dea_solid_report report;
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  for (int step = 1; step <= 3; step++) {
    for (size_t n = 0; n < grid->node_count; n++) {
      if (at_end(grid, n)) {
        assert_ok(dea_solid_prescribe(ctx, solid, n, 2, (const double[3]){0, 0.5 * step, 0}));
      }
    }
    assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
    assert_close(reaction(solid, grid), stress(1 + 0.5 * step / length), 1e-8, 0);
    for (size_t n = 0; n < grid->node_count; n++) {
      const double *u = dea_solid_displacement(solid) + 3 * n;
      assert_close(u[0], 0.5 * step * grid->X[3 * n] / length, 0, 1e-8);
    }
  }
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* Through itself: no equilibrium there, and the solid stays at the last one on the way, where
 * reaction and displacement belong together. */
TEST(test_way_that_ends)
{
  struct dea_grid *grid = block_grid(ctx, &bar);
  struct dea_solid *solid = block_solid(ctx, grid, bar.order_z, &soft, along);
  struct dea_solid_report report;
  pull_end(solid, grid, -1.5 * length);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_E_NOT_CONVERGED);
  assert_true(report.load_factor > 0.3 && report.load_factor < 2 / 3.0);
  size_t end = 0;
  while (!at_end(grid, end)) {
    end++;
  }
  double way = dea_solid_displacement(solid)[3 * end];
  assert_close(way, -1.5 * length * report.load_factor, 1e-9, 0);
  // and it goes on from there
  pull_end(solid, grid, way);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
  assert_close(reaction(solid, grid), stress(1 + way / length), 1e-7, 0);
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

int main(void)
{
  static const double param[] = {2e5, 0}; // modulus mu
  soft = dea_part_material_bonded(param);
  return run_all(solid_set_up, solid_tear_down);
}

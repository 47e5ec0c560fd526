/* A factor is of the state that it was made at: where the solid stands again at another one, or a
 * history in time ends, linear answers have one of their own. */
// ctest: solid
#include "model/solid/assembly/problem.h"
#include "model/solid/equilibrium/adjoint.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/solve_incremental.h"
#include "model/solid/motion/time.h"
#include "solid_block.h"

#include "solid_fixture.h"

#include <math.h>

static const struct block strip = {{20, 3, 0.2}, {16, 3, 1}, 2, 2};
static struct dea_part_material layer = {
    .param = {1e5}, .pre_stretch = {1, 1, 1}, .kappa_Pa = 2e6, .density_kg_per_m3 = 1000};

static int ends(const void *self, const double X[3])
{
  return X[0] < 1e-9 || X[0] > strip.size[0] - 1e-9 ? 1 | 2 | 4 : 0;
}

static struct dea_solid *make(const struct dea_grid *grid)
{
  layer.law = dea_law_find("neo-hookean");
  assert_int_equal(dea_part_material_relax(&layer), DEA_OK);
  return block_solid(ctx, grid, strip.order_z, &layer, ends);
}

/* The straight strip, pushed together by that share. */
static void push(struct dea_solid *s, const struct dea_grid *grid, double share)
{
  struct dea_solid_report report;
  for (size_t n = 0; n < grid->node_count; n++) {
    s->state.u[3 * n] = -share * grid->X[3 * n];
    s->state.u[3 * n + 1] = 0;
    s->state.u[3 * n + 2] = share * grid->X[3 * n + 2];
  }
  s->found.factor_fits = false;
  assert_ok(dea_load_steps_solve(ctx, s, 0, &report));
  assert_int_equal(report.unstable_modes, 0);
}

/* How far a force across the middle of the strip bends it. */
static double bend(struct dea_solid *s, const struct dea_grid *grid)
{
  static const bool wanted[] = {true};
  struct dea_arena memory = {.ctx = ctx};
  struct dea_adjoint *a;
  size_t middle = 0;
  const double at[] = {strip.size[0] / 2, strip.size[1] / 2, 0};
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *x = grid->X + 3 * n, *best = grid->X + 3 * middle;
    const double off = hypot(hypot(x[0] - at[0], x[1] - at[1]), x[2] - at[2]);
    middle = off < hypot(hypot(best[0] - at[0], best[1] - at[1]), best[2] - at[2]) ? n : middle;
  }
  assert_int_equal(dea_adjoint_create(ctx, s, 1, &memory, &a), DEA_OK);
  dea_adjoint_slope(a, 0)[3 * middle + 2] = 1;
  assert_int_equal(dea_adjoint_solve(ctx, a, wanted), DEA_OK);
  const double bent = dea_adjoint_answer(a, 0)[3 * middle + 2];
  dea_arena_free(&memory);
  return bent;
}

/* Back from where the strip nearly buckles, which the raised kappa alone says that it does not. */
TEST(test_another_state)
{
  struct dea_grid *grid = block_grid(ctx, &strip);
  struct dea_solid *s = make(grid);
  struct dea_solid_saved_state here;
  push(s, grid, 1e-4);
  const double bent = bend(s, grid);
  assert_int_equal(dea_solid_save_state(ctx, s, &here), DEA_OK);
  push(s, grid, 3.5e-4);
  assert_true(s->found.stiff_factor_fits);
  assert_true(bend(s, grid) > 10 * bent);
  dea_solid_restore_state(s, &here);
  assert_close(bend(s, grid), bent, 1e-6, 0);
  dea_solid_saved_state_free(&here);
  dea_solid_destroy(ctx, s);
  dea_grid_destroy(ctx, grid);
}

/* The factor of a step in time has the mass in it. */
TEST(test_after_time)
{
  struct dea_grid *grid = block_grid(ctx, &strip);
  struct dea_solid *s = make(grid);
  struct dea_solid_time *time;
  struct dea_solid_report report;
  const struct dea_solid_time_options options = {.inertia = true, .spectral_radius = 1};
  push(s, grid, 1e-4);
  const double bent = bend(s, grid);
  assert_int_equal(dea_solid_time_create(ctx, s, &options, &time), DEA_OK);
  assert_int_equal(dea_solid_time_step(ctx, time, 0, 0.1, &report), DEA_OK);
  dea_solid_time_accept(time);
  dea_solid_time_destroy(ctx, time);
  assert_close(bend(s, grid), bent, 1e-6, 0);
  dea_solid_destroy(ctx, s);
  dea_grid_destroy(ctx, grid);
}

TESTS(solid_set_up, solid_tear_down)

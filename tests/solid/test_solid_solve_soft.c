/* The bulk modulus on the way down to an equilibrium: a strip that is pushed together so far that
 * it buckles ends in the same state with a soft one as without, by fewer factors. */
// ctest: solid
#include "model/solid/assembly/problem.h"
#include "model/solid/equilibrium/load_steps.h"
#include "solid_block.h"

#include "solid_fixture.h"

#include <math.h>

static const struct block strip = {{20, 3, 0.2}, {16, 3, 1}, 2, 2};
static struct dea_part_material layer = {.param = {1e5}, .pre_stretch = {1, 1, 1}, .kappa_Pa = 1e7};

static int ends(const void *self, const double X[3])
{
  return X[0] < 1e-9 || X[0] > strip.size[0] - 1e-9 ? 1 | 2 | 4 : 0;
}

/* From a strip that is pushed together by that share and bent a little. */
static dea_status go_down(struct dea_solid *s, const struct dea_grid *grid, double share,
                          struct dea_solid_report *report)
{
  for (size_t n = 0; n < grid->node_count; n++) {
    double x = grid->X[3 * n] / strip.size[0];
    s->state.u[3 * n] = -share * grid->X[3 * n];
    s->state.u[3 * n + 2] = 0.05 * (1 - cos(2 * acos(-1) * x));
  }
  return dea_load_steps_solve(ctx, s, 0, report);
}

static struct dea_solid *make(const struct dea_grid *grid, double soft)
{
  struct dea_solid *s = block_solid(ctx, grid, strip.order_z, &layer, ends);
  s->settings.descent_bulk_factor = soft;
  return s;
}

TEST(test_same_state)
{
  struct dea_grid *grid = block_grid(ctx, &strip);
  struct dea_solid *own = make(grid, 1), *soft = make(grid, 1.0 / 16);
  struct dea_solid_report of_own, of_soft;
  assert_int_equal(go_down(own, grid, 0.05, &of_own), DEA_OK);
  assert_int_equal(go_down(soft, grid, 0.05, &of_soft), DEA_OK);
  assert_int_equal(of_own.unstable_modes, 0);
  assert_int_equal(of_soft.unstable_modes, 0);
  assert_true(soft->state.bulk_factor == 1);
  double off = 0, most = 0;
  for (size_t i = 0; i < own->problem.dofs; i++) {
    off = fmax(off, fabs(own->state.u[i] - soft->state.u[i]));
    most = fmax(most, fabs(own->state.u[i]));
  }
  print_message("%d and %d factors, %.1e apart\n", of_own.factorisations, of_soft.factorisations,
                off / most);
  assert_true(most > 5 * strip.size[2]); // far from straight
  assert_true(off < 1e-8 * most);
  assert_true(fabs(of_own.energy_J / of_soft.energy_J - 1) < 1e-12);
  assert_true(of_soft.factorisations < of_own.factorisations);
  dea_solid_destroy(ctx, own);
  dea_solid_destroy(ctx, soft);
  dea_grid_destroy(ctx, grid);
}

int main(void)
{
  layer.law = dea_law_find("neo-hookean");
  return dea_part_material_relax(&layer) == DEA_OK ? run_all(solid_set_up, solid_tear_down) : 1;
}

/* The shift that a tangent lacks: of a strip that is pushed together, to more and more unstable
 * modes, what Lanczos' method finds against the inertia of K shifted by a tenth less and more. */
// ctest: solid
#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/shift.h"
#include "solid_block.h"

#include "solid_fixture.h"

#include <math.h>

static const struct block strip = {{20, 3, 0.2}, {16, 3, 1}, 2, 2};
static struct dea_part_material layer = {.param = {1e5}, .pre_stretch = {1, 1, 1}, .kappa_Pa = 1e7};

static int ends(const void *self, const double X[3])
{
  return X[0] < 1e-9 || X[0] > strip.size[0] - 1e-9 ? 1 | 2 | 4 : 0;
}

/* Pushed together by that share, at no change of volume to first order, and K of there. */
static struct dea_solid *pushed(const struct dea_grid *grid, double share)
{
  double energy_J;
  struct dea_solid *s = block_solid(ctx, grid, strip.order_z, &layer, ends);
  for (size_t n = 0; n < grid->node_count; n++) {
    s->state.u[3 * n] = -share * grid->X[3 * n];
    s->state.u[3 * n + 2] = share * grid->X[3 * n + 2];
  }
  assert_int_equal(dea_solid_assemble(ctx, s, 0, DEA_TANGENT, &energy_J), DEA_OK);
  return s;
}

/* Negative pivots of K + more_Pa L, which K is after that. */
static int shifted(struct dea_solid *s, Mat L, double more_Pa)
{
  int negative;
  assert_int_equal(dea_solid_add_matrix(ctx, s->work.K, more_Pa, L), DEA_OK);
  assert_int_equal(dea_solid_factorise(ctx, s, &negative), DEA_OK);
  return negative;
}

/* *negative: pivots of K. */
static double check(const struct dea_grid *grid, double share, int *negative)
{
  struct dea_solid *s = pushed(grid, share);
  double lowest_Pa, again_Pa;
  Mat L;
  assert_int_equal(dea_solid_create_laplace(ctx, s, &L), DEA_OK);
  *negative = shifted(s, L, 0);
  assert_int_equal(dea_solid_lowest_by_laplace(ctx, s, L, *negative, &lowest_Pa), DEA_OK);
  assert_int_equal(dea_solid_lowest_by_laplace(ctx, s, L, *negative, &again_Pa), DEA_OK);
  assert_true(again_Pa == lowest_Pa);
  assert_true(lowest_Pa < 0);
  assert_int_equal(shifted(s, L, -1.1 * lowest_Pa), 0);
  assert_true(shifted(s, L, 0.2 * lowest_Pa) > 0); // - 0.9 of it
  MatDestroy(&L);
  dea_solid_destroy(ctx, s);
  return lowest_Pa;
}

TEST(test_strip)
{
  static const double shares[] = {0.0036, 0.0045, 0.006, 0.008, 0.01};
  layer.law = dea_law_find("neo-hookean");
  assert_int_equal(dea_part_material_relax(&layer), DEA_OK);
  struct dea_grid *grid = block_grid(ctx, &strip);
  int negative[5];
  double before_Pa = 0;
  for (int i = 0; i < 5; i++) {
    double lowest_Pa = check(grid, shares[i], &negative[i]);
    assert_true(lowest_Pa < before_Pa);
    before_Pa = lowest_Pa;
  }
  assert_true(negative[0] < 3 && negative[4] == 6);
  dea_grid_destroy(ctx, grid);
}

/* The same end where the lowest of more modes is looked for than are counted by default. */
TEST(test_many_modes)
{
  static const int modes[] = {8, 40};
  layer.law = dea_law_find("neo-hookean");
  assert_int_equal(dea_part_material_relax(&layer), DEA_OK);
  struct dea_grid *grid = block_grid(ctx, &strip);
  double energy_J[2];
  int negative;
  for (int i = 0; i < 2; i++) {
    struct dea_solid *s = pushed(grid, 0.02);
    struct dea_solid_report report;
    assert_int_equal(dea_solid_factor_roughly(ctx, s, 40, &negative), DEA_OK);
    assert_true(negative > 20 && negative <= 40);
    for (size_t n = 0; n < grid->node_count; n++) {
      s->state.u[3 * n + 2] = 0.05 * (1 - cos(2 * acos(-1) * grid->X[3 * n] / strip.size[0]));
    }
    s->settings.shift_max_modes = modes[i];
    assert_int_equal(dea_load_steps_solve(ctx, s, 0, &report), DEA_OK);
    assert_int_equal(report.unstable_modes, 0);
    energy_J[i] = report.energy_J;
    dea_solid_destroy(ctx, s);
  }
  assert_close(energy_J[1], energy_J[0], 1e-10, 0);
  dea_grid_destroy(ctx, grid);
}

TESTS(solid_set_up, solid_tear_down)

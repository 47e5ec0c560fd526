/* Mirror planes in any direction: a solid turned about the z axis answers with turned
 * displacements.
 */
// ctest: solid
#include "model/solid/assembly/solid.h"
#include "model/solid/equilibrium/load_steps.h"
#include "quarter_grid.h"
#include "testing.h"
#include "yeoh_part.h"

#include "solid_fixture.h" // after: its context shadows no name of the headers above

#include <math.h>
#include <string.h>

static const double a_m = 3.75e-3, b_m = 15e-3, h_m = 100e-6 / 2.25;

/* A quarter between the mirror planes at the angles `turn` and `turn` + 90 degrees. */
struct turned {
  double turn, c, s;
};

static void back(const struct turned *t, const double X[3], double x[2])
{
  x[0] = t->c * X[0] + t->s * X[1];
  x[1] = -t->s * X[0] + t->c * X[1];
}

static int held(const void *self, const double X[3])
{
  double x[2];
  back(self, X, x);
  if (hypot(x[0], x[1]) > b_m * (1 - 1e-9)) {
    return 1 | 2 | 4;
  }
  return (x[0] < 1e-12 ? 1 : 0) | (x[1] < 1e-12 ? 2 : 0);
}

static bool frame(const void *self, const double X[3], double Q[9])
{
  const struct turned *t = self;
  double x[2];
  back(t, X, x);
  const double axes[9] = {t->c, t->s, 0, -t->s, t->c, 0, 0, 0, 1};
  memcpy(Q, axes, sizeof axes);
  return x[0] < 1e-12 || x[1] < 1e-12;
}

static int layer_of(const void *self, int region, int ply)
{
  return ply;
}

static bool active(const void *self, int region, int ply)
{
  return region == DEA_REGION_ELECTRODE && ply == DEA_PLY_FILM;
}

/* Four fibres on a coarse mesh up to 4 kV; u: [node_count][3], turned back. */
static struct dea_solid_report run(double angle, double **u, size_t *count)
{
  const struct turned turned = {angle, cos(angle), sin(angle)};
  struct dea_part_material layers[] = {yeoh_part(1.5, 2.8 * DEA_EPSILON_0, h_m),
                                       dea_part_material_bonded((const double[]){2.75e9, 0.375})};
  const struct dea_quarter quarter = {2, 2, a_m, b_m, h_m, 4, 2e-3, 100e-6, .fine = 2, .across = 1};
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 2,
                                            .part_materials = layers,
                                            .part_material_of = layer_of,
                                            .active = active,
                                            .held = held,
                                            .frame = angle != 0 ? frame : NULL,
                                            .self = &turned};
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_report report;
  assert_int_equal(dea_grid_quarter(ctx, &quarter, &grid), DEA_OK);
  for (size_t n = 0; n < grid->node_count; n++) {
    double *X = grid->X + 3 * n, x = X[0], y = X[1];
    X[0] = turned.c * x - turned.s * y;
    X[1] = turned.s * x + turned.c * y;
  }
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  for (size_t n = 0; n < grid->node_count; n++) { // a dead load at the centre
    const double *X = grid->X + 3 * n;
    dea_solid_force(solid)[3 * n + 2] = hypot(X[0], X[1]) < 1e-9 ? 1e-5 : 0;
  }
  for (int kV = 0; kV <= 4; kV += 2) {
    assert_int_equal(dea_load_steps_solve(ctx, solid, 1e3 * kV, &report), DEA_OK);
  }
  *u = dea_alloc(ctx, grid->node_count, 3 * sizeof(double));
  assert_non_null(*u);
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *from = dea_solid_displacement(solid) + 3 * n;
    back(&turned, from, *u + 3 * n);
    (*u)[3 * n + 2] = from[2];
  }
  *count = grid->node_count;
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
  return report;
}

TEST(test_turned_quarter)
{
  double *straight, *turned, largest = 0;
  size_t count, same;
  struct dea_solid_report a = run(0, &straight, &count), b = run(0.7, &turned, &same);
  assert_int_equal(same, count);
  assert_int_equal(a.unstable_modes, 0);
  assert_int_equal(b.unstable_modes, 0);
  assert_int_equal(a.iterations, b.iterations);
  assert_close(b.energy_J, a.energy_J, 1e-10, 0);
  for (size_t i = 0; i < 3 * count; i++) {
    largest = fmax(largest, fabs(straight[i]));
  }
  assert_true(largest > 1e-4);
  for (size_t i = 0; i < 3 * count; i++) {
    assert_close(turned[i], straight[i], 0, 1e-8 * largest);
  }
  dea_free(ctx, straight);
  dea_free(ctx, turned);
}

TESTS(solid_set_up, solid_tear_down)

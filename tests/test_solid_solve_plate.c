/* The actuator on its sector, on two sectors and as a whole disc: one answer. */
// ctest: solid
#include "model/solid/assembly/solid.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/mesh/fibre_disc.h"
#include "solid_node.h"
#include "testing.h"

#include "solid_fixture.h" // after: its context shadows no name of the headers above

#include <math.h>

static const double a_m = 3.75e-3, b_m = 15e-3, h_m = 100e-6 / 2.25;

static int layer_of(const void *self, int region, int ply)
{
  (void)self;
  (void)region;
  return ply == DEA_FIBRE_DISC_FILM ? 0 : 1;
}

static bool active(const void *self, int region, int ply)
{
  (void)self;
  return (region & DEA_FIBRE_DISC_ELECTRODE) != 0 && ply == DEA_FIBRE_DISC_FILM;
}

static int held(const void *self, const double X[3])
{
  return dea_fibre_disc_held(self, X);
}

static bool frame(const void *self, const double X[3], double Q[9])
{
  return dea_fibre_disc_frame(self, X, Q);
}

struct answer {
  double tip, centre, between, energy; // z, z, outwards; of the whole actuator
  size_t nodes;
};

/* As built at 3 kV with N fibres on a coarse mesh. */
static struct answer run(int fibres, int sectors)
{
  static const double plastic[] = {2950e6, 0.38};
  const double pi = acos(-1);
  struct dea_constituent layers[] = {{.law = dea_law_find("yeoh"),
                                      .param = {178.4e3, -6e3, 4.2e3},
                                      .pre_stretch = {1.5, 1.5, 1 / 2.25},
                                      .kappa_Pa = 4e7,
                                      .permittivity_F_per_m = 2.8 * DEA_EPSILON_0,
                                      .thickness_m = h_m},
                                     dea_constituent_bonded(plastic)};
  const struct dea_fibre_disc plate = {.order = 2,
                                       .order_z = 2,
                                       .fibres = fibres,
                                       .sectors = sectors,
                                       .electrode_radius = a_m,
                                       .frame_radius = b_m,
                                       .tip_radius = a_m,
                                       .outer_radius = b_m,
                                       .tip_width = 2e-3,
                                       .outer_width = 2e-3,
                                       .film_thickness = h_m,
                                       .fibre_thickness = 100e-6,
                                       .size = 0.5 * a_m,
                                       .edge = 0.2 * a_m};
  const struct dea_solid_options options = {.order_z = 2,
                                            .constituent_count = 2,
                                            .constituents = layers,
                                            .constituent_of = layer_of,
                                            .active = active,
                                            .held = held,
                                            .frame = frame,
                                            .self = &plate};
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_report rest, report;
  assert_int_equal(dea_constituent_relax(&layers[0]), DEA_OK);
  assert_int_equal(dea_fibre_disc_create(ctx, &plate, &grid), DEA_OK);
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &rest), DEA_OK);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 3e3, &report), DEA_OK);
  assert_int_equal(report.unstable_modes, 0);
  const double *u = dea_solid_displacement(solid);
  double half = pi / fibres;
  size_t between = 3 * node_near(grid, a_m * cos(half), a_m * sin(half), 0);
  struct answer answer = {
      u[3 * node_near(grid, a_m, 0, 0.5 * h_m) + 2], u[3 * node_near(grid, 0, 0, 0) + 2],
      u[between] * cos(half) + u[between + 1] * sin(half),
      (report.energy_J - rest.energy_J) * 2 * fibres / sectors, grid->node_count};
  assert_close(u[between + 1] * cos(half) - u[between] * sin(half), 0, 0, 1e-12);
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
  return answer;
}

/* Four fibres: 45 degrees with a plane of its own axes, the quarter, and all of it; three fibres:
 * 60 and 120 degrees. */
static void test_domains_agree(void **state)
{
  (void)state;
  static const int domains[][2] = {{4, 1}, {4, 2}, {4, 8}, {3, 1}, {3, 2}};
  struct answer first = {0};
  for (size_t i = 0; i < sizeof domains / sizeof domains[0]; i++) {
    struct answer answer = run(domains[i][0], domains[i][1]);
    if (domains[i][1] == 1) {
      first = answer;
      assert_true(first.tip < -1e-6 && first.centre < -1e-6 && first.between > 5e-5);
      continue;
    }
    assert_true((double)answer.nodes > 1.7 * (double)first.nodes);
    assert_close(answer.tip, first.tip, 1e-7, 0);
    assert_close(answer.centre, first.centre, 1e-7, 0);
    assert_close(answer.between, first.between, 1e-7, 0);
    assert_close(answer.energy, first.energy, 1e-7, 0);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_domains_agree)};
  return cmocka_run_group_tests(tests, solid_set_up, solid_tear_down);
}

/* A coupled solid that is solved in a moment, for builds with sanitizers: fibres, a load, local
 * axes, orders 1 and 2. */
#include "model/solid/assembly/film_state.h"
#include "model/solid/assembly/solid.h"
#include "model/solid/equilibrium/load_steps.h"
#include "quarter_grid.h"
#include "solid_block.h"
#include "testing.h"
#include "yeoh_part.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <string.h>

static const double a_m = 3.75e-3, b_m = 15e-3, h_m = 44e-6;
static const double epsilon = 2.8 * DEA_EPSILON_0;

/* Local axes on x = 0, where y comes first. */
static bool swapped(const void *self, const double X[3], double Q[9])
{
  static const double axes[9] = {0, 1, 0, 1, 0, 0, 0, 0, 1};
  memcpy(Q, axes, sizeof axes);
  return X[0] < 1e-12;
}

static int held(const void *self, const double X[3])
{
  if (hypot(X[0], X[1]) > b_m * (1 - 1e-9)) {
    return 1 | 2 | 4;
  }
  return (X[0] < 1e-12 ? 2 : 0) | (X[1] < 1e-12 ? (X[0] < 1e-12 ? 1 : 2) : 0);
}

static bool faces(const void *self, const double X[3], double *share)
{
  *share = X[2] > 0 ? 1 : 0;
  return hypot(X[0], X[1]) < a_m * (1 + 1e-9) && fabs(fabs(X[2]) - 0.5 * h_m) < 1e-6 * h_m;
}

/* Spring of 1 N/m at the first node. */
static dea_status spring(const void *self, size_t piece, const double *u, enum dea_eval_order level,
                         struct dea_load_piece *out)
{
  memset(out, 0, sizeof *out);
  out->node_count = 1;
  out->energy_J = 0.5 * u[2] * u[2];
  out->g[2] = u[2];
  out->K[8] = 1;
  return DEA_OK;
}

/* For a small voltage the energy falls by C V^2/2, C that of plates which are too long by
 * 1/(order + 1)^2 of the element at their edge, much wider than the film is thick. */
static void check_capacity(int order)
{
  const double V = 100;
  struct dea_part_material layers[] = {yeoh_part(1.5, epsilon, h_m),
                                       dea_part_material_bonded((const double[]){2.75e9, 0.375})};
  const struct dea_quarter quarter = {.order = order,
                                      .order_z = order,
                                      .a = a_m,
                                      .b = b_m,
                                      .film_thickness = h_m,
                                      .fibres = 4,
                                      .fibre_width = 2e-3,
                                      .fibre_thickness = 100e-6,
                                      .fine = 1,
                                      .across = 1,
                                      .edge = 0.5e-3};
  const struct dea_solid_options options = {.order_z = order,
                                            .field = DEA_SOLID_FIELD_COUPLED,
                                            .part_material_count = 2,
                                            .part_materials = layers,
                                            .part_material_of = layer_of_ply,
                                            .held = held,
                                            .frame = swapped,
                                            .electrode = faces};
  const struct dea_solid_load load = {.piece_count = 1, .evaluate = spring};
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_report rest, report;
  assert_int_equal(dea_grid_quarter(ctx, &quarter, &grid), DEA_OK);
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  assert_int_equal(dea_solid_add_load(ctx, solid, &load), DEA_OK);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &rest), DEA_OK);
  assert_int_equal(dea_load_steps_solve(ctx, solid, V, &report), DEA_OK);
  assert_int_equal(report.unstable_modes, 0);
  double found;
  assert_int_equal(dea_solid_capacitance(ctx, solid, false, &found), DEA_OK);
  assert_close(rest.energy_J - report.energy_J, 0.5 * found * V * V, 1e-3, 0);
  double radius = a_m + 0.5e-3 / ((order + 1) * (order + 1));
  double capacity = epsilon * 0.25 * acos(-1) * radius * radius / h_m;
  assert_close(rest.energy_J - report.energy_J, 0.5 * capacity * V * V, order == 1 ? 0.1 : 0.01, 0);
  // a start that no element can be evaluated at is refused, and leaves the solid fit for others
  double *u = dea_solid_displacement(solid) + 3 * (grid->node_count / 2), z = u[2];
  u[2] = 1;
  assert_int_not_equal(dea_load_steps_solve(ctx, solid, V, &report), DEA_OK);
  u[2] = z;
  struct dea_solid_report again;
  assert_int_equal(dea_load_steps_solve(ctx, solid, V, &again), DEA_OK);
  assert_close(rest.energy_J - again.energy_J, 0.5 * found * V * V, 1e-3, 0);
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

TEST(test_capacity)
{
  assert_int_equal(dea_solid_start(ctx), DEA_OK);
  check_capacity(1);
  check_capacity(2);
  dea_solid_stop();
}

TESTS(context_set_up, context_tear_down)

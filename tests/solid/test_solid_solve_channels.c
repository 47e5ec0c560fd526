/* Electrodes on several voltages: charge by channel, reciprocity, response. */
// ctest: solid
#include "model/solid/assembly/channels.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/motion/response.h"
#include "solid_block.h"
#include "testing.h"

#include "solid_fixture.h" // after: its context shadows no name of the headers above

#include <stdlib.h>

static const double h_m = 44e-6, length_m = 4e-3;

static struct dea_part_material film_of(double thickness_m)
{
  struct dea_part_material film = {.law = dea_law_find("yeoh"),
                                   .param = {178.4e3, -6e3, 4.2e3},
                                   .pre_stretch = {1.5, 1.5, 1 / 2.25},
                                   .kappa_Pa = 4e7,
                                   .permittivity_F_per_m = 2.8 * DEA_EPSILON_0,
                                   .thickness_m = thickness_m,
                                   .density_kg_per_m3 = 1080};
  assert_int_equal(dea_part_material_relax(&film), DEA_OK);
  return film;
}

/* ---- a strip with two electrodes side by side on one film ---- */

static void map_third(const void *self, double s, double t, double x[2])
{
  x[0] = length_m * (*(const double *)self + s) / 3;
  x[1] = 0.5 * length_m * t;
}

static bool all_but_the_middle(const void *self, int region, int ply)
{
  return region != 1;
}

static void two_channels(const void *self, int region, int ply, int *top, int *bottom)
{
  *top = region == 0 ? 1 : 2;
  *bottom = 0;
}

/* Its ends and sides are held, as in a frame. */
static int framed(const void *self, const double X[3])
{
  bool end = X[0] < 1e-9 || X[0] > length_m - 1e-9;
  bool side = X[1] < 1e-9 || X[1] > 0.5 * length_m - 1e-9;
  return end || side ? 1 | 2 | 4 : 0;
}

struct strip {
  struct dea_grid *grid;
  struct dea_solid *solid;
};

static struct strip strip_create(bool membrane, size_t channels, const double *share)
{
  static const double from[3] = {0, 1, 2}, cuts_s[] = {0, 0.5, 1}, cuts_t[] = {0, 0.5, 1};
  struct dea_block blocks[3];
  for (int i = 0; i < 3; i++) {
    blocks[i] = (struct dea_block){map_third, &from[i], cuts_s, cuts_t, 2, 2, i};
  }
  const struct dea_ply ply = {membrane ? 0 : h_m, 1, 2};
  const struct dea_part_material film = film_of(h_m);
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 1,
                                            .part_materials = &film,
                                            .active = all_but_the_middle,
                                            .channels = channels > 0 ? two_channels : NULL,
                                            .channel_count = channels,
                                            .share = share,
                                            .held = framed};
  struct strip it;
  assert_int_equal(dea_grid_create(ctx, 2, blocks, 3, &ply, 1, NULL, 0, length_m, &it.grid),
                   DEA_OK);
  assert_int_equal(dea_solid_create(ctx, it.grid, &options, &it.solid), DEA_OK);
  return it;
}

static void strip_destroy(struct strip *it)
{
  dea_solid_destroy(ctx, it->solid);
  dea_grid_destroy(ctx, it->grid);
}

static void solve_at(struct strip *it, double voltage_V, double first_V, double second_V)
{
  struct dea_solid_report report;
  double *own = dea_solid_own_voltages(it->solid);
  own[1] = first_V;
  own[2] = second_V;
  assert_int_equal(dea_load_steps_solve(ctx, it->solid, voltage_V, &report), DEA_OK);
  assert_int_equal(report.unstable_modes, 0);
}

static void assert_same_displacements(struct strip *a, struct strip *b)
{
  double most = 0;
  for (size_t i = 0; i < 3 * a->grid->node_count; i++) {
    most = fmax(most, fabs(dea_solid_displacement(a->solid)[i]));
  }
  assert_true(most > 1e-6);
  for (size_t i = 0; i < 3 * a->grid->node_count; i++) {
    assert_close(dea_solid_displacement(a->solid)[i], dea_solid_displacement(b->solid)[i], 0,
                 1e-9 * most);
  }
}

/* Both channels at one voltage are the one voltage of a solid without channels; shares of a voltage
 * are own voltages of that size, whichever way is gone. */
TEST(test_shares_and_own_voltages)
{
  const double half[2] = {1, 0.5};
  struct strip one = strip_create(true, 0, NULL), two = strip_create(true, 2, NULL);
  struct strip shared = strip_create(true, 2, half), own = strip_create(true, 2, half);
  struct dea_solid_report report;
  assert_int_equal(dea_load_steps_solve(ctx, one.solid, 4e3, &report), DEA_OK);
  solve_at(&two, 4e3, 0, 0);
  assert_same_displacements(&one, &two);
  solve_at(&shared, 4e3, 0, 0);
  solve_at(&own, 0, 3e3, -1e3); // and not straight there
  solve_at(&own, 0, 4e3, 2e3);
  assert_same_displacements(&shared, &own);
  double V[3];
  dea_solid_channel_voltages(shared.solid, V);
  assert_true(V[0] == 0 && V[1] == 4e3 && V[2] == 2e3);
  strip_destroy(&one);
  strip_destroy(&two);
  strip_destroy(&shared);
  strip_destroy(&own);
}

/* Charge of channel k by central differences of equilibria against the matrix: dQ_k/dV_l. */
static void check_matrix(bool membrane, double accuracy)
{
  const double none[2] = {0, 0}, V[2] = {3e3, 1.5e3}, step_V = 4;
  struct strip strip = strip_create(membrane, 2, none);
  double matrix[9], held[9], found[2][2], charge[2][3];
  solve_at(&strip, 0, V[0], V[1]);
  assert_int_equal(dea_solid_capacitances(ctx, strip.solid, false, matrix), DEA_OK);
  assert_int_equal(dea_solid_capacitances(ctx, strip.solid, true, held), DEA_OK);
  assert_int_equal(dea_solid_flows(ctx, strip.solid, NULL, charge[0], NULL), DEA_OK);
  assert_close(charge[0][1], held[4] * V[0], 1e-12, 0); // no electrode faces the other channel
  assert_close(charge[0][2], held[8] * V[1], 1e-12, 0);
  assert_close(charge[0][0], -charge[0][1] - charge[0][2], 1e-12, 0);
  assert_true(held[5] == 0 && held[7] == 0);
  assert_true(matrix[4] > held[4] && matrix[8] > held[8]);
  for (int l = 0; l < 2; l++) {
    for (int side = 0; side < 2; side++) {
      double by = (2 * side - 1) * step_V;
      solve_at(&strip, 0, V[0] + (l == 0 ? by : 0), V[1] + (l == 1 ? by : 0));
      assert_int_equal(dea_solid_flows(ctx, strip.solid, NULL, charge[side], NULL), DEA_OK);
    }
    for (int k = 0; k < 2; k++) {
      found[k][l] = (charge[1][k + 1] - charge[0][k + 1]) / (2 * step_V);
      assert_close(matrix[3 * (k + 1) + l + 1], found[k][l], 0, accuracy * held[4]);
    }
  }
  print_message("%s: C_11 %.9g pF held, %.9g moving; dQ1/dV2 %.9g, dQ2/dV1 %.9g, matrix %.9g pF\n",
                membrane ? "membrane" : "solid", 1e12 * held[4], 1e12 * matrix[4],
                1e12 * found[0][1], 1e12 * found[1][0], 1e12 * matrix[5]);
  assert_close(found[0][1], found[1][0], 0, accuracy * held[4]); // reciprocity of equilibria
  assert_true(fabs(matrix[5]) > 1e3 * accuracy * held[4]);       // which is not that of zeros
  assert_close(matrix[5], matrix[7], 0, 1e-12 * held[4]);
  for (int i = 0; i < 3; i++) {
    assert_close(matrix[3 * i] + matrix[3 * i + 1] + matrix[3 * i + 2], 0, 0, 1e-12 * held[4]);
  }
  strip_destroy(&strip);
}

TEST(test_charges_follow_voltages)
{
  check_matrix(true, 1e-6);
  check_matrix(false, 1e-6);
}

/* ---- a stack of films with electrodes between them ---- */

/* The static response to an AC excitation of the whole, where channels are at voltages of their
 * own, against equilibria on both sides. */
TEST(test_response_about_own_voltages)
{
  static const double V[2] = {3e3, 1.5e3}, step_V = 20;
  static const struct dea_damping none;
  struct strip strip = strip_create(true, 2, (const double[]){1, 0.5});
  size_t count = 3 * strip.grid->node_count;
  double *slope = calloc(count, sizeof *slope), most = 0, off = 0;
  assert_non_null(slope);
  for (int side = -1; side <= 1; side += 2) {
    solve_at(&strip, side * step_V, V[0], V[1]);
    for (size_t i = 0; i < count; i++) {
      slope[i] += side * dea_solid_displacement(strip.solid)[i] / (2 * step_V);
    }
  }
  solve_at(&strip, 0, V[0], V[1]);
  struct dea_arena memory = {.ctx = ctx};
  struct dea_solid_response *response;
  assert_int_equal(dea_solid_response_create(ctx, strip.solid, 1, &memory, &response), DEA_OK);
  for (size_t n = 0; n < strip.grid->node_count; n++) {
    double real[3], imaginary[3];
    dea_solid_response_at(response, n, 0, &none, real, imaginary);
    for (size_t i = 0; i < 3; i++) {
      most = fmax(most, fabs(slope[3 * n + i]));
      off = fmax(off, fabs(real[i] - slope[3 * n + i]));
      assert_true(imaginary[i] == 0);
    }
  }
  print_message("up to %.6g nm/V, off by %.2e of it\n", 1e9 * most, off / most);
  assert_true(most > 1e-10);
  assert_true(off < 1e-5 * most);
  dea_arena_free(&memory);
  free(slope);
  strip_destroy(&strip);
}

TESTS(solid_set_up, solid_tear_down)

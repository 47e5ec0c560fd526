/* Stability of solids: both sides of the pitchfork of a compressed strip, solves that leave an
 * unstable equilibrium, modes of a plate. */
// ctest: solid
#include "model/solid/element/hex_shape.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/mesh/grid.h"
#include "solid_block.h"

#include "solid_fixture.h"

#include <stdlib.h>
#include <string.h>

/* A strip of a compressible solid, length 1 along x, clamped at both ends, free to move along y by
 * its width only by Poisson's ratio 0. nu = 0: E = 2 mu. Pre-strain is put in by prescribing the
 * end x = 1. */
static const double length = 1, width = 0.05, thickness = 0.01, mu = 0.5e6;
static const double elastic[] = {1e6, 0}; // E = 2 mu, nu
enum { ALONG = 8, ORDER = 3 };            // of order 2 ten are 3 % too stiff

static struct dea_grid *grid;
static struct dea_solid *solid;
static struct dea_solid_report report;

static void map_strip(const void *self, double s, double t, double x[2])
{
  x[0] = length * s;
  x[1] = width * t;
}

static int clamped_ends(const void *self, const double X[3])
{
  return X[0] < 1e-9 || X[0] > length - 1e-9 ? 7 : 0;
}

static void create(void)
{
  double cuts[ALONG + 1];
  static const double one[] = {0, 1};
  for (int i = 0; i <= ALONG; i++) {
    cuts[i] = (double)i / ALONG;
  }
  const struct dea_block block = {map_strip, NULL, cuts, one, ALONG, 1, 0};
  const struct dea_ply ply = {thickness, 1, 2};
  const struct dea_part_material layer = dea_part_material_bonded(elastic);
  const struct dea_solid_options options = {
      .order_z = 2, .part_material_count = 1, .part_materials = &layer, .held = clamped_ends};
  assert_ok(dea_grid_create(ctx, ORDER, &block, 1, &ply, 1, NULL, -0.5 * thickness, length, &grid));
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
}

static void destroy(void)
{
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* Both ends stay clamped, the one at x = 1 goes inwards by the strain. */
static void compress(double strain)
{
  const double to[3] = {-strain * length, 0, 0};
  for (size_t n = 0; n < grid->node_count; n++) {
    if (grid->X[3 * n] > length - 1e-9) {
      assert_int_equal(dea_solid_prescribe(ctx, solid, n, 7, to), DEA_OK);
    }
  }
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
}

static double middle_z(void)
{
  double most = 0;
  for (size_t n = 0; n < grid->node_count; n++) {
    double z = dea_solid_displacement(solid)[3 * n + 2];
    most = fabs(z) > fabs(most) ? z : most;
  }
  return most;
}

/* Pitchfork: left to either side the strip has the same energy, below that of the flat one, and is
 * the mirror image; deflection of the buckled strip from the length that it has to keep. */
TEST(test_both_sides_of_the_pitchfork)
{
  const double euler = acos(-1) * acos(-1) / 3 * thickness * thickness / (length * length);
  double z[2], energy[2], flat;
  create();
  dea_solid_settings_of(solid)->accept_unstable = true;
  compress(1.5 * euler); // the second mode comes at 2.05
  assert_int_equal(report.unstable_modes, 1);
  flat = report.energy_J;
  size_t size = 3 * grid->node_count * sizeof(double);
  double *keep = dea_alloc(ctx, 3 * grid->node_count, sizeof *keep);
  assert_non_null(keep);
  memcpy(keep, dea_solid_displacement(solid), size);
  for (int k = 0; k < 2; k++) {
    memcpy(dea_solid_displacement(solid), keep, size);
    assert_int_equal(dea_solid_descend_unstable(ctx, solid, k == 0 ? 1 : -1, &report), DEA_OK);
    assert_true(report.snapped);
    assert_int_equal(report.unstable_modes, 0);
    z[k] = middle_z();
    energy[k] = report.energy_J;
  }
  assert_true(z[0] > 0 && z[1] < 0);
  assert_close(z[0], -z[1], 1e-6, 0);
  assert_close(energy[0], energy[1], 1e-8, 0);
  assert_true(energy[0] < flat);
  // w = (z/2)(1 - cos 2 pi x/L): a quarter of the square of pi z/L takes up the strain beyond
  // Euler's
  assert_close(z[0], sqrt(4 * 0.5 * euler) / acos(-1), 2e-2, 0);
  dea_free(ctx, keep);
  destroy();
}

/* As a user has it: a solve ends at a stable equilibrium and says that it left another. */
TEST(test_a_solve_leaves_what_is_unstable)
{
  const double euler = acos(-1) * acos(-1) / 3 * thickness * thickness / (length * length);
  create();
  compress(0.5 * euler);
  assert_false(report.snapped);
  compress(3 * euler);
  assert_true(report.snapped);
  assert_int_equal(report.unstable_modes, 0);
  assert_true(fabs(middle_z()) > 0.5 * thickness);
  destroy();
}

static const struct block plate = {{1, 1, 0.01}, {4, 4, 1}, 3, 2};

static int clamped_around(const void *self, const double X[3])
{
  bool inside = X[0] > 1e-9 && X[0] < 1 - 1e-9 && X[1] > 1e-9 && X[1] < 1 - 1e-9;
  return inside ? 0 : 7;
}

/* M of the modes: the volume of a node, its share of the elements around it, by w N^2 over their
 * Gauss points. Sums up to that of the plate. */
static double *node_volumes(int order_z)
{
  static struct dea_hex_shape shape;
  double *volume = calloc(grid->node_count, sizeof *volume), sum = 0;
  double element = 1;
  assert_non_null(volume);
  assert_int_equal(dea_hex_shape_create(grid->order, order_z, &shape), DEA_OK);
  for (int i = 0; i < 3; i++) {
    element *= plate.size[i] / (double)plate.count[i];
  }
  for (size_t e = 0; e < grid->element_count; e++) { // all alike, with right angles
    double share[DEA_HEX_NODES_MAX] = {0}, whole = 0;
    for (int n = 0; n < shape.nodes; n++) {
      for (int q = 0; q < shape.gauss; q++) {
        share[n] += shape.weight[q] * shape.value[q][n] * shape.value[q][n];
      }
      whole += share[n];
    }
    for (int n = 0; n < shape.nodes; n++) {
      double part = element * share[n] / whole;
      volume[grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n]] += part;
      sum += part;
    }
  }
  assert_close(sum, plate.size[0] * plate.size[1] * plate.size[2], 1e-12, 0);
  return volume;
}

/* Bending of a clamped square plate: lambda = (E h^2/12) (36.0/a^2)^2, and (73.4/a^2)^2 twice
 * (Leissa 1969, with Poisson's ratio 0 as with any): eigenvalues that come twice are both found. */
TEST(test_modes_of_a_square_plate)
{
  enum { COUNT = 4 };
  const double h = plate.size[2], D = 2 * mu * h * h / 12;
  const struct dea_part_material layer = dea_part_material_bonded(elastic);
  double value[COUNT];
  grid = block_grid(ctx, &plate);
  solid = block_solid(ctx, grid, plate.order_z, &layer, clamped_around);
  double *vector = dea_alloc(ctx, COUNT * 3 * grid->node_count, sizeof *vector);
  assert_non_null(vector);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
  assert_ok(dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_VOLUME, COUNT, value, vector));
  assert_close(value[0], D * 35.99 * 35.99, 3e-2, 0);
  assert_close(value[1], D * 73.41 * 73.41, 3e-2, 0);
  assert_close(value[2], value[1], 1e-7, 0);
  assert_close(value[3], D * 108.3 * 108.3, 4e-2, 0);
  double *volume = node_volumes(plate.order_z);
  for (size_t a = 0; a < COUNT; a++) { // v_a . M v_b = 1 for a = b, else 0
    for (size_t b = 0; b < COUNT; b++) {
      double product = 0;
      for (size_t i = 0; i < 3 * grid->node_count; i++) {
        product += volume[i / 3] * vector[3 * a * grid->node_count + i] *
                   vector[3 * b * grid->node_count + i];
      }
      assert_close(product, a == b, 0, 1e-7);
    }
  }
  free(volume);
  assert_int_equal(dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_VOLUME, 2, value, NULL), DEA_OK);
  assert_close(value[1], D * 73.41 * 73.41, 3e-2, 0);
  dea_free(ctx, vector);
  destroy();
}

TESTS(solid_set_up, solid_tear_down)

/* Vibrations of solids against closed forms. */
// ctest: solid
#include "devices.h"
#include "material/plane.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/motion/response.h"
#include "solid_block.h"

#include "solid_fixture.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;
enum { MODES = 5, ALL = 16 };

/* ---- a stretched film in a rectangular frame ---- */

static const double frame_x = 0.1, frame_y = 0.05, rho = 1000, h = 20e-6;

static int square_frame(const void *self, const double X[3])
{
  bool edge = X[0] < 1e-9 || X[0] > frame_y - 1e-9 || X[1] < 1e-9 || X[1] > frame_y - 1e-9;
  return edge ? 7 : 0;
}

static int all_around(const void *self, const double X[3])
{
  bool edge = X[0] < 1e-9 || X[0] > frame_x - 1e-9 || X[1] < 1e-9 || X[1] > frame_y - 1e-9;
  return edge ? 7 : 0;
}

/* True stress of a film at equal stretches. */
static double pre_stress(const struct dea_material *material, double l)
{
  struct dea_plane plane;
  assert_int_equal(dea_plane_elastic(material, l, l, &plane), DEA_OK);
  return l * plane.s1;
}

static struct dea_part_material film_layer(const struct dea_material *material, double l)
{
  struct dea_part_material layer = {.pre_stretch = {l, l, 1 / (l * l)},
                                    .kappa_Pa = 100 * material->law->shear_modulus(material->param),
                                    .thickness_m = h,
                                    .density_kg_per_m3 = rho};
  dea_part_material_set_law(&layer, material->law, material->param);
  assert_int_equal(dea_part_material_relax(&layer), DEA_OK);
  return layer;
}

/* Share of the motion, in mass, that is out of the plane. */
static double out_of_plane(const struct dea_solid *solid, size_t nodes, const double *vector)
{
  double share = 0, *v = calloc(3 * nodes, sizeof *v), *Mv = calloc(3 * nodes, sizeof *Mv);
  assert_true(v != NULL && Mv != NULL);
  for (size_t n = 0; n < nodes; n++) {
    v[3 * n + 2] = vector[3 * n + 2];
  }
  assert_int_equal(dea_solid_mass_apply(ctx, solid, v, Mv), DEA_OK);
  for (size_t i = 0; i < 3 * nodes; i++) {
    share += v[i] * Mv[i];
  }
  free(v);
  free(Mv);
  return share;
}

/* The MODES lowest that go out of the plane; in its own plane a stretched film is about as fast. */
static void modes_out_of_plane(struct dea_solid *solid, const struct dea_grid *grid,
                               double found[MODES])
{
  struct dea_solid_report report;
  double square[ALL], *vector = calloc(3 * ALL * grid->node_count, sizeof *vector);
  int count = 0;
  assert_non_null(vector);
  assert_ok(dea_load_steps_solve(ctx, solid, 0, &report));
  assert_ok(dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_MASS, ALL, square, vector));
  for (size_t k = 0; k < ALL && count < MODES; k++) {
    if (out_of_plane(solid, grid->node_count, vector + 3 * k * grid->node_count) > 0.5) {
      found[count++] = square[k];
    }
  }
  assert_int_equal(count, MODES);
  free(vector);
}

/* ---- what frequencies must not depend on, and what they must show ---- */

static void lowest(const struct dea_part_material *layer, const struct block *block, size_t count,
                   double *square)
{
  struct dea_grid *grid = block_grid(ctx, block);
  struct dea_solid *solid = block_solid(ctx, grid, block->order_z, layer, all_around);
  struct dea_solid_report report;
  assert_ok(dea_load_steps_solve(ctx, solid, 0, &report));
  assert_ok(dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_MASS, count, square, NULL));
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* The bulk modulus of the augmented Lagrangian is a means, not a material's. */
TEST(test_no_trace_of_kappa)
{
  const struct dea_material gent = test_material("gent", 43e3, 115, 0);
  const struct block thick = {{frame_x, frame_y, 4e-3}, {4, 3, 1}, 2, 2};
  struct dea_part_material layer = film_layer(&gent, 1.5);
  double soft[ALL], stiff[ALL];
  lowest(&layer, &thick, ALL, soft);
  layer.kappa_Pa *= 16;
  lowest(&layer, &thick, ALL, stiff);
  for (int k = 0; k < ALL; k++) {
    assert_close(soft[k], stiff[k], 1e-3, 0);
  }
}

static dea_status take_nothing(struct dea_context *own, void *user, size_t i, const double *real,
                               const double *imaginary)
{
  return DEA_OK;
}

/* A flat film under voltage has the tension sigma - eps E^2, and all its frequencies out of the
 * plane fall with the root of that; below 0 they are unstable, each of them. */
TEST(test_voltage_takes_tension_away)
{
  enum { OUT_OF_PLANE = 9, UNSTABLE_MAX = 27 }; // free nodes and their components
  const struct block film = {{frame_x, frame_y, 0}, {2, 2, 1}, 2, 1};
  struct dea_material gent = test_material("gent", 43e3, 115, 0);
  struct dea_part_material layer = film_layer(&gent, 2);
  layer.permittivity_F_per_m = 1e-11;
  struct dea_grid *grid = block_grid(ctx, &film);
  const struct dea_solid_options options = {.order_z = 1,
                                            .part_material_count = 1,
                                            .part_materials = &layer,
                                            .active = everywhere,
                                            .held = all_around};
  struct dea_solid *solid;
  struct dea_solid_report report;
  double rest[1], square[UNSTABLE_MAX], sigma = pre_stress(&gent, 2);
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  dea_solid_settings_of(solid)->accept_unstable = true;
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
  assert_int_equal(dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_MASS, 1, rest, NULL), DEA_OK);
  for (int i = 0; i < 2; i++) {
    double left = i == 0 ? 0.3 : -0.2,
           V = h * sqrt((1 - left) * sigma / layer.permittivity_F_per_m);
    assert_int_equal(dea_load_steps_solve(ctx, solid, V, &report), DEA_OK);
    int unstable = report.unstable_modes;
    assert_true(left > 0 ? unstable == 0 : unstable >= OUT_OF_PLANE && unstable < UNSTABLE_MAX);
    size_t count = left > 0 ? 1 : (size_t)unstable;
    assert_ok(dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_MASS, count, square, NULL));
    double nearest = INFINITY;
    for (size_t k = 0; k < count; k++) {
      assert_true(left > 0 || square[k] < 0);
      nearest = fmin(nearest, fabs(square[k] / (left * rest[0]) - 1));
    }
    assert_close(nearest, 0, 0, 1e-8); // K has 1e-10 of a spring (membrane.md)
    const struct dea_branches branches = {1, {{30e3, 0.1}}};
    const struct dea_damping none = {0};
    const double w = sqrt(rest[0]);
    assert_int_equal( // no excitation about what does not stand
        dea_solid_respond_viscous(ctx, solid, &branches, &none, &w, 1, take_nothing, NULL),
        left > 0 ? DEA_OK : DEA_E_NOT_CONVERGED);
  }
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* In a square the modes (1, 2) and (2, 1) are as fast; none of them may be left out. */
TEST(test_modes_that_come_twice)
{
  const struct dea_material gent = test_material("gent", 43e3, 115, 0);
  const struct dea_part_material layer = film_layer(&gent, 4);
  const struct block film = {{frame_y, frame_y, 0}, {6, 6, 1}, 3, 1};
  double square[MODES];
  struct dea_grid *grid = block_grid(ctx, &film);
  struct dea_solid *solid = block_solid(ctx, grid, 1, &layer, square_frame);
  modes_out_of_plane(solid, grid, square);
  static const double sums[MODES] = {2, 5, 5, 8, 10}; // m^2 + n^2
  double first = pre_stress(&gent, 4) / rho * pi * pi / (frame_y * frame_y);
  for (int k = 0; k < MODES; k++) {
    assert_close(square[k], first * sums[k], 1e-3, 0);
  }
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

TESTS(solid_set_up, solid_tear_down)

/* Solids by PETSc: the plain disc against the exact one, false unstable modes, the actuator as
 * built, bending. */
// ctest: solid
#include "devices.h"
#include "failing_allocator.h"
#include "model/model.h"
#include "model/solid/assembly/solid.h"
#include "model/solid/equilibrium/load_steps.h"
#include "prototypes.h"
#include "quarter_grid.h"
#include "solid_block.h"
#include "solid_node.h"
#include "testing.h"
#include "yeoh_part.h"

#include "solid_fixture.h" // after: its context shadows no name of the headers above

/* ---- plain disc ---- */

static const double a_m = 3.75e-3, b_m = 15e-3;

struct disc {
  struct dea_grid *grid;
  struct dea_solid *solid;
  size_t edge; // node on the electrode edge, y = 0, in the middle of the thickness
};

/* Disc of film of unstretched thickness H0; mesh as in dea_grid_quarter. */
static struct disc disc_create(double H0, double pre_stretch, int order_z, size_t fine,
                               double edge_m)
{
  double h = H0 / (pre_stretch * pre_stretch);
  struct dea_part_material film = yeoh_part(pre_stretch, 2.8 * DEA_EPSILON_0, h);
  struct disc disc = {0};
  const struct dea_quarter quarter = {2, order_z, a_m, b_m, h, .fine = fine, .edge = edge_m};
  assert_int_equal(dea_grid_quarter(ctx, &quarter, &disc.grid), DEA_OK);
  const struct dea_solid_options options = {.order_z = order_z,
                                            .part_material_count = 1,
                                            .part_materials = &film,
                                            .active = first_region,
                                            .held = quarter_held};
  assert_int_equal(dea_solid_create(ctx, disc.grid, &options, &disc.solid), DEA_OK);
  for (size_t n = 0; n < disc.grid->node_count; n++) {
    const double *X = disc.grid->X + 3 * n;
    if (fabs(X[0] - a_m) < 1e-9 && fabs(X[1]) < 1e-9 && fabs(X[2]) < 0.1 * h) {
      disc.edge = n;
    }
  }
  return disc;
}

static void disc_destroy(struct disc *disc)
{
  dea_solid_destroy(ctx, disc->solid);
  dea_grid_destroy(ctx, disc->grid);
}

/* Strain of the electrode at a voltage; asserts that the state is stable. */
static double disc_strain(struct disc *disc, double voltage_V)
{
  struct dea_solid_report report;
  assert_int_equal(dea_load_steps_solve(ctx, disc->solid, voltage_V, &report), DEA_OK);
  assert_int_equal(report.unstable_modes, 0);
  assert_true(report.residual < 1e-8 && report.theta_max < 1e-6);
  return dea_solid_displacement(disc->solid)[3 * disc->edge] / a_m;
}

static double exact_strain(double voltage_V)
{
  const struct dea_model_type *type = dea_model_find("axisymmetric");
  struct dea_device device = test_disc(test_yeoh(), 1.5, a_m, 0.25, 0);
  struct dea_model *model;
  struct dea_load_point point;
  assert_int_equal(type->create(ctx, &device, NULL, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, voltage_V, &point), DEA_OK);
  type->destroy(ctx, model);
  return point.electrode_stretch - 1;
}

/* With the factor of the last equilibrium a step takes one factorisation, and comes to the state
 * that tangents of its own find. */
TEST(test_steps_with_one_factor)
{
  struct disc follows = disc_create(100e-6, 1.5, 2, 4, 2e-4);
  struct disc alone = disc_create(100e-6, 1.5, 2, 4, 2e-4);
  struct dea_solid_report one, many;
  size_t count = 3 * follows.grid->node_count;
  dea_solid_settings_of(alone.solid)->anderson_step_min = 2; // never
  for (int step = 0; step <= 8; step++) {
    double V = 500 * step, apart = 0, most = 0;
    assert_int_equal(dea_load_steps_solve(ctx, follows.solid, V, &one), DEA_OK);
    assert_int_equal(dea_load_steps_solve(ctx, alone.solid, V, &many), DEA_OK);
    const double *u = dea_solid_displacement(follows.solid);
    const double *w = dea_solid_displacement(alone.solid);
    for (size_t i = 0; i < count; i++) {
      apart = fmax(apart, fabs(u[i] - w[i]));
      most = fmax(most, fabs(w[i]));
    }
    assert_true(apart <= 1e-8 * most + 1e-18);
    assert_true(one.residual < 1e-9 && one.theta_max < 1e-7);
    assert_int_equal(one.unstable_modes, 0);
    assert_true(step == 0 || (one.factorisations == 1 && many.factorisations > 1));
  }
  disc_destroy(&follows);
  disc_destroy(&alone);
}

/* 0 to 11 kV in steps of 1 kV without help, no unstable mode on the way, within 0.4 % of the disc
 * without thickness. Elements of 0.2 mm at the electrode edge. */
TEST(test_plain_disc_to_11_kV)
{
  struct disc disc = disc_create(100e-6, 1.5, 2, 4, 2e-4);
  assert_close(disc_strain(&disc, 0), 0, 0, 1e-10);
  for (int kV = 1; kV <= 11; kV++) {
    assert_close(disc_strain(&disc, 1e3 * kV), exact_strain(1e3 * kV), 4e-3, 0);
  }
  disc_destroy(&disc);
}

/* What is left of the difference is the thickness of the film: at the same field and with elements
 * that shrink along, it falls about in proportion. */
TEST(test_difference_goes_with_the_thickness)
{
  static const double H0[] = {100e-6, 50e-6, 25e-6};
  double difference[3];
  for (int i = 0; i < 3; i++) {
    struct disc disc = disc_create(H0[i], 1.5, 2, 6, 0.5 * H0[i]);
    disc_strain(&disc, 0);
    double V = 2e3 * H0[i] / 100e-6;
    difference[i] = fabs(disc_strain(&disc, V) / exact_strain(2e3) - 1);
    disc_destroy(&disc);
  }
  assert_true(difference[0] < 3e-3);
  assert_true(difference[1] < 0.7 * difference[0]);
  assert_true(difference[2] < 0.7 * difference[1]);
}

/* Flat films at zero voltage are stable, whatever pre-stretch, mesh and order through the
 * thickness. */
TEST(test_no_false_modes_at_rest)
{
  static const double pre_stretch[] = {1.0, 1.1, 1.5, 2.0};
  for (size_t i = 0; i < 4; i++) {
    for (int order_z = 1; order_z <= 2; order_z++) {
      for (size_t fine = 1; fine <= 5; fine += 2) {
        struct disc disc = disc_create(100e-6, pre_stretch[i], order_z, fine, 0);
        disc_strain(&disc, 0);
        disc_destroy(&disc);
      }
    }
  }
}

/* ---- the paper's actuator with four fibres, as built ---- */

/* Pre-stretch 1.5, 100 um, PET fibres 2 mm x 100 um clamped at the frame, tip at the electrode
 * edge, against the programs of prototypes.h. */
TEST(test_four_fibres_as_built)
{
  static const double plastic[] = {2950e6, 0.38};
  const double h = 100e-6 / 2.25;
  struct dea_part_material layers[] = {yeoh_part(1.5, 2.8 * DEA_EPSILON_0, h),
                                       dea_part_material_bonded(plastic)};
  const struct dea_quarter quarter = {2,    2,      a_m,       b_m,         h,           4,
                                      2e-3, 100e-6, .fine = 3, .across = 2, .edge = 2e-4};
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 2,
                                            .part_materials = layers,
                                            .part_material_of = layer_of_ply,
                                            .active = quarter_active,
                                            .held = quarter_held};
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_report report;
  assert_int_equal(dea_grid_quarter(ctx, &quarter, &grid), DEA_OK);
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  size_t tip = node_near(grid, a_m, 0, 0.5 * h), centre = node_near(grid, 0, 0, 0);
  size_t between = node_near(grid, a_m * sqrt(0.5), a_m * sqrt(0.5), 0);
  const double *u = dea_solid_displacement(solid);
  for (int kV = 0; kV <= 6; kV++) {
    assert_int_equal(dea_load_steps_solve(ctx, solid, 1e3 * kV, &report), DEA_OK);
    assert_int_equal(report.unstable_modes, 0);
    if (kV == 5) {
      assert_between(hypot(u[3 * between], u[3 * between + 1]), prototype_edge_5kV_m, 5e-3);
    }
  }
  assert_between(u[3 * tip + 2], prototype_solid_tip_6kV_m, 2e-2);
  assert_between(u[3 * centre + 2], prototype_solid_centre_6kV_m, 1e-2);
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* ---- cantilever, Sze, Liu and Lo 2004 (benchmark 8) ---- */

static void map_strip(const void *self, double s, double t, double x[2])
{
  x[0] = 10 * s;
  x[1] = t;
}

static int clamp(const void *self, const double X[3])
{
  return X[0] < 1e-9 ? 1 | 2 | 4 : 0;
}

TEST(test_cantilever_under_end_shear)
{
  static const double cuts[] = {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1}, one[] = {0, 1};
  static const double part[] = {0.2, 0.5, 1.0}, wanted[] = {2.493, 4.933, 6.698};
  const struct dea_block block = {map_strip, NULL, cuts, one, 10, 1, 0};
  const struct dea_ply ply = {0.1, 1, 2};
  const struct dea_part_material steel = dea_part_material_bonded((const double[]){1.2e6, 0});
  const struct dea_solid_options options = {
      .order_z = 2, .part_material_count = 1, .part_materials = &steel, .held = clamp};
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_report report;
  assert_int_equal(dea_grid_create(ctx, 3, &block, 1, &ply, 1, NULL, -0.05, 10, &grid), DEA_OK);
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  size_t tip = 0, loaded = 0;
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    if (X[0] > 10 - 1e-9 && fabs(X[2]) < 1e-9) { // the middle line of the end
      loaded++;
      tip = n;
    }
  }
  for (double done = 0; done < 1 - 1e-9; done += 0.1) {
    for (size_t n = 0; n < grid->node_count; n++) {
      const double *X = grid->X + 3 * n;
      if (X[0] > 10 - 1e-9 && fabs(X[2]) < 1e-9) {
        dea_solid_force(solid)[3 * n + 2] = 4 * (done + 0.1) / (double)loaded;
      }
    }
    assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
    for (int k = 0; k < 3; k++) {
      if (fabs(done + 0.1 - part[k]) < 1e-9) {
        assert_close(dea_solid_displacement(solid)[3 * tip + 2], wanted[k], 1e-2, 0);
      }
    }
  }
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* What is ours; PETSc has its own memory. */
static struct dea_grid *small_grid;

static void make_solid(struct dea_context *failing)
{
  const struct dea_part_material steel = dea_part_material_bonded((const double[]){1.2e6, 0});
  const struct dea_solid_options options = {
      .order_z = 2, .part_material_count = 1, .part_materials = &steel, .held = quarter_held};
  struct dea_solid *solid = NULL;
  struct dea_solid_report report;
  dea_status status = dea_solid_create(failing, small_grid, &options, &solid);
  if (status == DEA_OK) {
    status = dea_load_steps_solve(failing, solid, 0, &report);
  }
  failing_check(failing, status);
  dea_solid_destroy(failing, solid);
}

TEST(test_each_allocation_of_a_solid)
{
  const struct dea_quarter quarter = {2, 2, a_m, b_m, 1e-4, .fine = 1};
  assert_int_equal(dea_grid_quarter(ctx, &quarter, &small_grid), DEA_OK);
  assert_true(failing_each(make_solid) > 15);
  dea_grid_destroy(ctx, small_grid);
}

TESTS(solid_set_up, solid_tear_down)

/* Membrane film by PETSc: the exact disc, false unstable modes, films without stiffness. */
// ctest: solid
#include "devices.h"
#include "model/model.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/assembly/solid.h"
#include "model/solid/element/membrane.h"
#include "model/solid/equilibrium/load_steps.h"
#include "quarter_grid.h"
#include "testing.h"

#include "solid_fixture.h" // after: its context shadows no name of the headers above

static const double a_m = 3.75e-3, b_m = 15e-3;

enum { FILM, BOND, FIBRE };

static int layer_of(const void *self, int region, int ply)
{
  static const int layers[] = {
      [DEA_PLY_SURFACE] = FILM, [DEA_PLY_BOND] = BOND, [DEA_PLY_FIBRE_ON_BOND] = FIBRE};
  return layers[ply];
}

static bool active(const void *self, int region, int ply)
{
  return region == DEA_REGION_ELECTRODE && ply == DEA_PLY_SURFACE;
}

struct actuator {
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_report report;
};

/* Film of 100 um unstretched. */
static struct actuator actuator_create(const struct dea_quarter *mesh, double pre_stretch,
                                       bool relaxed)
{
  static const double plastic[] = {2950e6, 0.38};
  const double area = pre_stretch * pre_stretch;
  struct dea_part_material layers[3] = {{.law = dea_law_find("yeoh"),
                                         .param = {178.4e3, -6e3, 4.2e3},
                                         .pre_stretch = {pre_stretch, pre_stretch, 1 / area},
                                         .kappa_Pa = 4e7,
                                         .permittivity_F_per_m = 2.8 * DEA_EPSILON_0,
                                         .thickness_m = 100e-6 / area,
                                         .relaxed = relaxed},
                                        {0},
                                        dea_part_material_bonded(plastic)};
  struct actuator it = {0};
  struct dea_quarter quarter = *mesh;
  quarter.film_thickness = layers[FILM].thickness_m;
  quarter.membrane = true;
  assert_int_equal(dea_part_material_relax(&layers[FILM]), DEA_OK);
  assert_int_equal(dea_membrane_bond(&layers[FILM], &layers[BOND]), DEA_OK);
  assert_int_equal(dea_grid_quarter(ctx, &quarter, &it.grid), DEA_OK);
  const struct dea_solid_options options = {.order_z = quarter.order_z,
                                            .part_material_count = 3,
                                            .part_materials = layers,
                                            .part_material_of = layer_of,
                                            .active = active,
                                            .held = quarter_held};
  assert_int_equal(dea_solid_create(ctx, it.grid, &options, &it.solid), DEA_OK);
  return it;
}

static void actuator_destroy(struct actuator *it)
{
  dea_solid_destroy(ctx, it->solid);
  dea_grid_destroy(ctx, it->grid);
}

/* Solves; asserts that the state is stable. */
static void solve(struct actuator *it, double voltage_V)
{
  assert_int_equal(dea_load_steps_solve(ctx, it->solid, voltage_V, &it->report), DEA_OK);
  assert_int_equal(it->report.unstable_modes, 0);
  assert_true(it->report.residual < 1e-8 && it->report.theta_max < 1e-6);
}

static const double *displacement_at(const struct actuator *it, double x, double y, double z)
{
  for (size_t n = 0; n < it->grid->node_count; n++) {
    const double *X = it->grid->X + 3 * n;
    if (fabs(X[0] - x) + fabs(X[1] - y) + fabs(X[2] - z) < 1e-9) {
      return dea_solid_displacement(it->solid) + 3 * n;
    }
  }
  fail_msg("no node at %g %g %g", x, y, z);
  return NULL;
}

static struct dea_load_point exact(double voltage_V)
{
  const struct dea_model_type *type = dea_model_find("axisymmetric");
  struct dea_device device = test_disc(test_yeoh(), 1.5, a_m, 0.25, 0);
  struct dea_model *model;
  struct dea_load_point point;
  assert_int_equal(type->create(ctx, &device, NULL, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, voltage_V, &point), DEA_OK);
  type->destroy(ctx, model);
  return point;
}

/* 0 to 11 kV without an unstable mode: the same surface energy as `axisymmetric`, so only the mesh
 * is between them. */
static void check_disc(const struct dea_quarter *mesh, double tolerance)
{
  const struct dea_material material = test_yeoh();
  struct actuator disc = actuator_create(mesh, 1.5, false);
  solve(&disc, 0);
  for (int kV = 1; kV <= 11; kV++) {
    struct dea_load_point wanted = exact(1e3 * kV);
    struct dea_solid_extremes extremes;
    solve(&disc, 1e3 * kV);
    double strain = displacement_at(&disc, a_m, 0, 0)[0] / a_m;
    assert_close(strain, wanted.electrode_stretch - 1, tolerance, 0);
    const struct dea_solid_film_data films[3] = {
        {&material, 1.5}, {&material, 1.5}, {&material, 1.5}};
    assert_int_equal(dea_solid_extremes(disc.solid, films, &extremes), DEA_OK);
    assert_close(extremes.true_field_V_per_m, wanted.true_field_V_per_m, tolerance, 0);
    assert_close(extremes.breakdown_margin, wanted.breakdown_margin, 10 * tolerance, tolerance);
    assert_close(extremes.min_tension_N_per_m, wanted.min_tension_N_per_m, 0, 10 * tolerance * 35);
  }
  actuator_destroy(&disc);
}

TEST(test_plain_disc_to_11_kV)
{
  check_disc(&(struct dea_quarter){2, 1, a_m, b_m, .fine = 2}, 3e-4);
  check_disc(&(struct dea_quarter){2, 1, a_m, b_m, .fine = 4, .edge = 2e-4}, 3e-5);
  check_disc(&(struct dea_quarter){3, 1, a_m, b_m, .fine = 2}, 3e-5);
}

/* Flat films at zero voltage have no unstable mode. Without pre-stretch nothing holds a film out of
 * its plane; that is no instability either. */
TEST(test_no_false_modes_at_rest)
{
  static const double pre_stretch[] = {1.0, 1.1, 1.3, 1.5, 1.7, 2.0};
  for (size_t i = 0; i < 6; i++) {
    for (size_t fine = 1; fine <= 5; fine += 2) {
      for (int order = 1; order <= 3; order++) {
        struct actuator disc = actuator_create(
            &(struct dea_quarter){order, 1, a_m, b_m, .fine = fine}, pre_stretch[i], i % 2 == 1);
        solve(&disc, 0);
        assert_close(dea_solid_displacement(disc.solid)[0], 0, 0, 1e-12);
        actuator_destroy(&disc);
      }
    }
  }
}

/* A film without pre-stretch under a voltage: in compression as it is, with as many unstable modes
 * as the mesh can show; without any when it may wrinkle. It is slack then and does not move. */
TEST(test_slack_film)
{
  struct actuator stiff =
      actuator_create(&(struct dea_quarter){2, 1, a_m, b_m, .fine = 2}, 1, false);
  struct actuator slack =
      actuator_create(&(struct dea_quarter){2, 1, a_m, b_m, .fine = 2}, 1, true);
  const struct dea_material material = test_yeoh();
  struct dea_solid_extremes extremes;
  dea_solid_settings_of(stiff.solid)->accept_unstable = true; // else it goes on to a buckled state
  assert_int_equal(dea_load_steps_solve(ctx, stiff.solid, 0, &stiff.report), DEA_OK);
  assert_int_equal(dea_load_steps_solve(ctx, stiff.solid, 1e3, &stiff.report), DEA_OK);
  assert_true(stiff.report.unstable_modes > 10);
  for (int kV = 0; kV <= 4; kV += 2) {
    solve(&slack, 1e3 * kV);
  }
  const struct dea_solid_film_data film = {&material, 1};
  assert_int_equal(dea_solid_extremes(slack.solid, &film, &extremes), DEA_OK);
  assert_close(extremes.min_tension_N_per_m, 0, 0, 1e-9);
  assert_true(extremes.true_field_V_per_m > 4e3 / 100e-6 * 1.02); // it thins all the same
  actuator_destroy(&stiff);
  actuator_destroy(&slack);
}

TESTS(solid_set_up, solid_tear_down)

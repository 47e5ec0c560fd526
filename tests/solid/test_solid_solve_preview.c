/* Model 3d with a membrane film: the exact disc, the actuator as built, rest, and beside the solid
 * film with fibres of all kinds. */
// ctest: solid
#include "devices.h"
#include "model/model.h"
#include "model/solid/assembly/solid.h"
#include "prototypes.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

extern const struct dea_model_type dea_solid_module;
static const struct dea_model_type *const solid = &dea_solid_module;

static const struct dea_model_settings preview = {.film = DEA_FILM_MEMBRANE};

static struct dea_model *create(const struct dea_device *device,
                                const struct dea_model_settings *settings)
{
  struct dea_model *model;
  assert_ok(solid->create(ctx, device, settings, &model));
  return model;
}

static struct dea_load_point solve(struct dea_model *model, double voltage_V)
{
  struct dea_load_point point;
  assert_ok(solid->solve(ctx, model, voltage_V, &point));
  assert_int_equal(point.unstable_modes, 0);
  assert_true(point.stable);
  return point;
}

static struct dea_load_point solve_once(const struct dea_device *device,
                                        const struct dea_model_settings *settings, double voltage_V)
{
  struct dea_model *model = create(device, settings);
  struct dea_load_point point = solve(model, voltage_V);
  solid->destroy(ctx, model);
  return point;
}

/* 0 to 11 kV: between the two is the mesh, and the disc inside the electrode is stretched alike
 * everywhere: the capacitance goes as the square of its area. */
TEST(test_plain_disc)
{
  const struct dea_model_type *exact = dea_model_find("axisymmetric");
  struct dea_device device = test_star(0);
  struct dea_model *model = create(&device, &preview), *reference;
  double rest_F = solve(model, 0).capacitance_F;
  assert_int_equal(exact->create(ctx, &device, NULL, &reference), DEA_OK);
  for (int kV = 1; kV <= 11; kV++) {
    struct dea_load_point wanted, point = solve(model, 1e3 * kV);
    double area = point.electrode_stretch * point.electrode_stretch;
    assert_int_equal(exact->solve(ctx, reference, 1e3 * kV, &wanted), DEA_OK);
    assert_close(point.electrode_stretch - 1, wanted.electrode_stretch - 1, 1e-3, 0);
    assert_close(point.true_field_V_per_m, wanted.true_field_V_per_m, 1e-3, 0);
    assert_close(point.energy_J, wanted.energy_J, 1e-3, 0);
    assert_close(point.min_tension_N_per_m, wanted.min_tension_N_per_m, 1e-2, 0.02);
    assert_close(point.capacitance_F, wanted.capacitance_F, 1e-3, 0);
    assert_close(point.capacitance_F, rest_F * area * area, 1e-3, 0);
    assert_close(point.centre_z_m, 0, 0, 1e-9);
  }
  exact->destroy(ctx, reference);
  solid->destroy(ctx, model);
}

/* 0 to 8 kV in steps of 1 kV. Against the membrane of prototypes.h. Above, the film wrinkles: it
 * has no tension then in one direction, and no less. */
TEST(test_four_fibres_as_built)
{
  struct dea_device device = test_star(4);
  struct dea_model *model = create(&device, &preview);
  struct dea_load_point before = solve(model, 0);
  assert_close(before.fibre_tip_z_m, 0, 0, 1e-12);
  assert_close(before.min_tension_N_per_m, 797.745e3 * 100e-6 / 2.25, 1e-5, 0);
  for (int kV = 1; kV <= 8; kV++) {
    struct dea_load_point point = solve(model, 1e3 * kV);
    assert_true(point.fibre_tip_z_m < before.fibre_tip_z_m);
    assert_true(point.electrode_edge_u_m > before.electrode_edge_u_m);
    if (kV == 6) {
      assert_close(point.fibre_tip_z_m, prototype_membrane_tip_6kV_m, 4e-2, 0);
      assert_close(point.centre_z_m, prototype_membrane_centre_6kV_m, 4e-2, 0);
      assert_true(point.min_tension_N_per_m > 4);
    }
    if (kV > 6) {
      assert_close(point.min_tension_N_per_m, 0, 0, 1e-9);
    }
    before = point;
  }
  assert_between(before.fibre_tip_z_m, prototype_tip_8kV_m, 0.15);
  solid->destroy(ctx, model);

  const struct dea_model_settings fine = {.film = DEA_FILM_MEMBRANE, .refinement = 2};
  struct dea_load_point finer = solve_once(&device, &fine, 6e3);
  assert_close(finer.fibre_tip_z_m, prototype_membrane_tip_6kV_m, 3e-2, 0);
  assert_close(finer.centre_z_m, prototype_membrane_centre_6kV_m, 3e-2, 0);
}

/* Also stress-free, where nothing holds the film out of its plane. The capacitance is eps A/h, A
 * the area of the mesh. */
TEST(test_rest)
{
  static const int fibres[] = {0, 1, 4};
  static const double pre_stretch[] = {1, 1.5, 2};
  for (size_t i = 0; i < 9; i++) {
    double l = pre_stretch[i % 3], h = 100e-6 / (l * l), a = 3.75e-3;
    struct dea_device device = test_star(fibres[i / 3]);
    device.pre_stretch = l;
    device.film_thickness_m = h;
    const struct dea_model_settings settings = {.film = DEA_FILM_MEMBRANE,
                                                .refinement = i % 2 == 0 ? 1 : 2};
    struct dea_load_point point = solve_once(&device, &settings, 0);
    assert_close(point.electrode_edge_u_m, 0, 0, 1e-12);
    assert_close(point.centre_z_m, 0, 0, 1e-12);
    assert_int_equal(dea_finding_count(ctx, DEA_WARNING), l == 1);
    dea_finding_clear(ctx);
    assert_close(point.capacitance_F, 2.8 * DEA_EPSILON_0 * acos(-1) * a * a / h, 2e-4, 0);
  }
}

/* ---- beside the solid film ---- */

/* A preview: z within 20 %. The film slips some 20 um further along each fibre (theory), which
 * counts the more the less film is between fibres: 3 % of the electrode's growth with four, 9 %
 * with six, and twice that of the capacitance's. Electrodes of a thickness move the film at rest,
 * which all is counted from. */
static void check_beside_solid(const struct dea_device *device, double of_edge)
{
  double tip[2], edge[2], capacitance[2];
  for (int film = 0; film < 2; film++) {
    const struct dea_model_settings settings = {.film =
                                                    film == 0 ? DEA_FILM_SOLID : DEA_FILM_MEMBRANE};
    struct dea_model *model = create(device, &settings);
    struct dea_load_point rest = solve(model, 0), point = solve(model, 2e3);
    tip[film] = point.fibre_tip_z_m - rest.fibre_tip_z_m;
    edge[film] = point.electrode_edge_u_m - rest.electrode_edge_u_m;
    capacitance[film] = point.capacitance_F / rest.capacitance_F;
    solid->destroy(ctx, model);
  }
  assert_close(tip[1], tip[0], 0.2, 0);
  assert_close(edge[1], edge[0], of_edge, 0);
  assert_close(capacitance[1] - 1, capacitance[0] - 1, 2.2 * of_edge, 0);
}

/* What lies between film and fibre. */
TEST(test_layers)
{
  struct dea_device device = test_star(4);
  device.bond_thickness_m = 50e-6;
  device.bond_modulus_Pa = 1e6;
  check_beside_solid(&device, 0.05);

  device = test_star(4);
  device.fibre_tip_radius_m -= 0.75e-3;
  check_beside_solid(&device, 0.05);

  device.electrode = test_material("neo-hookean", 400e3, 0, 0);
  device.electrode_thickness_m = 5e-6;
  check_beside_solid(&device, 0.05);

  device.fibre_tip_radius_m = device.electrode_radius_m;
  check_beside_solid(&device, 0.05);
}

/* Forces of a probe from both sides. */
TEST(test_probe)
{
  double force[2][2];
  for (int film = 0; film < 2; film++) {
    for (int side = 0; side < 2; side++) {
      const struct dea_probe probe = {
          .shape = DEA_PROBE_SPHERE, .radius_m = 1.5e-3, .from_fibre_side = side == 1};
      struct dea_device device = test_star(0);
      struct dea_load_point point;
      const struct dea_model_settings settings = {.film = film == 0 ? DEA_FILM_SOLID
                                                                    : DEA_FILM_MEMBRANE};
      struct dea_model *model = create(&device, &settings);
      assert_int_equal(solid->indent(ctx, model, &probe, 20e-6, &point), DEA_OK);
      force[film][side] = point.force_N;
      solid->destroy(ctx, model);
    }
  }
  assert_true(force[0][0] > 1e-4);
  assert_close(force[1][0], force[0][0], 0.05, 0);
  assert_close(force[1][1], force[0][1], 0.05, 0);
}

static int tear_down(void **state)
{
  dea_solid_stop();
  return context_tear_down(state);
}

TESTS(context_set_up, tear_down)

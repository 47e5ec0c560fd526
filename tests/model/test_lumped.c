/* Model lumped: benchmark 3, derivatives, force, random designs. */
#include "context_fixture.h"
#include "devices.h"
#include "first_root.h"
#include "model/model.h"
#include "testing.h"

static struct dea_model *make(const struct dea_device *device)
{
  struct dea_model *model;
  assert_int_equal(dea_model_find("lumped")->create(ctx, device, NULL, &model), DEA_OK);
  return model;
}

static struct dea_load_point solve(struct dea_model *model, double voltage_V)
{
  struct dea_load_point p;
  assert_int_equal(dea_model_find("lumped")->solve(ctx, model, voltage_V, &p), DEA_OK);
  return p;
}

TEST(test_benchmark_3)
{
  static const double stretch[] = {1.00440, 1.01792, 1.04145, 1.07611,
                                   1.12265, 1.18059, 1.24809, 1.32266};
  struct dea_device device = test_disc(test_yeoh(), 1.5, 5e-3, 0.2, 4);
  struct dea_model *model = make(&device);
  for (int kV = 1; kV <= 8; kV++) {
    struct dea_load_point p = solve(model, 1e3 * kV);
    assert_close(p.electrode_stretch, stretch[kV - 1], 0, 5e-6);
    assert_close(0.2 * p.electrode_stretch + 0.8 * p.passive_stretch, 1, 1e-14, 0); // eq 17
    assert_close(p.electrode_edge_u_m, 5e-3 * (p.electrode_stretch - 1), 1e-14, 0);
    assert_close(p.true_field_V_per_m, 1e3 * kV / 100e-6 * 2.25 * pow(p.electrode_stretch, 2),
                 1e-12, 0);
    assert_close(p.breakdown_margin, 1 - p.true_field_V_per_m / 80e6, 1e-12, 0);
    assert_true(p.stable);
  }
  assert_close(1e3 * solve(model, 1e3).fibre_tip_z_m, 0.66, 0, 5e-3);
  assert_close(1e3 * solve(model, 4e3).fibre_tip_z_m, 2.73, 0, 5e-3);
  assert_close(1e3 * solve(model, 6e3).fibre_tip_z_m, 4.15, 0, 5e-3);
  dea_model_find("lumped")->destroy(ctx, model);
}

/* Weibull at the smallest margin, which is 63.2 % at the breakdown field; nothing without a shape.
 */
TEST(test_probability_of_breakdown)
{
  static const char *const names[] = {"lumped", "axisymmetric"};
  for (size_t i = 0; i < 2; i++) {
    const struct dea_model_type *type = dea_model_find(names[i]);
    for (int shape = 0; shape <= 8; shape += 8) {
      struct dea_device device = test_disc(test_yeoh(), 1.5, 5e-3, 0.2, 0);
      struct dea_model *model;
      struct dea_load_point p;
      device.film.breakdown.law = (struct dea_breakdown_law){
          .at_rest_V_per_m = 80e6, .shape = shape, .area_m2 = 1e-4, .electrode_factor = 1};
      dea_device_fit_breakdown(&device);
      double area_m2 = 3.14159265358979 * 25e-6 / 2.25; // unstretched
      double strength = shape > 0 ? 80e6 * pow(1e-4 / area_m2, 1.0 / shape) : 80e6;
      assert_int_equal(type->create(ctx, &device, NULL, &model), DEA_OK);
      assert_int_equal(type->solve(ctx, model, 3e3, &p), DEA_OK);
      assert_close(p.breakdown_margin, 1 - p.true_field_V_per_m / strength, 1e-9, 0);
      if (shape > 0) {
        double survives = exp(-pow(p.true_field_V_per_m / 80e6, shape) * area_m2 / 1e-4);
        assert_close(1 - p.breakdown_probability, survives, 1e-9, 0);
      } else {
        assert_true(isnan(p.breakdown_probability));
      }
      type->destroy(ctx, model);
    }
  }
}

/* At rest the film is taut with the pre-stretch's own tension, and nothing has moved. */
TEST(test_rest_state)
{
  struct dea_device device = test_disc(test_yeoh(), 1.5, 5e-3, 0.2, 4);
  struct dea_model *model = make(&device);
  struct dea_load_point p = solve(model, 0);
  assert_close(p.electrode_stretch, 1, 0, 1e-13);
  assert_close(p.fibre_tip_z_m, 0, 0, 1e-8);
  assert_close(p.energy_J, 0, 0, 1e-18);
  assert_close(p.min_tension_N_per_m, 797.745e3 * 100e-6 / 2.25, 1e-5, 0); // benchmark 1
  double eps = 2.8 * DEA_EPSILON_0, pi = acos(-1);
  assert_close(p.capacitance_F, eps * pi * 25e-6 / (100e-6 / 2.25), 1e-12, 0);
  dea_model_find("lumped")->destroy(ctx, model);
}

static struct dea_lumped sample(const struct dea_material *m, double permittivity_slope,
                                struct dea_material *copy)
{
  *copy = *m;
  copy->permittivity.slope = permittivity_slope;
  struct dea_lumped lumped = {.film = {.material = copy, .thickness_m = 100e-6},
                              .pre_stretch = 1.4,
                              .coverage = 0.3,
                              .electrode_radius_m = 4e-3};
  return lumped;
}

/* Slopes against central differences of what they are slopes of, energy included. */
TEST(test_balance_derivatives)
{
  const struct dea_material m = test_yeoh();
  const double slopes[] = {0, -0.28};
  for (size_t k = 0; k < 2; k++) {
    struct dea_material copy;
    struct dea_lumped lumped = sample(&m, slopes[k], &copy);
    double l = 1.12, field = 4e7, d = 1e-5;
    struct dea_lumped_balance at, up, down;
    assert_int_equal(dea_lumped_balance_eval(&lumped, l, field, &at), DEA_OK);
    assert_int_equal(dea_lumped_balance_eval(&lumped, l + d, field, &up), DEA_OK);
    assert_int_equal(dea_lumped_balance_eval(&lumped, l - d, field, &down), DEA_OK);
    assert_close(at.slope_Pa, (up.imbalance_Pa - down.imbalance_Pa) / (2 * d), 1e-8, 0);
    assert_close(2 * lumped.pre_stretch * at.imbalance_Pa,
                 (up.energy_Pa - down.energy_Pa) / (2 * d), 1e-7, 0);
    assert_int_equal(dea_lumped_balance_eval(&lumped, l, field * (1 + d), &up), DEA_OK);
    assert_int_equal(dea_lumped_balance_eval(&lumped, l, field * (1 - d), &down), DEA_OK);
    assert_close(at.slope_field_Pa_m_per_V, (up.imbalance_Pa - down.imbalance_Pa) / (2 * d * field),
                 1e-8, 0);
  }
}

/* Energy of the active disc and what stretches with it, at height z of the tip. */
static double energy_at(const struct dea_lumped *lumped, const struct dea_lift *lift, double field,
                        double z)
{
  double L = lift->fibre_length_m, l = 1 + (L - sqrt(L * L - z * z)) / lift->tip_per_stretch_m;
  struct dea_lumped_balance at;
  assert_int_equal(dea_lumped_balance_eval(lumped, l, field, &at), DEA_OK);
  double r = lumped->electrode_radius_m, l_pre = lumped->pre_stretch;
  return at.energy_Pa * acos(-1) * r * r * lumped->film.thickness_m / (l_pre * l_pre);
}

TEST(test_force_is_minus_the_slope_of_the_energy)
{
  const struct dea_material m = test_yeoh();
  struct dea_material copy;
  struct dea_lumped lumped = sample(&m, 0, &copy);
  struct dea_lift lift = {.fibre_length_m = 11e-3, .tip_per_stretch_m = 4e-3};
  for (double z = 0.5e-3; z < 4e-3; z += 0.5e-3) {
    double force, d = 1e-7;
    assert_int_equal(dea_lift_force(&lumped, &lift, 5e7, z, &force), DEA_OK);
    double wanted =
        -(energy_at(&lumped, &lift, 5e7, z + d) - energy_at(&lumped, &lift, 5e7, z - d)) / (2 * d);
    assert_close(force, wanted, 1e-6, 0);
  }
}

/* The force vanishes at the free height, and the reported one is the largest of the load line. */
TEST(test_load_line)
{
  struct dea_device device = test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, 4);
  struct dea_model *model = make(&device);
  struct dea_load_point p = solve(model, 5e3);
  struct dea_lumped lumped = {.film = {.material = &device.film, .thickness_m = 100e-6},
                              .pre_stretch = 1.5,
                              .coverage = 0.25,
                              .electrode_radius_m = 3.75e-3};
  struct dea_lift lift = dea_lift_create(&device);
  double largest = 0, force;
  for (int i = 0; i <= 1000; i++) {
    double z = p.fibre_tip_z_m * i / 1000;
    assert_int_equal(dea_lift_force(&lumped, &lift, 5e7, z, &force), DEA_OK);
    largest = fmax(largest, force);
  }
  assert_close(force, 0, 0, 1e-10);
  assert_true(p.force_N > 0);
  assert_true(dea_load_point_valid(&p) && !dea_load_point_trusted(&p)); // z is a bound
  assert_close(p.force_N, largest, 1e-5, 0);
  dea_model_find("lumped")->destroy(ctx, model);
}

/* A tip on the electrode moves less, one short of it about as much as the passive film lets it. */
TEST(test_lift_of_overlapping_and_short_fibres)
{
  struct dea_device device = test_disc(test_yeoh(), 1.5, 5e-3, 1.0 / 3, 4);
  assert_close(dea_lift_create(&device).tip_per_stretch_m, 5e-3, 1e-14, 0);
  device.fibre_tip_radius_m = 4e-3;
  assert_close(dea_lift_create(&device).tip_per_stretch_m, 4e-3, 1e-14, 0);
  device.fibre_tip_radius_m = 7e-3; // r_a l_a + 2 mm l_p, l_p' = -R/(1 - R) = -1/2
  assert_close(dea_lift_create(&device).tip_per_stretch_m, 4e-3, 1e-14, 0);
  device.fibre_tip_radius_m = 15e-3; // at the frame with R by radius nothing moves
  assert_close(dea_lift_create(&device).tip_per_stretch_m, 0, 0, 1e-17);
}

static double uniform(unsigned *seed, double low, double high)
{
  *seed = *seed * 1664525u + 1013904223u;
  return low + (high - low) * (*seed >> 8) / 16777216.0;
}

/* The model finds what a scan does on designs drawn at random, pull-in included. */
TEST(test_random_designs)
{
  enum { COUNT = 300 };
  static const struct {
    const char *law;
    double p[3];
  } laws[] = {
      {"yeoh", {178.4e3, -6e3, 4.2e3}}, {"neo-hookean", {1e5, 0, 0}}, {"gent", {1e5, 60, 0}}};
  unsigned seed = 7;
  int without = 0;
  for (size_t k = 0; k < 3; k++) {
    struct dea_material m = test_material(laws[k].law, laws[k].p[0], laws[k].p[1], laws[k].p[2]);
    for (int i = 0; i < COUNT; i++) {
      double pre = uniform(&seed, 1, 2), R = uniform(&seed, 0.05, 0.6);
      double V = uniform(&seed, 0, 1e4), l = first_root(&m, pre, R, V / 100e-6, 10 * pre);
      struct dea_device device = test_disc(m, pre, 5e-3, R, 0);
      struct dea_model *model = make(&device);
      struct dea_load_point p;
      dea_status status = dea_model_find("lumped")->solve(ctx, model, V, &p);
      if (status == DEA_OK) {
        assert_close(l, p.electrode_stretch, 1e-9, 0);
      } else {
        assert_int_equal(status, DEA_E_NO_EQUILIBRIUM);
        assert_true(isnan(l));
        without++;
      }
      dea_model_find("lumped")->destroy(ctx, model);
    }
  }
  assert_true(without > 0); // otherwise the test has not seen pull-in
}

TESTS(context_set_up, context_tear_down)

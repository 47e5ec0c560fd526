/* Faces that enclose gas or a liquid: against given pressures, a spherical cap, and the ordinary
 * differential equation of an inflated membrane. */
// ctest: solid
#include "model/model.h"

#include "layout_device.h"

#include <string.h>

static const double radius_m = 10e-3, film_m = 100e-6, mu_Pa = 100e3, ambient_Pa = 101325;

/* A disc of neo-Hookean film over a chamber; monitors of its middle and of the chamber. */
static struct dea_device *diaphragm_new(double stretch, struct dea_layout_pressure pressure)
{
  struct dea_device *device = disc_new(radius_m, 0.8 * radius_m, stretch);
  struct dea_layout *l = device->layout;
  struct dea_material *m = &l->plies[0].material;
  m->law = dea_law_find("neo-hookean");
  m->param[0] = mu_Pa;
  pressure.ambient_Pa = ambient_Pa;
  l->pressures[l->pressure_count++] = pressure;
  l->monitors[0].at_m[0][0] = 0;
  l->monitors[l->monitor_count++] =
      (struct dea_layout_monitor){.name = "chamber", .kind = DEA_MONITOR_VOLUME};
  return device;
}

struct seen {
  double z_m, pressure_Pa, volume_m3, charge_C;
  struct dea_load_point point;
};

static struct seen solve(double stretch, struct dea_layout_pressure pressure, double voltage_V)
{
  const struct dea_model_settings settings = {.film = DEA_FILM_MEMBRANE, .refinement = 1};
  struct dea_device *device = diaphragm_new(stretch, pressure);
  struct dea_model *model = layout_model(device, &settings);
  struct dea_observation o;
  struct seen out;
  assert_int_equal(dea_model_find("3d")->solve(ctx, model, voltage_V, &out.point), DEA_OK);
  assert_int_equal(dea_model_find("3d")->observe(ctx, model, &o), DEA_OK);
  out.z_m = o.monitor[0][DEA_OBSERVED_Z];
  out.pressure_Pa = o.monitor[1][DEA_OBSERVED_PRESSURE];
  out.volume_m3 = o.monitor[1][DEA_OBSERVED_VOLUME];
  out.charge_C = o.channel[1].charge_C;
  assert_int_equal(dea_observed_main(o.monitor[0]), DEA_OBSERVED_Z);
  assert_int_equal(dea_observed_main(o.monitor[1]), DEA_OBSERVED_VOLUME);
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
  return out;
}

/* The pressure that an enclosed volume comes to, given to the face, leads to the same film. */
TEST(test_as_given_pressure)
{
  const struct dea_layout_pressure enclosed[] = {
      {.encloses = DEA_GAS, .pressure_Pa = 1.5e3, .volume_m3 = 20e-6},
      {.encloses = DEA_LIQUID, .volume_m3 = 0.3e-6},
  };
  for (size_t i = 0; i < 2; i++) {
    const struct seen a = solve(1.1, enclosed[i], 2e3);
    const struct dea_layout_pressure given = {.pressure_Pa = a.pressure_Pa};
    const struct seen b = solve(1.1, given, 2e3);
    assert_true(a.pressure_Pa > 100 && a.z_m > 1e-3);
    if (i == 0) {
      const double amount = (ambient_Pa + enclosed[0].pressure_Pa) * enclosed[0].volume_m3;
      assert_close(a.pressure_Pa, amount / (enclosed[0].volume_m3 + a.volume_m3) - ambient_Pa,
                   1e-10, 0);
    } else {
      assert_close(a.volume_m3, enclosed[1].volume_m3, 1e-8, 0);
    }
    assert_close(b.z_m, a.z_m, 1e-6, 0);
    assert_close(b.volume_m3, a.volume_m3, 1e-6, 0);
    assert_close(b.charge_C, a.charge_C, 1e-6, 0);
  }
}

/* A little liquid below a film of tension T = mu H (1 - 1/l^6): a cap, of the rise 2 v/(pi a^2) at
 * the pressure 4 T z/a^2, up to the square of the rise over the radius. */
TEST(test_cap)
{
  const double stretch = 1.5, T = mu_Pa * film_m * (1 - pow(stretch, -6));
  const double area_m2 = acos(-1.0) * radius_m * radius_m, volume_m3 = 1e-9;
  const struct dea_layout_pressure liquid = {.encloses = DEA_LIQUID, .volume_m3 = volume_m3};
  const struct seen seen = solve(stretch, liquid, 0);
  const double z_m = 2 * volume_m3 / area_m2;
  assert_close(seen.z_m, z_m, 5e-5, 0);
  assert_close(seen.pressure_Pa, 4 * T * z_m / (radius_m * radius_m), 5e-5, 0);
}

/* The membrane of radius a/l before the pre-stretch l, from a pole with a stretch: radius at its
 * edge; its rise and volume. Nominal tensions s1, s2 over mu H; R s1 = (X, Y) along r and z. */
static double integrate(double pole, double pressure, double edge, double *rise, double *volume)
{
  enum { STEPS = 4000 };
  const double h = edge / STEPS;
  double y[4] = {0}; // r, X, rise, volume
  for (int i = 0; i < STEPS; i++) {
    double k[4] = {0}, old[4];
    memcpy(old, y, sizeof old);
    for (int stage = 0; stage < 2; stage++) { // the midpoint rule
      const double R = (i + 0.5 * stage) * h, r = y[0], Y = 0.5 * pressure * r * r;
      const double l2 = R > 0 ? r / R : pole,
                   s1 = R > 0 ? hypot(y[1], Y) / R : pole - pow(pole, -5);
      double l1 = fmax(l2, 1);
      for (int n = 0; n < 50; n++) {
        l1 -= (l1 - 1 / (l1 * l1 * l1 * l2 * l2) - s1) / (1 + 3 / (pow(l1, 4) * l2 * l2));
      }
      const double along = R > 0 ? y[1] / (R * s1) : 1, down = R > 0 ? Y / (R * s1) : 0;
      const double s2 = l2 - 1 / (l2 * l2 * l2 * l1 * l1);
      k[0] = l1 * along;
      k[1] = s2 - pressure * r * l1 * down;
      k[2] = l1 * down;
      k[3] = acos(-1.0) * r * r * l1 * down;
      for (int c = 0; c < 4; c++) {
        y[c] = old[c] + (stage == 0 ? 0.5 : 1) * h * k[c];
      }
    }
  }
  *rise = y[2];
  *volume = y[3];
  return y[0];
}

/* Along the whole curve, also beyond the largest pressure, where a given one has no stable film. */
TEST(test_curve)
{
  const double stretch = 1.1, unit_Pa = mu_Pa * film_m / radius_m;
  static const double poles[] = {1.3, 2.2, 2.8};
  double before_Pa = 0, largest_Pa = 0;
  for (size_t i = 0; i < sizeof poles / sizeof poles[0]; i++) {
    double low = 0, high = 5, rise, volume;
    for (int n = 0; n < 60; n++) {
      const double middle = 0.5 * (low + high);
      const double at = integrate(poles[i], middle, 1 / stretch, &rise, &volume);
      *(at > 1 ? &low : &high) = middle;
    }
    const struct dea_layout_pressure liquid = {.encloses = DEA_LIQUID,
                                               .volume_m3 = volume * pow(radius_m, 3)};
    const struct seen seen = solve(stretch, liquid, 0);
    assert_close(seen.pressure_Pa, low * unit_Pa, 5e-4, 0);
    assert_close(seen.z_m, rise * radius_m, 5e-4, 0);
    assert_int_equal(seen.point.unstable_modes, 0);
    before_Pa = seen.pressure_Pa;
    largest_Pa = fmax(largest_Pa, before_Pa);
  }
  assert_true(before_Pa < 0.99 * largest_Pa);
}

TESTS(context_set_up, context_tear_down)

/* Fit and motion of model "reduced" of a spring that eps E^2 moves, in closed form:
 * Phi = -F^2/(2 K) - a F V^2 - C V^2/2. */
#include "model/reduced/reduced_fit.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

static const double K = 100, a = 1e-11, C = 4e-10, F_m = 0.1, V_m = 5e3;
enum { FORCES = 5, VOLTAGES = 9 };

static struct dea_reduced_sample sample(double force, double V)
{
  return (struct dea_reduced_sample){.voltage_V = V,
                                     .at = {.value = force / K + a * V * V,
                                            .force = force,
                                            .by_force = 1 / K,
                                            .by_voltage = 2 * a * V,
                                            .charge_C = C * V + 2 * a * force * V,
                                            .charge_by_force = 2 * a * V,
                                            .charge_by_voltage = C + 2 * a * force}};
}

static struct dea_reduced fitted(struct dea_arena *memory, size_t voltages, size_t stride)
{
  struct dea_reduced_sample samples[FORCES * VOLTAGES];
  struct dea_reduced out = {.even = 1, .strain = {1, 0, 0}};
  for (size_t i = 0; i < FORCES * voltages; i++) {
    const double force = (double)(i / voltages), voltage = (double)(i % voltages);
    samples[i] = sample(F_m * (force - 2) / 2, V_m * voltage / (double)(voltages - 1));
  }
  const struct dea_reduced_grid grid = {samples, FORCES, voltages, true};
  assert_int_equal(dea_reduced_fit_energy(memory, &grid, stride, &out.energy), DEA_OK);
  return out;
}

/* Between the samples, and held: what was fitted is in the space of the splines. */
TEST(test_fit)
{
  struct dea_arena memory = {.ctx = ctx};
  static const size_t fits[][2] = {{VOLTAGES, 1}, {VOLTAGES, 2}, {5, 2}}; // voltages, stride
  for (size_t k = 0; k < sizeof fits / sizeof fits[0]; k++) {
    const struct dea_reduced model = fitted(&memory, fits[k][0], fits[k][1]);
    for (int i = 0; i < 20; i++) {
      const double F = F_m * (0.1 * i - 0.97), V = V_m * (0.05 * i + 0.013);
      const struct dea_reduced_sample wanted = sample(F, V);
      struct dea_reduced_point p, held = {.force = 0};
      assert_int_equal(dea_reduced_at(&model, F, V, &p), DEA_REDUCED_OK);
      assert_close(p.q, wanted.at.value, 0, 1e-11 * F_m / K);
      assert_close(p.charge_C, wanted.at.charge_C, 1e-10, 0);
      assert_close(p.by_force, 1 / K, 1e-8, 0);
      assert_close(p.charge_by_voltage, C + 2 * a * F, 1e-8, 0);
      assert_int_equal(dea_reduced_held(&model, p.q, V, &held), DEA_REDUCED_OK);
      assert_close(held.force, F, 0, 1e-9 * F_m);
    }
    struct dea_reduced_point p;
    assert_int_equal(dea_reduced_at(&model, 0, 1.01 * V_m, &p), DEA_REDUCED_BEYOND_VOLTAGE);
    assert_int_equal(dea_reduced_at(&model, 1.01 * F_m, 0, &p), DEA_REDUCED_BEYOND_FORCE);
  }
  dea_arena_free(&memory);
}

/* A mass after a jump of the voltage: q = a V^2 (1 - cos w t), and its energy. */
TEST(test_swing)
{
  enum { STEPS = 4000 };
  struct dea_arena memory = {.ctx = ctx};
  struct dea_reduced model = fitted(&memory, VOLTAGES, 1);
  struct dea_reduced_state s;
  const double m = 0.02, w = sqrt(K / m), V = 3e3, h = 2 * acos(-1) / w / STEPS;
  model.modes[0] = (struct dea_reduced_mode){.mass = {m}, .share = 1, .voltage_share = 1};
  model.mode_count = 1;
  assert_int_equal(dea_reduced_begin(&model, 0, 0, &s), DEA_REDUCED_OK);
  assert_int_equal(dea_reduced_step(&model, &s, 0, V, 0, 1, 1, &s), DEA_REDUCED_OK);
  for (int i = 1; i <= STEPS; i++) {
    assert_int_equal(dea_reduced_step(&model, &s, h, V, 0, 1, 1, &s), DEA_REDUCED_OK);
    assert_close(s.at.q, a * V * V * (1 - cos(w * h * i)), 0, 1e-5 * a * V * V);
    const double potential = K * pow(s.at.q - a * V * V, 2) / 2;
    assert_close(potential + s.kinetic_J, K * pow(a * V * V, 2) / 2, 1e-6, 0);
  }
  dea_arena_free(&memory);
}

/* A branch without inertia: a standard linear solid, and what it loses. */
TEST(test_creep)
{
  enum { STEPS = 400 };
  struct dea_arena memory = {.ctx = ctx};
  struct dea_reduced model = fitted(&memory, VOLTAGES, 1);
  struct dea_reduced_state s;
  const double k = 40, tau = 2, V = 4e3, h = 0.02, q = a * V * V;
  model.branch_count = 1;
  model.branch_N_per_m[0] = k;
  model.branch_s[0] = tau;
  assert_int_equal(dea_reduced_begin(&model, 0, 0, &s), DEA_REDUCED_OK);
  assert_int_equal(dea_reduced_step(&model, &s, 0, V, 0, 0, 1, &s), DEA_REDUCED_OK);
  const double before = K * pow(s.at.q - q, 2) / 2 + s.branch_J;
  for (int i = 0; i <= STEPS; i++) {
    assert_close(s.at.q, q * (1 - k / (K + k) * exp(-h * i * K / ((K + k) * tau))), 0, 1e-5 * q);
    assert_int_equal(dea_reduced_step(&model, &s, h, V, 0, 0, 1, &s), DEA_REDUCED_OK);
  }
  const double after = K * pow(s.at.q - q, 2) / 2 + s.branch_J;
  assert_close(s.loss_J, before - after, 1e-4, 0);
  // a step that is short against tau
  assert_int_equal(dea_reduced_step(&model, &s, 0, 0, 0, 0, 1, &s), DEA_REDUCED_OK);
  const double lost = s.loss_J, power = 2 * s.branch_J / tau;
  assert_int_equal(dea_reduced_step(&model, &s, 1e-9, 0, 0, 0, 1, &s), DEA_REDUCED_OK);
  assert_close(s.loss_J - lost, 1e-9 * power, 1e-5, 0);
  dea_arena_free(&memory);
}

/* A force that a mode takes more of than of the voltage is taken off: what has crept stays. */
TEST(test_unloaded)
{
  struct dea_arena memory = {.ctx = ctx};
  struct dea_reduced model = fitted(&memory, VOLTAGES, 1);
  struct dea_reduced_state s;
  model.branch_count = model.mode_count = 1;
  model.branch_N_per_m[0] = 40;
  model.branch_s[0] = 2;
  model.modes[0] = (struct dea_reduced_mode){.mass = {0.02}, .share = 0.7, .voltage_share = 0.5};
  assert_int_equal(dea_reduced_begin(&model, 0, 0, &s), DEA_REDUCED_OK);
  assert_int_equal(dea_reduced_step(&model, &s, 1, 0, 0.5 * F_m, 1, 0, &s), DEA_REDUCED_OK);
  assert_int_equal(dea_reduced_step(&model, &s, 0, 0, 0, 1, 0, &s), DEA_REDUCED_OK);
  const double q = s.at.q, stored_J = s.branch_J;
  assert_int_equal(dea_reduced_step(&model, &s, 1e-6, 0, 0, 1, 0, &s), DEA_REDUCED_OK);
  assert_close(s.at.q, q, 1e-5, 0);
  assert_close(s.branch_J, stored_J, 1e-5, 0);
  dea_arena_free(&memory);
}

TESTS(context_set_up, context_tear_down)

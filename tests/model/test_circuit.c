/* circuit and branches: against closed forms, for steps of any length. */
#include "testing.h"

#include "material/branch.h"
#include "model/circuit.h"

#include <math.h>

static const double C = 2e-10; // of a film of given shape

/* Charges a film through R_s to V_s in n equal steps of a total time. */
static struct dea_circuit_state charge(const struct dea_circuit *circuit, double conductance_S,
                                       double V_s, double time_s, int n)
{
  const struct dea_circuit_film film = {.capacitance_F = C, .conductance_S = conductance_S};
  struct dea_circuit_state state = {.capacitance_F = C, .conductance_S = conductance_S};
  const struct dea_time_step jump = {.length_s = 0, .source_voltage_V = V_s},
                             step = {.length_s = time_s / n, .source_voltage_V = V_s};
  dea_circuit_advance(circuit, &state, &jump, &film, &state);
  for (int i = 0; i < n; i++) {
    dea_circuit_advance(circuit, &state, &step, &film, &state);
  }
  return state;
}

TEST(test_charging)
{
  const struct dea_circuit circuit = {1e9, INFINITY}; // R C = 0.2 s
  for (int n = 1; n <= 100; n *= 10) {
    for (double time_s = 1e-4; time_s < 1e3; time_s *= 10) {
      struct dea_circuit_state end = charge(&circuit, 0, 5000, time_s, n);
      double decay = exp(-time_s / 0.2);
      assert_close(end.voltage_V, 5000 * (1 - decay), 0, 1e-8);
      assert_close(end.current_A, 5e-6 * decay, 0, 1e-14);
      // int R I^2 dt = C V_s^2/2 (1 - exp(-2 t/RC))
      assert_close(end.resistance_loss_J, 0.5 * C * 25e6 * (1 - decay * decay), 0, 1e-15);
      assert_close(end.supply_work_J, C * 25e6 * (1 - decay), 0, 1e-14);
    }
  }
}

/* A supply that is disconnected leaves the charge, whatever was between; it leaks away exactly, at
 * steps of any length, and is kept where the film changes. */
TEST(test_disconnected)
{
  const struct dea_circuit circuits[] = {{0, INFINITY}, {1e9, INFINITY}, {1e9, 1e-9}};
  const double G = 1e-11; // C/G = 20 s
  for (size_t i = 0; i < 3; i++) {
    const struct dea_circuit *circuit = &circuits[i];
    struct dea_circuit_state now = charge(circuit, 0, 4000, 0.01, 10);
    const double V = now.voltage_V, work = now.supply_work_J;
    struct dea_circuit_film film = {.capacitance_F = C, .conductance_S = G};
    struct dea_time_step step = {.length_s = 0, .source_voltage_V = 5000, .disconnected = true};
    dea_circuit_advance(circuit, &now, &step, &film, &now);
    assert_close(now.voltage_V, V, 1e-14, 0);
    step.length_s = 7;
    for (int k = 0; k < 3; k++) {
      dea_circuit_advance(circuit, &now, &step, &film, &now);
      assert_close(now.current_A, 0, 0, 1e-22);
      assert_true(isinf(dea_circuit_longest_step(circuit, &now, &step, 5000)));
    }
    assert_close(now.voltage_V, V * exp(-21.0 / 20), 1e-12, 0);
    assert_close(now.supply_work_J, work, 1e-12, 1e-15);
    film = (struct dea_circuit_film){.capacitance_F = 2 * C};
    now.conductance_S = 0;
    dea_circuit_advance(circuit, &now, &step, &film, &now);
    assert_close(now.voltage_V, 0.5 * V * exp(-21.0 / 20), 1e-12, 0);
  }
}

/* 10 uA into 0.2 nF: 50 V/ms, with and without resistance. */
TEST(test_current_limit)
{
  const struct dea_circuit stiff = {0, 1e-5}, soft = {1e6, 1e-5}; // the end in 0.2 ms there
  struct dea_circuit_state end = charge(&stiff, 0, 5000, 0.05, 7);
  assert_close(end.voltage_V, 2500, 0, 1e-9);
  assert_close(end.current_A, 1e-5, 0, 1e-18);
  assert_close(charge(&stiff, 0, 5000, 0.2, 7).voltage_V, 5000, 0, 1e-9);
  end = charge(&soft, 0, 5000, 0.05, 7);
  assert_close(end.voltage_V, 2500, 0, 1e-9);
  assert_close(end.resistance_loss_J, 1e6 * 1e-10 * 0.05, 0, 1e-15);
  assert_close(charge(&soft, 0, 5000, 0.2, 2000).voltage_V, 5000, 0, 1e-6);
}

/* A ramp through R_s: exact for any step, V = s (t - RC (1 - exp(-t/RC))). */
TEST(test_ramp)
{
  const struct dea_circuit circuit = {1e9, INFINITY};
  const struct dea_circuit_film film = {.capacitance_F = C};
  for (int n = 1; n <= 64; n *= 8) {
    struct dea_circuit_state now = {.capacitance_F = C};
    for (int i = 1; i <= n; i++) {
      const struct dea_time_step step = {.length_s = 0.8 / n,
                                         .source_voltage_V = 1000 * 0.8 * i / n};
      dea_circuit_advance(&circuit, &now, &step, &film, &now);
    }
    assert_close(now.voltage_V, 1000 * (0.8 - 0.2 * (1 - exp(-4))), 0, 1e-9);
  }
}

/* dV by the shape, against differences. */
TEST(test_slope)
{
  const struct dea_circuit circuits[] = {{1e9, INFINITY}, {1e9, 1e-6}, {0, 1e-6}, {0, INFINITY}};
  const struct dea_circuit_state last = {1000, 400, 400 * C, 6e-7, C, 1e-11, 0, 0, 0};
  const struct dea_time_step step = {.length_s = 0.05, .source_voltage_V = 3000};
  for (size_t i = 0; i < 4; i++) {
    double V[2], slope, unused, d = 1e-6;
    for (int k = 0; k < 2; k++) {
      double x = k == 0 ? -d : d;
      const struct dea_circuit_film film = {C * (1 + 3 * x), 1e-11 * (1 + 4 * x), 0, 0};
      V[k] = dea_circuit_voltage(&circuits[i], &last, &step, &film, &unused);
    }
    const struct dea_circuit_film film = {C, 1e-11, 3 * C, 4e-11};
    dea_circuit_voltage(&circuits[i], &last, &step, &film, &slope);
    assert_close((V[1] - V[0]) / (2 * d), slope, 0, 1e-5 * (1 + fabs(slope)));
  }
}

// Branches ---------------------------------------------------------------------------------------

TEST(test_weights)
{
  for (double x = 1e-12; x < 1e6; x *= 3.7) {
    struct dea_branch_weights w = dea_branch_weights(x, 1);
    long double e = expl(-(long double)x), mean = -expm1l(-(long double)x) / (long double)x;
    double loss = x < 1e-4 ? 1e-6 : 1e-12; // of the subtractions here
    assert_true(w.e >= 0 && w.w0 >= 0 && w.w1 >= 0);
    assert_close(w.e + w.w0 + w.w1, 1, 0, 1e-15);
    assert_close(w.w0, (double)(mean - e), 0, fmax(loss * w.w0, 1e-17));
    assert_close(w.w1, (double)(1 - mean), 0, fmax(loss * w.w1, 1e-17));
  }
}

/* C^-1 that goes evenly with time: A is exact at any step; and a film that was held stays. */
TEST(test_update)
{
  const struct dea_material m = {.branch_count = 2, .branches = {{3e4, 0.3}, {1e4, 40}}};
  struct dea_equal_tensor A[2], held = dea_equal_inverse(1.5);
  for (int i = 0; i < 2; i++) {
    A[i] = held;
  }
  dea_equal_update(&m, A, 7, 1.5, 1.5, A);
  for (int i = 0; i < 2; i++) {
    assert_close(A[i].p, held.p, 0, 1e-15);
    assert_close(A[i].z, held.z, 0, 1e-15);
  }
  struct dea_equal_tensor B = dea_equal_known(&m, A, 7, 1.5);
  double W, s, k, W2[2];
  dea_equal_stress(&B, 1.5, &W, &s, &k);
  assert_close(s, 0, 0, 1e-10); // Pa, of moduli of 1e4
  assert_true(fabs(dea_equal_energy(&m, A, 1.5)) < 1e-10);
  assert_true(fabs(dea_equal_loss(&m, A, 7, 1.5, 1.5)) < 1e-10);
  // p of C^-1 from 1/4 to 1/9 (stretch 2 to 3) and A = tau (p' - ...): A' = (p(t) - A)/tau
  const struct dea_material one = {.branch_count = 1, .branches = {{1e4, 2}}};
  struct dea_equal_tensor a = {0.7, 3};
  double h = 5, slope = (1.0 / 9 - 1.0 / 4) / h, e = exp(-h / 2);
  dea_equal_update(&one, &a, h, 2, 3, &a);
  assert_close(a.p, 1.0 / 9 - slope * 2 + e * (0.7 - 1.0 / 4 + slope * 2), 0, 1e-14);
  for (int i = 0; i < 2; i++) { // stress is the derivative of the energy, in one of two directions
    dea_equal_stress(&B, 1.8 + (i == 0 ? -1e-5 : 1e-5), &W2[i], &s, &k);
  }
  dea_equal_stress(&B, 1.8, &W, &s, &k);
  assert_close((W2[1] - W2[0]) / 2e-5, 2 * s, 0, 1e-4 * fabs(s));
}

TESTS(NULL, NULL)

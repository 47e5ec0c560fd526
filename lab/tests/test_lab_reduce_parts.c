/* The steps of the reduction, each against a closed form or a slow way to the same. */
// ctest: quick, heavy
#include "context_fixture.h"
#include "lab_signals.h"
#include "reduce/reduce_parts.h"

// Order and filter -------------------------------------------------------------------------------

static int by_value(const void *a, const void *b)
{
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

TEST(test_median_is_that_of_a_sorted_list)
{
  uint64_t seed = 4;
  for (size_t n = 1; n < 60; n++) {
    double values[60], sorted[60];
    for (size_t i = 0; i < n; i++) { // with equal ones
      sorted[i] = values[i] = floor(20.0 * signal_uniform(&seed));
    }
    qsort(sorted, n, sizeof *sorted, by_value);
    assert_close(dea_median(values, n), 0.5 * (sorted[n / 2] + sorted[(n - 1) / 2]), 0.0, 1e-14);
    for (size_t k = 0; k < n; k++) {
      assert_close(dea_quantile(values, n, n > 1 ? (double)k / (double)(n - 1) : 0.0), sorted[k],
                   0.0, 0.0);
    }
  }
  double holes[] = {NAN, 3.0, NAN, 1.0, 2.0};
  assert_close(dea_median(holes, 5), 2.0, 0.0, 0.0);
  assert_true(isnan(dea_median(holes + 3, 0)));
}

TEST(test_running_median)
{
  enum { N = 97 };
  uint64_t seed = 9;
  double values[N], out[N];
  for (size_t i = 0; i < N; i++) {
    values[i] = signal_uniform(&seed) < 0.1 ? NAN : signal_normal(&seed);
  }
  for (size_t half = 0; half < 60; half += 7) {
    dea_running_median(values, N, half, out);
    for (size_t i = 0; i < N; i++) {
      double own[N];
      size_t n = 0;
      for (size_t k = i > half ? i - half : 0; k <= i + half && k < N; k++) {
        own[n++] = values[k];
      }
      double wanted = dea_median(own, n);
      assert_true(isnan(wanted) ? isnan(out[i]) : fabs(out[i] - wanted) < 1e-15);
    }
  }
}

TEST(test_spread_is_sigma_of_normal_noise)
{
  enum { N = 20000 };
  static double values[N];
  uint64_t seed = 1;
  for (size_t i = 0; i < N; i++) { // a tenth are far off
    values[i] = i % 10 == 0 ? 1e3 : 5.0 + 2.0 * signal_normal(&seed);
  }
  assert_close(dea_spread(values, N, 5.0), 2.0, 0.2, 0.0); // and 2 within 2 % without those
}

TEST(test_filter_has_its_cutoff_and_no_delay)
{
  enum { N = 20000 };
  static double in[N], out[N];
  const double cutoff_Hz = 10.0, rate_Hz = 10000.0;
  struct dea_channel c = {.interval_s = 1.0 / rate_Hz, .values = in, .count = N};
  for (int k = 1; k <= 4; k++) {
    double f = 5.0 * k, cosine = 0.0, sine = 0.0, norm = 0.0;
    for (size_t i = 0; i < N; i++) {
      in[i] = sin(2.0 * acos(-1.0) * f * dea_channel_time(&c, i));
    }
    dea_filter_apply(&c, cutoff_Hz, out);
    for (size_t i = N / 4; i < 3 * N / 4; i++) {
      double phase = 2.0 * acos(-1.0) * f * dea_channel_time(&c, i);
      sine += out[i] * sin(phase);
      cosine += out[i] * cos(phase);
      norm += sin(phase) * sin(phase);
    }
    double u = f / cutoff_Hz;
    assert_close(sine / norm, 1.0 / (1.0 + u * u * (sqrt(2.0) - 1.0)), 0.01, 0.0);
    assert_close(cosine / norm, 0.0, 0.0, 2e-3);
  }
  in[50] = NAN;
  dea_filter_apply(&c, NAN, out);
  assert_true(isnan(out[50]) && out[51] == in[51]);
  for (size_t i = 0; i < N; i++) { // half of an edge is seen before it, exp(-15) of that from afar
    in[i] = i < N / 2 ? 0.0 : 1.0;
  }
  dea_filter_apply(&c, cutoff_Hz, out);
  size_t reach = (size_t)(dea_filter_reach(cutoff_Hz) * rate_Hz + 0.5);
  assert_close(out[N / 2 - reach], 0.5 * exp(-15.0), 0.05, 0.0);
  assert_true(dea_filter_reach(0.0) == 0.0 && dea_filter_reach(NAN) == 0.0);
}

TEST(test_a_list_grows)
{
  size_t capacity = 0;
  size_t *list = NULL;
  for (size_t n = 0; n < 1000; n++) {
    size_t before = capacity;
    assert_int_equal(dea_array_grow(ctx, &list, n, &capacity, sizeof *list), DEA_OK);
    assert_true(capacity > n && (before > n ? capacity == before : capacity >= 2 * before));
    list[n] = n;
  }
  for (size_t n = 0; n < 1000; n++) {
    assert_int_equal(list[n], n);
  }
  dea_free(ctx, list);
}

// Noise ------------------------------------------------------------------------------------------

/* Variance of the mean of n samples of noise with the correlation rho^lag, summed up. */
static double variance_of_mean(double rho, size_t n)
{
  double sum = 1.0;
  for (size_t lag = 1; lag < n; lag++) {
    sum += 2.0 * (1.0 - (double)lag / (double)n) * pow(rho, (double)lag);
  }
  return sum / (double)n;
}

TEST(test_noise_of_a_mean)
{
  enum { N = 12000, SPANS = 60 };
  static double values[N];
  const double rhos[] = {0.0, 0.5, 0.9};
  for (int k = 0; k < 3; k++) {
    struct dea_channel c = {.interval_s = 0.01, .values = values, .count = N};
    struct dea_span spans[SPANS];
    struct dea_noise noise;
    uint64_t seed = 3;
    double before = signal_normal(&seed);
    for (size_t i = 0; i < N; i++) { // on a slope that is not noise
      before = signal_correlated(&seed, rhos[k], before);
      values[i] = before + 0.05 * (double)i;
    }
    for (size_t s = 0; s < SPANS; s++) {
      spans[s] = (struct dea_span){2.0 * (double)s - 0.005, 2.0 * (double)(s + 1) - 0.005};
    }
    assert_int_equal(dea_noise_estimate(ctx, &c, spans, SPANS, &noise), DEA_OK);
    assert_close(noise.sample, 1.0, 0.1, 0.0);
    assert_close(sqrt(dea_noise_of_mean(&noise, 200)), sqrt(variance_of_mean(rhos[k], 200)), 0.15,
                 0.0);
    assert_close(sqrt(dea_noise_of_mean(&noise, 80)), sqrt(variance_of_mean(rhos[k], 80)), 0.15,
                 0.0);
  }
}

/* Of short windows the lines take much of the noise along; what they took is given back: means of
 * two neighbours, whose covariances are 1 and 1/2. */
TEST(test_noise_in_short_windows)
{
  enum { WINDOWS = 8000, EACH = 16, N = WINDOWS * EACH };
  static double values[N];
  static struct dea_span spans[WINDOWS];
  struct dea_channel c = {.interval_s = 0.01, .values = values, .count = N};
  struct dea_noise noise;
  uint64_t seed = 5;
  double before = signal_normal(&seed);
  for (size_t i = 0; i < N; i++) {
    double next = signal_normal(&seed);
    values[i] = (next + before) / sqrt(2.0);
    before = next;
  }
  for (size_t s = 0; s < WINDOWS; s++) {
    double begin_s = 0.01 * EACH * (double)s - 0.005;
    spans[s] = (struct dea_span){begin_s, begin_s + 0.01 * EACH};
  }
  assert_int_equal(dea_noise_estimate(ctx, &c, spans, WINDOWS, &noise), DEA_OK);
  assert_int_equal(noise.block, 1);
  assert_int_equal(noise.lags, 1);
  assert_close(noise.covariance[0], 1.0, 0.02, 0.0);
  assert_close(noise.covariance[1], 0.5, 0.03, 0.0);
}

// Edges ------------------------------------------------------------------------------------------

TEST(test_edges_in_a_gap)
{
  enum { N = 700 };
  static double x[N], z[N], work[3 * N];
  uint64_t seed = 5;
  for (size_t i = 0; i < N; i++) { // the frame's sides shade 0.6 mm of the film
    x[i] = -17.5e-3 + 35e-3 * (double)i / (N - 1);
    double r = fabs(x[i] - 0.4e-3);
    z[i] = (r > 15e-3 ? 3e-3 : 0.0) + 0.1 * x[i] + 5e-6 * signal_normal(&seed);
    z[i] = r > 14.4e-3 && r < 15e-3 ? NAN : signal_uniform(&seed) < 0.02 ? 8e-3 : z[i];
  }
  double edges[2], height;
  assert_true(dea_frame_edges(x, z, N, 15e-3, work, edges, &height));
  assert_close(edges[0], -14.3e-3, 0.0, 0.1e-3); // the middle of the gap
  assert_close(edges[1], 15.1e-3, 0.0, 0.1e-3);
  assert_close(height, 3e-3, 0.05, 0.0);
  assert_false(dea_frame_edges(x, z, N, 9e-3, work, edges, &height)); // another frame
  for (size_t i = 0; i < N; i++) {
    z[i] = 5e-6 * signal_normal(&seed) + 3e-4 * cos(100.0 * x[i]);
  }
  assert_false(dea_frame_edges(x, z, N, NAN, work, edges, &height)); // a film alone
  assert_false(dea_frame_edges(x, z, 10, NAN, work, edges, &height));
}

/* A cable beside the film is a step too, but not at the frame's distance. */
TEST(test_edges_beside_a_cable)
{
  enum { N = 700 };
  static double x[N], z[N], work[3 * N];
  uint64_t seed = 6;
  for (size_t i = 0; i < N; i++) {
    x[i] = -20e-3 + 40e-3 * (double)i / (N - 1);
    double r = fabs(x[i]);
    z[i] = (r > 15e-3 ? 2e-3 : 0.0) + 5e-6 * signal_normal(&seed) + (x[i] > 18e-3 ? 6e-3 : 0.0);
  }
  double edges[2], height;
  assert_true(dea_frame_edges(x, z, N, 15e-3, work, edges, &height));
  assert_close(edges[1], 15e-3, 0.0, 0.06e-3);
}

// Discharges -------------------------------------------------------------------------------------

enum { I_RATE = 2000, I_COUNT = 40000 };

struct currents {
  struct dea_channel asked, measured, current;
  double u[I_COUNT], v[I_COUNT], i[I_COUNT];
};

/* Square cycles of 2 s to 6 kV with charging currents of 4 ms, a leakage that decays, and noise. */
static void fill_currents(struct currents *c, double sigma, uint64_t seed)
{
  struct dea_channel plain = {.interval_s = 1.0 / I_RATE, .count = I_COUNT, .filter_Hz = NAN};
  c->asked = c->measured = c->current = plain;
  c->asked.values = c->u;
  c->measured.values = c->v;
  c->current.values = c->i;
  for (size_t k = 0; k < I_COUNT; k++) {
    double t = (double)k / I_RATE, since = fmod(t, 1.0);
    bool on = fmod(t, 2.0) >= 1.0;
    double charge = t < 1.0 ? 0.0 : (on ? 1.0 : -1.0) * 40e-6 * exp(-since / 4e-3);
    c->u[k] = on ? 6000.0 : 0.0;
    c->v[k] = c->u[k] + 5.0 * signal_normal(&seed);
    c->i[k] =
        charge + (on ? 0.3e-6 + 0.1e-6 * exp(-since / 0.2) : 0.0) + sigma * signal_normal(&seed);
  }
}

static size_t discharges(const struct currents *c, struct dea_discharge **found,
                         struct dea_current_limits *limits)
{
  struct dea_voltage_scale scale;
  size_t count;
  assert_int_equal(dea_voltage_scale_find(ctx, &c->asked, &scale), DEA_OK);
  assert_int_equal(
      dea_discharges_find(ctx, &c->current, &c->asked, &c->measured, &scale, found, &count, limits),
      DEA_OK);
  return count;
}

TEST(test_threshold_follows_the_number_of_samples)
{
  for (size_t n = 1000; n <= 100000000; n *= 10) {
    double k = dea_discharge_threshold(n);
    assert_close((double)n * erfc(k / sqrt(2.0)), 0.1, 1e-6, 0.0);
  }
}

TEST(test_discharges_are_found)
{
  static struct currents c;
  const double sigma = 20e-9;
  size_t others = 0;
  for (uint64_t seed = 1; seed <= 20; seed++) {
    fill_currents(&c, sigma, seed);
    const double times[] = {1.1, 1.62, 2.4, 5.31, 9.77, 15.5};
    double charges[6];
    for (size_t d = 0; d < 6; d++) { // 9 sigma and more, for 1 to 6 samples
      size_t at = (size_t)(times[d] * I_RATE);
      charges[d] = 0.0;
      for (size_t k = 0; k <= d; k++) {
        double extra = sigma * (12.0 + 20.0 * (double)d) * (d % 2 == 0 ? 1.0 : -1.0);
        c.i[at + k] += extra;
        charges[d] += extra / I_RATE;
        c.v[at + k] -= 500.0; // which pulls the amplifier's output down
      }
    }
    struct dea_discharge *found;
    struct dea_current_limits limits;
    size_t count = discharges(&c, &found, &limits);
    assert_close(limits.noise_A, sigma, 0.05, 0.0);
    for (size_t d = 0, k = 0; d < 6; d++, k++) {
      for (; k < count && found[k].time_s < times[d] - 1.5 / I_RATE; k++) {
      }
      assert_true(k < count);
      assert_int_equal(found[k].kind, DEA_DISCHARGE);
      assert_close(found[k].time_s, times[d], 0.0, 1.5 / I_RATE);
      assert_close(found[k].charge_C, charges[d], 0.1, 6.0 * sigma / I_RATE);
      assert_close(found[k].voltage_V, c.u[(size_t)(times[d] * I_RATE)], 0.0, 30.0);
    }
    others += count - 6;
    dea_free(ctx, found);
  }
  assert_true(others <= 6); // 2 at most are expected of 20 recordings
}

/* Charging currents are no discharges: 4 false ones at most are expected of 40 recordings. A coarse
 * converter, in every fourth, adds none. */
TEST(test_nothing_is_found_in_quiet)
{
  static struct currents c;
  size_t all = 0;
  for (uint64_t seed = 1; seed <= 40; seed++) {
    struct dea_discharge *found;
    struct dea_current_limits limits;
    fill_currents(&c, 20e-9, 100 + seed);
    for (size_t k = 0; k < I_COUNT && seed % 4 == 0; k++) {
      c.i[k] = 50e-9 * round(c.i[k] / 50e-9);
    }
    all += discharges(&c, &found, &limits);
    assert_true(limits.blind_s > 8e-3 && limits.blind_s < 60e-3);
    dea_free(ctx, found);
  }
  assert_true(all <= 8);
}

/* Under a voltage that never rests the leakage is taken off the whole. */
TEST(test_discharge_on_a_ramp)
{
  static struct currents c;
  const double sigma = 20e-9;
  fill_currents(&c, sigma, 9);
  uint64_t seed = 10;
  for (size_t k = 0; k < I_COUNT; k++) {
    c.u[k] = 6000.0 * (double)k / I_COUNT;
    c.v[k] = c.u[k];
    c.i[k] = 0.2e-6 * (double)k / I_COUNT + sigma * signal_normal(&seed);
  }
  c.i[I_COUNT / 2] += 60.0 * sigma;
  struct dea_discharge *found;
  struct dea_current_limits limits;
  assert_int_equal(discharges(&c, &found, &limits), 1);
  assert_close(found[0].time_s, 0.5 * I_COUNT / I_RATE, 0.0, 1.5 / I_RATE);
  assert_close(found[0].charge_C, 60.0 * sigma / I_RATE, 0.1, 0.0);
  dea_free(ctx, found);
}

/* Slow ramps: what charges at their foot, within the tolerance of a plateau, is no discharge. */
TEST(test_nothing_is_found_on_slow_ramps)
{
  static struct currents c;
  const double sigma = 2e-9, film_F = 300e-12, ramp_s = 0.3;
  for (uint64_t turn = 1; turn <= 8; turn++) {
    uint64_t seed = 20 + turn;
    const double volts = turn % 2 == 0 ? 0.0 : 5.0; // noise of a measured voltage
    struct dea_discharge *found;
    struct dea_current_limits limits;
    fill_currents(&c, sigma, seed);
    for (size_t k = 0; k < I_COUNT; k++) {
      double t = fmod((double)k / I_RATE, 2.0);
      double up = fmin(fmax((t - 0.2) / ramp_s, 0.0), 1.0);
      double down = fmin(fmax((t - 1.2) / ramp_s, 0.0), 1.0);
      bool moves = (up > 0.0 && up < 1.0) || (down > 0.0 && down < 1.0);
      c.u[k] = 6000.0 * (up - down) + volts * signal_normal(&seed);
      c.v[k] = c.u[k];
      c.i[k] = (moves ? (down > 0.0 ? -1.0 : 1.0) * film_F * 6000.0 / ramp_s : 0.0) +
               sigma * signal_normal(&seed);
    }
    size_t count = discharges(&c, &found, &limits);
    assert_true(limits.samples > I_COUNT / 2);
    assert_int_equal(count, 0);
    dea_free(ctx, found);
  }
}

TEST(test_breakdown)
{
  static struct currents c;
  fill_currents(&c, 20e-9, 8);
  for (size_t k = (size_t)(13.4 * I_RATE); k < I_COUNT; k++) { // shorted from there on
    c.v[k] = c.u[k] > 0.0 ? 300.0 : 0.0;
    c.i[k] += c.u[k] > 0.0 ? 200e-6 : 0.0;
  }
  struct dea_discharge *found;
  struct dea_current_limits limits;
  size_t count = discharges(&c, &found, &limits);
  assert_true(count >= 1);
  assert_int_equal(found[0].kind, DEA_BREAKDOWN);
  assert_close(found[0].time_s, 13.4, 0.0, 2.0 / I_RATE);
  assert_close(found[0].voltage_V, 6000.0, 0.0, 30.0);
  assert_close(found[0].charge_C, 200e-6 * 0.6, 0.01, 0.0);
  for (size_t d = 0; d < count; d++) {
    assert_int_equal(found[d].kind, DEA_BREAKDOWN);
  }
  dea_free(ctx, found);
}

// Rise -------------------------------------------------------------------------------------------

/* Seconds under voltage against those counted by hand: a square of 2 s, at rest every other second,
 * with a lost sample, the other sign, and an offset that a film idles at. */
TEST(test_time_under_voltage)
{
  double values[80];
  for (size_t i = 0; i < 80; i++) { // 10 Hz
    values[i] = i % 20 < 10 ? 0.0 : i < 40 ? 2000.0 : -2000.0;
  }
  values[15] = NAN;
  struct dea_channel u = {.values = values, .count = 80, .interval_s = 0.1};
  struct dea_reduced_cycle cycles[4] = {0};
  for (size_t k = 0; k < 4; k++) {
    cycles[k].cycle.end_s = 2.0 * (double)(k + 1) - (k == 3 ? 0.55 : 0.0);
  }
  dea_cycles_dose(&u, 100.0, cycles, 4);
  static const double wanted_s[] = {1.0, 2.0, 3.0, 3.45};
  for (size_t k = 0; k < 4; k++) {
    assert_close(cycles[k].under_voltage_s, wanted_s[k], 1e-9, 0.0);
  }
  cycles[1].cycle.end_s = 1.5; // one within another
  dea_cycles_dose(&u, 100.0, cycles, 2);
  assert_close(cycles[0].under_voltage_s, 1.0, 1e-9, 0.0);
  assert_close(cycles[1].under_voltage_s, 0.5, 1e-9, 0.0);
  for (size_t i = 0; i < 80; i++) {
    values[i] = i % 20 < 10 ? 1000.0 : 2000.0; // idles at half of it
  }
  dea_cycles_dose(&u, 100.0, cycles, 1);
  assert_close(cycles[0].under_voltage_s, 2.0, 1e-9, 0.0);
}

/* A trapezoid on a film whose capacitance grows with the voltage, with leakage and a monitor that
 * is off: the charge between two equal ramps is that of the film alone. */
TEST(test_charge_between_equal_ramps)
{
  enum { RATE = 1000, COUNT = 4000 };
  static const double C0_F = 30e-12, grows_per_V2 = 2e-8, high_V = 3000, leak_ohm = 1e12;
  static double volts[COUNT], amperes[COUNT];
  double before_C = 0;
  for (size_t i = 0; i < COUNT; i++) { // up from 1 to 1.2 s, down from 2.2 to 2.4 s
    double t = (double)i / RATE;
    volts[i] = high_V * fmin(fmax(fmin((t - 1) / 0.2, (2.4 - t) / 0.2), 0.0), 1.0);
    double charge_C = C0_F * volts[i] * (1 + grows_per_V2 * volts[i] * volts[i]);
    amperes[i] = (charge_C - before_C) * RATE + volts[i] / leak_ohm + 2e-9;
    before_C = charge_C;
  }
  const struct dea_channel u = {.values = volts, .count = COUNT, .interval_s = 1.0 / RATE};
  const struct dea_channel a = {.values = amperes, .count = COUNT, .interval_s = 1.0 / RATE};
  const struct dea_charge_limits limits = {60, 0.05, 0};
  struct dea_cycle_parts part = {
      .rest = {0, 1}, .active = {1.2, 2.2}, .after = {2.4, 4}, .held = true};
  struct dea_reduced_cycle cycles[2] = {{.capacitance_F = NAN}, {.capacitance_F = NAN}};
  const struct dea_cycle_parts parts[2] = {part, part};
  assert_int_equal(dea_charge_find(ctx, &a, &u, parts, 2, 0.2, &limits, cycles), DEA_OK);
  const double wanted_F = C0_F * (1 + grows_per_V2 * high_V * high_V);
  assert_close(cycles[0].capacitance_F, wanted_F, 1e-4, 0.0);
  assert_close(cycles[0].leakage_A, high_V / leak_ohm, 1e-6, 0.0);
  assert_close(cycles[1].charge_C, 2 * wanted_F * high_V, 1e-4, 0.0);
  part.held = false; // a peak: the windows are the two ways
  cycles[0].capacitance_F = NAN;
  assert_int_equal(dea_charge_find(ctx, &a, &u, &part, 1, 0.2, &limits, cycles), DEA_OK);
  assert_close(cycles[0].capacitance_F, wanted_F, 1e-4, 0.0);
  part.after.begin_s = 2.6; // another ramp down than up
  cycles[0].capacitance_F = NAN;
  assert_int_equal(dea_charge_find(ctx, &a, &u, &part, 1, 0.2, &limits, cycles), DEA_OK);
  assert_true(isnan(cycles[0].capacitance_F));
}

/* A cycle whose own charge is not known (a lost sample, an unequal ramp) takes what the capacitance
 * says of its voltage; without any the charge is not known. */
TEST(test_charge_of_cycles_without_one)
{
  enum { RATE = 1000, COUNT = 6000 };
  static const double film_F = 30e-12, high_V = 3000;
  static double volts[COUNT], amperes[COUNT];
  double before_V = 0;
  struct dea_cycle_parts parts[3];
  struct dea_reduced_cycle cycles[3] = {{.voltage_V = 3000}, {.voltage_V = 3000}, {.voltage_V = 0}};
  for (size_t k = 0; k < 3; k++) {
    double at = 2.0 * (double)k;
    cycles[k].capacitance_F = NAN;
    parts[k] = (struct dea_cycle_parts){
        .rest = {at, at + 0.5}, .active = {at + 0.6, at + 1.2}, .after = {at + 1.3, at + 2}};
    parts[k].held = true;
  }
  for (size_t i = 0; i < COUNT; i++) {
    double t = fmod((double)i / RATE, 2.0);
    volts[i] =
        i >= 4000 ? 0.0 : high_V * fmin(fmax(fmin((t - 0.5) / 0.1, (1.3 - t) / 0.1), 0.0), 1.0);
    amperes[i] = film_F * (volts[i] - before_V) * RATE;
    before_V = volts[i];
  }
  amperes[550] = NAN;
  const struct dea_channel u = {.values = volts, .count = COUNT, .interval_s = 1.0 / RATE};
  const struct dea_channel a = {.values = amperes, .count = COUNT, .interval_s = 1.0 / RATE};
  const struct dea_charge_limits limits = {60, 0.05, 0};
  assert_int_equal(dea_charge_find(ctx, &a, &u, parts, 3, 0.2, &limits, cycles), DEA_OK);
  assert_true(isnan(cycles[0].capacitance_F));
  assert_close(cycles[1].capacitance_F, film_F, 1e-6, 0.0);
  assert_close(cycles[0].charge_C, film_F * high_V, 1e-6, 0.0);
  assert_close(cycles[1].charge_C, 2 * film_F * high_V, 1e-6, 0.0);
  assert_close(cycles[2].charge_C, 2 * film_F * high_V, 1e-6, 0.0);
  amperes[2550] = cycles[1].capacitance_F = NAN;
  assert_int_equal(dea_charge_find(ctx, &a, &u, parts, 3, 0.2, &limits, cycles), DEA_OK);
  assert_true(isnan(cycles[0].charge_C) && isnan(cycles[2].charge_C));
}

/* The stretch is told against the voltage nearest to 0, whatever its sign. */
TEST(test_sensed_stretch_of_either_sign)
{
  for (int sign = -1; sign <= 1; sign += 2) {
    struct dea_reduced_cycle cycles[2] = {{.capacitance_F = 16e-12}, {.capacitance_F = 100e-12}};
    const size_t high = sign < 0 ? 0 : 1;
    struct dea_voltage_level levels[2] = {{.voltage_V = sign < 0 ? -5000 : 1000},
                                          {.voltage_V = sign < 0 ? -1000 : 5000}};
    struct dea_reduction reduction = {
        .cycles = cycles, .cycle_count = 2, .levels = levels, .level_count = 2};
    cycles[1].capacitance_F = 81e-12;
    cycles[0].level = 1 - high;
    cycles[1].level = high;
    dea_charge_levels(&reduction);
    assert_close(levels[1 - high].sensed_stretch, 1, 1e-12, 0);
    assert_close(levels[high].sensed_stretch, 1.5, 1e-12, 0);
  }
}

/* Steps of 50 V up to 6 kV, each below 1 % of that: no level spans more than 1 %. */
TEST(test_small_steps_are_no_one_level)
{
  enum { STEPS = 120 };
  static struct dea_reduced_cycle cycles[STEPS];
  struct dea_voltage_level *levels;
  size_t count;
  for (size_t k = 0; k < STEPS; k++) {
    cycles[k].voltage_V = 50.0 * (double)(k + 1);
  }
  assert_int_equal(dea_levels_form(ctx, cycles, STEPS, 60.0, &levels, &count), DEA_OK);
  assert_int_equal(count, STEPS / 2);
  for (size_t k = 0; k < STEPS; k++) {
    assert_int_equal(cycles[k].level, k / 2);
    assert_close(levels[k / 2].voltage_V, cycles[k].voltage_V, 0, 25.1);
  }
  dea_free(ctx, levels);
}

/* Two pulses of 5 ms in two minutes, without noise: fewer samples than the quantiles look at. */
TEST(test_rare_pulses)
{
  enum { COUNT = 120000 };
  static double volts[COUNT];
  for (size_t i = 0; i < 5; i++) {
    volts[40000 + i] = volts[80000 + i] = 5000;
  }
  const struct dea_channel u = {.values = volts, .count = COUNT, .interval_s = 1e-3};
  const struct dea_recording recording = {.file = ""};
  struct dea_voltage_scale scale;
  struct dea_cycle_list list;
  assert_int_equal(dea_voltage_scale_find(ctx, &u, &scale), DEA_OK);
  assert_int_equal(dea_cycles_find(ctx, &recording, &u, &scale, &list), DEA_OK);
  assert_int_equal(list.count, 2);
  assert_close(list.parts[1].active.begin_s, 80, 1e-9, 0);
  dea_free(ctx, list.parts);
}

TEST(test_rise_of_a_straight_line)
{
  double values[40];
  struct dea_channel c = {.interval_s = 0.1, .values = values, .count = 40};
  for (size_t i = 0; i < 40; i++) { // 0 to 1 from 1.04 s to 2.04 s
    values[i] = fmin(fmax(0.1 * (double)i - 1.04, 0.0), 1.0);
  }
  double end_s;
  struct dea_span all = {0.0, 4.0};
  assert_close(dea_rise_time(&c, all, 0.0, 1.0, 0.0, &end_s), 0.8, 1e-12, 0.0);
  assert_close(end_s, 2.0, 1e-12, 0.0);
  values[14] = NAN;
  assert_close(dea_rise_time(&c, all, 0.0, 1.0, 0.0, &end_s), 0.8, 1e-12, 0.0);
  assert_true(isnan(dea_rise_time(&c, all, 0.0, 1.0, 0.2, &end_s))); // in the noise
  assert_true(isnan(dea_rise_time(&c, all, 0.0, 5.0, 0.0, &end_s))); // never there
  for (size_t i = 0; i < 40; i++) {
    values[i] = i < 10 ? 0.0 : i == 10 ? 0.5 : 1.0; // one sample within
  }
  assert_true(isnan(dea_rise_time(&c, all, 0.0, 1.0, 0.0, &end_s)));
  assert_close(end_s, 1.1, 1e-12, 0.0);
}

TESTS(context_set_up, context_tear_down)

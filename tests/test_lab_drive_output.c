/* lab/drive/drive_output and drive_watch: what is asked of the amplifier, sample by sample,
 * and what of its answer ends a measurement. */
#define _GNU_SOURCE
#include "lab/drive/drive.h"
#include "lab/drive/drive_output.h"
#include "lab/instrument/drive_watch.h"
#include "protocol_text.h"

#include <math.h>

/* A rate and a frequency that share no factor: a sample at or after each corner has its value. */
static void test_corners_fall_on_samples(void **state)
{
  (void)state;
  static const double rates[] = {1000, 999, 333.3, 12345.678};
  for (size_t k = 0; k < 4; k++) {
    struct dea_protocol *p = good_protocol(
        ctx, "dea-protocol: 1\n" PROTOCOL_AMPLIFIER
             "sequence:\n  - {waveform: {kind: square, high: 1 kV, low: 500 V, frequency: 9 Hz, "
             "cycles: 40}, repeat: 2, pause: 0.3 s}\n  - {waveform: {kind: ramp, to: 3 kV, "
             "duration: 0.7 s}}\n");
    struct dea_drive_output output;
    double asked_V;
    p->rate_Hz.si = rates[k];
    dea_drive_output_start(&output, p);
    size_t i = 0;
    for (; dea_drive_output_next(&output, 1, &asked_V) == 1; i++) {
      const long double small = 1e-6L / (long double)rates[k]; // s
      long double time_s = (long double)i / (long double)rates[k], in = time_s * 9;
      double wanted = 0;
      if (in < 80 - 9 * small) {
        long double phase = in + 9 * small - floorl(in + 9 * small);
        wanted = phase < 0.5L ? 1000 : 500;
      } else if (time_s >= 80 / 9.0L + 0.3L - small && time_s < 80 / 9.0L + 1 - small) {
        wanted = (double)(3000 * (time_s - 80 / 9.0L - 0.3L) / 0.7L);
        wanted = wanted > 0 ? wanted : 0;
      }
      if (fabs(asked_V - wanted) > 0.1) {
        fail_msg("%g Hz, sample %zu: %g, not %g", rates[k], i, asked_V, wanted);
      }
    }
    assert_true(asked_V == 0);
    assert_int_equal(i, (size_t)ceil((80 / 9.0 + 1) * rates[k] - 1e-6) + 1);
    dea_protocol_destroy(ctx, p);
  }
}

#define WATCHED                                                                                    \
  "dea-protocol: 1\n" PROTOCOL_AMPLIFIER                                                           \
  "safety: {ramp: 5 kV/s, trip_current: 1 mA, trip_time: 5 ms, voltage_error: 300 V}\n"            \
  "rate: 1 kHz\n"                                                                                  \
  "waveform: {kind: sine, amplitude: 2 kV, frequency: 2 Hz, cycles: 4}\n"                          \
  "channels:\n"                                                                                    \
  "  - {name: voltage, quantity: voltage, input: ai0, per_volt: 1 kV}\n"                           \
  "  - {name: current, quantity: current, input: ai1, per_volt: 1 mA}\n"

/* A slow ramp is one of the longest time that the protocol allows: 2 kV by 50 V/s in 1 s, not 40.
 */
static void test_longest_ramp(void **state)
{
  (void)state;
  struct dea_drive_output output;
  double asked_V[3000];
  struct dea_protocol *p =
      good_protocol(ctx, "dea-protocol: 1\n" PROTOCOL_AMPLIFIER
                         "safety: {ramp: 50 V/s, longest_ramp: 1 s}\nrate: 1 kHz\n"
                         "waveform: {kind: constant, voltage: 2 kV, duration: 2 s}\n");
  dea_drive_output_start(&output, p);
  assert_int_equal(dea_drive_output_next(&output, 500, asked_V), 500);
  dea_drive_output_ramp(&output);
  size_t n = dea_drive_output_next(&output, 3000, asked_V);
  assert_true(n >= 999 && n <= 1001 && asked_V[n - 1] == 0);
  for (size_t i = 0; i + 1 < n; i++) {
    assert_close(asked_V[i], 2000 - 2 * (double)(i + 1), 0, 1e-6);
  }
  dea_protocol_destroy(ctx, p);
}

/* From any sample on the ramp goes down by 5 V a sample, from either sign. */
static void test_ramp_from_any_sample(void **state)
{
  (void)state;
  struct dea_protocol *p = good_protocol(ctx, WATCHED);
  for (size_t from = 0; from <= 2000; from += 125) {
    struct dea_drive_output output;
    double asked_V[3000];
    dea_drive_output_start(&output, p);
    assert_int_equal(dea_drive_output_next(&output, from, asked_V), from);
    double last_V = from > 0 ? asked_V[from - 1] : 0;
    dea_drive_output_ramp(&output);
    size_t n = dea_drive_output_next(&output, 3000, asked_V);
    assert_int_equal(n, fmax(1, ceil(fabs(last_V) / 5 - 1e-9)));
    for (size_t i = 0; i < n; i++) {
      double left_V = fmax(0, fabs(last_V) - 5 * (double)(i + 1));
      assert_close(asked_V[i], copysign(left_V, last_V), 0, 1e-9);
    }
    assert_true(asked_V[n - 1] == 0 && output.over && output.played == from);
    assert_int_equal(dea_drive_output_next(&output, 1, asked_V), 0);
  }
  dea_protocol_destroy(ctx, p);
}

/* Feeds an amplifier that is `late` samples behind and `off` volts away; the sample that ends it,
 * -1 when none does. */
static long watch(const struct dea_protocol *p, double settle_s, long late, double off_V,
                  double current_A, long lasting)
{
  struct dea_drive_watch w;
  char why[DEA_WHY_ENDED_SIZE];
  dea_drive_watch_start(&w, p, settle_s);
  for (long i = 0; i < 1000; i++) {
    double asked_V = i / 100 % 2 == 0 ? 0 : 2000; // jumps every 100 samples
    double now_V = i < late ? 0 : (i - late) / 100 % 2 == 0 ? 0 : 2000;
    bool on = i >= 300 && i < 300 + lasting;
    double values[2] = {now_V + (on ? off_V : 0), on ? current_A : 0};
    if (!dea_drive_watch_sample(&w, asked_V, values, why)) {
      return i;
    }
  }
  return -1;
}

static void test_what_ends_a_measurement(void **state)
{
  (void)state;
  struct dea_protocol *p = good_protocol(ctx, WATCHED);
  // the amplifier may be late by what it needs to settle, and not by much more
  assert_int_equal(watch(p, 0.02, 20, 0, 0, 0), -1);
  assert_int_equal(watch(p, 0.002, 20, 0, 0, 0) > 100, true);
  // a limit is exceeded when it lasts
  assert_int_equal(watch(p, 0.002, 0, 0, 1.01e-3, 4), -1);
  assert_int_equal(watch(p, 0.002, 0, 0, 1.01e-3, 50), 304);
  assert_int_equal(watch(p, 0.002, 0, 0, -1.01e-3, 50), 304);
  assert_int_equal(watch(p, 0.002, 0, 0, 0.99e-3, 900), -1);
  // after a jump up only what is above is wrong at once; what is below, when it had time to settle
  assert_int_equal(watch(p, 0.002, 0, 301, 0, 50), 304);
  assert_int_equal(watch(p, 0.002, 0, 299, 0, 900), -1);
  assert_int_equal(watch(p, 0.002, 0, -301, 0, 4), -1);
  assert_true(watch(p, 0.002, 0, -301, 0, 50) > 304 && watch(p, 0.002, 0, -301, 0, 50) < 315);
  dea_protocol_destroy(ctx, p);
}

static void test_run_checks_first(void **state)
{
  (void)state;
  struct dea_drive_report report;
  const struct dea_drive_options options = {.file = in_folder("none.h5")};
  struct dea_protocol *p =
      good_protocol(ctx, "dea-protocol: 1\n" PROTOCOL_AMPLIFIER
                         "waveform: {kind: square, high: 16 kV, frequency: 1 Hz}\n");
  assert_int_equal(dea_drive_run(ctx, p, &options, &report), DEA_E_INTERLOCK);
  dea_protocol_destroy(ctx, p);
  p = good_protocol(ctx, WATCHED);
  assert_int_equal(dea_drive_run(ctx, p, &options, &report), DEA_E_INSTRUMENT);
  assert_non_null(strstr(dea_context_message(ctx), "names no instruments"));
  assert_false(there("none.h5"));
  dea_protocol_destroy(ctx, p);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_corners_fall_on_samples),
      cmocka_unit_test(test_ramp_from_any_sample),
      cmocka_unit_test(test_longest_ramp),
      cmocka_unit_test(test_what_ends_a_measurement),
      cmocka_unit_test(test_run_checks_first),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}

/* lab/drive/leak_watch: a leakage current is compared with its base line. Films are imitated:
 * charging current, a leak, noise, and what a healthy bench shows besides. */
// ctest: quick, heavy
#include "drive/drive_watch.h"
#include "protocol_text.h"

#include <math.h>

#define BENCH                                                                                      \
  "dea-protocol: 1\n" PROTOCOL_AMPLIFIER                                                           \
  "safety: {trip_current: 1 mA, trip_time: 10 ms, voltage_error: 300 V}\n"                         \
  "rate: 100 Hz\n"                                                                                 \
  "channels:\n"                                                                                    \
  "  - {name: voltage, quantity: voltage, input: ai0, per_volt: 1 kV}\n"                           \
  "  - {name: current, quantity: current, input: ai1, per_volt: 1 mA}\n"
#define SQUARE BENCH "waveform: {kind: square, high: 2 kV, frequency: 0.5 Hz, cycles: 1000000}\n"
#define SINE BENCH "waveform: {kind: sine, amplitude: 2 kV, frequency: 5 Hz, cycles: 1000000}\n"
#define SLOW                                                                                       \
  BENCH "waveform: {kind: triangle, low: 0 V, high: 2 kV, frequency: 0.002 Hz, cycles: 10000}\n"
#define PULSES                                                                                     \
  BENCH "waveform: {kind: square, high: 2 kV, frequency: 0.05 Hz, duty: 5 %, cycles: 100000}\n"
#define STAYS BENCH "waveform: {kind: constant, voltage: -2 kV, duration: 1000000 s}\n"

/* A film; currents in uA at 2 kV, times in s. */
struct film {
  double capacitance_F, leak_uA, noise_uA;
  double grows_per_s;           // exponent of its leak
  double step_s, lasts_s, step; // from when on and for how long the leak is `step` times itself
  double power;                 // of the voltage, 1: ohmic
};

struct noise {
  unsigned long long state;
};

/* Sum of uniform numbers: nearly normal, of variance 1. */
static double noise_next(struct noise *noise)
{
  double sum = -6;
  for (int i = 0; i < 12; i++) {
    noise->state = noise->state * 6364136223846793005ULL + 1442695040888963407ULL;
    sum += (double)(noise->state >> 11) / 9007199254740992.0;
  }
  return sum;
}

struct outcome {
  double end_s, learned_s, drifted_s, scattered_s; // when; NAN: never
  double value_A, limit_A;                         // at the end
};

static struct outcome play(const char *text, const struct film *film, double until_s)
{
  static struct dea_leak_watch watch;
  good_protocol(text);
  struct outcome out = {NAN, NAN, NAN, NAN, NAN, NAN};
  struct noise noise = {7};
  double rate_Hz = p->rate_Hz.si, before_V = 0;
  dea_leak_watch_start(&watch, p);
  for (double i = 0; i < until_s * rate_Hz && isnan(out.end_s); i++) {
    double time_s = i / rate_Hz, asked_V = dea_protocol_value(p, time_s);
    double leak = film->leak_uA * exp(film->grows_per_s * time_s);
    leak *= time_s >= film->step_s && time_s < film->step_s + film->lasts_s ? film->step : 1;
    double current_uA = copysign(leak * pow(fabs(asked_V) / 2000, film->power), asked_V);
    bool jump = fabs(asked_V - before_V) > 1000; // which a sample shows as all that there is
    current_uA += jump ? copysign(10e3, asked_V - before_V)
                       : 1e6 * film->capacitance_F * (asked_V - before_V) * rate_Hz;
    current_uA += film->noise_uA * noise_next(&noise);
    before_V = asked_V;
    switch (dea_leak_watch_sample(&watch, time_s, asked_V, 1e-6 * current_uA)) {
    case DEA_LEAK_LEARNED:
      out.learned_s = isnan(out.learned_s) ? time_s : out.learned_s;
      break;
    case DEA_LEAK_DRIFTED:
      assert_true(isnan(out.drifted_s)); // said once
      out.drifted_s = time_s;
      break;
    case DEA_LEAK_SCATTER:
      out.scattered_s = time_s;
      break;
    case DEA_LEAK_ROSE:
      out.end_s = time_s;
      out.value_A = watch.value_A;
      out.limit_A = watch.limit_A;
      break;
    case DEA_LEAK_NOTHING:
      break;
    }
  }
  return out;
}

static const struct {
  const char *name, *text;
  double until_s, learned_s; // by when a base line is there at the latest
} waves[] = {{"square", SQUARE, 1000, 30},
             {"sine", SINE, 300, 40},
             {"triangle", SLOW, 8000, 4600},
             {"pulses", PULSES, 2000, 300},
             {"constant", STAYS, 600, 95}};
enum { WAVES = sizeof waves / sizeof waves[0] };
static const struct film healthy = {100e-12, 50, 3, 0, 1e9, 0, 1, 3};

/* What is learned, in numbers: the lower quartile of 10 to 20 uA, and the median 3 of what their
 * differences (2, -1, 4, -2, 7, -6, 2) are away from their median, 2. */
TEST(test_what_is_learned)
{
  static const double visits_uA[] = {10, 12, 11, 15, 13, 20, 14, 16, 16};
  static struct dea_leak_watch watch;
  good_protocol(STAYS);
  size_t learned = 0;
  dea_leak_watch_start(&watch, p);
  for (int i = 0; i < 8100; i++) { // -2 kV; sections of 10 s
    enum dea_leak_event event =
        dea_leak_watch_sample(&watch, 0.01 * i, -2000, -1e-6 * visits_uA[i / 1000]);
    assert_true(event == DEA_LEAK_NOTHING || event == DEA_LEAK_LEARNED);
    if (event == DEA_LEAK_LEARNED) {
      learned++; // one of some 97 values of a section lies across its end: 1 % of 7 uA
      assert_close(0.01 * i, 80, 0, 0.2);
      assert_close(watch.value_A, 11.5e-6, 2e-3, 0);
      assert_close(watch.parts[0].scatter_A, 1.4826 * 3e-6 / sqrt(2), 0.03, 0);
      assert_close(watch.limit_A, 11.5e-6 + 6 * 1.4826 * 3e-6 / sqrt(2), 0.03, 0);
    }
  }
  assert_int_equal(learned, 1);
}

/* Charging, spikes at jumps, noise, and a slow rise by half: no fault. */
TEST(test_healthy_films)
{
  for (size_t w = 0; w < WAVES; w++) {
    for (int k = 0; k < 3; k++) {
      struct film film = healthy;
      film.capacitance_F = k == 1 ? 5e-9 : film.capacitance_F; // 314 uA of the sine
      film.noise_uA = k == 1 ? 0 : film.noise_uA;
      film.leak_uA = k == 2 ? 0.02 : film.leak_uA;
      film.grows_per_s = log(1.5) / waves[w].until_s;
      struct outcome out = play(waves[w].text, &film, waves[w].until_s);
      if (!isnan(out.end_s) || !(out.learned_s <= waves[w].learned_s) || !isnan(out.scattered_s)) {
        fail_msg("%s %d: ended at %g s, learned at %g s, scatter at %g s", waves[w].name, k,
                 out.end_s, out.learned_s, out.scattered_s);
      }
    }
  }
}

/* Three times as much, for good: found within leak_time of 5 s under voltage, at least in the parts
 * of a cycle where it is seen; for a second under voltage it is nothing. */
TEST(test_step)
{
  static const double within_s[WAVES] = {15, 15, 700, 160, 10}; // of the clock
  static const double short_s[WAVES] = {2, 2, 4, 20, 2};
  for (size_t w = 0; w < WAVES; w++) {
    struct film film = healthy;
    film.step = 3;
    film.step_s = 0.7 * waves[w].until_s;
    film.lasts_s = 1e9;
    struct outcome out = play(waves[w].text, &film, waves[w].until_s);
    if (!(out.end_s >= film.step_s + 4.5 && out.end_s <= film.step_s + within_s[w])) {
      fail_msg("%s: from %g s on, ended at %g s", waves[w].name, film.step_s, out.end_s);
    }
    assert_true(out.value_A > out.limit_A && out.limit_A < 150e-6);
    film.lasts_s = short_s[w];
    assert_true(isnan(play(waves[w].text, &film, waves[w].until_s).end_s));
  }
}

/* Doubling every 40 cycles: the base line follows a little, and is left behind. */
TEST(test_leak_that_grows)
{
  struct film film = healthy;
  film.grows_per_s = log(2) / 80;
  struct outcome out = play(SQUARE, &film, 1000);
  assert_true(out.end_s > 80 && out.end_s < 230);
  assert_true(out.value_A < 5 * 50e-6);
}

/* Ever so slowly: ageing is followed to twice the first base line, and ends at twice that, far
 * below the fixed limit; whoever grows more slowly is found at the same current. */
TEST(test_drift_hides_no_fault)
{
  for (int k = 1; k <= 4; k *= 2) {
    struct film film = healthy;
    film.grows_per_s = log(2) / (2000 * k); // a thousand cycles and more
    struct outcome out = play(SQUARE, &film, 12000 * k);
    assert_true(out.drifted_s < out.end_s);
    if (!(out.value_A > 3.2 * 50e-6 && out.value_A < 4.6 * 50e-6)) {
      fail_msg("drifted at %g s, ended at %g s with %g uA", out.drifted_s, out.end_s,
               1e6 * out.value_A);
    }
  }
}

/* A film that fails while the base line is learned, one that leaks half of what is allowed at all,
 * and one whose current is nothing but noise. */
TEST(test_learning_on_a_bad_film)
{
  struct film film = healthy;
  film.grows_per_s = log(6) / 16; // six times as much after the first eight cycles
  struct outcome out = play(SQUARE, &film, 100);
  assert_true(out.end_s > 15 && out.end_s < 35);
  film.grows_per_s = 0;
  film.leak_uA = 600;
  out = play(SQUARE, &film, 200);
  assert_true(isnan(out.end_s) && out.scattered_s < 30);
  film.leak_uA = 50;
  film.noise_uA = 3000;
  out = play(SQUARE, &film, 400);
  assert_true(isnan(out.end_s) && out.scattered_s < 60);
  // a film that is conditioned leaks less and less: the base line follows, and so does its limit
  film = healthy;
  film.leak_uA = 200;
  film.grows_per_s = -log(4) / 400;
  film.step_s = 600;
  film.lasts_s = 1e9;
  film.step = 4;
  out = play(SQUARE, &film, 1000);
  assert_true(out.end_s > 600 && out.end_s < 620);
}

/* What does not repeat has no base line, and charging it is no fault. */
TEST(test_what_does_not_repeat)
{
  static const char ramp[] =
      BENCH "sequence:\n"
            "  - {waveform: {kind: ramp, to: 2 kV, duration: 100 s}}\n"
            "  - {waveform: {kind: square, high: 2 kV, frequency: 0.5 Hz, cycles: 5}}\n"
            "  - {waveform: {kind: square, high: 2 kV, frequency: 0.5 Hz, cycles: 50}}\n";
  struct film film = healthy;
  film.capacitance_F = 1e-6; // 20 uA
  struct outcome out = play(ramp, &film, 220);
  assert_true(isnan(out.end_s) && out.learned_s > 110 + 16 && out.learned_s < 110 + 30);
  good_protocol(ramp);
  struct dea_protocol_plan plan;
  assert_true(isnan(dea_protocol_period_s(&p->steps[0])));
  assert_close(dea_protocol_period_s(&p->steps[1]), 2, 1e-12, 0);
  assert_true(isinf(dea_protocol_learning_s(&p->steps[1])));
  assert_close(dea_protocol_learning_s(&p->steps[2]), 18, 1e-12, 0);
  assert_int_equal(dea_protocol_check(ctx, p, &plan), DEA_OK);
  assert_non_null(find_finding(ctx, DEA_NOTE, "has no base line in 2 of 3 steps (step 1)"));
}

/* The paper's staircase of 15 cycles at each voltage: each has its base line, and the next voltage,
 * at which more leaks, is no rise; ten times as much in the middle of the last ones is. */
TEST(test_staircase)
{
  static const char stairs[] =
      BENCH "waveform: {kind: staircase, values: [0.5 kV, 1 kV, 2 kV], frequency: 0.5 Hz, cycles: "
            "15}\n";
  struct film film = healthy;
  struct outcome out = play(stairs, &film, 90);
  assert_true(isnan(out.end_s) && out.learned_s < 20);
  film.step_s = 78;
  film.lasts_s = 1e9;
  film.step = 10;
  out = play(stairs, &film, 100);
  assert_true(out.end_s > 82 && out.end_s < 90);
  good_protocol(stairs);
  assert_close(dea_protocol_period_s(&p->steps[0]), 2, 1e-12, 0);
  assert_close(dea_protocol_learning_s(&p->steps[0]), 18, 1e-12, 0);
  good_protocol(BENCH "waveform: {kind: staircase, values: [1 kV, 2 kV], frequency: 0.5 Hz, "
                      "cycles: 9}\n");
  assert_true(isinf(dea_protocol_learning_s(&p->steps[0]))); // 18 s at each
}

/* The watch of a drive: what it notices, and that the fixed limit holds before and after. */
TEST(test_fixed_limit_stays)
{
  static struct dea_drive_watch w;
  good_protocol(SQUARE);
  for (int k = 0; k < 2; k++) {
    char why[DEA_WHY_ENDED_SIZE] = "";
    size_t events = 0, i = 0, from = k == 0 ? 500 : 6000;
    dea_drive_watch_start(&w, p, 0.02, 0);
    for (bool good = true; good; i++) {
      double asked_V = dea_protocol_value(p, (double)i / 100), base_A = asked_V > 0 ? 300e-6 : 0;
      double values[2] = {asked_V, i >= from ? 1.01e-3 : base_A};
      good = dea_drive_watch_sample(&w, asked_V, values, why);
      for (size_t e = 0; e < w.event_count; e++) {
        assert_true(w.events[e].kind == DEA_NOTICED_LEARNED && w.events[e].channel == 1);
        events++;
      }
    }
    assert_int_equal(i, from + 1); // trip_time of 10 ms is a sample
    assert_non_null(strstr(why, "safety.trip_current"));
    assert_int_equal(events, k);
  }
}

/* Two weeks of a life test of a slow triangle, a sample a tenth of a second: an ageing film is none
 * that fails, and one that begins to in the last week is found on that day. */
TEST(test_weeks)
{
  static const char life[] =
      "dea-protocol: 1\n" PROTOCOL_AMPLIFIER "safety: {trip_current: 1 mA, trip_time: 0.1 s}\n"
      "rate: 10 Hz\n"
      "channels: [{name: current, quantity: current, input: ai0, per_volt: 1 mA}]\n"
      "waveform: {kind: triangle, low: 0 V, high: 2 kV, frequency: 0.1 Hz, cycles: 604800}\n";
  static const double week_s = 604800;
  struct film film = {100e-12, 20, 2, log(1.6) / (2 * week_s), 1e9, 0, 1, 2};
  film.step_s = 1.9 * week_s;
  film.lasts_s = 1e9;
  film.step = 5;
  struct outcome out = play(life, &film, 2 * week_s);
  if (!(out.learned_s < 1000 && out.end_s > film.step_s && out.end_s < film.step_s + 120)) {
    fail_msg("learned at %g s, ended at %g s", out.learned_s, out.end_s);
  }
}

TESTS(set_up, protocol_tear_down)

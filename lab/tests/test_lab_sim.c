/* The simulated bench: without noise what the model says, with noise what was asked for. */
// ctest: quick, heavy
#include "failing_allocator.h"
#include "instrument/instrument.h"
#include "instrument/sim_bench.h"
#include "protocol_text.h"
#include "study/design_file.h"
#include "study/study.h"

#include <math.h>

#define CHANNELS                                                                                   \
  "channels:\n"                                                                                    \
  "  - {name: V, quantity: voltage, input: ai0, per_volt: 1 kV}\n"                                 \
  "  - {name: I, quantity: current, input: ai1, per_volt: 1 mA}\n"                                 \
  "  - {name: z, quantity: displacement, input: ai2, per_volt: -1 mm, at_zero: 2 mm}\n"            \
  "  - {name: F, quantity: force, input: ai3, per_volt: 0.5 N}\n"
#define HEAD                                                                                       \
  "dea-protocol: 1\n"                                                                              \
  "design: design.yaml\n"                                                                          \
  "safety: {largest_field: 400 V/um}\n" CHANNELS
#define WAVE "{kind: square, high: 5 kV, frequency: 5 Hz, cycles: 3, duty: 60 %}"
#define QUIET                                                                                      \
  "voltage_noise: 0 V, current_noise: 0 A, displacement_noise: 0 m, force_noise: 0 N, "            \
  "profile_noise: 0 m, outliers: 0 %, missing: 0 %, tilt: 0 degree"
#define IDEAL "amplifier: {gain: 1000, max_voltage: 10 kV}\n"
/* A viscous film, so that there is something to follow. */
#define VISCOUS_DESIGN                                                                             \
  "dea: 1\n"                                                                                       \
  "film: {material: elastosil-2030, thickness: 100 um}\n"                                          \
  "pre_stretch: 1.5\nframe: {inner_diameter: 30 mm}\n"                                             \
  "electrodes: {diameter: 5 mm unstretched}\nfibres: {count: 4, material: pet}\n"                  \
  "compute: {transient: {tolerance: 1e-7, longest_step: 0.2 ms, interval: 0.01 ms}}\n"

/* What came from a bench. */
struct record {
  size_t inputs, samples, frames, points, lost;
  double *volts; // [samples][inputs]
  double *z_m, *frame_s, *x_m;
};

static dea_status take_samples(void *user, const double *volts, size_t count)
{
  struct record *r = user;
  memcpy(r->volts + r->samples * r->inputs, volts, count * r->inputs * sizeof *volts);
  r->samples += count;
  return DEA_OK;
}

static dea_status take_profile(void *user, double time_s, const double *z_m)
{
  struct record *r = user;
  r->frame_s[r->frames] = time_s;
  memcpy(r->z_m + r->frames++ * r->points, z_m, r->points * sizeof *z_m);
  return DEA_OK;
}

static void free_record(struct record *r)
{
  free(r->volts);
  free(r->z_m);
  free(r->frame_s);
  free(r->x_m);
}

/* Plays a protocol to its end, `block` samples at a time. */
static dea_status play(struct dea_context *context, const struct dea_protocol *protocol,
                       size_t block, struct record *r)
{
  struct dea_instrument *bench;
  size_t count = (size_t)ceil(dea_protocol_duration_s(protocol) * protocol->rate_Hz.si);
  const struct dea_sink sink = {r, take_samples, take_profile, NULL};
  *r = (struct record){.inputs = protocol->input_count};
  dea_status status = dea_instrument_open(context, &protocol->sim, protocol, &bench);
  if (status != DEA_OK) {
    return status;
  }
  r->points = bench->profile_points;
  r->volts = malloc(count * protocol->input_count * sizeof(double) + 1);
  r->z_m = malloc((count * r->points + 1) * sizeof(double));
  r->frame_s = malloc((count + 1) * sizeof(double));
  r->x_m = malloc((r->points + 1) * sizeof(double));
  memcpy(r->x_m, bench->x_m, r->points * sizeof(double));
  status = bench->type->start(context, bench);
  for (size_t i = 0; status == DEA_OK && i < count; i += block) {
    double volts[4096];
    size_t now = count - i < block ? count - i : block;
    for (size_t k = 0; k < now; k++) {
      volts[k] = dea_protocol_value(protocol, (double)(i + k) / protocol->rate_Hz.si) /
                 protocol->amplifier.gain.si;
    }
    status = bench->type->put(context, bench, volts, now);
    status = status == DEA_OK ? bench->type->get(context, bench, 0.1, &sink) : status;
  }
  r->lost = bench->lost;
  bench->type->stop(context, bench);
  bench->type->close(context, bench);
  return status;
}

static void bench_protocol(const char *text)
{
  write_in_folder("design.yaml", VISCOUS_DESIGN);
  write_in_folder("protocol.yaml", text);
  dea_finding_clear(ctx);
  if (protocol_read(in_folder("protocol.yaml"), NULL, 0) != DEA_OK) {
    print_findings(ctx);
    fail_msg("%s", text);
  }
}

static struct record r; // that was played last

static void played(size_t block)
{
  free_record(&r);
  if (play(ctx, p, block, &r) != DEA_OK) {
    print_findings(ctx);
    fail_msg("%s", dea_context_message(ctx));
  }
}

/* Value of an input at a sample, as the protocol says. */
static double value(size_t sample, size_t input)
{
  return r.volts[sample * r.inputs + input] * p->inputs[input].per_volt + p->inputs[input].at_zero;
}

/* Half a step of the converter, in the quantity. */
static double half_step(size_t input)
{
  return 0.5 * fabs(p->inputs[input].per_volt) * 2 * p->inputs[input].range_V.si / 65536;
}

/* The same waveform by the study of what happens in time, which steps on its own. */
struct study {
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
  const struct dea_curve *curve;
};

static void study(struct study *out)
{
  static const char *const names[] = {"transient"};
  const struct dea_override sets[] = {{"drive.waveform", WAVE}, {"compute.models", "[lumped]"}};
  assert_int_equal(dea_design_read(ctx, in_folder("design.yaml"), sets, 2, &out->design), DEA_OK);
  assert_int_equal(dea_device_build(ctx, out->design, &out->device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, out->design, out->device, &out->result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, dea_model_find("lumped"), names, 1, out->result), DEA_OK);
  out->curve = dea_result_find(out->result, "lumped", "transient");
  assert_non_null(out->curve);
}

/* The point at a time, before a jump that is there. */
static struct dea_load_point point_at(const struct dea_curve *curve, double time_s)
{
  size_t k = 0;
  while (k + 1 < curve->count && curve->points[k].time_s < time_s - 1e-9) {
    k++;
  }
  struct dea_load_point point = curve->points[k];
  if (k > 0 && point.time_s > time_s + 1e-9) {
    const struct dea_load_point *a = &curve->points[k - 1];
    double share = (time_s - a->time_s) / (point.time_s - a->time_s);
    point.voltage_V = a->voltage_V + share * (point.voltage_V - a->voltage_V);
    point.centre_z_m = a->centre_z_m + share * (point.centre_z_m - a->centre_z_m);
    point.force_N = a->force_N + share * (point.force_N - a->force_N);
    point.charge_C = a->charge_C + share * (point.charge_C - a->charge_C);
  }
  return point;
}

TEST(test_truth_is_the_model)
{
  bench_protocol(HEAD IDEAL "waveform: " WAVE "\nsim: {" QUIET ", profile_points: 0}\n");
  played(100);
  assert_int_equal(r.samples, 600);
  struct study model;
  study(&model);
  double charge_C = 0;
  for (size_t i = 0; i < r.samples; i++) {
    const struct dea_load_point point = point_at(model.curve, (double)i / 1000);
    charge_C += value(i, 1) * 1e-3;
    assert_close(value(i, 0), point.voltage_V, 0, half_step(0) * 1.001);
    assert_close(value(i, 2), point.centre_z_m, 5e-6, half_step(2) * 1.001);
    assert_close(value(i, 3), point.force_N, 2e-5, half_step(3) * 1.001);
    assert_close(charge_C, point.charge_C, 1e-5, (double)(i + 1) * half_step(1) * 1e-3);
  }
  assert_true(point_at(model.curve, 0.05).centre_z_m > 1e-3); // it did move
  dea_result_destroy(ctx, model.result);
  dea_device_destroy(ctx, model.device);
  dea_design_destroy(ctx, model.design);
}

/* What is true at the first samples of a protocol: a bench of its own plays it. */
static void play_truth(size_t count, struct dea_sim_state *truth)
{
  const struct dea_sim_settings settings = {.model = "lumped",
                                            .breakdown_V = (double)NAN,
                                            .breakdown_s = (double)NAN,
                                            .fatigue_s = (double)NAN};
  struct dea_sim_bench *bench;
  assert_int_equal(dea_sim_bench_create(ctx, p, &settings, &bench), DEA_OK);
  for (size_t i = 0; i < count; i++) {
    double asked_V = dea_protocol_value(p, (double)i / p->rate_Hz.si);
    assert_int_equal(dea_sim_bench_sample(bench, asked_V / p->amplifier.gain.si, &truth[i]),
                     DEA_OK);
  }
  dea_sim_bench_destroy(ctx, bench);
}

/* Mean and standard deviation of what an input says beyond the truth. */
static void statistics(const struct dea_sim_state *truth, size_t input, double out[2])
{
  double sum = 0, square = 0, n = (double)r.samples;
  for (size_t i = 0; i < r.samples; i++) {
    const double due[4] = {truth[i].output_V, truth[i].current_A, truth[i].centre_z_m,
                           truth[i].force_N};
    double error = value(i, input) - due[input];
    sum += error;
    square += error * error;
  }
  out[0] = sum / n;
  out[1] = sqrt(square / n - out[0] * out[0]);
}

#define LONG_WAVE "{kind: constant, voltage: 3 kV, duration: 10 s}"

TEST(test_noise_is_what_was_asked)
{
  static const double sigma[4] = {20, 2e-6, 5e-6, 1e-3};
  bench_protocol(HEAD IDEAL "waveform: " LONG_WAVE
                            "\nsim: {voltage_noise: 20 V, current_noise: 2 uA, "
                            "displacement_noise: 5 um, force_noise: 1 mN, profile_noise: 3 um, "
                            "outliers: 2 %, missing: 3 %, tilt: 0.5 degree, profile_points: 200, "
                            "frame_rate: 10 Hz, displacement_drift: 1 um/s, force_offset: 3 mN}\n");
  played(1000);
  size_t n = r.samples;
  assert_int_equal(n, 10000);
  struct dea_sim_state *truth = malloc(n * sizeof *truth);
  play_truth(n, truth);
  assert_true(truth[0].output_V == 0 && truth[1].output_V == 3000 && truth[9].time_s == 0.009);
  for (size_t k = 0; k < 4; k++) {
    double found[2], step = 2 * half_step(k), drift = k == 2 ? 10e-6 / sqrt(12) : 0;
    double due = sqrt(sigma[k] * sigma[k] + step * step / 12 + drift * drift);
    statistics(truth, k, found);
    assert_close(found[1], due, 0.03, 0); // of 10000 samples: 0.7 % is one sigma
    double mean = k == 2 ? 5e-6 : k == 3 ? 3e-3 : 0;
    assert_close(found[0], mean, 0, 4 * sigma[k] / 100);
  }
  // The profile: line of the tilt, cone, frame.
  size_t missing = 0, outliers = 0, frames = r.frames;
  double square = 0, good = 0;
  assert_int_equal(frames, 100);
  for (size_t f = 0; f < frames; f++) {
    const struct dea_sim_state *s = &truth[(size_t)lround(r.frame_s[f] * 1000)];
    for (size_t i = 0; i < r.points; i++) {
      double x = r.x_m[i], radius = fabs(x);
      double film = radius >= 0.015 ? 2e-3
                    : radius > 0.00375
                        ? s->fibre_tip_z_m * (0.015 - radius) / (0.015 - 0.00375)
                        : s->centre_z_m + (s->fibre_tip_z_m - s->centre_z_m) * radius / 0.00375;
      double due = film + x * tan(0.5 * 3.14159265358979 / 180) + 1e-6 * r.frame_s[f];
      double error = r.z_m[f * r.points + i] - due;
      missing += isnan(error) ? 1U : 0U;
      outliers += fabs(error) > 15e-6 ? 1U : 0U;
      if (fabs(error) <= 15e-6) {
        square += error * error;
        good++;
      }
    }
  }
  assert_close(sqrt(square / good), 3e-6, 0.03, 0);
  assert_close((double)missing / (double)(frames * r.points), 0.03, 0.1, 0);
  assert_close((double)outliers / (double)(frames * r.points), 0.02 * 0.97, 0.15, 0);
  free(truth);
}

/* One seed gives one recording, however it is read; another seed another one. */
TEST(test_seeds)
{
  static const char *const texts[3] = {HEAD IDEAL "waveform: " WAVE "\nsim: {seed: 7, lost: 5 %}\n",
                                       HEAD IDEAL "waveform: " WAVE "\nsim: {seed: 7, lost: 5 %}\n",
                                       HEAD IDEAL "waveform: " WAVE
                                                  "\nsim: {seed: 8, lost: 5 %}\n"};
  struct record all[3];
  for (int k = 0; k < 3; k++) {
    bench_protocol(texts[k]);
    assert_int_equal(play(ctx, p, k == 1 ? 37 : 600, &all[k]), DEA_OK);
  }
  size_t lost = 0, same = 0;
  assert_true(all[0].samples == 600 && all[1].samples == 600);
  assert_int_equal(memcmp(all[0].volts, all[1].volts, 600 * 4 * sizeof(double)), 0);
  assert_int_equal(memcmp(all[0].z_m, all[1].z_m, all[0].frames * all[0].points * sizeof(double)),
                   0);
  for (size_t i = 0; i < 600; i++) {
    lost += isnan(all[0].volts[4 * i]) ? 1U : 0U;
    same += all[0].volts[4 * i + 2] == all[2].volts[4 * i + 2] ? 1U : 0U;
  }
  assert_int_equal(lost, all[0].lost);
  assert_true(lost > 10 && lost < 60 && same < 60);
  for (int k = 0; k < 3; k++) {
    free_record(&all[k]);
  }
}

/* A jump of the amplifier takes as long as its limits say. */
TEST(test_limits)
{
  bench_protocol(HEAD
                 "amplifier: {gain: 1000, max_voltage: 10 kV, slew_limit: 1 V/us}\nrate: 100 kHz\n"
                 "waveform: {kind: constant, voltage: 4 kV, duration: 6 ms}\n"
                 "sim: {" QUIET ", profile_points: 0}\n");
  played(600);
  for (size_t i = 0; i < r.samples; i++) { // 10 us a sample: 10 V
    assert_close(value(i, 0), fmin(10 * (double)i, 4000), 0, 2 * half_step(0));
  }
  bench_protocol(
      HEAD "amplifier: {gain: 1000, max_voltage: 10 kV, current_limit: 20 uA}\nrate: 100 kHz\n"
           "waveform: {kind: constant, voltage: 4 kV, duration: 12 ms}\n"
           "sim: {" QUIET ", profile_points: 0}\n");
  played(1200);
  double charge_C = 0;
  for (size_t i = 0; i < r.samples; i++) {
    charge_C += value(i, 1) * 1e-5;
    assert_true(value(i, 1) <= 20e-6 + 2 * half_step(1));
    assert_true(value(i, 0) <= 4000 + half_step(0));
  }
  // some 30 pF at 4 kV: 0.13 uC, which 20 uA bring in 6 ms
  assert_true(value(300, 0) < 3900 && value(r.samples - 1, 0) > 3990);
  assert_close(charge_C, 32.5e-12 * 4000, 0.03, 0);
}

/* From its breakdown voltage on the film is a short circuit; discharges bring their charge. */
TEST(test_breakdown_and_discharges)
{
  bench_protocol(HEAD "amplifier: {gain: 1000, max_voltage: 10 kV, current_limit: 5 mA}\n"
                      "waveform: {kind: ramp, to: 5 kV, duration: 1 s}\n"
                      "sim: {" QUIET ", breakdown_voltage: 3 kV, profile_points: 0}\n");
  played(1000);
  assert_true(value(590, 0) > 2900 && value(590, 1) < 1e-6);
  assert_true(value(610, 0) < 100 && value(610, 1) > 4.9e-3);
  assert_close(value(999, 2), 0, 0, half_step(2) * 1.01);
  bench_protocol(HEAD IDEAL "waveform: " LONG_WAVE "\nsim: {" QUIET
                            ", discharge_rate: 10 Hz, discharge_voltage: 2 kV, "
                            "discharge_charge: 40 nC, profile_points: 0}\n");
  played(1000);
  size_t spikes = 0;
  for (size_t i = 10; i < r.samples; i++) {
    spikes += value(i, 1) > 35e-6 ? 1U : 0U;
  }
  assert_true(spikes > 70 && spikes < 130); // 100 in 10 s
}

/* Some minutes of a life test by ten samples a second: each is a jump of 50 V, which the
 * amplifier's current charges in some 100 ns, and a film that stays whole; one that lives for 1000
 * s under voltage does not.
 */
TEST(test_slow_wave)
{
#define LIFE(end)                                                                                  \
  HEAD "amplifier: {gain: 1000, max_voltage: 10 kV, current_limit: 10 mA}\nrate: 10 Hz\n"          \
       "waveform: {kind: triangle, high: 2.5 kV, low: 0 V, frequency: 0.1 Hz, cycles: 60}\n"       \
       "sim: {" QUIET ", profile_points: 0" end "}\n"
  static const char *const lives[] = {LIFE(""), LIFE(", breakdown_time: 200 s")};
  for (int k = 0; k < 2; k++) {
    bench_protocol(lives[k]);
    size_t whole = 0;
    played(1000);
    while (whole < r.samples && value(whole, 1) < 1e-4) {
      whole++;
    }
    assert_true(k == 0 ? whole == 6000 : whole > 2000 && whole < 2050);
  }
}

/* In real time it takes as long as the protocol. */
TEST(test_real_pace)
{
  bench_protocol(HEAD IDEAL "waveform: {kind: constant, voltage: 1 kV, "
                            "duration: 50 ms}\nsim: {pace: real}\n");
  struct dea_instrument *bench;
  struct record own = {.inputs = 4, .points = 320};
  static double volts[50], capacity[50 * 4 + 4], z_m[320 * 50], frame_s[50];
  own.volts = capacity;
  own.z_m = z_m;
  own.frame_s = frame_s;
  const struct dea_sink sink = {&own, take_samples, take_profile, NULL};
  assert_int_equal(dea_instrument_open(ctx, &p->sim, p, &bench), DEA_OK);
  assert_int_equal(bench->type->start(ctx, bench), DEA_OK);
  assert_int_equal(bench->type->put(ctx, bench, volts, 50), DEA_OK);
  size_t calls = 0;
  while (own.samples < 50 && calls < 1000) {
    assert_int_equal(bench->type->get(ctx, bench, 0.02, &sink), DEA_OK);
    calls++;
  }
  assert_true(own.samples == 50 && calls > 1);
  assert_int_equal(bench->type->get(ctx, bench, 0.001, &sink), DEA_OK); // nothing is left
  assert_int_equal(own.samples, 50);
  bench->type->stop(ctx, bench);
  bench->type->close(ctx, bench);
}

TEST(test_errors)
{
  static const struct {
    const char *text, *part;
    size_t line;
  } wrong[] = {
      {HEAD IDEAL "waveform: " WAVE "\nsim: {model: lumpd}\n", "did you mean 'lumped'", 11},
      {HEAD IDEAL "waveform: " WAVE "\nsim: {model: axisymmetric}\n",
       "model 'axisymmetric' does not support transients", 11},
      {HEAD IDEAL "waveform: " WAVE "\nsim: {voltage_nois: 3 V}\n", "did you mean 'voltage_noise'",
       11},
      {"dea-protocol: 1\n" IDEAL "waveform: " WAVE "\nsim: {kind: sim}\n", "needs a film", 4},
  };
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    bench_protocol(wrong[i].text);
    struct dea_instrument *bench;
    assert_int_equal(dea_instrument_open(ctx, &p->sim, p, &bench), DEA_E_DESIGN);
    assert_null(bench);
    const struct dea_finding *f = find_error(ctx, wrong[i].part);
    if (f == NULL || f->location.line != wrong[i].line) {
      print_findings(ctx);
      fail_msg("no '%s'", wrong[i].part);
    }
  }
}

static dea_status play_short(struct dea_context *context)
{
  struct dea_protocol *own;
  struct record short_one = {0};
  dea_status status =
      dea_protocol_read(context, &dea_film_of_design, in_folder("protocol.yaml"), NULL, 0, &own);
  status = status == DEA_OK ? play(context, own, 10, &short_one) : status;
  dea_protocol_destroy(context, own);
  free_record(&short_one);
  return status;
}

TEST(test_memory)
{
  bench_protocol(HEAD IDEAL "waveform: {kind: constant, voltage: 1 kV, "
                            "duration: 30 ms}\n");
  assert_true(failing_ends(play_short, DEA_OK) > 10); // there was something to fail
}

static int record_tear_down(void **state)
{
  free_record(&r);
  return protocol_tear_down(state);
}

TESTS(set_up, record_tear_down)

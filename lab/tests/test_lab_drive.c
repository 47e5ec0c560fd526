/* lab/drive/drive: what is played and recorded is the protocol; whatever fails, the output
 * comes down to 0 V within the ramp, every instrument is stopped once, and the recording is
 * readable. */
// ctest: slow, heavy
#include "base/clock.h"
#include "drive/drive_loop.h"
#include "failing_allocator.h"
#include "protocol_text.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>

/* A clock on which more time passes with every look at it. */
static atomic_long hurries_ns, hurried_ns;

int clock_gettime(clockid_t clock, struct timespec *out)
{
  long result = syscall(SYS_clock_gettime, clock, out);
  long long ns = out->tv_nsec + (atomic_fetch_add(&hurried_ns, atomic_load(&hurries_ns)));
  out->tv_sec += (time_t)(ns / 1000000000);
  out->tv_nsec = (long)(ns % 1000000000);
  return (int)result;
}

// Instruments -------------------------------------------------------------------------------------

/* A DAQ without hardware, and a profile sensor on its clock. They keep what was asked of them, and
 * fail where they are told to. */

enum { FAKE_SAMPLES_MAX = 20000 };
static const double fake_gain = 1000, fake_frame_s = 0.02;

/* What the DAQ does; numbers count calls or samples from 0, negative: never. */
struct fake_script {
  long fail_start, fail_put, fail_get; // of these calls
  long interrupt_put;                  // a signal comes in this call
  long current_from, voltage_from;     // samples from which they are wrong
  long missing_from, missing_to;       // samples of all inputs that are lost
  long silent_from;                    // samples from which nothing comes any more
  long ahead_put;                      // inputs run ahead of the output after this call
  size_t at_a_time;                    // samples handed over by a call of get
  unsigned idle;                       // calls of get of which all but one bring nothing
  bool inputs;                         // it reads them
  long leak_from;                      // sample from which the current is 0.2 mA; 0: never
  void (*after_interrupt)(void); // in the next call, when the signal was heeded; NULL: nothing
  double start_s;                // that its start takes, and its first put
  long broken_from; // sample from which the film is a short circuit, beside current_from; 0: never
};
static const struct fake_script fake_good = {-1, -1, -1, -1,   -1, -1,   -1, -1, -1,
                                             -1, 37, 1,  true, 0,  NULL, 0,  0};

struct fake_daq {
  struct dea_instrument common;
  struct fake_script script;
  size_t inputs;
  double out[FAKE_SAMPLES_MAX];  // control voltages
  const struct fake_daq *player; // whose output its inputs show; NULL: its own
  size_t put, got, puts, gets, starts, stops;
  volatile sig_atomic_t *flag; // that a signal sets
  double begun_s, stopped_s;   // by the computer's clock
};

struct fake_sensor {
  struct dea_instrument common;
  const struct fake_daq *daq; // whose clock it has
  size_t frames, starts, stops;
  double value;                             // of its reading; NAN: none. 0: the usual one
  long fail_start, fail_frame, wrong_frame; // frames at which it fails, or has no time
  double x_m[3];
};

static dea_status fake_fail(struct dea_context *context, const char *what)
{
  return dea_fail(context, DEA_E_INSTRUMENT, "the fake %s has failed", what);
}

static dea_status fake_start(struct dea_context *context, struct dea_instrument *instrument)
{
  struct fake_daq *daq = (struct fake_daq *)instrument;
  dea_clock_wait(daq->script.start_s);
  return (long)daq->starts++ == daq->script.fail_start ? fake_fail(context, "start") : DEA_OK;
}

static dea_status fake_put(struct dea_context *context, struct dea_instrument *instrument,
                           const double *volts, size_t count)
{
  struct fake_daq *daq = (struct fake_daq *)instrument;
  assert_int_equal(daq->starts, 1);
  assert_int_equal(daq->stops, 0);
  assert_true(count > 0);
  if ((long)daq->puts == daq->script.interrupt_put) {
    *daq->flag = 1;
  }
  if (daq->script.after_interrupt != NULL && (long)daq->puts == daq->script.interrupt_put + 1) {
    daq->script.after_interrupt();
  }
  if ((long)daq->puts++ == daq->script.fail_put) {
    return fake_fail(context, "put");
  }
  if (daq->put == 0) { // a DAQ begins with its first sample
    dea_clock_wait(daq->script.start_s);
    daq->begun_s = dea_clock_s();
  }
  for (size_t i = 0; i < count; i++) {
    assert_true(daq->put < FAKE_SAMPLES_MAX);
    daq->out[daq->put++] = volts[i];
  }
  return DEA_OK;
}

/* Volts at the inputs: voltage monitor 1 V/kV, current monitor 1 V/mA, and a ramp. */
static void fake_read(const struct fake_daq *daq, size_t i, double *volts)
{
  const struct fake_script *s = &daq->script;
  const struct fake_daq *player = daq->player != NULL ? daq->player : daq;
  const double before = i > 0 && i <= player->put ? player->out[i - 1] : 0;
  bool broken = s->broken_from > 0 && (long)i >= s->broken_from;
  const double all[3] = {broken                                               ? 0.01 * (before > 0)
                         : s->voltage_from >= 0 && (long)i >= s->voltage_from ? before + 1
                                                                              : before,
                         s->current_from >= 0 && (long)i >= s->current_from ? 2.5
                         : broken && before > 0                             ? 2.5
                         : s->leak_from > 0 && (long)i >= s->leak_from      ? 0.2
                                                                            : 0.02,
                         1e-3 * (double)i};
  bool lost = (long)i >= s->missing_from && (long)i < s->missing_to;
  for (size_t k = 0; k < daq->inputs; k++) {
    volts[k] = lost ? (double)NAN : all[k % 3];
  }
}

static dea_status fake_get(struct dea_context *context, struct dea_instrument *instrument,
                           double timeout_s, const struct dea_sink *sink)
{
  struct fake_daq *daq = (struct fake_daq *)instrument;
  const struct fake_script *s = &daq->script;
  double volts[64 * DEA_PROTOCOL_INPUTS_MAX];
  assert_true(timeout_s >= 0 && timeout_s < 1);
  assert_false(dea_interrupted(context)); // one that waits would end
  assert_int_equal(daq->stops, 0);
  if ((long)daq->gets++ == s->fail_get) {
    return fake_fail(context, "get");
  }
  if (!s->inputs || daq->gets % s->idle != 0) {
    return DEA_OK;
  }
  bool ahead = s->ahead_put >= 0 && (long)daq->puts > s->ahead_put;
  for (size_t left = s->at_a_time; left > 0 && (ahead || daq->got < daq->put); left--) {
    if (s->silent_from >= 0 && (long)daq->got >= s->silent_from) {
      break;
    }
    fake_read(daq, daq->got++, volts);
    dea_status status = sink->samples(sink->user, volts, 1);
    if (status != DEA_OK) {
      return status;
    }
  }
  return DEA_OK;
}

static struct dea_zero fake_stop(struct dea_context *context, struct dea_instrument *instrument)
{
  ((struct fake_daq *)instrument)->stops++;
  ((struct fake_daq *)instrument)->stopped_s = dea_clock_s();
  return (struct dea_zero){DEA_ZERO_COMMANDED, (double)NAN, NULL};
}

static void fake_close(struct dea_context *context, struct dea_instrument *instrument)
{
  fail_msg("closed by the loop");
}

static dea_status fake_sensor_start(struct dea_context *context, struct dea_instrument *instrument)
{
  struct fake_sensor *sensor = (struct fake_sensor *)instrument;
  return (long)sensor->starts++ == sensor->fail_start ? fake_fail(context, "start") : DEA_OK;
}

static dea_status fake_sensor_get(struct dea_context *context, struct dea_instrument *instrument,
                                  double timeout_s, const struct dea_sink *sink)
{
  struct fake_sensor *sensor = (struct fake_sensor *)instrument;
  double rate_Hz = 1000, now_s = (double)sensor->daq->got / rate_Hz;
  while ((double)sensor->frames * fake_frame_s <= now_s) {
    double time_s = (double)sensor->frames * fake_frame_s, z_m[3] = {time_s, NAN, -time_s};
    if ((long)sensor->frames == sensor->fail_frame) {
      return fake_fail(context, "sensor");
    }
    bool wrong = (long)sensor->frames++ == sensor->wrong_frame;
    sink->profile(sink->user, wrong ? 0 : time_s, z_m);
    sink->reading(sink->user, 0, time_s, sensor->value != 0 ? sensor->value : 300 + time_s);
  }
  return DEA_OK;
}

static struct dea_zero fake_sensor_stop(struct dea_context *context,
                                        struct dea_instrument *instrument)
{
  ((struct fake_sensor *)instrument)->stops++;
  return (struct dea_zero){DEA_ZERO_NONE, (double)NAN, NULL};
}

static const struct dea_instrument_type fake_daq_type = {.name = "fake DAQ",
                                                         .start = fake_start,
                                                         .put = fake_put,
                                                         .get = fake_get,
                                                         .stop = fake_stop,
                                                         .close = fake_close};
static const struct dea_instrument_type fake_sensor_type = {.name = "fake sensor",
                                                            .start = fake_sensor_start,
                                                            .get = fake_sensor_get,
                                                            .stop = fake_sensor_stop,
                                                            .close = fake_close};

static void fake_daq_open(const struct dea_protocol *protocol, const struct fake_script *script,
                          volatile sig_atomic_t *flag, struct fake_daq *daq)
{
  *daq = (struct fake_daq){.script = *script, .inputs = protocol->input_count, .flag = flag};
  daq->common.type = &fake_daq_type;
  daq->common.roles = DEA_PLAYS_OUTPUT | (script->inputs ? DEA_READS_INPUTS : 0U);
}

static void fake_sensor_open(const struct fake_daq *daq, struct fake_sensor *sensor)
{
  *sensor = (struct fake_sensor){.daq = daq, .x_m = {-0.01, 0, 0.01}};
  sensor->common.type = &fake_sensor_type;
  sensor->common.roles = DEA_SENDS_PROFILES | DEA_GIVES_READINGS;
  sensor->common.profile_points = 3;
  sensor->common.x_m = sensor->x_m;
  sensor->common.readings[0] =
      (struct dea_instrument_reading){"temperature", DEA_CHANNEL_OTHER, "K"};
  sensor->common.reading_count = 1;
  sensor->fail_start = sensor->fail_frame = sensor->wrong_frame = -1;
}

// A protocol played on them, and what must hold of whatever came out ------------------------------

#define CHANNELS                                                                                   \
  "channels:\n"                                                                                    \
  "  - {name: voltage, quantity: voltage, input: ai0, per_volt: 1 kV}\n"                           \
  "  - {name: current, quantity: current, input: ai1, per_volt: 1 mA}\n"                           \
  "  - {name: laser, quantity: displacement, input: ai2, per_volt: 200 um, at_zero: 1 mm}\n"
#define SQUARE                                                                                     \
  "dea-protocol: 1\n" PROTOCOL_AMPLIFIER                                                           \
  "safety: {ramp: 20 kV/s, trip_current: 1 mA, trip_time: 5 ms, voltage_error: 300 V}\n"           \
  "rate: 1 kHz\n"                                                                                  \
  "waveform: {kind: square, high: 2 kV, frequency: 10 Hz, cycles: 12}\n"

enum { RATE = 1000, PERIOD = 100, CYCLES = 12, LENGTH = PERIOD * CYCLES, TAIL = 26 };
static const double ramp_V = 20e3 / RATE; // largest step of it

static double square(size_t i)
{
  return i < LENGTH && i % PERIOD < PERIOD / 2 ? 2000 : 0;
}

/* A bench of both, and what came out; the last one. */
static struct fake_daq trial_daq;
static struct trial {
  struct fake_daq *daq;
  struct fake_sensor sensor;
  volatile sig_atomic_t flag;
  double stall_s;
  struct dea_drive_report report;
  dea_status status;
  struct dea_recording *recording;
} t;

static void trial_open(const char *text, const struct fake_script *script)
{
  dea_recording_destroy(ctx, t.recording);
  good_protocol(text);
  t = (struct trial){.daq = &trial_daq, .stall_s = 3};
  fake_daq_open(p, script, &t.flag, t.daq);
  fake_sensor_open(t.daq, &t.sensor);
}

static void trial_play(bool sensor)
{
  struct dea_instrument *all[2] = {&t.daq->common, &t.sensor.common};
  struct dea_drive_bench bench = {all, sensor ? 2 : 1, 0.005, t.stall_s, NULL, NULL, 0};
  unlink(in_folder("drive.h5"));
  dea_context_set_interrupt(ctx, &t.flag);
  t.status = dea_drive_play(ctx, p, &bench, in_folder("drive.h5"), &t.report);
  assert_ptr_equal(dea_context_get_interrupt(ctx), &t.flag);
  dea_context_set_interrupt(ctx, NULL);
  assert_int_equal(t.daq->stops, 1);
  assert_int_equal(t.sensor.stops, sensor ? 1 : 0);
  if (t.status != DEA_OK) {
    assert_true(t.report.ended[0] != '\0');
    assert_non_null(strstr(dea_context_message(ctx), t.report.ended));
  }
}

static void trial_read(void)
{
  if (dea_recording_read(ctx, in_folder("drive.h5"), &t.recording) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  assert_int_equal(t.recording->cycle_count, t.report.cycles);
  assert_true(t.recording->complete == (t.status == DEA_OK));
  assert_string_equal(t.recording->ended, t.report.ended);
}

static int trial_tear_down(void **state)
{
  dea_recording_destroy(ctx, t.recording);
  return protocol_tear_down(state);
}

/* Samples that are the sequence's. From there on it is a ramp to 0 V, which ends there. */
static size_t check_ramp(const struct fake_daq *daq)
{
  size_t n = 0;
  while (n < daq->put && n <= LENGTH && daq->out[n] * fake_gain == square(n)) {
    n++;
  }
  double last_V = n > 0 ? square(n - 1) : 0;
  for (size_t i = n; i < daq->put; i++) {
    double asked_V = daq->out[i] * fake_gain;
    assert_true(fabs(asked_V - last_V) <= ramp_V * (1 + 1e-12));
    assert_true(fabs(asked_V) <= fabs(last_V));
    last_V = asked_V;
  }
  assert_true(last_V == 0);
  // and no longer than it takes, and for the voltage channel to show it
  assert_true(daq->put - n <= 2000 / 20 + 1 + TAIL);
  return n;
}

/* Completed are the cycles that were played to their end before the ramp. */
static void check_cycles(size_t played)
{
  for (size_t i = 0; i < t.recording->cycle_count; i++) {
    const struct dea_recorded_cycle *cycle = &t.recording->cycles[i];
    assert_int_equal(cycle->number, i);
    assert_close(cycle->end_s, 0.1 * (double)(i + 1), 0, 1e-12);
    assert_true((i + 1) * PERIOD <= played);
  }
  assert_true(t.recording->cycle_count + 1 >= played / PERIOD);
}

static void check_channels(void)
{
  const struct dea_recording *r = t.recording;
  for (size_t i = 0; i < r->channels[0].count; i++) {
    double volts[3];
    assert_true(r->channels[0].values[i] == t.daq->out[i] * fake_gain);
    fake_read(t.daq, i, volts);
    const double wanted[3] = {1e3 * volts[0], 1e-3 * volts[1], 2e-4 * volts[2] + 1e-3};
    for (size_t k = 0; k < 3; k++) {
      double value = r->channels[k + 1].values[i];
      assert_true(isnan(wanted[k]) ? isnan(value) : fabs(value - wanted[k]) < 1e-9);
    }
  }
}

// What is played ---------------------------------------------------------------------------------

TEST(test_plays_and_records_the_protocol)
{
  trial_open(SQUARE CHANNELS, &fake_good);
  trial_play(true);
  assert_int_equal(t.status, DEA_OK);
  assert_int_equal(t.daq->put, LENGTH + 1 + TAIL);
  assert_int_equal(check_ramp(t.daq), LENGTH + 1);
  assert_true(t.report.zero.state == DEA_ZERO_READ_BACK && t.report.lost == 0 &&
              t.report.cycles == CYCLES);
  assert_close(t.report.played_s, 1.2, 0, 1e-12);
  assert_close(t.report.largest_current_A, 2e-5, 1e-12, 0);
  trial_read();
  check_channels();
  const struct dea_recording *r = t.recording;
  assert_int_equal(r->channel_count, 5);
  for (size_t c = 0; c < 4; c++) {
    assert_int_equal(r->channels[c].count, LENGTH + 1);
  }
  assert_string_equal(r->channels[0].name, "command");
  assert_int_equal(r->channels[3].kind, DEA_CHANNEL_DISPLACEMENT);
  assert_string_equal(r->channels[4].unit, "K");
  assert_int_equal(r->profiles.count, 61);
  assert_int_equal(r->channels[4].count, 61);
  assert_true(r->profiles.z_m[3 * 50] == 50 * fake_frame_s && isnan(r->profiles.z_m[3 * 50 + 1]));
  assert_non_null(strstr(r->protocol, "frequency: 10 Hz"));
  assert_non_null(strstr(r->provenance, "fake sensor"));
  check_cycles(LENGTH);
}

TEST(test_instruments_of_any_pace)
{
  static const size_t paces[] = {1, 7, 64, 5000};
  for (size_t k = 0; k < 4; k++) {
    struct fake_script script = fake_good;
    script.at_a_time = paces[k];
    script.idle = k == 1 ? 5 : 1;
    trial_open(SQUARE CHANNELS, &script);
    trial_play(k % 2 == 0);
    assert_int_equal(t.status, DEA_OK);
    assert_int_equal(check_ramp(t.daq), LENGTH + 1);
    assert_int_equal(t.report.cycles, CYCLES);
  }
}

TEST(test_without_channels_the_clock_paces)
{
  struct fake_script script = fake_good;
  script.inputs = false;
  trial_open(SQUARE, &script);
  trial_play(false);
  assert_int_equal(t.status, DEA_OK);
  assert_int_equal(check_ramp(t.daq), LENGTH + 1);
  trial_read();
  assert_int_equal(t.recording->channels[0].count, LENGTH + 1);
  assert_int_equal(t.recording->cycle_count, CYCLES);
}

/* A DAQ without channels that takes its time to start plays to its end before it is stopped. */
TEST(test_slow_start_without_channels)
{
  struct fake_script script = fake_good;
  script.inputs = false;
  script.start_s = 0.5;
  trial_open(SQUARE, &script);
  trial_play(false);
  assert_int_equal(t.status, DEA_OK);
  assert_true(t.daq->stopped_s - t.daq->begun_s >= (double)LENGTH / RATE);
}

/* The clock of a sensor begins with that of a DAQ, however long that takes to start. */
TEST(test_slow_start_and_a_sensor)
{
  struct fake_script script = fake_good;
  script.start_s = 0.2;
  trial_open(SQUARE CHANNELS, &script);
  trial_play(true);
  assert_int_equal(t.status, DEA_OK);
  assert_true(t.sensor.common.start_s >= t.daq->begun_s);
}

// What fails -------------------------------------------------------------------------------------

/* Plays with a fault and checks what must hold in all of them but those of the DAQ itself. */
static void expect_ramp(const struct fake_script *script, bool sensor, long fail_frame,
                        dea_status wanted, const char *reason)
{
  trial_open(SQUARE CHANNELS, script);
  t.sensor.fail_frame = fail_frame;
  t.stall_s = 0.3;
  trial_play(sensor);
  if (t.status != wanted || strstr(t.report.ended, reason) == NULL) {
    fail_msg("%s: %s", dea_status_name(t.status), t.report.ended);
  }
  // what the voltage channel does not show is not known
  bool shown = script->voltage_from < 0 && script->missing_to < LENGTH;
  assert_int_equal(t.report.zero.state, shown ? DEA_ZERO_READ_BACK : DEA_ZERO_UNKNOWN);
  size_t played = check_ramp(t.daq);
  assert_true(played < LENGTH);
  trial_read();
  check_channels();
  assert_int_equal(t.recording->channels[0].count, t.daq->put - TAIL);
  size_t seen = fail_frame >= 0 ? (size_t)fail_frame * RATE / 50 : t.daq->got; // frames of 20 ms
  check_cycles(played < seen ? played : seen);
}

TEST(test_signals)
{
  for (long put = 0; put < 22; put++) {
    struct fake_script script = fake_good;
    script.interrupt_put = put;
    script.at_a_time = 20 + (size_t)put;
    expect_ramp(&script, put % 2 == 0, -1, DEA_E_INTERRUPTED, "interrupted");
  }
}

/* Nothing is given to an output that has come to the end of the sequence and may have run dry. */
TEST(test_faults_at_the_end)
{
  for (int trips = 0; trips < 2; trips++) {
    struct fake_script script = fake_good;
    script.interrupt_put = trips ? -1 : (LENGTH + 1) / 50; // the last one
    script.current_from = trips ? LENGTH - 10 : -1;
    trial_open(SQUARE CHANNELS, &script);
    trial_play(false);
    assert_int_equal(t.status, trips ? DEA_E_INTERLOCK : DEA_OK);
    assert_int_equal(t.daq->put, LENGTH + 1 + TAIL);
    assert_true(t.report.zero.state == DEA_ZERO_READ_BACK && t.report.cycles == CYCLES);
    trial_read();
  }
}

TEST(test_current_trips)
{
  for (long from = 0; from < 700; from += 61) {
    struct fake_script script = fake_good;
    script.current_from = from;
    expect_ramp(&script, from % 2 == 0, -1, DEA_E_INTERLOCK, "trip_current");
  }
}

/* What pulls the voltage down ends with it: a current that goes on at 0 V explains nothing. */
TEST(test_film_that_breaks_down)
{
  for (int goes_on = 0; goes_on < 2; goes_on++) {
    struct fake_script script = fake_good;
    script.broken_from = 548; // at 2 kV for 48 ms
    script.current_from = goes_on ? script.broken_from : -1;
    trial_open(SQUARE CHANNELS, &script);
    p->safety.zero_time_s.si = 0.3;
    trial_play(false);
    assert_int_equal(t.status, DEA_E_INTERLOCK);
    assert_non_null(strstr(t.report.ended, "trip_current"));
    assert_int_equal(t.report.zero.state, goes_on ? DEA_ZERO_UNKNOWN : DEA_ZERO_READ_BACK);
    if (goes_on) {
      assert_string_equal(t.report.zero.why, "more than safety.trip_current still flows");
    }
  }
}

TEST(test_wrong_voltage_trips)
{
  for (long from = 0; from < 700; from += 53) {
    struct fake_script script = fake_good;
    script.voltage_from = from;
    expect_ramp(&script, false, -1, DEA_E_INTERLOCK, "voltage_error");
  }
}

TEST(test_lost_samples_do_not_end_it_but_silence_does)
{
  struct fake_script script = fake_good;
  script.missing_from = 130;
  script.missing_to = 500;
  trial_open(SQUARE CHANNELS, &script);
  trial_play(true);
  assert_int_equal(t.status, DEA_OK);
  trial_read();
  check_channels(); // NAN where they were lost
  script.missing_to = 5000;
  expect_ramp(&script, true, -1, DEA_E_INTERLOCK, "has given no value");
}

TEST(test_lost_sensor)
{
  for (long frame = 0; frame < 36; frame += 7) {
    expect_ramp(&fake_good, true, frame, DEA_E_INSTRUMENT, "the fake sensor has failed");
  }
}

TEST(test_inputs_ahead_of_the_output)
{
  struct fake_script script = fake_good;
  script.ahead_put = 9;
  script.at_a_time = 60;
  trial_open(SQUARE CHANNELS, &script);
  trial_play(false);
  assert_int_equal(t.status, DEA_E_INSTRUMENT);
  assert_non_null(strstr(t.report.ended, "ran dry"));
  check_ramp(t.daq);
}

/* The playing instrument itself fails: nothing can be put any more, it is stopped at once. */
TEST(test_failed_daq_is_stopped)
{
  for (long k = 0; k < 15; k++) {
    for (int put = 0; put < 2; put++) {
      struct fake_script script = fake_good;
      *(put ? &script.fail_put : &script.fail_get) = k;
      trial_open(SQUARE CHANNELS, &script);
      trial_play(true);
      assert_int_equal(t.status, DEA_E_INSTRUMENT);
      assert_non_null(strstr(t.report.ended, put ? "put has failed" : "get has failed"));
      assert_true(t.report.zero.state != DEA_ZERO_READ_BACK);
      trial_read();
      check_channels();
    }
  }
  struct fake_script script = fake_good;
  script.silent_from = 333;
  trial_open(SQUARE CHANNELS, &script);
  t.stall_s = 0.2;
  trial_play(false);
  assert_int_equal(t.status, DEA_E_INSTRUMENT);
  assert_non_null(strstr(t.report.ended, "no sample has come for 0.2 s"));
  trial_read();
  assert_int_equal(t.recording->cycle_count, 3);
}

TEST(test_failed_start)
{
  for (int of_sensor = 0; of_sensor < 2; of_sensor++) {
    struct fake_script script = fake_good;
    script.fail_start = of_sensor ? -1 : 0;
    trial_open(SQUARE CHANNELS, &script);
    t.sensor.fail_start = of_sensor ? 0 : -1;
    trial_play(true);
    assert_int_equal(t.status, DEA_E_INSTRUMENT);
    assert_int_equal(t.daq->put, 0);
    assert_true(t.report.zero.state == DEA_ZERO_COMMANDED);
    trial_read();
  }
}

/* Inputs of one instrument, output of another: without the inputs the ramp goes on. */
TEST(test_reader_apart_from_the_player)
{
  for (long fail = -1; fail < 30; fail += 10) {
    struct fake_script script = fake_good;
    struct fake_daq *player = malloc(sizeof *player);
    assert_non_null(player);
    trial_open(SQUARE CHANNELS, &script);
    script.inputs = false;
    fake_daq_open(p, &script, &t.flag, player);
    t.daq->common.roles = DEA_READS_INPUTS;
    t.daq->script.fail_get = fail;
    t.daq->script.at_a_time = 40;
    t.daq->script.ahead_put = 0;
    t.daq->puts = 1; // of nothing: it reads on its own clock
    t.daq->player = player;
    struct dea_instrument *all[2] = {&player->common, &t.daq->common};
    struct dea_drive_bench bench = {all, 2, 0.005, 3, NULL, NULL, 0};
    unlink(in_folder("drive.h5"));
    p->safety.voltage_error_V.si = 1e5;
    t.status = dea_drive_play(ctx, p, &bench, in_folder("drive.h5"), &t.report);
    // its clock is ahead when the output is given 50 samples for its 40: not before the end
    assert_int_equal(t.status, fail < 0 ? DEA_OK : DEA_E_INSTRUMENT);
    assert_int_equal(t.report.zero.state, fail < 0 ? DEA_ZERO_READ_BACK : DEA_ZERO_UNKNOWN);
    check_ramp(player);
    assert_int_equal(player->stops, 1);
    assert_int_equal(t.daq->stops, 1);
    trial_read();
    free(player);
  }
}

TEST(test_full_disk_ramps_down)
{
  struct rlimit before, small;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  trial_open(SQUARE CHANNELS, &fake_good);
  small = before;
  small.rlim_cur = 50000;
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
  trial_play(true);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
  assert_int_equal(t.status, DEA_E_IO);
  assert_true(t.report.zero.state == DEA_ZERO_READ_BACK && t.daq->put > 0);
  check_ramp(t.daq);
  signal(SIGXFSZ, handler);
}

static void fill_the_disk(void)
{
  struct rlimit small;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &small), 0);
  small.rlim_cur = 1;
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
}

/* The disk is full when the ramp begins: it goes on to 0 V, and what came first is told first. */
TEST(test_disk_that_fills_in_the_ramp)
{
  struct rlimit before;
  struct fake_script script = fake_good;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  script.interrupt_put = 8;
  script.after_interrupt = fill_the_disk;
  trial_open(SQUARE CHANNELS, &script);
  trial_play(true);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
  assert_int_equal(t.status, DEA_E_INTERRUPTED);
  assert_true(t.report.zero.state == DEA_ZERO_READ_BACK);
  assert_string_equal(t.report.ended, "interrupted");
  assert_non_null(find_finding(ctx, DEA_WARNING, "cannot write"));
  assert_true(check_ramp(t.daq) < LENGTH);
  signal(SIGXFSZ, handler);
}

static void play_without_memory(struct dea_context *context)
{
  struct dea_instrument *all[2] = {&t.daq->common, &t.sensor.common};
  struct dea_drive_bench bench = {all, 2, 0.005, 3, NULL, NULL, 0};
  fake_daq_open(p, &fake_good, &t.flag, t.daq);
  fake_sensor_open(t.daq, &t.sensor);
  unlink(in_folder("memory.h5"));
  t.status = dea_drive_play(context, p, &bench, in_folder("memory.h5"), &t.report);
  failing_check(context, t.status);
  assert_true(t.daq->stops == 1 && t.sensor.stops == 1);
  check_ramp(t.daq);
}

TEST(test_out_of_memory)
{
  trial_open(SQUARE CHANNELS, &fake_good);
  assert_true(failing_each(play_without_memory) > 3); // the recorder has a context of its own
}

TEST(test_frames_without_time_are_counted)
{
  trial_open(SQUARE CHANNELS, &fake_good);
  t.sensor.wrong_frame = 8;
  trial_play(true);
  assert_int_equal(t.status, DEA_OK);
  assert_int_equal(t.report.lost, 1);
}

/* What is noticed while it plays stands in the recording, and in its copy; a leakage current that
 * rises ends it, ten times below trip_current. */
TEST(test_leak_that_rises)
{
  static const char text[] =
      "dea-protocol: 1\n" PROTOCOL_AMPLIFIER
      "safety: {ramp: 20 kV/s, trip_current: 2 mA, voltage_error: 300 V, leak_time: 0.5 s}\n"
      "rate: 1 kHz\n"
      "waveform: {kind: square, high: 2 kV, frequency: 10 Hz, cycles: 150}\n" CHANNELS;
  struct fake_script script = fake_good;
  script.leak_from = 11000;
  trial_open(text, &script);
  trial_play(true);
  assert_int_equal(t.status, DEA_E_INTERLOCK);
  assert_non_null(strstr(t.report.ended, "the leakage current has risen to 200 uA, above 40 uA"));
  if (!(t.report.played_s > 11.5 && t.report.played_s < 13)) {
    fail_msg("%g s: %s", t.report.played_s, t.report.ended);
  }
  assert_non_null(find_finding(ctx, DEA_NOTE, "'current' has a base line: up to 20 uA"));
  assert_non_null(find_finding(ctx, DEA_WARNING, "'current' has risen to 200 uA, above 40 uA"));
  trial_read();
  for (int k = 0; k < 2; k++) { // and its copy
    const struct dea_recording *r = t.recording;
    assert_int_equal(r->event_count, 2);
    assert_true(r->events[0].kind == DEA_NOTICED_LEARNED && r->events[0].time_s < 11);
    assert_true(r->events[1].kind == DEA_NOTICED_LEAK_ROSE && r->events[1].time_s > 11);
    assert_close(r->events[1].value, 2e-4, 1e-12, 0);
    assert_close(r->events[1].limit, 4e-5, 1e-12, 0);
    assert_string_equal(r->channels[r->events[1].channel].name, "current");
    struct dea_recording *copy;
    unlink(in_folder("copy.h5"));
    assert_int_equal(dea_recording_write(ctx, r, in_folder("copy.h5")), DEA_OK);
    assert_int_equal(dea_recording_read(ctx, in_folder("copy.h5"), &copy), DEA_OK);
    dea_recording_destroy(ctx, t.recording);
    t.recording = copy;
  }
}

/* A current that an instrument reads has no value any more: said after 10 s, the ramp after 60 s.
 */
TEST(test_reading_without_values)
{
  static const double values[] = {NAN, 1e-6};
  for (int k = 0; k < 2; k++) {
    trial_open(SQUARE CHANNELS, &fake_good);
    t.sensor.common.readings[0].kind = DEA_CHANNEL_CURRENT;
    t.sensor.common.readings[0].unit[0] = '\0';
    t.sensor.value = values[k];
    t.stall_s = 1e9;
    atomic_store(&hurries_ns, 100000000);
    trial_play(true);
    atomic_store(&hurries_ns, 0);
    trial_read();
    if (k == 0) {
      assert_int_equal(t.status, DEA_E_INTERLOCK);
      assert_non_null(strstr(t.report.ended, "reading 'temperature' has given no value for 60 s"));
      assert_true(t.recording->event_count == 1);
      assert_true(t.recording->events[0].kind == DEA_NOTICED_SILENT);
      assert_true(t.recording->events[0].value >= 10 && t.recording->events[0].value < 20);
      check_ramp(t.daq);
    } else {
      assert_true(t.status == DEA_OK && t.recording->event_count == 0);
    }
  }
}

TEST(test_benches_that_cannot_play)
{
  struct fake_daq *second = malloc(sizeof *second);
  assert_non_null(second);
  trial_open(SQUARE CHANNELS, &fake_good);
  fake_daq_open(p, &fake_good, &t.flag, second);
  struct dea_instrument *all[2] = {&t.daq->common, &second->common};
  struct dea_drive_bench bench = {all, 2, 0.005, 3, NULL, NULL, 0};
  static const struct {
    unsigned first, second;
    const char *why;
  } cases[] = {{DEA_PLAYS_OUTPUT, DEA_PLAYS_OUTPUT, "two of them play"},
               {DEA_READS_INPUTS, DEA_SENDS_PROFILES, "none of them plays"},
               {DEA_PLAYS_OUTPUT, DEA_SENDS_PROFILES, "none of them reads"},
               {DEA_PLAYS_OUTPUT | DEA_READS_INPUTS, DEA_READS_INPUTS, "two of them read"},
               {DEA_PLAYS_OUTPUT | DEA_SENDS_PROFILES, DEA_SENDS_PROFILES, "two of them send"}};
  for (size_t k = 0; k < 5; k++) {
    t.daq->common.roles = cases[k].first;
    second->common.roles = cases[k].second;
    t.daq->stops = second->stops = 0;
    t.status = dea_drive_play(ctx, p, &bench, in_folder("none.h5"), &t.report);
    assert_int_equal(t.status, DEA_E_INSTRUMENT);
    assert_non_null(strstr(dea_context_message(ctx), cases[k].why));
    assert_true(t.daq->stops == 1 && second->stops == 1 && t.daq->starts == 0);
    assert_false(there("none.h5"));
  }
  free(second);
}

TESTS(set_up, trial_tear_down)

/* Instruments of tests: a DAQ without hardware, and a profile sensor on its clock. They keep what
 * was asked of them, and fail where they are told to. */
#pragma once

#include "base/clock.h"
#include "drive/drive_loop.h"
#include "testing.h"

#include <signal.h>
#include <stdlib.h>
#include <time.h>

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

static inline dea_status fake_fail(struct dea_context *context, const char *what)
{
  return dea_fail(context, DEA_E_INSTRUMENT, "the fake %s has failed", what);
}

static inline dea_status fake_start(struct dea_context *context, struct dea_instrument *instrument)
{
  struct fake_daq *daq = (struct fake_daq *)instrument;
  dea_clock_wait(daq->script.start_s);
  return (long)daq->starts++ == daq->script.fail_start ? fake_fail(context, "start") : DEA_OK;
}

static inline dea_status fake_put(struct dea_context *context, struct dea_instrument *instrument,
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
static inline void fake_read(const struct fake_daq *daq, size_t i, double *volts)
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

static inline dea_status fake_get(struct dea_context *context, struct dea_instrument *instrument,
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

static inline struct dea_zero fake_stop(struct dea_context *context,
                                        struct dea_instrument *instrument)
{
  ((struct fake_daq *)instrument)->stops++;
  ((struct fake_daq *)instrument)->stopped_s = dea_clock_s();
  return (struct dea_zero){DEA_ZERO_COMMANDED, (double)NAN, NULL};
}

static inline void fake_close(struct dea_context *context, struct dea_instrument *instrument)
{
  fail_msg("closed by the loop");
}

static inline dea_status fake_sensor_start(struct dea_context *context,
                                           struct dea_instrument *instrument)
{
  struct fake_sensor *sensor = (struct fake_sensor *)instrument;
  return (long)sensor->starts++ == sensor->fail_start ? fake_fail(context, "start") : DEA_OK;
}

static inline dea_status fake_sensor_get(struct dea_context *context,
                                         struct dea_instrument *instrument, double timeout_s,
                                         const struct dea_sink *sink)
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

static inline struct dea_zero fake_sensor_stop(struct dea_context *context,
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

static inline void fake_daq_open(const struct dea_protocol *protocol,
                                 const struct fake_script *script, volatile sig_atomic_t *flag,
                                 struct fake_daq *daq)
{
  *daq = (struct fake_daq){.script = *script, .inputs = protocol->input_count, .flag = flag};
  daq->common.type = &fake_daq_type;
  daq->common.roles = DEA_PLAYS_OUTPUT | (script->inputs ? DEA_READS_INPUTS : 0U);
}

static inline void fake_sensor_open(const struct fake_daq *daq, struct fake_sensor *sensor)
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

/* A protocol played on fake instruments, and what must hold of whatever came out. */
#pragma once

#include "failing_allocator.h"
#include "fake_instruments.h"
#include "protocol_text.h"

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

static inline double square(size_t i)
{
  return i < LENGTH && i % PERIOD < PERIOD / 2 ? 2000 : 0;
}

/* A bench of both, and what came out. */
struct trial {
  struct dea_protocol *protocol;
  struct fake_daq *daq;
  struct fake_sensor sensor;
  volatile sig_atomic_t flag;
  double stall_s;
  struct dea_drive_report report;
  dea_status status;
  struct dea_recording *recording;
};

static inline void trial_open(struct trial *t, const char *text, const struct fake_script *script)
{
  good_protocol(text);
  *t = (struct trial){.protocol = p, .stall_s = 3};
  t->daq = malloc(sizeof *t->daq);
  assert_non_null(t->daq);
  fake_daq_open(t->protocol, script, &t->flag, t->daq);
  fake_sensor_open(t->daq, &t->sensor);
}

static inline void trial_play(struct trial *t, bool sensor)
{
  struct dea_instrument *all[2] = {&t->daq->common, &t->sensor.common};
  struct dea_drive_bench bench = {all, sensor ? 2 : 1, 0.005, t->stall_s, NULL, NULL, 0};
  unlink(in_folder("drive.h5"));
  dea_context_set_interrupt(ctx, &t->flag);
  t->status = dea_drive_play(ctx, t->protocol, &bench, in_folder("drive.h5"), &t->report);
  assert_ptr_equal(dea_context_get_interrupt(ctx), &t->flag);
  dea_context_set_interrupt(ctx, NULL);
  assert_int_equal(t->daq->stops, 1);
  assert_int_equal(t->sensor.stops, sensor ? 1 : 0);
  if (t->status != DEA_OK) {
    assert_true(t->report.ended[0] != '\0');
    assert_non_null(strstr(dea_context_message(ctx), t->report.ended));
  }
}

static inline void trial_read(struct trial *t)
{
  if (dea_recording_read(ctx, in_folder("drive.h5"), &t->recording) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  assert_int_equal(t->recording->cycle_count, t->report.cycles);
  assert_true(t->recording->complete == (t->status == DEA_OK));
  assert_string_equal(t->recording->ended, t->report.ended);
}

static inline void trial_close(struct trial *t)
{
  dea_recording_destroy(ctx, t->recording);
  free(t->daq);
}

/* Samples that are the sequence's. From there on it is a ramp to 0 V, which ends there. */
static inline size_t check_ramp(const struct fake_daq *daq)
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
static inline void check_cycles(const struct trial *t, size_t played)
{
  for (size_t i = 0; i < t->recording->cycle_count; i++) {
    const struct dea_recorded_cycle *cycle = &t->recording->cycles[i];
    assert_int_equal(cycle->number, i);
    assert_close(cycle->end_s, 0.1 * (double)(i + 1), 0, 1e-12);
    assert_true((i + 1) * PERIOD <= played);
  }
  assert_true(t->recording->cycle_count + 1 >= played / PERIOD);
}

static inline void check_channels(const struct trial *t)
{
  const struct dea_recording *r = t->recording;
  for (size_t i = 0; i < r->channels[0].count; i++) {
    double volts[3];
    assert_true(r->channels[0].values[i] == t->daq->out[i] * fake_gain);
    fake_read(t->daq, i, volts);
    const double wanted[3] = {1e3 * volts[0], 1e-3 * volts[1], 2e-4 * volts[2] + 1e-3};
    for (size_t k = 0; k < 3; k++) {
      double value = r->channels[k + 1].values[i];
      assert_true(isnan(wanted[k]) ? isnan(value) : fabs(value - wanted[k]) < 1e-9);
    }
  }
}

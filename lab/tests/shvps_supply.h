/* The SHVPS as a supply on a line, and `dea drive` on it. */
#pragma once

#include "supply_drive.h"

static const double shvps_range_V = 2500;

static inline void shvps_answer(struct supply *s, const char *command, char out[SUPPLY_ANSWER])
{
  double value;
  int number;
  if (sscanf(command, "SVset%lf", &value) == 1) {
    s->set_V = s->wrong.deaf ? s->set_V : value;
    snprintf(out, SUPPLY_ANSWER, "%.0f", value);
  } else if (sscanf(command, "SSwMode%d", &number) == 1) {
    s->mode = number;
    snprintf(out, SUPPLY_ANSWER, "%d", number);
  } else if (sscanf(command, "SF%lf", &value) == 1) {
    s->frequency_Hz = value;
    snprintf(out, SUPPLY_ANSWER, "%.3f", value);
  } else if (strcmp(command, "SSwSrc0") == 0) {
    snprintf(out, SUPPLY_ANSWER, "0");
  } else if (strcmp(command, "QF") == 0) {
    snprintf(out, SUPPLY_ANSWER, "%.3f", s->frequency_Hz);
  } else if (strcmp(command, "QVnow") == 0) {
    snprintf(out, SUPPLY_ANSWER, "%.0f", s->shown_V);
  } else if (strcmp(command, "QVmax") == 0) {
    snprintf(out, SUPPLY_ANSWER, "%.0f", shvps_range_V);
  } else if (strcmp(command, "QName") == 0) {
    snprintf(out, SUPPLY_ANSWER, "bench 5");
  }
}

/* More keys of `safety`. */
static const char *shvps_safety = "zero_time: 6 s, guard_time: 2 s";

/* Longer times than usual, as the machine may be busy; more: keys of the supply. */
#define SHVPS_PATIENT ", behind: 1.5 s"
static inline void shvps_protocol_of(const char *device, const char *waveform, const char *more)
{
  char text[2048];
  snprintf(text, sizeof text,
           "dea-protocol: 1\n"
           "waveform: {%s}\n"
           "amplifier: {gain: 1000, max_voltage: 5 kV, min_voltage: 0 V}\n"
           "rate: 100 Hz\n"
           "safety: {ramp: 4 kV/s, voltage_error: 300 V, at_zero: %g V, %s}\n"
           "instruments:\n"
           "  - {kind: shvps, device: %s, queue: 1 s, timeout: 2 s%s}\n",
           waveform, supply_zero_V, shvps_safety, device, more);
  command_write("p.yaml", text);
}

/* A triangle, 4 s a cycle. */
static inline void shvps_protocol(double highest_kV, int cycles, const char *more)
{
  char waveform[128];
  snprintf(waveform, sizeof waveform,
           "kind: triangle, low: 0 kV, high: %g kV, cycles: %d, frequency: 0.25 Hz", highest_kV,
           cycles);
  shvps_protocol_of(hv.device, waveform, more);
}

static inline void shvps_begin(struct supply *s)
{
  s->answer = s->answer != NULL ? s->answer : shvps_answer;
  s->error = "Err";
  s->buffer = SUPPLY_SHVPS_BUFFER;
  supply_start(s);
}

/* Starts it as told. */
static inline void shvps_set_up(struct supply as)
{
  hv = as;
  shvps_begin(&hv);
}

/* It plays triangles of 2 kV, and is above 1 kV; the program that drives it. */
static inline pid_t shvps_playing(struct supply as, const char *more)
{
  shvps_set_up(as);
  shvps_protocol(2, 20, more);
  pid_t child = supply_arm_checked("played.h5");
  assert_true(supply_reaches(&hv, 1000, 60));
  return child;
}

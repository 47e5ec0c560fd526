/* Waveform "burst": some cycles of a sine, rest at the mean, again. */
#include "waveform/wave_make.h"

#include <math.h>

enum { MEAN, AMPLITUDE, FREQUENCY, CYCLES, PERIOD, BURSTS };

struct raw {
  struct dea_label kind;
  struct dea_quantity mean_V, amplitude_V, frequency_Hz, cycles, period_s, bursts;
};

static const struct dea_field fields[] = {
    DEA_WAVE_KIND(struct raw),
    DEA_WAVE_VOLTAGE(struct raw, mean_V, "mean", "voltage in the middle and between bursts",
                     .default_text = "0 kV"),
    DEA_WAVE_VOLTAGE(struct raw, amplitude_V, "amplitude", "half of peak to peak",
                     .required = true),
    DEA_WAVE_FREQUENCY(struct raw, frequency_Hz, "frequency", "cycles a second within a burst"),
    DEA_WAVE_CYCLES(struct raw, cycles, "cycles", "cycles of a burst", "10"),
    DEA_WAVE_TIME(struct raw, period_s, "period", "from the start of a burst to that of the next",
                  .above_min = true, .required = true),
    DEA_WAVE_CYCLES(struct raw, bursts, "bursts", "number of bursts", "1"),
};

static dea_status build(const struct dea_reader *reader, const void *data, const char *beside,
                        struct dea_waveform *out)
{
  (void)beside;
  const struct raw *raw = data;
  double *p = out->numbers;
  p[MEAN] = raw->mean_V.si;
  p[AMPLITUDE] = raw->amplitude_V.si;
  p[FREQUENCY] = raw->frequency_Hz.si;
  p[CYCLES] = raw->cycles.si;
  p[PERIOD] = raw->period_s.si;
  p[BURSTS] = raw->bursts.si;
  if (p[CYCLES] / p[FREQUENCY] > p[PERIOD]) {
    return dea_finding_add(reader->ctx, DEA_ERROR, raw->period_s.location,
                           "period: %g s is shorter than a burst, %g s", p[PERIOD],
                           p[CYCLES] / p[FREQUENCY]);
  }
  // Blocks of two knots each burst mark its ends, where the curve bends; the value is below.
  DEA_TRY(reader->ctx, dea_wave_room(reader->ctx, out, 2, 1));
  dea_wave_open(out, 0, 1 / p[PERIOD], (size_t)p[BURSTS]);
  dea_wave_add(out, 0, 0, p[MEAN] + copysign(p[AMPLITUDE], p[MEAN]));
  dea_wave_add(out, 0, p[CYCLES] / p[FREQUENCY], p[MEAN]);
  out->end_s = p[BURSTS] * p[PERIOD];
  out->longest_step_s = 0.05 / p[FREQUENCY];
  return DEA_OK;
}

static double value(const struct dea_waveform *w, double t)
{
  const double *p = w->numbers;
  double number = fmin(floor(t / p[PERIOD]), p[BURSTS] - 1);
  double cycles = (t - number * p[PERIOD]) * p[FREQUENCY];
  return cycles < p[CYCLES] ? p[MEAN] + p[AMPLITUDE] * dea_wave_sine_of(cycles) : p[MEAN];
}

static void extent(const struct dea_waveform *w, struct dea_wave_extent *out)
{
  const double *p = w->numbers;
  dea_wave_sine_extent(p[MEAN], p[AMPLITUDE], 0, p[CYCLES], p[FREQUENCY], out); // whole ones
}

DEA_WAVE_TYPE(burst, "some cycles of a sine, a pause, again", .value = value, .extent = extent);

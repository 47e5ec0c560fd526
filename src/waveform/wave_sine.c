/* Waveform "sine": mean + amplitude sin(2 pi (f t + phase)). */
#include "waveform/wave_make.h"

#include <math.h>

enum { MEAN, AMPLITUDE, FREQUENCY, PHASE, CYCLES };

struct raw {
  struct dea_label kind;
  struct dea_quantity mean_V, amplitude_V, frequency_Hz, phase_rad, cycles;
};

static const struct dea_field fields[] = {
    DEA_WAVE_KIND(struct raw),
    DEA_WAVE_VOLTAGE(struct raw, mean_V, "mean", "voltage in the middle", .default_text = "0 kV"),
    DEA_WAVE_VOLTAGE(struct raw, amplitude_V, "amplitude", "half of peak to peak",
                     .required = true),
    DEA_WAVE_FREQUENCY(struct raw, frequency_Hz, "frequency", "cycles a second"),
    DEA_NUMBER_ROW("phase", offsetof(struct raw, phase_rad), "radian", "-90 degree",
                   "phase at the start; -90 degree: it starts at the lowest voltage", .min = -7,
                   .max = 7, .default_text = "0 degree"),
    DEA_WAVE_CYCLES(struct raw, cycles, "cycles", "number of cycles", "10"),
};

static dea_status build(const struct dea_reader *reader, const void *data, const char *beside,
                        struct dea_waveform *out)
{
  (void)reader;
  (void)beside;
  static const double two_pi = 6.28318530717958647692;
  const struct raw *raw = data;
  out->numbers[MEAN] = raw->mean_V.si;
  out->numbers[AMPLITUDE] = raw->amplitude_V.si;
  out->numbers[FREQUENCY] = raw->frequency_Hz.si;
  out->numbers[PHASE] = raw->phase_rad.si / two_pi;
  out->numbers[CYCLES] = raw->cycles.si;
  out->end_s = raw->cycles.si / raw->frequency_Hz.si;
  out->longest_step_s = 0.05 / raw->frequency_Hz.si;
  return DEA_OK;
}

static double value(const struct dea_waveform *w, double time_s)
{
  const double *p = w->numbers;
  return p[MEAN] + p[AMPLITUDE] * dea_wave_sine_of(p[FREQUENCY] * time_s + p[PHASE]);
}

static void extent(const struct dea_waveform *w, struct dea_wave_extent *out)
{
  const double *p = w->numbers;
  dea_wave_sine_extent(p[MEAN], p[AMPLITUDE], 0, p[CYCLES], p[FREQUENCY], out); // whole ones
}

static bool cycle(const struct dea_waveform *w, size_t number, struct dea_wave_cycle *out)
{
  const double *p = w->numbers;
  out->start_s = (double)number / p[FREQUENCY];
  out->end_s = (double)(number + 1) / p[FREQUENCY];
  out->level_V = p[MEAN] + copysign(p[AMPLITUDE], p[MEAN]);
  return (double)number < p[CYCLES];
}

DEA_WAVE_TYPE(sine, "a sine about a mean", .value = value, .extent = extent, .cycle = cycle);

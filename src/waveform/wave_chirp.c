/* Waveform "chirp": a sine whose frequency goes from one value to another. Cycles until t:
 *
 *   linear       f_0 t + (f_1 - f_0) t^2/(2 T)
 *   logarithmic  f_0 T/ln(f_1/f_0) ((f_1/f_0)^(t/T) - 1) */
#include "waveform/wave_make.h"

#include <math.h>

enum { MEAN, AMPLITUDE, FROM, TO, DURATION, LOGARITHMIC };

struct raw {
  struct dea_label kind;
  struct dea_quantity mean_V, amplitude_V, from_Hz, to_Hz, duration_s;
  struct dea_choice spacing;
};

static const char *const spacings[] = {"linear", "logarithmic", NULL};

static const struct dea_field fields[] = {
    DEA_WAVE_KIND(struct raw),
    DEA_WAVE_VOLTAGE(struct raw, mean_V, "mean", "voltage in the middle", .default_text = "0 kV"),
    DEA_WAVE_VOLTAGE(struct raw, amplitude_V, "amplitude", "half of peak to peak",
                     .required = true),
    DEA_WAVE_FREQUENCY(struct raw, from_Hz, "from", "frequency at the start"),
    DEA_WAVE_FREQUENCY(struct raw, to_Hz, "to", "frequency at the end"),
    DEA_WAVE_TIME(struct raw, duration_s, "duration", "how long it takes", .above_min = true,
                  .required = true),
    DEA_CHOICE_ROW("spacing", offsetof(struct raw, spacing), spacings, "linear",
                   "how the frequency goes with time: evenly, or by equal factors",
                   .default_text = "logarithmic"),
};

static dea_status build(const struct dea_reader *reader, const void *data, const char *beside,
                        struct dea_waveform *out)
{
  (void)reader;
  (void)beside;
  const struct raw *raw = data;
  out->numbers[MEAN] = raw->mean_V.si;
  out->numbers[AMPLITUDE] = raw->amplitude_V.si;
  out->numbers[FROM] = raw->from_Hz.si;
  out->numbers[TO] = raw->to_Hz.si;
  out->numbers[DURATION] = raw->duration_s.si;
  out->numbers[LOGARITHMIC] = raw->spacing.value == 1 && raw->from_Hz.si != raw->to_Hz.si;
  out->end_s = raw->duration_s.si;
  out->longest_step_s = 0.05 / fmax(raw->from_Hz.si, raw->to_Hz.si);
  return DEA_OK;
}

static double cycles_until(const double *p, double t)
{
  double T = p[DURATION], rate = log(p[TO] / p[FROM]);
  return p[LOGARITHMIC] != 0 ? p[FROM] * T / rate * expm1(rate * t / T)
                             : p[FROM] * t + (p[TO] - p[FROM]) * t * t / (2 * T);
}

static double value(const struct dea_waveform *w, double t)
{
  const double *p = w->numbers;
  return p[MEAN] + p[AMPLITUDE] * dea_wave_sine_of(cycles_until(p, t));
}

static void extent(const struct dea_waveform *w, struct dea_wave_extent *out)
{
  const double *p = w->numbers;
  dea_wave_sine_extent(p[MEAN], p[AMPLITUDE], 0, cycles_until(p, p[DURATION]), fmax(p[FROM], p[TO]),
                       out);
}

static bool cycle(const struct dea_waveform *w, size_t number, struct dea_wave_cycle *out)
{
  (void)w;
  (void)number;
  (void)out;
  return false; // none is like another
}

DEA_WAVE_TYPE(chirp, "a sine of changing frequency", .value = value, .extent = extent,
              .cycle = cycle);

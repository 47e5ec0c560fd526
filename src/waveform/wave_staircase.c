/* Waveform "staircase": pulses at one voltage after the other. The measurements of the paper
 * (section 3.2): 0 to 8 kV in steps of 1 kV, 15 pulses at each, 0.5 Hz, duty 50 %. */
#include "waveform/wave_make.h"

#include <math.h>

enum { LEVELS_MAX = 200, VOLTAGE_GROUP = 1 };

struct raw {
  struct dea_label kind;
  struct dea_quantity from_V, to_V, step_V, values_V[LEVELS_MAX];
  size_t value_count;
  struct dea_quantity low_V, cycles, frequency_Hz, duty, rise_s, pause_s;
};

static const struct dea_field fields[] = {
    DEA_WAVE_KIND(struct raw),
    DEA_WAVE_VOLTAGE(struct raw, from_V, "from", "first voltage", .group = VOLTAGE_GROUP,
                     .option = 1, .default_text = "0 kV"),
    DEA_WAVE_VOLTAGE(struct raw, to_V, "to", "last voltage; below `from` the stairs go down",
                     .group = VOLTAGE_GROUP, .option = 1, .default_text = "8 kV"),
    DEA_NUMBER_ROW("step", offsetof(struct raw, step_V), "V", "1 kV", "step between voltages",
                   .above_min = true, .max = 1e6, .group = VOLTAGE_GROUP, .option = 1,
                   .default_text = "1 kV"),
    DEA_NUMBER_ROW("values", offsetof(struct raw, values_V), "V", "[4 kV, 6 kV]",
                   "the voltages themselves", .min = -1e6, .max = 1e6, .group = VOLTAGE_GROUP,
                   .option = 2,
                   DEA_LIST(1, LEVELS_MAX, struct dea_quantity, offsetof(struct raw, value_count))),
    DEA_WAVE_VOLTAGE(struct raw, low_V, "low", "voltage between pulses", .default_text = "0 kV"),
    DEA_WAVE_CYCLES(struct raw, cycles, "cycles", "pulses at each voltage", "15"),
    DEA_WAVE_FREQUENCY(struct raw, frequency_Hz, "frequency", "pulses a second"),
    DEA_WAVE_SHARE(struct raw, duty, "duty", "share of a cycle that the pulse lasts"),
    DEA_WAVE_TIME(struct raw, rise_s, "rise_time", "how long a rise or fall takes; 0: jumps",
                  .default_text = "0 s"),
    DEA_WAVE_TIME(struct raw, pause_s, "pause", "rest after the pulses of each voltage",
                  .default_text = "0 s"),
};

/* Number of voltages; 0 after a finding. */
static dea_status count_levels(const struct dea_reader *reader, const struct raw *raw,
                               size_t *count)
{
  *count = raw->value_count;
  if (*count > 0) {
    return DEA_OK;
  }
  double steps = floor(fabs(raw->to_V.si - raw->from_V.si) / raw->step_V.si + 1e-6);
  if (steps < LEVELS_MAX) {
    *count = (size_t)steps + 1;
    return DEA_OK;
  }
  return dea_finding_add(reader->ctx, DEA_ERROR, raw->step_V.location,
                         "step: from %g V to %g V in steps of %g V are more than %d voltages",
                         raw->from_V.si, raw->to_V.si, raw->step_V.si, LEVELS_MAX);
}

static dea_status build(const struct dea_reader *reader, const void *data, const char *beside,
                        struct dea_waveform *out)
{
  (void)beside;
  const struct raw *raw = data;
  size_t count;
  DEA_TRY(reader->ctx,
          dea_wave_check_rise(reader, &raw->rise_s, raw->frequency_Hz.si, raw->duty.si));
  DEA_TRY(reader->ctx, count_levels(reader, raw, &count));
  DEA_TRY(reader->ctx, dea_wave_room(reader->ctx, out, count * DEA_WAVE_PULSE_KNOTS, count));
  double each_s = raw->cycles.si / raw->frequency_Hz.si + raw->pause_s.si;
  for (size_t i = 0; i < count; i++) {
    double level = raw->value_count > 0 ? raw->values_V[i].si
                                        : raw->from_V.si + copysign((double)i * raw->step_V.si,
                                                                    raw->to_V.si - raw->from_V.si);
    const struct dea_wave_pulses pulses = {
        .low_V = raw->low_V.si,
        .high_V = level,
        .frequency_Hz = raw->frequency_Hz.si,
        .duty = raw->duty.si,
        .rise_s = raw->rise_s.si,
        .cycles = (size_t)raw->cycles.si,
    };
    dea_wave_add_pulses(out, (double)i * each_s, &pulses);
  }
  out->end_s = (double)count * each_s;
  return DEA_OK;
}

DEA_WAVE_TYPE(staircase, "pulses at one voltage after the other", .value = NULL);

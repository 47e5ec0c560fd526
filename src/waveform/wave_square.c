/* Waveform "square": pulses of equal height. */
#include "waveform/wave_make.h"

struct raw {
  struct dea_label kind;
  struct dea_quantity low_V, high_V, frequency_Hz, duty, rise_s, cycles;
};

static const struct dea_field fields[] = {
    DEA_WAVE_KIND(struct raw),
    DEA_WAVE_VOLTAGE(struct raw, low_V, "low", "voltage between pulses", .default_text = "0 kV"),
    DEA_WAVE_VOLTAGE(struct raw, high_V, "high", "voltage of a pulse", .required = true),
    DEA_WAVE_FREQUENCY(struct raw, frequency_Hz, "frequency", "pulses a second"),
    DEA_WAVE_SHARE(struct raw, duty, "duty", "share of a cycle that the pulse lasts"),
    DEA_WAVE_TIME(struct raw, rise_s, "rise_time", "how long a rise or fall takes; 0: jumps",
                  .default_text = "0 s"),
    DEA_WAVE_CYCLES(struct raw, cycles, "cycles", "number of pulses", "10"),
};

static dea_status build(const struct dea_reader *reader, const void *data, const char *beside,
                        struct dea_waveform *out)
{
  (void)beside;
  const struct raw *raw = data;
  const struct dea_wave_pulses pulses = {
      .low_V = raw->low_V.si,
      .high_V = raw->high_V.si,
      .frequency_Hz = raw->frequency_Hz.si,
      .duty = raw->duty.si,
      .rise_s = raw->rise_s.si,
      .cycles = (size_t)raw->cycles.si,
  };
  DEA_TRY(reader->ctx, dea_wave_check_rise(reader, &raw->rise_s, pulses.frequency_Hz, pulses.duty));
  DEA_TRY(reader->ctx, dea_wave_room(reader->ctx, out, DEA_WAVE_PULSE_KNOTS, 1));
  dea_wave_add_pulses(out, 0, &pulses);
  out->end_s = raw->cycles.si / pulses.frequency_Hz;
  return DEA_OK;
}

DEA_WAVE_TYPE(square, "pulses of equal height", .value = NULL);

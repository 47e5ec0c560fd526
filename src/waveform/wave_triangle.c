/* Waveform "triangle": up and down again evenly. */
#include "waveform/wave_make.h"

struct raw {
  struct dea_label kind;
  struct dea_quantity low_V, high_V, frequency_Hz, duty, cycles;
};

static const struct dea_field fields[] = {
    DEA_WAVE_KIND(struct raw),
    DEA_WAVE_VOLTAGE(struct raw, low_V, "low", "voltage at the feet", .default_text = "0 kV"),
    DEA_WAVE_VOLTAGE(struct raw, high_V, "high", "voltage at the tops", .required = true),
    DEA_WAVE_FREQUENCY(struct raw, frequency_Hz, "frequency", "cycles a second"),
    DEA_WAVE_SHARE(struct raw, duty, "duty", "share of a cycle that the way up takes"),
    DEA_WAVE_CYCLES(struct raw, cycles, "cycles", "number of cycles", "10"),
};

static dea_status build(const struct dea_reader *reader, const void *data, const char *beside,
                        struct dea_waveform *out)
{
  (void)beside;
  const struct raw *raw = data;
  DEA_TRY(reader->ctx, dea_wave_room(reader->ctx, out, 3, 1));
  dea_wave_open(out, 0, raw->frequency_Hz.si, (size_t)raw->cycles.si);
  dea_wave_add(out, 0, 0, raw->low_V.si);
  dea_wave_add(out, raw->duty.si, 0, raw->high_V.si);
  dea_wave_add(out, 1, 0, raw->low_V.si);
  out->end_s = raw->cycles.si / raw->frequency_Hz.si;
  return DEA_OK;
}

DEA_WAVE_TYPE(triangle, "up and down evenly", .value = NULL);

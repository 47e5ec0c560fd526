/* Waveform "constant": one voltage. */
#include "waveform/wave_make.h"

struct raw {
  struct dea_label kind;
  struct dea_quantity voltage_V, duration_s;
};

static const struct dea_field fields[] = {
    DEA_WAVE_KIND(struct raw),
    DEA_WAVE_VOLTAGE(struct raw, voltage_V, "voltage", "the voltage", .required = true),
    DEA_WAVE_TIME(struct raw, duration_s, "duration", "how long it lasts", .above_min = true,
                  .default_text = "10 s"),
};

static dea_status build(const struct dea_reader *reader, const void *data, const char *beside,
                        struct dea_waveform *out)
{
  (void)beside;
  const struct raw *raw = data;
  DEA_TRY(reader->ctx, dea_wave_room(reader->ctx, out, 1, 1));
  out->end_s = raw->duration_s.si;
  dea_wave_open(out, 0, 1 / out->end_s, 1);
  dea_wave_add(out, 0, 0, raw->voltage_V.si);
  return DEA_OK;
}

DEA_WAVE_TYPE(constant, "one voltage", .value = NULL);

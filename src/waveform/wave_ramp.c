/* Waveform "ramp": evenly from one voltage to another, and a time of rest there. */
#include "waveform/wave_make.h"

struct raw {
  struct dea_label kind;
  struct dea_quantity from_V, to_V, duration_s, hold_s;
};

static const struct dea_field fields[] = {
    DEA_WAVE_KIND(struct raw),
    DEA_WAVE_VOLTAGE(struct raw, from_V, "from", "voltage at the start", .default_text = "0 kV"),
    DEA_WAVE_VOLTAGE(struct raw, to_V, "to", "voltage at the end", .required = true),
    DEA_WAVE_TIME(struct raw, duration_s, "duration", "how long the ramp takes", .above_min = true,
                  .required = true),
    DEA_WAVE_TIME(struct raw, hold_s, "hold", "how long the last voltage stays",
                  .default_text = "0 s"),
};

static dea_status build(const struct dea_reader *reader, const void *data, const char *beside,
                        struct dea_waveform *out)
{
  (void)beside;
  const struct raw *raw = data;
  DEA_TRY(reader->ctx, dea_wave_room(reader->ctx, out, 2, 1));
  out->end_s = raw->duration_s.si + raw->hold_s.si;
  dea_wave_open(out, 0, 1 / out->end_s, 1);
  dea_wave_add(out, 0, 0, raw->from_V.si);
  dea_wave_add(out, 0, raw->duration_s.si, raw->to_V.si);
  return DEA_OK;
}

DEA_WAVE_TYPE(ramp, "evenly from one voltage to another", .value = NULL);

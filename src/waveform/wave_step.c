/* Waveform "step": from one voltage to another, at once or within a rise time. */
#include "waveform/wave_make.h"

struct raw {
  struct dea_label kind;
  struct dea_quantity from_V, to_V, at_s, rise_s, duration_s;
};

static const struct dea_field fields[] = {
    DEA_WAVE_KIND(struct raw),
    DEA_WAVE_VOLTAGE(struct raw, from_V, "from", "voltage before", .default_text = "0 kV"),
    DEA_WAVE_VOLTAGE(struct raw, to_V, "to", "voltage after", .required = true),
    DEA_WAVE_TIME(struct raw, at_s, "at", "when it begins to change", .default_text = "0 s"),
    DEA_WAVE_TIME(struct raw, rise_s, "rise_time", "how long the change takes; 0: a jump",
                  .default_text = "0 s"),
    DEA_WAVE_TIME(struct raw, duration_s, "duration", "how long the waveform lasts",
                  .above_min = true, .default_text = "10 s"),
};

static dea_status build(const struct dea_reader *reader, const void *data, const char *beside,
                        struct dea_waveform *out)
{
  (void)beside;
  const struct raw *raw = data;
  out->end_s = raw->duration_s.si;
  if (raw->at_s.si + raw->rise_s.si > out->end_s) {
    return dea_finding_add(reader->ctx, DEA_ERROR, raw->duration_s.location,
                           "duration: the step is over after %g s, but the waveform lasts %g s",
                           raw->at_s.si + raw->rise_s.si, out->end_s);
  }
  DEA_TRY(reader->ctx, dea_wave_room(reader->ctx, out, 3, 1));
  dea_wave_open(out, 0, 1 / out->end_s, 1);
  dea_wave_add(out, 0, 0, raw->from_V.si);
  dea_wave_add(out, 0, raw->at_s.si, raw->from_V.si);
  dea_wave_add(out, 0, raw->at_s.si + raw->rise_s.si, raw->to_V.si);
  return DEA_OK;
}

DEA_WAVE_TYPE(step, "from one voltage to another", .value = NULL);

/* What a drive is made of: who does what, and the recording that it fills. */
#include "drive/drive_loop.h"

#include "base/json.h"
#include "result/provenance.h"

#include <math.h>
#include <string.h>

static dea_status wrong_bench(struct dea_context *ctx, const char *what)
{
  return dea_fail(ctx, DEA_E_INSTRUMENT, "these instruments cannot play a protocol: %s", what);
}

/* Takes a role; false when another one has it. */
static bool assign_role(struct dea_instrument *instrument, unsigned role,
                        struct dea_instrument **who)
{
  if ((instrument->roles & role) == 0) {
    return true;
  }
  bool free = *who == NULL;
  *who = instrument;
  return free;
}

dea_status dea_drive_find_roles(struct dea_context *ctx, const struct dea_protocol *protocol,
                                const struct dea_drive_bench *bench, struct dea_drive_roles *out)
{
  *out = (struct dea_drive_roles){.player = NULL};
  if (bench->count > DEA_PROTOCOL_INSTRUMENTS_MAX) {
    return wrong_bench(ctx, "there are too many");
  }
  for (size_t i = 0; i < bench->count; i++) {
    struct dea_instrument *instrument = bench->instruments[i];
    if (!assign_role(instrument, DEA_PLAYS_OUTPUT, &out->player)) {
      return wrong_bench(ctx, "two of them play the output");
    }
    if (!assign_role(instrument, DEA_READS_INPUTS, &out->reader)) {
      return wrong_bench(ctx, "two of them read the inputs");
    }
    if (!assign_role(instrument, DEA_SENDS_PROFILES, &out->sensor)) {
      return wrong_bench(ctx, "two of them send profiles; a recording has one profile sensor");
    }
  }
  if (out->player == NULL) {
    return wrong_bench(ctx, "none of them plays the output");
  }
  if (protocol->input_count > 0 && out->reader == NULL) {
    return wrong_bench(ctx, "the protocol has channels, and none of them reads its inputs");
  }
  if (protocol->input_count == 0) {
    out->reader = NULL;
  }
  return DEA_OK;
}

/* JSON text of where it comes from; owned by the caller. */
static dea_status provenance_text(struct dea_context *ctx, const struct dea_protocol *protocol,
                                  const struct dea_drive_bench *bench, char **out)
{
  struct dea_provenance p = {.wall_s = 0};
  struct dea_text names = {.ctx = ctx};
  *out = NULL;
  DEA_TRY(ctx, dea_provenance_fill(ctx, protocol->text, strlen(protocol->text), NULL, 0, NULL, &p));
  for (size_t i = 0; i < bench->count; i++) {
    dea_text_add(&names, "%s%s", i > 0 ? ", " : "", bench->instruments[i]->type->name);
  }
  json_t *json = json_object();
  dea_json_add_text(json, "program", p.program);
  dea_json_add_text(json, "started", p.started);
  dea_json_add_text(json, "libraries", p.libraries);
  dea_json_add_text(json, "protocol_file", protocol->file);
  dea_json_add_text(json, "protocol_sha256", p.input_sha256);
  if (protocol->overrides != NULL) {
    dea_json_add_text(json, "protocol_overrides", protocol->overrides);
  }
  dea_json_add_text(json, "instruments", dea_text_get(&names));
  dea_status status = dea_json_text(ctx, json, out);
  dea_text_free(&names);
  dea_free(ctx, p.input);
  dea_free(ctx, p.overrides);
  return status;
}

/* The number of channels, DEA_CHANNELS_MAX + 1 for too many. */
static size_t list_channels(const struct dea_protocol *protocol,
                            const struct dea_drive_bench *bench,
                            struct dea_recorder_channel channels[DEA_CHANNELS_MAX])
{
  double interval_s = 1 / protocol->rate_Hz.si;
  size_t count = 0;
  channels[count++] = (struct dea_recorder_channel){
      .name = "command", .kind = DEA_CHANNEL_COMMAND, .interval_s = interval_s, .filter_Hz = NAN};
  for (size_t i = 0; i < protocol->input_count; i++) {
    const struct dea_protocol_input *input = &protocol->inputs[i];
    const char *unit = input->kind.value == DEA_CHANNEL_OTHER ? input->unit.text : NULL;
    double reach = fabs(input->range_V.si * input->per_volt);
    channels[count++] =
        (struct dea_recorder_channel){.name = input->name.text,
                                      .kind = (enum dea_channel_kind)input->kind.value,
                                      .unit = unit,
                                      .interval_s = interval_s,
                                      .filter_Hz = input->filter_Hz.si,
                                      .lowest = input->at_zero - reach,
                                      .highest = input->at_zero + reach};
  }
  for (size_t i = 0; i < bench->count; i++) {
    for (size_t k = 0; k < bench->instruments[i]->reading_count; k++) {
      const struct dea_instrument_reading *reading = &bench->instruments[i]->readings[k];
      if (count == DEA_CHANNELS_MAX) {
        return DEA_CHANNELS_MAX + 1;
      }
      const char *unit = reading->unit[0] != '\0' ? reading->unit : NULL;
      channels[count++] = (struct dea_recorder_channel){
          .name = reading->name, .kind = reading->kind, .unit = unit, .filter_Hz = NAN};
    }
  }
  return count;
}

dea_status dea_drive_recorder(struct dea_context *ctx, const struct dea_protocol *protocol,
                              const struct dea_drive_bench *bench, const char *file,
                              const struct dea_instrument *sensor, struct dea_recorder **out)
{
  struct dea_recorder_channel channels[DEA_CHANNELS_MAX];
  struct dea_recorder_options options = {
      .title = protocol->title.text,
      .protocol = protocol->text,
      .design = protocol->design_text,
      .design_name = protocol->design_text != NULL ? protocol->design_file.text : NULL,
      .channels = channels,
      .channel_count = list_channels(protocol, bench, channels),
  };
  if (sensor != NULL) {
    options.profile_points = sensor->profile_points;
    options.x_m = sensor->x_m;
  }
  char *provenance;
  DEA_TRY(ctx, provenance_text(ctx, protocol, bench, &provenance));
  options.provenance = provenance;
  dea_status status = dea_recorder_create(ctx, file, &options, out);
  dea_free(ctx, provenance);
  return status;
}

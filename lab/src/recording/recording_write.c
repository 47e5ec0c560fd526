/* A whole recording as a new file, through the recorder. */
#include "recording/recorder.h"

#include <stdio.h>

static dea_status add_all(struct dea_recorder *recorder, const struct dea_recording *recording)
{
  dea_status status = DEA_OK;
  for (size_t c = 0; c < recording->channel_count && status == DEA_OK; c++) {
    const struct dea_channel *channel = &recording->channels[c];
    status =
        channel->interval_s > 0
            ? dea_recorder_add(recorder, c, channel->values, channel->count)
            : dea_recorder_add_timed(recorder, c, channel->time_s, channel->values, channel->count);
  }
  const struct dea_profiles *profiles = &recording->profiles;
  for (size_t i = 0; i < profiles->count && status == DEA_OK; i++) {
    status = dea_recorder_add_profile(recorder, profiles->time_s[i],
                                      profiles->z_m + i * profiles->points);
  }
  for (size_t i = 0; i < recording->cycle_count && status == DEA_OK; i++) {
    status = dea_recorder_add_cycle(recorder, &recording->cycles[i]);
  }
  for (size_t i = 0; i < recording->event_count && status == DEA_OK; i++) {
    status = dea_recorder_add_event(recorder, &recording->events[i]);
  }
  return status;
}

dea_status dea_recording_write(struct dea_context *ctx, const struct dea_recording *recording,
                               const char *file)
{
  struct dea_recorder_channel channels[DEA_CHANNELS_MAX];
  struct dea_recorder_options options = {
      .title = recording->title,
      .protocol = recording->protocol,
      .design = recording->design,
      .design_name = recording->design_name,
      .provenance = recording->provenance,
      .channels = channels,
      .channel_count = recording->channel_count,
      .profile_points = recording->profiles.points,
      .x_m = recording->profiles.x_m,
      .flush_s = INFINITY,
      .plain = true,
  };
  for (size_t c = 0; c < recording->channel_count; c++) {
    const struct dea_channel *channel = &recording->channels[c];
    channels[c] = (struct dea_recorder_channel){
        channel->name,       channel->kind,      channel->unit,   channel->start_s,
        channel->interval_s, channel->filter_Hz, channel->lowest, channel->highest};
  }
  struct dea_recorder *recorder;
  DEA_TRY(ctx, dea_recorder_create(ctx, file, &options, &recorder));
  dea_status status = add_all(recorder, recording);
  const char *ended = recording->ended[0] != '\0' ? recording->ended : "for an unknown reason";
  dea_recorder_set_output(recorder, recording->output);
  dea_status finished = dea_recorder_finish(recorder, recording->complete ? NULL : ended);
  status = status != DEA_OK ? status : finished;
  if (status != DEA_OK) {
    remove(file); // half a copy is of no use
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}

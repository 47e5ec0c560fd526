/* A recording in memory. */
#include "recording/recording.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

/* The table that the list of recording.h is written for. */
const struct dea_channel_meaning dea_channel_meanings[DEA_CHANNEL_KINDS] = {
#define DEA_CHANNEL_MEANING(enumerator, name, si, display, factor, meaning)                        \
  {name, si, display, factor, meaning},
    DEA_CHANNEL_LIST(DEA_CHANNEL_MEANING)
#undef DEA_CHANNEL_MEANING
};

const char *const dea_channel_names[DEA_CHANNEL_KINDS + 1] = {
#define DEA_CHANNEL_NAME(enumerator, name, si, display, factor, meaning) name,
    DEA_CHANNEL_LIST(DEA_CHANNEL_NAME)
#undef DEA_CHANNEL_NAME
        NULL};

dea_status dea_recording_create(struct dea_context *ctx, struct dea_recording **out)
{
  *out = dea_alloc(ctx, 1, sizeof **out);
  DEA_TRY_MEMORY(*out != NULL);
  (*out)->file = "";
  (*out)->title = dea_copy_text(ctx, "", 0);
  if ((*out)->title == NULL) {
    dea_free(ctx, *out);
    *out = NULL;
    return DEA_E_MEMORY;
  }
  return DEA_OK;
}

void dea_recording_destroy(struct dea_context *ctx, struct dea_recording *recording)
{
  if (recording == NULL) {
    return;
  }
  for (size_t c = 0; c < recording->channel_count; c++) {
    dea_free(ctx, recording->channels[c].time_s);
    dea_free(ctx, recording->channels[c].values);
  }
  dea_free(ctx, recording->profiles.x_m);
  dea_free(ctx, recording->profiles.time_s);
  dea_free(ctx, recording->profiles.z_m);
  dea_free(ctx, recording->cycles);
  dea_free(ctx, recording->events);
  dea_free(ctx, recording->title);
  dea_free(ctx, recording->protocol);
  dea_free(ctx, recording->design);
  dea_free(ctx, recording->design_name);
  dea_free(ctx, recording->provenance);
  dea_free(ctx, recording);
}

const struct dea_channel *dea_recording_kind(const struct dea_recording *recording,
                                             enum dea_channel_kind kind)
{
  for (size_t c = 0; c < recording->channel_count; c++) {
    if (recording->channels[c].kind == kind) {
      return &recording->channels[c];
    }
  }
  return NULL;
}

const struct dea_channel *dea_recording_channel(const struct dea_recording *recording,
                                                const char *name)
{
  for (size_t c = 0; c < recording->channel_count; c++) {
    if (strcmp(recording->channels[c].name, name) == 0) {
      return &recording->channels[c];
    }
  }
  return NULL;
}

void dea_recording_name_apart(const struct dea_recording *recording, struct dea_channel *channel)
{
  char name[DEA_CHANNEL_NAME_SIZE];
  snprintf(name, sizeof name, "%s", channel->name);
  for (int k = 2; dea_recording_channel(recording, channel->name) != NULL; k++) {
    snprintf(channel->name, sizeof channel->name, "%.*s %d",
             (int)dea_text_cut(name, sizeof name - 8), name, k);
  }
}

bool dea_samples_same(const double *a, const double *b, size_t count)
{
  bool same = true;
  for (size_t i = 0; same && i < count; i++) {
    same = a[i] == b[i] || (isnan(a[i]) && isnan(b[i]));
  }
  return same;
}

size_t dea_channel_index(const struct dea_channel *channel, double time_s)
{
  size_t low = 0, high = channel->count; // all before low are earlier, high and later are not
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (dea_channel_time(channel, middle) < time_s) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

void dea_noticed_text(const struct dea_recorded_event *event, const char *channel,
                      char out[DEA_NOTICED_TEXT_SIZE])
{
  double value = event->value, limit = event->limit;
  size_t size = DEA_NOTICED_TEXT_SIZE;
  switch (event->kind) {
  case DEA_NOTICED_LEARNED:
    snprintf(out, size, "'%.60s' has a base line: up to %.4g uA; above %.4g uA is a rise", channel,
             1e6 * value, 1e6 * limit);
    break;
  case DEA_NOTICED_SCATTER:
    snprintf(out, size,
             "'%.60s' has no base line: with %.4g uA and its scatter in equal cycles a rise would "
             "begin at %.4g uA, above the fixed limit, which alone is left",
             channel, 1e6 * value, 1e6 * limit);
    break;
  case DEA_NOTICED_DRIFTED:
    snprintf(out, size,
             "'%.60s': the base line has risen to %.4g uA, as far as it may; above %.4g uA it ends",
             channel, 1e6 * value, 1e6 * limit);
    break;
  case DEA_NOTICED_LEAK_ROSE:
    snprintf(out, size, "'%.60s' has risen to %.4g uA, above %.4g uA", channel, 1e6 * value,
             1e6 * limit);
    break;
  case DEA_NOTICED_READ_BACK:
    snprintf(out, size, "'%.60s' reads back %.4g kV where %.4g kV is asked", channel, 1e-3 * value,
             1e-3 * limit);
    break;
  default:
    snprintf(out, size, "'%.60s' has given no value for %.3g s; for %.3g s it ends", channel, value,
             limit);
  }
}

/* Two recordings of one measurement as one. */
#include "recording/recording.h"

#include "base/json.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* From the first sample or frame to the last; lowest above highest without any. */
struct span {
  double first_s, last_s;
};

static struct span span_of(const struct dea_recording *recording)
{
  struct span span = {INFINITY, -INFINITY};
  for (size_t c = 0; c < recording->channel_count; c++) {
    const struct dea_channel *channel = &recording->channels[c];
    if (channel->count > 0) {
      span.first_s = fmin(span.first_s, dea_channel_time(channel, 0));
      span.last_s = fmax(span.last_s, dea_channel_time(channel, channel->count - 1));
    }
  }
  if (recording->profiles.count > 0) {
    span.first_s = fmin(span.first_s, recording->profiles.time_s[0]);
    span.last_s = fmax(span.last_s, recording->profiles.time_s[recording->profiles.count - 1]);
  }
  return span;
}

static bool is_same(const struct dea_channel *a, const struct dea_channel *b)
{
  return a->count == b->count && a->count > 1 && a->kind == b->kind &&
         dea_samples_same(a->values, b->values, a->count);
}

/* Whether all that the other has is there already, under whatever name. */
static bool has_all(const struct dea_recording *recording, const struct dea_recording *other)
{
  bool all = other->channel_count > 0 && other->profiles.count == 0;
  for (size_t k = 0; k < other->channel_count && all; k++) {
    bool found = false;
    for (size_t i = 0; i < recording->channel_count && !found; i++) {
      found = is_same(&recording->channels[i], &other->channels[k]);
    }
    all = found;
  }
  return all;
}

static dea_status check(struct dea_context *ctx, const struct dea_recording *recording,
                        const struct dea_recording *other, double after_s)
{
  const struct span a = span_of(recording), b = span_of(other);
  if (has_all(recording, other)) {
    return dea_fail(ctx, DEA_E_IO, "what '%s' has is in '%s' already, value by value", other->file,
                    recording->file);
  }
  if (recording->channel_count + other->channel_count > DEA_CHANNELS_MAX) {
    return dea_fail(ctx, DEA_E_IO, "'%s' and '%s' have more than %d channels together",
                    recording->file, other->file, (int)DEA_CHANNELS_MAX);
  }
  if (recording->profiles.count > 0 && other->profiles.count > 0) {
    return dea_fail(ctx, DEA_E_IO,
                    "'%s' and '%s' both have profiles, and a recording has those of "
                    "one sensor",
                    recording->file, other->file);
  }
  if (recording->cycle_count > 0 && other->cycle_count > 0) {
    return dea_fail(ctx, DEA_E_IO,
                    "'%s' and '%s' both have cycles of a drive, and a recording has "
                    "those of one",
                    recording->file, other->file);
  }
  if (a.first_s <= a.last_s && b.first_s <= b.last_s &&
      !(b.first_s + after_s <= a.last_s && b.last_s + after_s >= a.first_s)) {
    return dea_fail(ctx, DEA_E_IO,
                    "'%s' lasts from %.6g to %.6g s on the clock of '%s', which lasts from %.6g "
                    "to %.6g s: they have no moment together",
                    other->file, b.first_s + after_s, b.last_s + after_s, recording->file,
                    a.first_s, a.last_s);
  }
  return DEA_OK;
}

static void shift(double *time_s, size_t count, double by_s)
{
  for (size_t i = 0; time_s != NULL && i < count; i++) {
    time_s[i] += by_s;
  }
}

/* Takes what the first one lacks. */
static void move_text(char **own, char **other)
{
  if (*own == NULL || (*own)[0] == '\0') {
    char *kept = *own;
    *own = *other;
    *other = kept;
  }
}

/* What the first says of where it comes from, with the other and its own. */
static dea_status join_provenance(struct dea_context *ctx, struct dea_recording *recording,
                                  const struct dea_recording *other, double after_s)
{
  json_t *json = recording->provenance != NULL ? json_loads(recording->provenance, 0, NULL) : NULL;
  json_t *own = other->provenance != NULL ? json_loads(other->provenance, 0, NULL) : NULL;
  json_t *part = json_object();
  dea_json_add_text(part, "file", other->file);
  dea_json_add(part, "after_s", after_s);
  json_object_set_new(part, "provenance", own != NULL ? own : json_null());
  if (!json_is_object(json)) {
    json_decref(json);
    json = json_object();
  }
  json_t *joined = json_object_get(json, "joined");
  if (!json_is_array(joined)) {
    json_object_set_new(json, "joined", json_array());
    joined = json_object_get(json, "joined");
  }
  json_array_append_new(joined, part);
  char *text = json_dumps(json, JSON_INDENT(2) | JSON_SORT_KEYS);
  json_decref(json);
  char *copy = text != NULL ? dea_copy_text(ctx, text, SIZE_MAX) : NULL;
  free(text);
  if (copy == NULL) {
    return dea_fail(ctx, DEA_E_MEMORY, "out of memory");
  }
  dea_free(ctx, recording->provenance);
  recording->provenance = copy;
  return DEA_OK;
}

static dea_status join_events(struct dea_context *ctx, struct dea_recording *recording,
                              const struct dea_recording *other, double after_s)
{
  const size_t count = recording->event_count + other->event_count;
  if (other->event_count == 0) {
    return DEA_OK;
  }
  void *moved = dea_resize(ctx, recording->events, count, sizeof *recording->events);
  DEA_TRY_MEMORY(moved != NULL);
  recording->events = moved;
  for (size_t i = 0; i < other->event_count; i++) {
    struct dea_recorded_event *event = &recording->events[recording->event_count++];
    *event = other->events[i];
    event->time_s += after_s;
    event->channel += recording->channel_count; // before the other's are there
  }
  return DEA_OK;
}

static void move_channels(struct dea_recording *recording, struct dea_recording *other,
                          double after_s)
{
  for (size_t c = 0; c < other->channel_count; c++) {
    struct dea_channel *channel = &other->channels[c];
    dea_recording_name_apart(recording, channel);
    channel->start_s += after_s;
    shift(channel->time_s, channel->count, after_s);
    recording->channels[recording->channel_count++] = *channel;
  }
  other->channel_count = 0;
}

/* Exchanges what both have room for, so that each is freed with one of them. */
static void move_profiles(struct dea_recording *recording, struct dea_recording *other,
                          double after_s)
{
  if (other->profiles.count > 0) {
    const struct dea_profiles kept = recording->profiles;
    shift(other->profiles.time_s, other->profiles.count, after_s);
    recording->profiles = other->profiles;
    other->profiles = kept;
  }
}

static void move_cycles(struct dea_recording *recording, struct dea_recording *other,
                        double after_s)
{
  if (other->cycle_count > 0) {
    struct dea_recorded_cycle *kept = recording->cycles;
    for (size_t i = 0; i < other->cycle_count; i++) {
      other->cycles[i].start_s += after_s;
      other->cycles[i].end_s += after_s;
    }
    recording->cycles = other->cycles;
    recording->cycle_count = other->cycle_count;
    other->cycles = kept;
    other->cycle_count = 0;
  }
}

/* Of times first_s ... last_s, a step apart on average, what they cover. */
static void narrow(struct span *span, double first_s, double last_s, size_t count)
{
  const double step_s = count > 1 ? (last_s - first_s) / (double)(count - 1) : INFINITY;
  span->first_s = fmax(span->first_s, first_s - 0.5 * step_s);
  span->last_s = fmin(span->last_s, last_s + 1.5 * step_s);
}

/* What all channels and the profiles of a recording cover, to half a sample. */
static struct span common_of(const struct dea_recording *recording)
{
  struct span span = {-INFINITY, INFINITY};
  for (size_t c = 0; c < recording->channel_count; c++) {
    const struct dea_channel *channel = &recording->channels[c];
    if (channel->count > 0) {
      narrow(&span, dea_channel_time(channel, 0), dea_channel_time(channel, channel->count - 1),
             channel->count);
    }
  }
  const struct dea_profiles *profiles = &recording->profiles;
  if (profiles->count > 0) {
    narrow(&span, profiles->time_s[0], profiles->time_s[profiles->count - 1], profiles->count);
  }
  return span;
}

/* Leaves out the cycles of one that the other did not measure; shift_s: what the one's clock shows
 * where the other's shows 0. Where none is left it fails, with all as they were. */
static dea_status drop_cycles(struct dea_context *ctx, struct dea_recording *of,
                              const struct dea_recording *other, double shift_s)
{
  const struct dea_location location = {.file = other->file};
  const struct span covered = common_of(other);
  const double first_s = covered.first_s + shift_s, last_s = covered.last_s + shift_s;
  const size_t before = of->cycle_count;
  size_t kept = 0;
  for (size_t i = 0; i < before; i++) {
    kept += of->cycles[i].start_s >= first_s && of->cycles[i].end_s <= last_s;
  }
  if (kept == 0 && before > 0) {
    return dea_fail(ctx, DEA_E_IO, "'%s' covers none of the %zu cycles of '%s' from begin to end",
                    other->file, before, of->file);
  }
  of->cycle_count = 0;
  for (size_t i = 0; i < before; i++) {
    if (of->cycles[i].start_s >= first_s && of->cycles[i].end_s <= last_s) {
      of->cycles[of->cycle_count++] = of->cycles[i];
    }
  }
  return kept == before ? DEA_OK
                        : dea_finding_add(
                              ctx, DEA_WARNING, location,
                              "it does not cover %zu of the %zu cycles of '%s', which are left out",
                              before - kept, before, of->file);
}

dea_status dea_recording_join(struct dea_context *ctx, struct dea_recording *recording,
                              struct dea_recording *other, double after_s)
{
  DEA_TRY(ctx, check(ctx, recording, other, after_s));
  DEA_TRY(ctx, drop_cycles(ctx, recording, other, after_s));
  DEA_TRY(ctx, drop_cycles(ctx, other, recording, -after_s));
  DEA_TRY(ctx, join_provenance(ctx, recording, other, after_s));
  DEA_TRY(ctx, join_events(ctx, recording, other, after_s));
  move_channels(recording, other, after_s);
  move_profiles(recording, other, after_s);
  move_cycles(recording, other, after_s);
  move_text(&recording->title, &other->title);
  move_text(&recording->protocol, &other->protocol);
  if (recording->design == NULL) {
    move_text(&recording->design, &other->design);
    move_text(&recording->design_name, &other->design_name);
  }
  if (recording->complete && !other->complete) {
    recording->complete = false;
    snprintf(recording->ended, sizeof recording->ended, "%s", other->ended);
  }
  static const char zero[] = "at 0 V"; // what is known of the other may be worse
  if (other->output[0] != '\0' &&
      (recording->output[0] == '\0' || strncmp(other->output, zero, sizeof zero - 1) != 0)) {
    snprintf(recording->output, sizeof recording->output, "%s", other->output);
  }
  return DEA_OK;
}

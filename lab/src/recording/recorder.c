#include "recording/recorder.h"

#include "base/clock.h"
#include "base/write_file.h"
#include "recording/disk.h"
#include "recording/recording_layout.h"
#include "recording/series.h"

#include <stdio.h>
#include <string.h>

enum { GROUP_NAME_SIZE = DEA_CHANNEL_NAME_SIZE + 24 };

static const char cannot_write[] = "cannot write";

struct recorded_channel {
  struct dea_recorded_series values, time; // the second only with interval 0
  bool timed;
  double last_s;
};

struct dea_recorder {
  struct dea_context *ctx;
  char *path;
  dea_status status; // of the first failure; after it nothing more is written
  struct dea_disk disk;
  hid_t file;
  struct recorded_channel channels[DEA_CHANNELS_MAX];
  size_t channel_count;
  struct dea_recorded_series frame_time, frames, cycles, events;
  double last_frame_s;
  char output[DEA_OUTPUT_SIZE]; // what is known of it at the end
  double flush_s, flushed_s;    // longest time between flushes, time of the last one
};

// Making the file --------------------------------------------------------------------------------

static dea_status refuse(struct dea_context *ctx, const char *what)
{
  return dea_fail(ctx, DEA_E_ARGUMENT, "a recording cannot be made: %s", what);
}

static bool is_new_name(const struct dea_recorder_channel *channels, size_t c)
{
  for (size_t k = 0; k < c; k++) {
    if (strcmp(channels[k].name, channels[c].name) == 0) {
      return false;
    }
  }
  return true;
}

static dea_status check_options(struct dea_context *ctx, const struct dea_recorder_options *options)
{
  if (options->channel_count > DEA_CHANNELS_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a recording has %d channels at most, not %zu",
                    DEA_CHANNELS_MAX, options->channel_count);
  }
  for (size_t c = 0; c < options->channel_count; c++) {
    const struct dea_recorder_channel *channel = &options->channels[c];
    size_t length = strlen(channel->name);
    if (length == 0 || length >= DEA_CHANNEL_NAME_SIZE || !is_new_name(options->channels, c)) {
      return dea_fail(ctx, DEA_E_ARGUMENT,
                      "'%s' cannot name a channel: names are of 1 to %d bytes, and each one once",
                      channel->name, DEA_CHANNEL_NAME_SIZE - 1);
    }
    if ((int)channel->kind < 0 || channel->kind >= DEA_CHANNEL_KINDS ||
        (channel->unit != NULL && strlen(channel->unit) >= DEA_CHANNEL_NAME_SIZE) ||
        !isfinite(channel->start_s) || !isfinite(channel->interval_s) || channel->interval_s < 0) {
      return refuse(ctx, "a channel's kind, unit or clock makes no sense");
    }
  }
  if (options->profile_points > (1U << 20)) {
    return refuse(ctx, "a profile has more than 1048576 points");
  }
  for (size_t i = 0; i < options->profile_points; i++) {
    if (!isfinite(options->x_m[i]) || (i > 0 && options->x_m[i] <= options->x_m[i - 1])) {
      return refuse(ctx, "the positions of the profile do not rise");
    }
  }
  return DEA_OK;
}

/* Name of a channel's group: its name, where that can be one ('/' leads into groups, '.' to the
 * group itself), otherwise made from it. */
static void group_name(struct h5 *h, hid_t channels, const char *name, char out[GROUP_NAME_SIZE])
{
  snprintf(out, GROUP_NAME_SIZE, "%s", name);
  for (size_t n = 2;; n++) {
    for (char *c = out; *c != '\0'; c++) {
      *c = *c == '/' ? '_' : *c;
    }
    if (strcmp(out, ".") != 0 && !dea_h5_has(h, channels, out)) {
      return;
    }
    snprintf(out, GROUP_NAME_SIZE, "%s (%zu)", name, n);
  }
}

/* Rows of a chunk: about a second of samples, so that a slow channel takes little room. */
static size_t chunk_rows(double interval_s)
{
  size_t rows = 1024;
  while (rows < 65536 && interval_s > 0 && (double)rows * interval_s < 1.0) {
    rows *= 2;
  }
  return rows;
}

static size_t frame_rows(size_t points)
{
  return points < 65536 ? 65536 / points : 1;
}

static void create_channel(struct h5 *h, hid_t channels, size_t index,
                           const struct dea_recorder_channel *channel, char *key)
{
  const struct dea_channel_meaning *meaning = &dea_channel_meanings[channel->kind];
  const char *unit = channel->unit != NULL ? channel->unit : meaning->si_unit;
  group_name(h, channels, channel->name, key);
  hid_t group = dea_h5_group_create(h, channels, key);
  dea_h5_write_text(h, group, "name", channel->name);
  dea_h5_write_text(h, group, "quantity", meaning->name);
  dea_h5_write_text(h, group, "unit", unit);
  dea_h5_write_int(h, group, "index", (long long)index);
  dea_h5_write_real(h, group, "start_s", channel->start_s);
  dea_h5_write_real(h, group, "interval_s", channel->interval_s);
  dea_h5_write_real(h, group, "filter_Hz", channel->filter_Hz);
  if (channel->lowest < channel->highest) {
    dea_h5_write_real(h, group, "lowest", channel->lowest);
    dea_h5_write_real(h, group, "highest", channel->highest);
  }
  size_t rows = chunk_rows(channel->interval_s);
  dea_series_create(h, group, "values", 1, rows, unit, meaning->meaning);
  if (channel->interval_s == 0) {
    dea_series_create(h, group, "time", 1, rows, "s", "time of each value");
  }
  dea_h5_close(group);
}

static void build_profiles(struct h5 *h, hid_t file, const struct dea_recorder_options *options)
{
  size_t points = options->profile_points;
  if (points == 0) {
    return;
  }
  hid_t group = dea_h5_group_create(h, file, "profiles");
  dea_h5_write_array(h, group, "x_m", H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, points, options->x_m, "m",
                     "positions along the line");
  dea_series_create(h, group, "time_s", 1, 1024, "s", "time of each frame");
  dea_series_create(h, group, "z_m", points, frame_rows(points), "m",
                    "height at each position, a row a frame; NAN: no valid point");
  dea_h5_close(group);
}

static void build_texts(struct h5 *h, hid_t file, const struct dea_recorder_options *options)
{
  dea_h5_write_text(h, file, "format", DEA_RECORDING_FORMAT);
  dea_h5_write_int(h, file, "version", DEA_RECORDING_VERSION);
  dea_h5_write_long_text(h, file, "title", options->title);
  dea_h5_write_long_text(h, file, "protocol", options->protocol);
  dea_h5_write_long_text(h, file, "design", options->design);
  dea_h5_write_long_text(h, file, "design_name", options->design_name);
  dea_h5_write_long_text(h, file, "provenance", options->provenance);
  char state[DEA_STATE_SIZE];
  memset(state, ' ', sizeof state);
  state[sizeof state - 1] = '\0'; // as long as what comes to stand there
  dea_h5_write_long_text(h, file, "state", state);
  dea_h5_write_long_text(h, file, "output", state);
}

/* Overwrites a text of a fixed size. */
static void set_text(struct h5 *h, const struct dea_recorder *recorder, const char *name,
                     const char *text)
{
  if (h->status != DEA_OK) {
    return;
  }
  char state[DEA_STATE_SIZE] = "";
  snprintf(state, sizeof state, "%s", text);
  hid_t set = dea_h5_array_open(h, recorder->file, name);
  hid_t type = set >= 0 ? H5Dget_type(set) : H5I_INVALID_HID;
  if (type < 0 || H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, state) < 0 ||
      H5Dflush(set) < 0) {
    dea_h5_fail(h, cannot_write);
  }
  dea_h5_close(type);
  dea_h5_close(set);
}

/* A write that failed, of which HDF5 knows nothing. */
static void check_disk(struct h5 *h, const struct dea_recorder *recorder)
{
  if (h->status == DEA_OK && recorder->disk.error != 0) {
    h->status = dea_fail(h->ctx, DEA_E_IO, "cannot write %s: %s", h->path,
                         recorder->disk.error == DEA_DISK_CUT ? "another program has cut it off"
                                                              : strerror(recorder->disk.error));
  }
}

static hid_t create_file(struct h5 *h, bool plain, struct dea_disk *disk)
{
  hid_t access = H5Pcreate(H5P_FILE_ACCESS), creation = H5Pcreate(H5P_FILE_CREATE);
  if (!plain) {
    // what SWMR needs; small objects within a page, which the system writes as a whole or not
    H5Pset_metadata_read_attempts(access, 1); // nobody else writes
    H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    H5Pset_file_space_strategy(creation, H5F_FSPACE_STRATEGY_PAGE, false, 1);
    H5Pset_file_space_page_size(creation, 4096);
  }
  hid_t file = H5I_INVALID_HID;
  if (dea_disk_use(access, disk)) {
    file = H5Fcreate(h->path, H5F_ACC_EXCL, creation, access);
  }
  dea_h5_close(creation);
  dea_h5_close(access);
  if (file < 0 && disk->error != 0) {
    h->status = dea_fail(h->ctx, DEA_E_IO, "cannot make %s: %s", h->path, strerror(disk->error));
  } else if (file < 0) {
    dea_h5_fail(h, cannot_write);
  }
  return file;
}

static void open_channel(struct h5 *h, hid_t channels, const char *key, double interval_s,
                         struct recorded_channel *channel)
{
  hid_t group = dea_h5_group_open(h, channels, key);
  size_t rows = chunk_rows(interval_s);
  dea_series_open(h, group, "values", 1, rows, &channel->values);
  channel->timed = interval_s == 0;
  channel->last_s = -INFINITY;
  if (channel->timed) {
    dea_series_open(h, group, "time", 1, rows, &channel->time);
  }
  dea_h5_close(group);
}

/* Makes all objects first: once the file has readers, no more can be added. */
static void create_objects(struct h5 *h, struct dea_recorder *recorder,
                           const struct dea_recorder_options *options)
{
  char keys[DEA_CHANNELS_MAX][GROUP_NAME_SIZE];
  hid_t file = recorder->file;
  build_texts(h, file, options);
  hid_t channels = dea_h5_group_create(h, file, "channels");
  for (size_t c = 0; c < options->channel_count && h->status == DEA_OK; c++) {
    create_channel(h, channels, c, &options->channels[c], keys[c]);
  }
  dea_h5_close(channels);
  build_profiles(h, file, options);
  dea_series_create(h, file, "cycles", DEA_CYCLE_WIDTH, 1024, "1",
                    "completed cycles: step, number in it, start (s), end (s), level (V)");
  dea_series_create(h, file, "events", DEA_NOTICED_WIDTH, 64, "1",
                    "what the watches noticed: time (s), kind, channel, value, limit");
  set_text(h, recorder, "state", DEA_STATE_RUNNING);
  set_text(h, recorder, "output", "");
  if (h->status == DEA_OK && H5Fflush(file, H5F_SCOPE_GLOBAL) < 0) {
    dea_h5_fail(h, cannot_write);
  }
  check_disk(h, recorder); // now: what comes next reads what was written
  if (h->status == DEA_OK && !options->plain && H5Fstart_swmr_write(file) < 0) {
    dea_h5_fail(h, cannot_write);
  }
  check_disk(h, recorder);
  channels = dea_h5_group_open(h, file, "channels");
  for (size_t c = 0; c < options->channel_count && h->status == DEA_OK; c++) {
    open_channel(h, channels, keys[c], options->channels[c].interval_s, &recorder->channels[c]);
    recorder->channel_count++;
  }
  dea_h5_close(channels);
  if (options->profile_points > 0) {
    size_t points = options->profile_points;
    hid_t profiles = dea_h5_group_open(h, file, "profiles");
    dea_series_open(h, profiles, "time_s", 1, 1024, &recorder->frame_time);
    dea_series_open(h, profiles, "z_m", points, frame_rows(points), &recorder->frames);
    dea_h5_close(profiles);
  }
  dea_series_open(h, file, "cycles", DEA_CYCLE_WIDTH, 1024, &recorder->cycles);
  dea_series_open(h, file, "events", DEA_NOTICED_WIDTH, 64, &recorder->events);
}

static void close_all(struct dea_recorder *recorder)
{
  struct dea_context *ctx = recorder->ctx;
  for (size_t c = 0; c < recorder->channel_count; c++) {
    dea_series_close(ctx, &recorder->channels[c].values);
    dea_series_close(ctx, &recorder->channels[c].time);
  }
  dea_series_close(ctx, &recorder->frame_time);
  dea_series_close(ctx, &recorder->frames);
  dea_series_close(ctx, &recorder->cycles);
  dea_series_close(ctx, &recorder->events);
  dea_h5_close(recorder->file);
}

static void destroy(struct dea_recorder *recorder)
{
  dea_free(recorder->ctx, recorder->path);
  dea_free(recorder->ctx, recorder);
}

static dea_status recorder_make(struct dea_context *ctx, const char *file,
                                const struct dea_recorder_options *options,
                                struct dea_recorder **out)
{
  const struct dea_recorded_series none = {.set = H5I_INVALID_HID};
  struct dea_recorder *recorder = *out = dea_alloc(ctx, 1, sizeof *recorder);
  DEA_TRY_MEMORY(recorder != NULL);
  *recorder = (struct dea_recorder){
      .ctx = ctx, .file = H5I_INVALID_HID, .disk = {.file = -1, .lasting = !options->plain}};
  for (size_t c = 0; c < DEA_CHANNELS_MAX; c++) {
    recorder->channels[c] = (struct recorded_channel){.values = none, .time = none};
  }
  recorder->frame_time = recorder->frames = recorder->cycles = recorder->events = none;
  recorder->last_frame_s = -INFINITY;
  recorder->flush_s = options->flush_s > 0 ? options->flush_s : 0.2;
  recorder->flushed_s = dea_clock_s();
  recorder->path = dea_copy_text(ctx, file, SIZE_MAX);
  DEA_TRY_MEMORY(recorder->path != NULL);
  struct h5 h;
  dea_h5_begin(&h, ctx, recorder->path);
  recorder->file = create_file(&h, options->plain, &recorder->disk);
  if (h.status == DEA_OK) {
    create_objects(&h, recorder, options);
  }
  check_disk(&h, recorder);
  dea_h5_end(&h);
  return h.status;
}

dea_status dea_recorder_create(struct dea_context *ctx, const char *file,
                               const struct dea_recorder_options *options,
                               struct dea_recorder **out)
{
  *out = NULL;
  DEA_TRY(ctx, check_options(ctx, options));
  if (dea_path_exists(file)) {
    return dea_fail(ctx, DEA_E_IO, "%s exists; a recording is never written over: give a new name",
                    file);
  }
  struct dea_recorder *recorder;
  dea_status status = recorder_make(ctx, file, options, &recorder);
  if (status != DEA_OK && recorder != NULL) {
    bool made = recorder->file >= 0;
    close_all(recorder);
    destroy(recorder);
    recorder = NULL;
    if (made) {
      remove(file); // there was none of that name before
    }
  }
  *out = recorder;
  return status;
}

// Filling it -------------------------------------------------------------------------------------

/* A call of the recorder begins and ends: nothing is done after a failure. */
static void begin(const struct dea_recorder *recorder, struct h5 *h)
{
  dea_h5_begin(h, recorder->ctx, recorder->path);
  h->status = recorder->status;
}

static dea_status end(struct dea_recorder *recorder, struct h5 *h)
{
  check_disk(h, recorder);
  dea_h5_end(h);
  recorder->status = h->status;
  return h->status;
}

/* Samples first: a reader must never find a cycle without them. */
static void flush_samples(struct h5 *h, struct dea_recorder *recorder)
{
  for (size_t c = 0; c < recorder->channel_count; c++) {
    dea_series_flush(h, &recorder->channels[c].values);
    if (recorder->channels[c].timed) {
      dea_series_flush(h, &recorder->channels[c].time);
    }
  }
  if (recorder->frames.set >= 0) {
    dea_series_flush(h, &recorder->frames);
    dea_series_flush(h, &recorder->frame_time);
  }
  recorder->flushed_s = dea_clock_s();
}

static void flush_when_due(struct h5 *h, struct dea_recorder *recorder)
{
  if (dea_clock_s() - recorder->flushed_s >= recorder->flush_s) {
    flush_samples(h, recorder);
  }
}

dea_status dea_recorder_add(struct dea_recorder *recorder, size_t channel, const double *values,
                            size_t count)
{
  if (channel >= recorder->channel_count || recorder->channels[channel].timed) {
    return refuse(recorder->ctx, "samples for a channel without a clock");
  }
  struct h5 h;
  begin(recorder, &h);
  dea_series_add(&h, &recorder->channels[channel].values, values, count);
  flush_when_due(&h, recorder);
  return end(recorder, &h);
}

dea_status dea_recorder_add_timed(struct dea_recorder *recorder, size_t channel,
                                  const double *time_s, const double *values, size_t count)
{
  if (channel >= recorder->channel_count || !recorder->channels[channel].timed) {
    return refuse(recorder->ctx, "samples with times for a channel that has a clock");
  }
  struct recorded_channel *target = &recorder->channels[channel];
  for (size_t i = 0; i < count; i++) {
    double before = i > 0 ? time_s[i - 1] : target->last_s;
    if (!isfinite(time_s[i]) || time_s[i] <= before) {
      return refuse(recorder->ctx, "the times of a channel do not rise");
    }
  }
  struct h5 h;
  begin(recorder, &h);
  dea_series_add(&h, &target->values, values, count);
  dea_series_add(&h, &target->time, time_s, count);
  target->last_s = count > 0 ? time_s[count - 1] : target->last_s;
  flush_when_due(&h, recorder);
  return end(recorder, &h);
}

dea_status dea_recorder_add_profile(struct dea_recorder *recorder, double time_s, const double *z_m)
{
  if (recorder->frames.set < 0) {
    return refuse(recorder->ctx, "a profile without a profile sensor");
  }
  if (!isfinite(time_s) || time_s <= recorder->last_frame_s) {
    return refuse(recorder->ctx, "the times of the profiles do not rise");
  }
  struct h5 h;
  begin(recorder, &h);
  dea_series_add(&h, &recorder->frames, z_m, 1);
  dea_series_add(&h, &recorder->frame_time, &time_s, 1);
  recorder->last_frame_s = time_s;
  flush_when_due(&h, recorder);
  return end(recorder, &h);
}

dea_status dea_recorder_add_cycle(struct dea_recorder *recorder,
                                  const struct dea_recorded_cycle *cycle)
{
  const double row[DEA_CYCLE_WIDTH] = {(double)cycle->step, (double)cycle->number, cycle->start_s,
                                       cycle->end_s, cycle->level_V};
  struct h5 h;
  begin(recorder, &h);
  flush_samples(&h, recorder);
  dea_series_add(&h, &recorder->cycles, row, 1);
  dea_series_flush(&h, &recorder->cycles);
  return end(recorder, &h);
}

dea_status dea_recorder_add_event(struct dea_recorder *recorder,
                                  const struct dea_recorded_event *event)
{
  const double row[DEA_NOTICED_WIDTH] = {event->time_s, (double)event->kind, (double)event->channel,
                                         event->value, event->limit};
  struct h5 h;
  begin(recorder, &h);
  dea_series_add(&h, &recorder->events, row, 1);
  dea_series_flush(&h, &recorder->events);
  return end(recorder, &h);
}

dea_status dea_recorder_sync(struct dea_recorder *recorder)
{
  struct h5 h;
  begin(recorder, &h);
  flush_samples(&h, recorder);
  if (h.status == DEA_OK) {
    dea_disk_sync(&recorder->disk);
  }
  return end(recorder, &h);
}

void dea_recorder_set_output(struct dea_recorder *recorder, const char *text)
{
  if (recorder != NULL) {
    snprintf(recorder->output, sizeof recorder->output, "%s", text);
  }
}

dea_status dea_recorder_finish(struct dea_recorder *recorder, const char *ended)
{
  if (recorder == NULL) {
    return DEA_OK;
  }
  char state[DEA_STATE_SIZE];
  bool early = ended != NULL && ended[0] != '\0';
  snprintf(state, sizeof state, "%s%.255s", early ? DEA_STATE_ENDED : DEA_STATE_COMPLETE,
           early ? ended : "");
  struct h5 h;
  begin(recorder, &h);
  flush_samples(&h, recorder);
  set_text(&h, recorder, "output", recorder->output);
  set_text(&h, recorder, "state", state);
  if (h.status == DEA_OK && H5Fflush(recorder->file, H5F_SCOPE_GLOBAL) < 0) {
    dea_h5_fail(&h, cannot_write);
  }
  if (h.status == DEA_OK && !dea_disk_is_named(&recorder->disk, recorder->path)) {
    h.status = dea_fail(h.ctx, DEA_E_IO, "%s was removed or replaced while it was written", h.path);
  }
  close_all(recorder); // HDF5 writes here too
  check_disk(&h, recorder);
  dea_h5_end(&h);
  destroy(recorder);
  return h.status;
}

struct dea_context *dea_recorder_context(const struct dea_recorder *recorder)
{
  return recorder->ctx;
}

// A whole recording ------------------------------------------------------------------------------

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

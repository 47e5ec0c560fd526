#define _POSIX_C_SOURCE 200809L // stat
/* Reads recordings, also those of programs that were killed, and believes nothing in them. */
#include "base/file.h"
#include "recording/recording.h"
#include "recording/recording_layout.h"
#include "recording/series.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static void wrong(struct h5 *h, const char *what)
{
  if (h->status == DEA_OK) {
    h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged or no recording: %s", h->path, what);
  }
}

/* What is not as it should be is told once, in `ended`. */
static void report_ended(struct dea_recording *recording, const char *why)
{
  recording->complete = false;
  if (recording->ended[0] == '\0') {
    snprintf(recording->ended, sizeof recording->ended, "%s", why);
  }
}

// Parts ------------------------------------------------------------------------------------------

/* Whether it was ended by its program, complete or not. */
static bool get_state(struct h5 *h, hid_t file, struct dea_recording *recording)
{
  bool ended = false;
  char *state = dea_h5_get_long_text(h, file, "state");
  size_t prefix = strlen(DEA_STATE_ENDED);
  if (state == NULL) {
    wrong(h, "its text 'state' is missing, which says whether it is 'complete'");
  } else if (strcmp(state, DEA_STATE_COMPLETE) == 0) {
    recording->complete = true;
    ended = true;
  } else if (strncmp(state, DEA_STATE_ENDED, prefix) == 0) {
    report_ended(recording, state + prefix);
    ended = true;
  } else {
    report_ended(recording, "its program was killed, or is still recording");
  }
  dea_free(h->ctx, state);
  return ended;
}

static void get_output(struct h5 *h, hid_t file, struct dea_recording *recording)
{
  char *output = dea_h5_get_long_text(h, file, "output");
  if (output != NULL) {
    snprintf(recording->output, sizeof recording->output, "%s", output);
  }
  dea_free(h->ctx, output);
}

static bool find_kind(const char *name, enum dea_channel_kind *kind)
{
  for (int k = 0; k < DEA_CHANNEL_KINDS; k++) {
    if (strcmp(dea_channel_meanings[k].name, name) == 0) {
      *kind = (enum dea_channel_kind)k;
      return true;
    }
  }
  return false;
}

/* The times up to where they stop rising. */
static size_t rising(const double *time_s, size_t count)
{
  size_t n = 0;
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): as many as are counted
  while (n < count && isfinite(time_s[n]) && (n == 0 || time_s[n] > time_s[n - 1])) {
    n++;
  }
  return n;
}

static void get_channel(struct h5 *h, hid_t group, struct dea_recording *recording, bool *cut)
{
  char quantity[DEA_CHANNEL_NAME_SIZE];
  long long index = dea_h5_get_int(h, group, "index");
  if (h->status == DEA_OK && (index < 0 || (size_t)index >= recording->channel_count ||
                              recording->channels[index].name[0] != '\0')) {
    wrong(h, "the numbers of its channels are not in order");
  }
  if (h->status != DEA_OK) {
    return;
  }
  struct dea_channel *channel = &recording->channels[index];
  dea_h5_get_text(h, group, "name", channel->name, sizeof channel->name);
  dea_h5_get_text(h, group, "quantity", quantity, sizeof quantity);
  dea_h5_get_text(h, group, "unit", channel->unit, sizeof channel->unit);
  channel->start_s = dea_h5_get_real(h, group, "start_s");
  channel->interval_s = dea_h5_get_real(h, group, "interval_s");
  channel->filter_Hz = dea_h5_get_real(h, group, "filter_Hz");
  if (dea_h5_has_attribute(h, group, "lowest")) {
    channel->lowest = dea_h5_get_real(h, group, "lowest");
    channel->highest = dea_h5_get_real(h, group, "highest");
  }
  if (h->status == DEA_OK &&
      (channel->name[0] == '\0' || !find_kind(quantity, &channel->kind) ||
       !isfinite(channel->start_s) || !isfinite(channel->interval_s) || channel->interval_s < 0)) {
    wrong(h, "a channel's name, quantity or clock makes no sense");
  }
  const char *si = dea_channel_meanings[channel->kind].si_unit;
  if (h->status == DEA_OK && channel->kind != DEA_CHANNEL_OTHER && strcmp(channel->unit, si) != 0) {
    h->status = dea_fail(h->ctx, DEA_E_IO,
                         "%s: the channel '%s' is in '%s', and a recording has it "
                         "in %s",
                         h->path, channel->name, channel->unit, si);
  }
  dea_series_read(h, group, "values", 1, &channel->values, &channel->count, cut);
  if (h->status == DEA_OK && channel->interval_s == 0) {
    size_t count;
    dea_series_read(h, group, "time", 1, &channel->time_s, &count, cut);
    count = count < channel->count ? count : channel->count;
    channel->count = rising(channel->time_s, count);
    *cut = *cut || channel->count < count;
  }
}

static void get_channels(struct h5 *h, hid_t file, struct dea_recording *recording, bool *cut)
{
  hid_t channels = dea_h5_group_open(h, file, "channels");
  size_t count = dea_h5_link_count(h, channels);
  if (count > DEA_CHANNELS_MAX) {
    wrong(h, "it has more channels than a recording can have");
  }
  recording->channel_count = h->status == DEA_OK ? count : 0;
  for (size_t c = 0; c < recording->channel_count; c++) {
    char key[2 * DEA_CHANNEL_NAME_SIZE];
    dea_h5_link_name(h, channels, c, key, sizeof key);
    hid_t group = dea_h5_group_open(h, channels, key);
    get_channel(h, group, recording, cut);
    dea_h5_close(group);
  }
  for (size_t c = 1; c < recording->channel_count && h->status == DEA_OK; c++) {
    const char *name = recording->channels[c].name;
    if (dea_recording_channel(recording, name) != &recording->channels[c]) {
      wrong(h, "two channels have one name");
    }
  }
  dea_h5_close(channels);
}

static void get_profiles(struct h5 *h, hid_t file, struct dea_profiles *profiles, bool *cut)
{
  if (!dea_h5_has(h, file, "profiles")) {
    return;
  }
  size_t heights = 0;
  hid_t group = dea_h5_group_open(h, file, "profiles");
  size_t points = dea_series_width(h, group, "z_m");
  dea_series_read(h, group, "time_s", 1, &profiles->time_s, &profiles->count, cut);
  dea_series_read(h, group, "z_m", points, &profiles->z_m, &heights, cut);
  if (h->status == DEA_OK && points > dea_h5_file_size(h, file) / sizeof(double)) {
    wrong(h, "its profiles have more points than the file can hold");
  }
  if (h->status == DEA_OK) {
    // a killed program may have written the heights of a frame, and not yet its time
    size_t count = heights < profiles->count ? heights : profiles->count;
    profiles->count = rising(profiles->time_s, count);
    *cut = *cut || profiles->count < count;
    profiles->points = points;
    profiles->x_m = dea_alloc(h->ctx, points, sizeof *profiles->x_m);
    h->status = profiles->x_m != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  dea_h5_get_array(h, group, "x_m", H5T_NATIVE_DOUBLE, points, profiles->x_m);
  if (h->status == DEA_OK && rising(profiles->x_m, points) < points) {
    wrong(h, "the positions of its profiles do not rise");
  }
  dea_h5_close(group);
}

static bool is_count(double value)
{
  return value >= 0 && value < 9007199254740992.0 && value == floor(value); // 2^53
}

static bool makes_sense(const double row[DEA_CYCLE_WIDTH])
{
  return is_count(row[0]) && is_count(row[1]) && isfinite(row[2]) && isfinite(row[3]) &&
         row[3] >= row[2] && isfinite(row[4]);
}

/* A row that is counted, but was never written: the computer's power failed in between. */
static bool is_empty(const double row[DEA_CYCLE_WIDTH])
{
  static const double none[DEA_CYCLE_WIDTH];
  // bytes that nobody wrote
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison,cert-exp42-c,cert-flp37-c)
  return memcmp(row, none, sizeof none) == 0;
}

/* Those of other programs may have none. */
static void get_cycles(struct h5 *h, hid_t file, struct dea_recording *recording, bool *cut)
{
  double *rows = NULL;
  size_t count = 0;
  if (!dea_h5_has(h, file, "cycles")) {
    return;
  }
  dea_series_read(h, file, "cycles", DEA_CYCLE_WIDTH, &rows, &count, cut);
  if (h->status == DEA_OK && count > 0) {
    recording->cycles = dea_alloc(h->ctx, count, sizeof *recording->cycles);
    h->status = recording->cycles != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    const double *row = rows + i * DEA_CYCLE_WIDTH;
    if (!recording->complete && (is_empty(row) || !makes_sense(row))) {
      *cut = true; // those before it are whole
      break;
    }
    if (!makes_sense(row)) {
      wrong(h, "a cycle in it makes no sense");
      break;
    }
    recording->cycles[recording->cycle_count++] =
        (struct dea_recorded_cycle){(size_t)row[0], (size_t)row[1], row[2], row[3], row[4]};
  }
  dea_free(h->ctx, rows);
}

/* Older files have none. A row that makes no sense, or was never written, ends them. */
static void get_events(struct h5 *h, hid_t file, struct dea_recording *recording)
{
  double *rows = NULL;
  size_t count = 0;
  bool cut = false;
  if (h->status == DEA_OK && dea_h5_has(h, file, "events")) {
    dea_series_read(h, file, "events", DEA_NOTICED_WIDTH, &rows, &count, &cut);
  }
  if (h->status == DEA_OK && count > 0) {
    recording->events = dea_alloc(h->ctx, count, sizeof *recording->events);
    h->status = recording->events != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    const double *row = rows + i * DEA_NOTICED_WIDTH;
    if (!isfinite(row[0]) || !(row[1] >= 1 && row[1] < DEA_NOTICED_KINDS) ||
        !(row[2] >= 0 && row[2] < (double)recording->channel_count)) {
      break;
    }
    recording->events[recording->event_count++] = (struct dea_recorded_event){
        row[0], (enum dea_noticed_kind)row[1], (size_t)row[2], row[3], row[4]};
  }
  dea_free(h->ctx, rows);
}

// The whole --------------------------------------------------------------------------------------

/* Channels on one clock end together; only a killed program leaves some of them longer. */
static void level_channels(struct dea_recording *recording)
{
  for (size_t c = 0; c < recording->channel_count; c++) {
    struct dea_channel *channel = &recording->channels[c];
    for (size_t k = 0; k < recording->channel_count; k++) {
      const struct dea_channel *other = &recording->channels[k];
      if (channel->interval_s > 0 && other->interval_s == channel->interval_s &&
          other->start_s == channel->start_s && other->count > 0 && other->count < channel->count) {
        channel->count = other->count;
      }
    }
  }
}

/* Drops the cycles, from the first one, that end after the samples of some channel. */
static void drop_cycles(struct dea_recording *recording)
{
  double end_s = INFINITY;
  for (size_t c = 0; c < recording->channel_count; c++) {
    const struct dea_channel *channel = &recording->channels[c];
    if (channel->interval_s > 0 && channel->count > 0) {
      // half an interval for rounding of the cycle's end
      double its = channel->start_s + ((double)channel->count + 0.5) * channel->interval_s;
      end_s = its < end_s ? its : end_s;
    }
  }
  size_t n = 0;
  while (n < recording->cycle_count && recording->cycles[n].end_s <= end_s) {
    n++;
  }
  if (n < recording->cycle_count) {
    report_ended(recording, "its last cycles have no samples");
  }
  recording->cycle_count = n;
}

static void get_all(struct h5 *h, hid_t file, struct dea_recording *recording)
{
  char format[32];
  bool cut = false;
  dea_h5_get_text(h, file, "format", format, sizeof format);
  if (h->status == DEA_OK && strcmp(format, DEA_RECORDING_FORMAT) != 0) {
    wrong(h, "its attribute 'format' is not '" DEA_RECORDING_FORMAT "'");
  }
  long long version = dea_h5_get_int(h, file, "version");
  if (h->status == DEA_OK && version != DEA_RECORDING_VERSION) {
    h->status = dea_fail(h->ctx, DEA_E_UNSUPPORTED,
                         "%s is a recording of version %lld; this program reads version %d",
                         h->path, version, DEA_RECORDING_VERSION);
  }
  const bool ended = get_state(h, file, recording);
  get_output(h, file, recording);
  get_cycles(h, file, recording, &cut); // before the samples: a program may be adding to both
  get_channels(h, file, recording, &cut);
  get_profiles(h, file, &recording->profiles, &cut);
  get_events(h, file, recording);
  char *title = dea_h5_get_long_text(h, file, "title");
  if (title != NULL) {
    dea_free(h->ctx, recording->title);
    recording->title = title;
  }
  recording->protocol = dea_h5_get_long_text(h, file, "protocol");
  recording->design = dea_h5_get_long_text(h, file, "design");
  recording->design_name = dea_h5_get_long_text(h, file, "design_name");
  recording->provenance = dea_h5_get_long_text(h, file, "provenance");
  if (h->status != DEA_OK) {
    return;
  }
  if (cut) {
    report_ended(recording, "the file is damaged: samples are missing at the end");
  }
  if (!ended || cut) {
    level_channels(recording);
  }
  drop_cycles(recording);
}

/* A file whose program was killed is still marked as being written, which is what SWMR reads. Only
 * such a one is opened in that way: of others HDF5 checks the length. */
static hid_t open_file(struct h5 *h)
{
  unsigned char head[12] = {0};
  size_t count;
  dea_file_head(h->path, head, sizeof head, &count); // what cannot be opened HDF5 says
  const bool is_h5 = dea_head_is_h5(head, count) && count == sizeof head;
  if (count > 0 && !is_h5) {
    h->status =
        dea_fail(h->ctx, DEA_E_IO,
                 "%s is no recording; dea import makes one of CSV, .mat, .lvm and .tdms, and "
                 "examples/python/area_strain.py a table of pictures",
                 h->path);
    return H5I_INVALID_HID;
  }
  // a superblock of version 3 whose flags say: open for one writer and many readers
  const bool written = is_h5 && head[8] == 3 && (head[11] & 4) != 0;
  return dea_h5_file_open(h, written);
}

dea_status dea_recording_read(struct dea_context *ctx, const char *file, struct dea_recording **out)
{
  *out = NULL;
  struct stat info;
  if (stat(file, &info) != 0) {
    return dea_fail(ctx, DEA_E_IO, "%s does not exist", file);
  }
  if (!S_ISREG(info.st_mode)) { // a pipe would be waited for
    return dea_fail(ctx, DEA_E_IO, "%s is no file that can hold a recording", file);
  }
  struct dea_recording *recording;
  DEA_TRY(ctx, dea_recording_create(ctx, &recording));
  struct h5 h;
  dea_h5_begin(&h, ctx, file);
  h.not_it = "no recording, or a damaged one:";
  recording->file = dea_intern(ctx, file);
  h.status = recording->file != NULL ? DEA_OK : DEA_E_MEMORY;
  hid_t id = h.status == DEA_OK ? open_file(&h) : H5I_INVALID_HID;
  get_all(&h, id, recording);
  dea_h5_close(id);
  dea_h5_end(&h);
  if (h.status != DEA_OK) {
    dea_recording_destroy(ctx, recording);
    return dea_fail_chain(ctx, h.status, __func__, __FILE__, __LINE__);
  }
  *out = recording;
  return DEA_OK;
}

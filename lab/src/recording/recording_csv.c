#include "recording/recording_csv.h"

#include "base/csv_line.h"
#include "base/write_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

/* A table on its way to the disk: the lines that wait, at most about BLOCK bytes. */
enum { BLOCK = 1 << 20 };
struct table {
  struct dea_context *ctx;
  char *path;
  FILE *file;
  struct dea_text lines;
  dea_status status;
};

static void table_begin(struct dea_context *ctx, const char *folder, const char *name,
                        struct table *t)
{
  *t = (struct table){.ctx = ctx, .lines = {.ctx = ctx}};
  t->path = dea_path_join(ctx, folder, name);
  if (t->path == NULL) {
    t->status = DEA_E_MEMORY;
    return;
  }
  t->file = fopen(t->path, "wb");
  if (t->file == NULL) {
    t->status = dea_fail(ctx, DEA_E_IO, "cannot write %s: %s", t->path, strerror(errno));
  }
}

static void table_pass(struct table *t)
{
  if (t->status == DEA_OK && t->lines.failed) {
    t->status = DEA_E_MEMORY;
  } else if (t->status == DEA_OK && dea_interrupted(t->ctx)) {
    t->status = dea_fail(t->ctx, DEA_E_INTERRUPTED, "interrupted");
  } else if (t->status == DEA_OK && t->lines.length > 0 &&
             fwrite(t->lines.data, 1, t->lines.length, t->file) != t->lines.length) {
    t->status = dea_fail(t->ctx, DEA_E_IO, "cannot write %s: %s", t->path, strerror(errno));
  }
  t->lines.length = 0;
}

static void table_end_line(struct table *t)
{
  dea_text_add(&t->lines, "\n");
  if (t->lines.length >= BLOCK) {
    table_pass(t);
  }
}

static dea_status table_end(struct table *t)
{
  table_pass(t);
  if (t->file != NULL && fclose(t->file) != 0 && t->status == DEA_OK) {
    t->status = dea_fail(t->ctx, DEA_E_IO, "cannot write %s: %s", t->path, strerror(errno));
  }
  if (t->file != NULL && t->status != DEA_OK) {
    remove(t->path);
  }
  dea_text_free(&t->lines);
  dea_free(t->ctx, t->path);
  return t->status;
}

static void add_value(struct table *t, double value)
{
  if (isfinite(value)) {
    dea_text_add(&t->lines, ",%.12g", value);
  } else {
    dea_text_add(&t->lines, ",");
  }
}

// Channels ---------------------------------------------------------------------------------------

const char *dea_channel_display_unit(const struct dea_channel *channel)
{
  return channel->kind == DEA_CHANNEL_OTHER ? channel->unit
                                            : dea_channel_meanings[channel->kind].display_unit;
}

static bool same_clock(const struct dea_channel *a, const struct dea_channel *b)
{
  return a->interval_s > 0 && a->interval_s == b->interval_s && a->start_s == b->start_s;
}

static void add_title(struct table *t, const struct dea_channel *channel)
{
  char title[2 * DEA_CHANNEL_NAME_SIZE + 4];
  const char *unit = dea_channel_display_unit(channel);
  bool any = unit[0] != '\0' && strcmp(unit, "1") != 0;
  snprintf(title, sizeof title, "%s%s%s%s", channel->name, any ? " (" : "", any ? unit : "",
           any ? ")" : "");
  dea_text_add(&t->lines, ",");
  dea_csv_add_name(&t->lines, title);
}

/* Time, and the channels on the clock of one of them, or that one alone. */
static dea_status write_clock(struct dea_context *ctx, const struct dea_recording *recording,
                              size_t first, const char *folder, const char *name)
{
  const struct dea_channel *leader = &recording->channels[first], *all[DEA_CHANNELS_MAX] = {leader};
  struct table t;
  size_t count = 1, rows = leader->count;
  for (size_t c = first + 1; c < recording->channel_count; c++) {
    const struct dea_channel *channel = &recording->channels[c];
    if (same_clock(leader, channel)) {
      all[count++] = channel;
      rows = channel->count > rows ? channel->count : rows;
    }
  }
  table_begin(ctx, folder, name, &t);
  dea_text_add(&t.lines, "time (s)");
  for (size_t c = 0; c < count; c++) {
    add_title(&t, all[c]);
  }
  table_end_line(&t);
  for (size_t i = 0; i < rows && t.status == DEA_OK; i++) {
    dea_text_add(&t.lines, "%.12g", dea_channel_time(leader, i));
    for (size_t c = 0; c < count; c++) {
      double factor = dea_channel_meanings[all[c]->kind].factor;
      add_value(&t, i < all[c]->count ? factor * all[c]->values[i] : (double)NAN);
    }
    table_end_line(&t);
  }
  return table_end(&t);
}

static bool is_first_of_clock(const struct dea_recording *recording, size_t c)
{
  for (size_t k = 0; k < c; k++) {
    if (same_clock(&recording->channels[k], &recording->channels[c])) {
      return false;
    }
  }
  return true;
}

static dea_status write_channels(struct dea_context *ctx, const struct dea_recording *recording,
                                 const char *folder)
{
  size_t clocks = 0, readings = 0;
  for (size_t c = 0; c < recording->channel_count; c++) {
    char name[48];
    if (recording->channels[c].interval_s == 0) {
      snprintf(name, sizeof name, "readings_%zu.csv", ++readings);
    } else if (!is_first_of_clock(recording, c)) {
      continue;
    } else if (++clocks == 1) {
      snprintf(name, sizeof name, "channels.csv");
    } else {
      snprintf(name, sizeof name, "channels_%zu.csv", clocks);
    }
    DEA_TRY(ctx, write_clock(ctx, recording, c, folder, name));
  }
  return DEA_OK;
}

// Profiles and cycles ----------------------------------------------------------------------------

static dea_status write_profiles(struct dea_context *ctx, const struct dea_profiles *profiles,
                                 const char *folder)
{
  struct table t;
  table_begin(ctx, folder, "profiles.csv", &t);
  dea_text_add(&t.lines, "time (s)");
  for (size_t k = 0; k < profiles->points; k++) {
    dea_text_add(&t.lines, ",z at x = %.6g mm (um)", 1e3 * profiles->x_m[k]);
  }
  table_end_line(&t);
  for (size_t i = 0; i < profiles->count && t.status == DEA_OK; i++) {
    dea_text_add(&t.lines, "%.12g", profiles->time_s[i]);
    for (size_t k = 0; k < profiles->points; k++) {
      add_value(&t, 1e6 * profiles->z_m[i * profiles->points + k]);
    }
    table_end_line(&t);
  }
  return table_end(&t);
}

static dea_status write_cycles(struct dea_context *ctx, const struct dea_recording *recording,
                               const char *folder)
{
  struct table t;
  table_begin(ctx, folder, "cycles.csv", &t);
  dea_text_add(&t.lines, "step,number,start (s),end (s),level (kV)");
  table_end_line(&t);
  for (size_t i = 0; i < recording->cycle_count && t.status == DEA_OK; i++) {
    const struct dea_recorded_cycle *cycle = &recording->cycles[i];
    dea_text_add(&t.lines, "%zu,%zu", cycle->step, cycle->number);
    add_value(&t, cycle->start_s);
    add_value(&t, cycle->end_s);
    add_value(&t, 1e-3 * cycle->level_V);
    table_end_line(&t);
  }
  return table_end(&t);
}

/* Takes tables of an earlier recording out of the way, or refuses. */
static dea_status create_folders(struct dea_context *ctx, const char *folder, bool force)
{
  static const char *const names[] = {"channels.csv", "profiles.csv", "cycles.csv"};
  static const char *const numbered[] = {"channels", "readings"};
  char name[64];
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    DEA_TRY(ctx, dea_path_create_folders(ctx, folder, names[i], force));
  }
  for (size_t n = 1; n <= DEA_CHANNELS_MAX; n++) {
    for (size_t i = 0; i < sizeof numbered / sizeof numbered[0]; i++) {
      snprintf(name, sizeof name, "%s_%zu.csv", numbered[i], n);
      DEA_TRY(ctx, dea_path_create_folders(ctx, folder, name, force));
    }
  }
  return DEA_OK;
}

dea_status dea_recording_write_tables(struct dea_context *ctx,
                                      const struct dea_recording *recording, const char *folder,
                                      bool force)
{
  DEA_TRY(ctx, create_folders(ctx, folder, force));
  DEA_TRY(ctx, dea_folder_create(ctx, folder));
  dea_status status = write_channels(ctx, recording, folder);
  if (status == DEA_OK && recording->profiles.count > 0) {
    status = write_profiles(ctx, &recording->profiles, folder);
  }
  if (status == DEA_OK && recording->cycle_count > 0) {
    status = write_cycles(ctx, recording, folder);
  }
  return status;
}

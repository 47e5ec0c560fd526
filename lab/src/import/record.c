/* A recording of a table. */
#include "base/text.h"
#include "import/mapping.h"
#include "import/sample_times.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAMES_SHOWN = 8 };

struct work {
  struct dea_context *ctx;
  const struct dea_table *table;
  const struct dea_mapping *mapping;
  struct dea_column_role *roles; // [column_count]
  struct dea_clock *clocks;      // [column_count], count 0: not read yet
  struct dea_recording *recording;
  double origin_s; // what is taken off all times
};

static struct dea_location file_place(const struct work *work)
{
  return (struct dea_location){.file = work->table->file};
}

// Clocks -----------------------------------------------------------------------------------------

/* Times without a unit are taken in seconds, which is said, and not done when it cannot be. */
static dea_status check_time_unit(struct work *work, size_t column)
{
  const struct dea_table_column *c = &work->table->columns[column];
  if (c->unit[0] != '\0' || (work->mapping != NULL && work->mapping->time_unit.text[0] != '\0')) {
    return DEA_OK;
  }
  DEA_TRY(work->ctx, dea_clock_check_seconds(work->ctx, work->table, column));
  return work->mapping != NULL
             ? DEA_OK
             : dea_finding_add(work->ctx, DEA_WARNING, file_place(work),
                               "the time '%.60s' has no unit and is taken in s: say it in a "
                               "mapping (time_unit: ms)",
                               c->name);
}

/* Clock of a column; columns with the same times share it. */
static dea_status clock_get(struct work *work, size_t column, struct dea_clock *out)
{
  const struct dea_table_column *c = &work->table->columns[column];
  const struct dea_column_role *role = &work->roles[column];
  if (role->clock == 0) {
    if (isnan(role->interval_s)) {
      return dea_fail(work->ctx, DEA_E_IO,
                      "'%s' has no times for '%.60s': say the rate in a mapping (rate: 10 kHz), or "
                      "which column has them (time: NAME)",
                      work->table->file, c->name);
    }
    *out = (struct dea_clock){.start_s = role->start_s, .interval_s = role->interval_s};
    out->count = c->count;
    return DEA_OK;
  }
  size_t at = role->clock - 1;
  if (work->table->columns[at].count != c->count) {
    return dea_fail(work->ctx, DEA_E_IO,
                    "in '%s' the column '%.60s' has %zu values and its times '%.60s' %zu",
                    work->table->file, c->name, c->count, work->table->columns[at].name,
                    work->table->columns[at].count);
  }
  if (work->clocks[at].count == 0) {
    DEA_TRY(work->ctx, check_time_unit(work, at));
    DEA_TRY(work->ctx,
            dea_clock_read(work->ctx, work->table, at, work->roles[at].factor, &work->clocks[at]));
    const struct dea_clock *clock = &work->clocks[at];
    if (clock->time_s == NULL) {
      DEA_TRY(work->ctx, dea_finding_add(work->ctx, DEA_NOTE, file_place(work),
                                         "'%.60s' is the time: %zu samples from %.10g s, %.10g Hz",
                                         work->table->columns[at].name, clock->count,
                                         clock->start_s, 1 / clock->interval_s));
    } else {
      DEA_TRY(work->ctx, dea_finding_add(work->ctx, DEA_NOTE, file_place(work),
                                         "'%.60s' is the time: %zu samples that are not uniform",
                                         work->table->columns[at].name, clock->count));
    }
  }
  *out = work->clocks[at];
  return DEA_OK;
}

/* Times of day or since 1970: the first becomes 0, since a recording counts from its start. */
static dea_status find_origin(struct work *work)
{
  double first = INFINITY;
  for (size_t i = 0; i < work->table->column_count; i++) {
    struct dea_clock clock = {0};
    if (work->roles[i].use == DEA_USE_CHANNEL || work->roles[i].use == DEA_USE_PROFILE) {
      DEA_TRY(work->ctx, clock_get(work, i, &clock));
      first = fmin(first, clock.start_s);
    }
  }
  if (isfinite(first) && fabs(first) > 1e7) {
    work->origin_s = first;
    return dea_finding_add(work->ctx, DEA_NOTE, file_place(work),
                           "the times begin at %.10g s: the first one becomes 0", first);
  }
  return DEA_OK;
}

/* Times of its own for a channel or the profiles; NULL with an interval. */
static dea_status copy_times(struct work *work, const struct dea_clock *clock, bool always,
                             double **out)
{
  *out = NULL;
  if (clock->time_s == NULL && !always) {
    return DEA_OK;
  }
  *out = dea_alloc(work->ctx, clock->count, sizeof **out);
  for (size_t i = 0; *out != NULL && i < clock->count; i++) {
    double time =
        clock->time_s != NULL ? clock->time_s[i] : clock->start_s + (double)i * clock->interval_s;
    (*out)[i] = time - work->origin_s;
  }
  return *out != NULL ? DEA_OK : DEA_E_MEMORY;
}

/* SI values of a column, of the rows that have a time, `step` apart. */
static dea_status copy_values(struct work *work, size_t column, size_t step, double *out)
{
  const struct dea_table_column *c = &work->table->columns[column];
  const struct dea_column_role *role = &work->roles[column];
  if (role->clock > 0) {
    return dea_clock_parse(work->ctx, work->table, column, role->clock - 1, role->factor,
                           role->offset, step, out);
  }
  for (size_t i = 0; i < c->count; i++) {
    out[step * i] = c->values[i] * role->factor + role->offset;
  }
  return DEA_OK;
}

// Channels ---------------------------------------------------------------------------------------

static const struct dea_mapped *mapped_get(const struct work *work, size_t column)
{
  const char *name = work->table->columns[column].name;
  for (size_t i = 0; work->mapping != NULL && i < work->mapping->column_count; i++) {
    if (dea_mapping_matches(name, work->mapping->columns[i].column.text, false)) {
      return &work->mapping->columns[i];
    }
  }
  return NULL;
}

/* A name that no other channel has. */
static void name_channel(const struct work *work, const char *wanted, struct dea_channel *channel)
{
  wanted = wanted[0] != '\0' ? wanted : "channel";
  snprintf(channel->name, sizeof channel->name, "%.*s",
           (int)dea_text_cut(wanted, DEA_CHANNEL_NAME_SIZE - 8), wanted);
  dea_recording_name_apart(work->recording, channel);
}

static dea_status add_channel(struct work *work, size_t column)
{
  struct dea_recording *recording = work->recording;
  const struct dea_table_column *c = &work->table->columns[column];
  const struct dea_column_role *role = &work->roles[column];
  const struct dea_mapped *mapped = mapped_get(work, column);
  struct dea_clock clock = {0};
  if (recording->channel_count == DEA_CHANNELS_MAX) {
    return dea_fail(work->ctx, DEA_E_IO,
                    "'%s' gives more than %d channels: name those that matter in a mapping",
                    work->table->file, (int)DEA_CHANNELS_MAX);
  }
  DEA_TRY(work->ctx, clock_get(work, column, &clock));
  struct dea_channel channel = {
      .kind = role->kind, .interval_s = clock.interval_s, .filter_Hz = NAN};
  channel.start_s = clock.start_s - work->origin_s;
  channel.count = clock.count;
  bool named = mapped != NULL && mapped->name.text[0] != '\0';
  name_channel(work, named ? mapped->name.text : c->name, &channel);
  bool other = role->kind == DEA_CHANNEL_OTHER;
  bool united = mapped != NULL && mapped->unit.text[0] != '\0';
  const char *unit = united ? mapped->unit.text : c->unit;
  const char *si = dea_channel_meanings[role->kind].si_unit;
  snprintf(channel.unit, sizeof channel.unit, "%.*s",
           (int)dea_text_cut(other ? unit : si, sizeof channel.unit - 1), other ? unit : si);
  if (mapped != NULL && !isnan(mapped->filter_Hz.si)) {
    channel.filter_Hz = mapped->filter_Hz.si;
  }
  DEA_TRY(work->ctx, copy_times(work, &clock, false, &channel.time_s));
  channel.values = dea_alloc(work->ctx, clock.count, sizeof *channel.values);
  recording->channels[recording->channel_count++] = channel; // owns the times from here on
  DEA_TRY_MEMORY(channel.values != NULL);
  DEA_TRY(work->ctx, copy_values(work, column, 1, channel.values));
  return dea_finding_add(work->ctx, DEA_NOTE, file_place(work),
                         "'%.60s'%s%.40s is taken as %s (%s)", c->name,
                         unit[0] != '\0' ? " in " : "", unit, dea_role_name(role), role->why);
}

/* Units that were not written, and monitors that divide, are the errors that nobody sees. */
static dea_status warn(struct work *work)
{
  for (size_t i = 0; work->mapping == NULL && i < work->table->column_count; i++) {
    const struct dea_table_column *c = &work->table->columns[i];
    const struct dea_column_role *role = &work->roles[i];
    if (role->use != DEA_USE_CHANNEL) {
      continue;
    }
    if (c->unit[0] == '\0') {
      DEA_TRY(work->ctx,
              dea_finding_add(work->ctx, DEA_WARNING, file_place(work),
                              "'%.60s' has no unit and is taken in %s: say it in a mapping",
                              c->name, dea_channel_meanings[role->kind].si_unit));
    }
    double largest = 0;
    for (size_t k = 0; k < c->count; k++) {
      largest = fmax(largest, fabs(c->values[k]) * fabs(role->factor)); // fmax passes over NAN
    }
    if ((role->kind == DEA_CHANNEL_VOLTAGE || role->kind == DEA_CHANNEL_COMMAND) && largest > 0 &&
        largest <= 10.5) {
      DEA_TRY(work->ctx,
              dea_finding_add(work->ctx, DEA_WARNING, file_place(work),
                              "'%.60s' never exceeds %.3g V: when it is a monitor of the "
                              "amplifier, say what 1 V stands for in a mapping "
                              "(per_unit: 1 kV)",
                              c->name, largest));
    }
  }
  return DEA_OK;
}

// Profiles ---------------------------------------------------------------------------------------

/* Places of the points; *falling: they fall, and all is turned round. */
static dea_status place_points(struct work *work, size_t points, bool *falling)
{
  struct dea_profiles *profiles = &work->recording->profiles;
  const struct dea_mapping *mapping = work->mapping;
  double from = mapping->profile.x_from_m.si, to = mapping->profile.x_to_m.si;
  size_t position = work->table->column_count;
  for (size_t i = 0; i < work->table->column_count; i++) {
    position = work->roles[i].use == DEA_USE_POSITION ? i : position;
  }
  const struct dea_table_column *x =
      position < work->table->column_count ? &work->table->columns[position] : NULL;
  if (x != NULL && x->count != points) {
    return dea_fail(work->ctx, DEA_E_IO,
                    "'%s' has %zu columns of the profile, but %zu places '%.60s'",
                    work->table->file, points, x->count, x->name);
  }
  for (size_t i = 0; i < points; i++) {
    profiles->x_m[i] = x != NULL ? x->values[i] * work->roles[position].factor
                                 : from + (to - from) * (double)i / (double)(points - 1);
  }
  *falling = profiles->x_m[points - 1] < profiles->x_m[0];
  for (size_t i = 0; *falling && i < points / 2; i++) {
    double kept = profiles->x_m[i];
    profiles->x_m[i] = profiles->x_m[points - 1 - i];
    profiles->x_m[points - 1 - i] = kept;
  }
  for (size_t i = 1; i < points; i++) {
    if (!(profiles->x_m[i] > profiles->x_m[i - 1])) {
      return dea_fail(work->ctx, DEA_E_IO, "the places '%.60s' in '%s' do not rise", x->name,
                      work->table->file);
    }
  }
  return DEA_OK;
}

static dea_status add_profiles(struct work *work)
{
  struct dea_profiles *profiles = &work->recording->profiles;
  const struct dea_table *table = work->table;
  struct dea_clock clock = {0};
  size_t points = 0, first = 0;
  bool falling = false;
  for (size_t i = 0; i < table->column_count; i++) {
    if (work->roles[i].use == DEA_USE_PROFILE) {
      first = points == 0 ? i : first;
      if (table->columns[i].count != table->columns[first].count) {
        return dea_fail(work->ctx, DEA_E_IO, "in '%s' the columns of the profile differ in length",
                        table->file);
      }
      points++;
    }
  }
  if (points == 0) {
    return DEA_OK;
  }
  DEA_TRY(work->ctx, clock_get(work, first, &clock));
  size_t frames = clock.count;
  profiles->points = points;
  profiles->x_m = dea_alloc(work->ctx, points, sizeof(double));
  profiles->z_m = dea_alloc(work->ctx, points * frames, sizeof(double));
  DEA_TRY_MEMORY(profiles->x_m != NULL && profiles->z_m != NULL);
  DEA_TRY(work->ctx, copy_times(work, &clock, true, &profiles->time_s));
  profiles->count = frames;
  DEA_TRY(work->ctx, place_points(work, points, &falling));
  size_t point = 0;
  for (size_t i = 0; i < table->column_count; i++) {
    if (work->roles[i].use == DEA_USE_PROFILE) {
      size_t at = falling ? points - 1 - point : point;
      DEA_TRY(work->ctx, copy_values(work, i, points, profiles->z_m + at));
      point++;
    }
  }
  return dea_finding_add(
      work->ctx, DEA_NOTE, file_place(work),
      "%zu columns from '%.60s' on are the profile: %zu frames from %.4g to %.4g "
      "mm",
      points, table->columns[first].name, frames, profiles->x_m[0] * 1e3,
      profiles->x_m[points - 1] * 1e3);
}

// All --------------------------------------------------------------------------------------------

static bool is_ignored(const struct work *work, const char *name)
{
  for (size_t i = 0; work->mapping != NULL && i < work->mapping->ignore_count; i++) {
    if (dea_mapping_matches(name, work->mapping->ignore[i].text, true)) {
      return true;
    }
  }
  return false;
}

static dea_status report_left(struct work *work)
{
  struct dea_text names = {.ctx = work->ctx};
  size_t left = 0;
  for (size_t i = 0; i < work->table->column_count; i++) {
    const char *name = work->table->columns[i].name;
    if (work->roles[i].use == DEA_USE_LEFT && !is_ignored(work, name)) {
      if (left < NAMES_SHOWN) {
        bool said = strcmp(work->roles[i].why, "not known") != 0;
        dea_text_add(&names, "%s'%.60s'%s%s%s", left > 0 ? ", " : "", name, said ? " (" : "",
                     said ? work->roles[i].why : "", said ? ")" : "");
      }
      left++;
    }
  }
  dea_status status = names.failed ? DEA_E_MEMORY : DEA_OK;
  if (left > NAMES_SHOWN) {
    dea_text_add(&names, " and %zu more", left - NAMES_SHOWN);
  }
  if (left > 0 && status == DEA_OK) {
    status = dea_finding_add(work->ctx, DEA_NOTE, file_place(work), "left out: %s",
                             dea_text_get(&names));
  }
  dea_text_free(&names);
  return status;
}

static dea_status fill(struct work *work)
{
  DEA_TRY(work->ctx, dea_table_roles(work->ctx, work->table, work->mapping, work->roles));
  DEA_TRY(work->ctx, find_origin(work));
  for (size_t i = 0; i < work->table->column_count; i++) {
    DEA_TRY(work->ctx, work->roles[i].use == DEA_USE_CHANNEL ? add_channel(work, i) : DEA_OK);
  }
  DEA_TRY(work->ctx, add_profiles(work));
  DEA_TRY(work->ctx, warn(work));
  DEA_TRY(work->ctx, report_left(work));
  if (work->recording->channel_count == 0 && work->recording->profiles.count == 0) {
    return dea_fail(work->ctx, DEA_E_IO,
                    "no column of '%s' could be taken for anything: say what they are in a mapping "
                    "(dea import --list shows them, dea schema --mapping the keys)",
                    work->table->file);
  }
  work->recording->complete = true;
  if (work->mapping != NULL && work->mapping->title.text[0] != '\0') {
    char *title = dea_copy_text(work->ctx, work->mapping->title.text, DEA_TITLE_SIZE);
    DEA_TRY_MEMORY(title != NULL);
    dea_free(work->ctx, work->recording->title);
    work->recording->title = title;
  }
  return DEA_OK;
}

dea_status dea_table_record(struct dea_context *ctx, const struct dea_table *table,
                            const struct dea_mapping *mapping, struct dea_recording **out)
{
  struct work work = {.ctx = ctx, .table = table, .mapping = mapping};
  *out = NULL;
  DEA_TRY(ctx, dea_recording_create(ctx, &work.recording));
  work.roles = dea_alloc(ctx, table->column_count, sizeof *work.roles);
  work.clocks =
      work.roles != NULL ? dea_alloc(ctx, table->column_count, sizeof *work.clocks) : NULL;
  dea_status status = work.clocks != NULL ? fill(&work) : DEA_E_MEMORY;
  for (size_t i = 0; work.clocks != NULL && i < table->column_count; i++) {
    dea_free(ctx, work.clocks[i].time_s);
  }
  dea_free(ctx, work.clocks);
  dea_free(ctx, work.roles);
  DEA_TRY_ELSE(ctx, status, dea_recording_destroy(ctx, work.recording));
  *out = work.recording;
  return DEA_OK;
}

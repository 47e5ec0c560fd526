#include "cli/cli.h"

#include "base/json.h"
#include "recording/recording_csv.h"

#include <math.h>
#include <string.h>

struct request {
  const char *file, *output, *folder, *with;
  double after_s; // NAN: not said
  bool json, force;
};
static const struct request defaults = {.after_s = NAN};

// What is in it ----------------------------------------------------------------------------------

struct range {
  double lowest, highest; // NAN without any value
  size_t missing;
};

static struct range range_of(const double *values, size_t count)
{
  struct range range = {NAN, NAN, 0};
  for (size_t i = 0; i < count; i++) {
    range.missing += isnan(values[i]) ? 1U : 0U;
    range.lowest = fmin(range.lowest, values[i]);
    range.highest = fmax(range.highest, values[i]);
  }
  return range;
}

static double duration_of(const struct dea_channel *channel)
{
  if (channel->interval_s > 0) {
    return (double)channel->count * channel->interval_s;
  }
  return channel->count > 0 ? channel->time_s[channel->count - 1] - channel->time_s[0] : 0.0;
}

static size_t steps_of(const struct dea_recording *recording)
{
  size_t steps = 0;
  for (size_t i = 0; i < recording->cycle_count; i++) {
    steps += i == 0 || recording->cycles[i].step != recording->cycles[i - 1].step;
  }
  return steps;
}

static void print_line(const char *what, const char *text)
{
  char shown[CLI_PLAIN_SIZE];
  printf("%-14s %s\n", what, cli_plain(text, shown));
}

static void print_channel(const struct dea_channel *channel)
{
  char pace[48], name[CLI_PLAIN_SIZE], shown[CLI_PLAIN_SIZE];
  struct range range = range_of(channel->values, channel->count);
  double factor = dea_channel_meanings[channel->kind].factor;
  const char *unit = cli_plain(dea_channel_display_unit(channel), shown);
  if (channel->interval_s > 0) {
    snprintf(pace, sizeof pace, "%.6g Hz", 1 / channel->interval_s);
  } else {
    snprintf(pace, sizeof pace, "readings");
  }
  printf("  %-22s %-13s %-12s %10.3f s %10zu values", cli_plain(channel->name, name),
         dea_channel_meanings[channel->kind].name, pace, duration_of(channel), channel->count);
  if (!isnan(range.lowest)) {
    printf("  %.5g to %.5g %s", factor * range.lowest, factor * range.highest, unit);
  }
  if (range.missing > 0) {
    printf(", %zu missing", range.missing);
  }
  putchar('\n');
}

static void print_profiles(const struct dea_profiles *profiles)
{
  size_t total = profiles->count * profiles->points;
  struct range range = range_of(profiles->z_m, total);
  double span_s = profiles->time_s[profiles->count - 1] - profiles->time_s[0];
  printf("%-14s %zu of %zu points from %.5g to %.5g mm", "profiles", profiles->count,
         profiles->points, 1e3 * profiles->x_m[0], 1e3 * profiles->x_m[profiles->points - 1]);
  if (span_s > 0) {
    printf(", %.4g a second", (double)(profiles->count - 1) / span_s);
  }
  if (!isnan(range.lowest)) {
    printf(", heights %.5g to %.5g um", 1e6 * range.lowest, 1e6 * range.highest);
  }
  printf(", %.3g %% of the points invalid\n", 100.0 * (double)range.missing / (double)total);
}

/* The recordings that were joined, and when they begin, with what was joined to them before. */
static void print_joined(const json_t *joined, double at_s)
{
  const json_t *part;
  size_t i;
  char shown[CLI_PLAIN_SIZE];
  json_array_foreach(joined, i, part)
  {
    const char *file = json_string_value(json_object_get(part, "file"));
    double after_s = at_s + json_number_value(json_object_get(part, "after_s"));
    printf("%-14s %s, whose 0 is at %g s\n", "joined", cli_plain(file != NULL ? file : "", shown),
           after_s);
    print_joined(json_object_get(json_object_get(part, "provenance"), "joined"), after_s);
  }
}

static void print_provenance(const char *text)
{
  json_t *json = json_loads(text, 0, NULL), *value;
  const char *key;
  char shown[CLI_PLAIN_SIZE];
  if (json_is_object(json)) {
    json_object_foreach(json, key, value)
    {
      if (json_is_string(value)) {
        print_line(cli_plain(key, shown), json_string_value(value));
      } else if (json_is_number(value)) {
        printf("%-14s %g\n", cli_plain(key, shown), json_number_value(value));
      } else if (strcmp(key, "joined") == 0) {
        print_joined(value, 0);
      }
    }
  }
  json_decref(json);
}

static void print_text(const struct dea_recording *recording)
{
  char shown[CLI_PLAIN_SIZE];
  print_line("title", recording->title[0] != '\0' ? recording->title : "(none)");
  printf("%-14s %s%s\n", "complete",
         recording->complete ? "yes" : "no: ", cli_plain(recording->ended, shown));
  if (recording->output[0] != '\0') {
    print_line("output", recording->output);
  }
  printf("%-14s %zu\n", "channels", recording->channel_count);
  for (size_t c = 0; c < recording->channel_count; c++) {
    print_channel(&recording->channels[c]);
  }
  if (recording->profiles.count > 0) {
    print_profiles(&recording->profiles);
  }
  printf("%-14s %zu completed", "cycles", recording->cycle_count);
  if (recording->cycle_count > 0) {
    double lowest = INFINITY, highest = -INFINITY;
    for (size_t i = 0; i < recording->cycle_count; i++) {
      lowest = fmin(lowest, recording->cycles[i].level_V);
      highest = fmax(highest, recording->cycles[i].level_V);
    }
    size_t steps = steps_of(recording);
    printf(" in %zu step%s, %.4g to %.4g kV", steps, steps == 1 ? "" : "s", 1e-3 * lowest,
           1e-3 * highest);
  }
  putchar('\n');
  for (size_t i = 0; i < recording->event_count; i++) {
    const struct dea_recorded_event *event = &recording->events[i];
    char text[DEA_NOTICED_TEXT_SIZE];
    dea_noticed_text(event, recording->channels[event->channel].name, text);
    printf("%-14s %.6g s: %s\n", i == 0 ? "events" : "", event->time_s, cli_plain(text, shown));
  }
  print_line("protocol", recording->protocol != NULL ? "inside" : "none");
  print_line("design", recording->design == NULL        ? "none"
                       : recording->design_name != NULL ? recording->design_name
                                                        : "inside");
  if (recording->provenance != NULL) {
    print_provenance(recording->provenance);
  }
}

static json_t *json_of_channel(const struct dea_channel *channel)
{
  struct range range = range_of(channel->values, channel->count);
  json_t *json = json_object();
  dea_json_add_text(json, "name", channel->name);
  dea_json_add_text(json, "quantity", dea_channel_meanings[channel->kind].name);
  dea_json_add_text(json, "unit", channel->unit);
  dea_json_add_count(json, "count", channel->count);
  dea_json_add_count(json, "missing", range.missing);
  if (channel->interval_s > 0) {
    dea_json_add(json, "start_s", channel->start_s);
    dea_json_add(json, "interval_s", channel->interval_s);
  }
  dea_json_add(json, "duration_s", duration_of(channel));
  dea_json_add(json, "filter_Hz", channel->filter_Hz);
  dea_json_add(json, "lowest", range.lowest);
  dea_json_add(json, "highest", range.highest);
  return json;
}

static void print_json(const struct dea_recording *recording)
{
  json_t *json = json_object(), *channels = json_array(), *cycles = json_array();
  json_t *events = json_array();
  dea_json_add_text(json, "title", recording->title);
  json_object_set_new(json, "complete", json_boolean(recording->complete));
  dea_json_add_text(json, "ended", recording->ended);
  dea_json_add_text(json, "output", recording->output);
  for (size_t c = 0; c < recording->channel_count; c++) {
    json_array_append_new(channels, json_of_channel(&recording->channels[c]));
  }
  json_object_set_new(json, "channels", channels);
  if (recording->profiles.count > 0) {
    const struct dea_profiles *profiles = &recording->profiles;
    struct range range = range_of(profiles->z_m, profiles->count * profiles->points);
    json_t *object = json_pack("{s:I, s:I, s:I}", "frames", (json_int_t)profiles->count, "points",
                               (json_int_t)profiles->points, "invalid", (json_int_t)range.missing);
    dea_json_add(object, "from_m", profiles->x_m[0]);
    dea_json_add(object, "to_m", profiles->x_m[profiles->points - 1]);
    dea_json_add(object, "lowest_m", range.lowest);
    dea_json_add(object, "highest_m", range.highest);
    json_object_set_new(json, "profiles", object);
  }
  for (size_t i = 0; i < recording->cycle_count; i++) {
    const struct dea_recorded_cycle *cycle = &recording->cycles[i];
    json_t *object = json_pack("{s:I, s:I}", "step", (json_int_t)cycle->step, "number",
                               (json_int_t)cycle->number);
    dea_json_add(object, "start_s", cycle->start_s);
    dea_json_add(object, "end_s", cycle->end_s);
    dea_json_add(object, "level_V", cycle->level_V);
    json_array_append_new(cycles, object);
  }
  json_object_set_new(json, "cycles", cycles);
  for (size_t i = 0; i < recording->event_count; i++) {
    const struct dea_recorded_event *event = &recording->events[i];
    char text[DEA_NOTICED_TEXT_SIZE];
    json_t *object = dea_json_append(events);
    dea_noticed_text(event, recording->channels[event->channel].name, text);
    dea_json_add(object, "time_s", event->time_s);
    dea_json_add_text(object, "text", text);
    dea_json_add(object, "value", event->value);
    dea_json_add(object, "limit", event->limit);
  }
  json_object_set_new(json, "events", events);
  dea_json_add_text(json, "design_name", recording->design_name);
  json_t *provenance =
      recording->provenance != NULL ? json_loads(recording->provenance, 0, NULL) : NULL;
  json_object_set_new(json, "provenance", provenance != NULL ? provenance : json_null());
  cli_print_json(json);
}

/* One at a time: each has its own --after. */
static dea_status parse_with(struct dea_cli *cli, const struct cli_option *option, const char *text,
                             void *target)
{
  const char **with = target;
  (void)option;
  if (*with != NULL) {
    return cli_usage_error(cli, "--with once: write the two with -o, and join the third "
                                "to that");
  }
  *with = text;
  return DEA_OK;
}

static dea_status join(struct dea_context *ctx, const struct request *request,
                       struct dea_recording *recording)
{
  struct dea_recording *other;
  DEA_TRY(ctx, dea_recording_read(ctx, request->with, &other));
  dea_status status = dea_recording_join(ctx, recording, other, request->after_s);
  if (status == DEA_OK && request->output == NULL && request->folder == NULL) {
    const struct dea_location location = {.file = request->file};
    status =
        dea_finding_add(ctx, DEA_NOTE, location, "what is joined is shown only: -o FILE writes it");
  }
  dea_recording_destroy(ctx, other);
  return status;
}

static dea_status run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  struct dea_recording *recording = NULL;
  if ((request->with != NULL) != !isnan(request->after_s)) {
    return cli_usage_error(
        cli, request->with != NULL ? "--with needs --after: when the other's time 0 is, such as 0s "
                                     "where both count from one trigger"
                                   : "--after is said of another recording: --with FILE");
  }
  dea_status status = dea_recording_read(cli->ctx, request->file, &recording);
  status = status == DEA_OK && request->with != NULL ? join(cli->ctx, request, recording) : status;
  if (status == DEA_OK && request->output != NULL) {
    status = dea_recording_write(cli->ctx, recording, request->output);
  }
  if (status == DEA_OK && request->folder != NULL) {
    status = dea_recording_write_tables(cli->ctx, recording, request->folder, request->force);
  }
  if (status == DEA_OK && request->json) {
    print_json(recording);
  } else if (status == DEA_OK) {
    print_text(recording);
  }
  dea_recording_destroy(cli->ctx, recording);
  return status;
}

static const struct cli_option options[] = {
    CLI_RECORDING_ROW,
    CLI_OUTPUT_ROW(
        CLI_NEW_FILE, "FILE",
        "write a clean copy as FILE, which must not exist: also of a recording whose program was "
        "killed, and in a form that programs with older versions of HDF5 read"),
    {"with", 0, CLI_FILE, "OTHER",
     "join the channels and profiles of another recording of the same measurement", CLI_AT(with),
     parse_with},
    {"after", 0, CLI_TEXT, "TIME",
     "what FILE's clock shows where OTHER's shows 0, '0.25 s': 0 s where both count from one "
     "trigger",
     CLI_AT(after_s), cli_parse_quantity, .measure = {"s", "0.25 s"}},
    {"csv", 0, CLI_FOLDER, "DIR", "write the channels, profiles and cycles as CSV files into DIR",
     CLI_AT(folder)},
    CLI_FORCE_ROW('f', "replace an earlier recording's CSV files in DIR"),
    CLI_JSON_ROW("what is in it as JSON"),
    {0}};

const struct dea_command cmd_recording = {
    .name = "recording",
    .summary = "Say what is in a recording; copy, rescue or join it; write it as CSV",
    .defaults = &defaults,
    CLI_RUN};

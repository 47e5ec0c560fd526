#define _POSIX_C_SOURCE 200809L // unlink
#include "base/file.h"
#include "base/json.h"
#include "base/version.h"
#include "base/write_file.h"
#include "cli/cli.h"
#include "import/import.h"
#include "study/design_file.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

struct request {
  struct cli_words files;
  const char *map, *format, *output, *design;
  bool list, force, json;
};

// Listing ----------------------------------------------------------------------------------------

/* Smallest and largest value, NAN without any; returns how many are missing. */
static size_t range_get(const struct dea_table_column *column, double *low, double *high)
{
  size_t missing = 0;
  *low = NAN;
  *high = NAN;
  for (size_t i = 0; i < column->count; i++) {
    *low = fmin(*low, column->values[i]);
    *high = fmax(*high, column->values[i]);
    missing += isnan(column->values[i]) != 0;
  }
  return missing;
}

static dea_status list_json(struct dea_cli *cli, const struct dea_table *table,
                            const struct dea_column_role *roles)
{
  json_t *columns = json_array();
  for (size_t i = 0; i < table->column_count; i++) {
    const struct dea_table_column *column = &table->columns[i];
    double low, high;
    size_t missing = range_get(column, &low, &high);
    json_array_append_new(
        columns, json_pack("{s:s, s:s, s:I, s:I, s:o, s:o, s:o, s:s, s:s}", "name", column->name,
                           "unit", column->unit, "count", (json_int_t)column->count, "missing",
                           (json_int_t)missing, "smallest", dea_json_number(low), "largest",
                           dea_json_number(high), "interval_s", dea_json_number(column->interval),
                           "as", dea_role_name(&roles[i]), "why", roles[i].why));
  }
  json_t *json = json_pack("{s:s, s:s, s:s, s:o}", "file", table->file, "format", table->format,
                           "note", table->note != NULL ? table->note : "", "columns", columns);
  if (json == NULL) {
    return dea_fail(cli->ctx, DEA_E_IO, "'%s' has a name that is no UTF-8", table->file);
  }
  cli_print_json(json);
  return DEA_OK;
}

/* Letters of a name, for columns on the screen: bytes that begin one. */
static int letters(const char *text)
{
  int n = 0;
  for (; *text != '\0'; text++) {
    n += ((unsigned char)*text & 0xc0) != 0x80;
  }
  return n;
}

static void print_padded(const char *text, int width)
{
  printf("%s%*s", text, letters(text) < width ? width - letters(text) : 0, "");
}

static void list_text(const struct dea_table *table, const struct dea_column_role *roles)
{
  int name_width = 6, unit_width = 4;
  for (size_t i = 0; i < table->column_count; i++) {
    int n = letters(table->columns[i].name), m = letters(table->columns[i].unit);
    name_width = n > name_width ? n : name_width;
    unit_width = m > unit_width ? m : unit_width;
  }
  printf("%s: %s, %zu columns\n", table->file, table->format, table->column_count);
  print_padded("column", name_width + 2);
  print_padded("unit", unit_width + 2);
  printf("%9s  %12s  %12s  %-10s  %s\n", "values", "from", "to", "interval", "taken as");
  for (size_t i = 0; i < table->column_count; i++) {
    const struct dea_table_column *column = &table->columns[i];
    double low, high;
    size_t missing = range_get(column, &low, &high);
    print_padded(column->name, name_width + 2);
    print_padded(column->unit, unit_width + 2);
    printf("%9zu  %12.6g  %12.6g  ", column->count - missing, low, high);
    if (column->interval > 0) {
      printf("%-8.3g s", column->interval);
    } else {
      printf("%-10s", "");
    }
    printf("  %s (%s)", dea_role_name(&roles[i]), roles[i].why);
    if (missing > 0) {
      printf("; %zu missing", missing);
    }
    putchar('\n');
  }
}

static dea_status list(struct dea_cli *cli, const struct request *request,
                       const struct dea_table *table, const struct dea_mapping *mapping)
{
  struct dea_column_role *roles = dea_alloc(cli->ctx, table->column_count, sizeof *roles);
  dea_status status =
      roles != NULL ? dea_table_roles(cli->ctx, table, mapping, roles) : DEA_E_MEMORY;
  if (status == DEA_OK && request->json) {
    status = list_json(cli, table, roles);
  } else if (status == DEA_OK) {
    list_text(table, roles);
  }
  dea_free(cli->ctx, roles);
  return status;
}

// Recording --------------------------------------------------------------------------------------

static dea_status add_design(struct dea_context *ctx, const char *file,
                             struct dea_recording *recording)
{
  struct dea_design *design;
  DEA_TRY(ctx, dea_design_read(ctx, file, NULL, 0, &design)); // so that it is known to be good
  dea_design_destroy(ctx, design);
  size_t length;
  DEA_TRY(ctx, dea_file_read(ctx, file, DEA_YAML_SIZE_MAX, &recording->design, &length));
  recording->design_name = dea_copy_text(ctx, dea_path_name(file), SIZE_MAX);
  return recording->design_name != NULL ? DEA_OK : DEA_E_MEMORY;
}

/* Which files it came from, and how. */
static dea_status add_provenance(struct dea_cli *cli, const struct request *request,
                                 const struct dea_table *table, struct dea_recording *recording)
{
  json_t *files = json_array();
  for (size_t i = 0; i < request->files.count; i++) {
    json_array_append_new(files, json_string_nocheck(request->files.at[i]));
  }
  json_t *json = json_pack("{s:s, s:s, s:o, s:s, s:s}", "program", "dea import", "version",
                           DEA_VERSION, "files", files, "format", table->format, "note",
                           table->note != NULL ? table->note : "");
  char *text = json != NULL ? json_dumps(json, JSON_INDENT(2) | JSON_SORT_KEYS) : NULL;
  json_decref(json);
  recording->provenance = text != NULL ? dea_copy_text(cli->ctx, text, SIZE_MAX) : NULL;
  free(text);
  return recording->provenance != NULL ? DEA_OK : dea_fail(cli->ctx, DEA_E_MEMORY, "out of memory");
}

static dea_status write_file(struct dea_cli *cli, const struct request *request, const char *file,
                             const struct dea_recording *recording)
{
  struct dea_context *ctx = cli->ctx;
  if (dea_path_exists(file) && !request->force) {
    return dea_fail(ctx, DEA_E_IO, "'%s' already exists; --force replaces it", file);
  }
  char *partial = dea_partial_name(ctx, file);
  DEA_TRY_MEMORY(partial != NULL);
  unlink(partial); // left by a process of the same number that was killed
  dea_status status = dea_recording_write(ctx, recording, partial);
  status = status == DEA_OK ? dea_partial_finish(ctx, partial, file) : status;
  dea_free(ctx, partial);
  return status;
}

static void print_text(const char *file, const struct dea_recording *recording)
{
  for (size_t i = 0; i < recording->channel_count; i++) {
    const struct dea_channel *channel = &recording->channels[i];
    size_t last = channel->count > 0 ? channel->count - 1 : 0;
    printf("%-24s %-12s %zu samples", channel->name, dea_channel_names[channel->kind],
           channel->count);
    if (channel->count > 0) {
      printf(", %.6g to %.6g s", dea_channel_time(channel, 0), dea_channel_time(channel, last));
    }
    if (channel->interval_s > 0) {
      printf(", %.6g Hz", 1 / channel->interval_s);
    }
    printf("\n");
  }
  if (recording->profiles.count > 0) {
    printf("%-24s %-12s %zu frames of %zu points\n", "profile", "profile",
           recording->profiles.count, recording->profiles.points);
  }
  printf("%-24s %s\n", "file", file);
}

static void print_json(const char *file, const struct dea_recording *recording)
{
  json_t *channels = json_array();
  for (size_t i = 0; i < recording->channel_count; i++) {
    const struct dea_channel *channel = &recording->channels[i];
    json_array_append_new(
        channels,
        json_pack("{s:s, s:s, s:s, s:I, s:o, s:o}", "name", channel->name, "kind",
                  dea_channel_names[channel->kind], "unit", channel->unit, "count",
                  (json_int_t)channel->count, "start_s",
                  dea_json_number(channel->count > 0 ? dea_channel_time(channel, 0) : NAN),
                  "interval_s",
                  dea_json_number(channel->interval_s > 0 ? channel->interval_s : NAN)));
  }
  cli_print_json(json_pack("{s:s, s:o, s:I, s:I}", "recording", file, "channels", channels,
                           "frames", (json_int_t)recording->profiles.count, "points",
                           (json_int_t)recording->profiles.points));
}

static dea_status record(struct dea_cli *cli, const struct request *request,
                         const struct dea_table *table, const struct dea_mapping *mapping)
{
  struct dea_context *ctx = cli->ctx;
  struct dea_text name = {.ctx = ctx};
  struct dea_recording *recording;
  DEA_TRY(ctx, dea_table_record(ctx, table, mapping, &recording));
  dea_status status = add_provenance(cli, request, table, recording);
  if (status == DEA_OK && request->design != NULL) {
    status = add_design(ctx, request->design, recording);
  }
  if (request->output != NULL) {
    dea_text_add(&name, "%s", request->output);
  } else {
    size_t stem;
    const char *path = dea_path_stem(request->files.at[0], &stem);
    dea_text_add(&name, "%.*s.h5", (int)stem, path);
  }
  if (status == DEA_OK) {
    status = name.failed ? DEA_E_MEMORY : write_file(cli, request, dea_text_get(&name), recording);
  }
  if (status == DEA_OK && request->json) {
    print_json(dea_text_get(&name), recording);
  } else if (status == DEA_OK) {
    print_text(dea_text_get(&name), recording);
  }
  dea_text_free(&name);
  dea_recording_destroy(ctx, recording);
  return status;
}

static dea_status read_tables(struct dea_cli *cli, const struct request *request,
                              struct dea_table **out)
{
  DEA_TRY(cli->ctx, dea_table_read(cli->ctx, request->files.at[0], request->format, out));
  dea_status status = DEA_OK;
  for (size_t i = 1; i < request->files.count && status == DEA_OK; i++) {
    struct dea_table *other;
    status = dea_table_read(cli->ctx, request->files.at[i], request->format, &other);
    status = status == DEA_OK ? dea_table_join(cli->ctx, *out, other) : status;
    dea_table_destroy(cli->ctx, other);
  }
  return status;
}

static dea_status run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  struct dea_mapping *mapping = NULL;
  struct dea_table *table = NULL;
  if (request->list && (request->output != NULL || request->design != NULL)) {
    return cli_usage_error(cli, "--list writes nothing: leave -o and --design out");
  }
  dea_status status =
      request->map != NULL ? dea_mapping_read(cli->ctx, request->map, &mapping) : DEA_OK;
  status = status == DEA_OK ? read_tables(cli, request, &table) : status;
  if (status == DEA_OK) {
    status =
        request->list ? list(cli, request, table, mapping) : record(cli, request, table, mapping);
  }
  dea_table_destroy(cli->ctx, table);
  dea_mapping_destroy(cli->ctx, mapping);
  return status;
}

static const struct cli_option options[] = {
    CLI_MANY(CLI_FILE, "FILE...", "files of one measurement", files, CLI_WORDS_MAX,
             "a file is missing", "more than 64 files"),
    {"map", 0, CLI_FILE, "FILE", "mapping in YAML", CLI_AT(map)},
    {"format", 0, CLI_IMPORTER, "NAME", "format, when it is not recognised", CLI_AT(format)},
    CLI_OUTPUT_ROW(CLI_NEW_FILE, "FILE",
                   "the recording; without it the first file's name with .h5, here"),
    {"design", 0, CLI_DESIGN, "DESIGN",
     "put this design inside, so that 'dea reduce' knows the geometry", CLI_AT(design)},
    {"list", 0, CLI_FLAG, NULL, "show columns and what they would be taken for; write nothing",
     CLI_AT(list)},
    CLI_FORCE_ROW('f', "replace the recording"),
    CLI_JSON_ROW("print what was read as JSON"),
    {0}};

const struct dea_command cmd_import = {
    .name = "import",
    .summary = "Make a recording of other programs' files",
    .about =
        "Reads columns of numbers from CSV and other text (any separator, decimal comma, units in "
        "titles; those of oscilloscopes too), MATLAB's .mat (version 5 and 7.3), LabVIEW's .lvm "
        "and .tdms, TRIOS' .json, and COMSOL's text export. What a column is follows from its name "
        "and unit, or from a mapping; 'dea schema "
        "--mapping' shows its keys. What was taken for what is said. Several files become one "
        "recording when they have one clock.",
    CLI_RUN};

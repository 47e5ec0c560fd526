/* dea fab: design -> files for the workshop. */
#include "cli/cli.h"

#include "base/json.h"
#include "base/text.h"
#include "fabricate/files.h"
#include "fabricate/process.h"

static dea_status add_name(void *array, const char *name)
{
  json_array_append_new(array, json_string(name));
  return DEA_OK;
}

/* What one actuator needs; what the design does not say is left out. */
static json_t *amounts_json(const struct dea_workshop *w)
{
  struct dea_amounts a;
  json_t *json = json_object();
  dea_amounts_find(w, &a);
  dea_json_put(json, "film_area_m2", a.film_area_m2);
  dea_json_put(json, "ink_area_m2", a.ink_area_m2);
  dea_json_put(json, "ink_volume_m3", a.ink_volume_m3);
  dea_json_put(json, "transfer_glue_area_m2", a.transfer_glue_area_m2);
  dea_json_put(json, "bond_area_m2", a.bond_area_m2);
  dea_json_put(json, "bond_volume_m3", a.bond_volume_m3);
  return json;
}

/* Sizes of the finished parts, and what was written where. */
static void print_json(const struct dea_workshop *w, const struct cli_design_arguments *arguments,
                       const struct dea_workshop_options *options, const char *directory)
{
  json_t *parts = json_array(), *files = json_array();
  for (size_t i = 0; i < w->count; i++) {
    const struct dea_part *part = &w->part[i];
    json_t *row = json_pack("{s:s, s:s, s:i, s:f, s:f}", "name", part->name, "film",
                            dea_film_state_name(part->state), "copies", w->layout[i].count,
                            "area_m2", dea_part_area_m2(part), "cut_length_m",
                            dea_part_length_m(part, DEA_LAYER_CUT_INNER) +
                                dea_part_length_m(part, DEA_LAYER_CUT_OUTER));
    json_array_append_new(parts, row);
  }
  dea_workshop_files(w, options, add_name, files);
  json_t *json = json_object();
  dea_json_put_text(json, "design", arguments->design);
  dea_json_put_text(json, "folder", directory);
  json_object_set_new(json, "copies", json_integer(w->plan.copies));
  dea_json_put(json, "kerf_m", w->plan.kerf_m);
  json_object_set_new(json, "parts", parts);
  json_object_set_new(json, "files", files);
  json_object_set_new(json, "amounts_of_one", amounts_json(w));
  cli_print_json(json);
}

static dea_status write_files(struct dea_cli *cli, const struct cli_design_arguments *arguments,
                              const struct dea_workshop *workshop)
{
  struct dea_text name = {.ctx = cli->ctx};
  const struct dea_workshop_options options = {arguments->force, arguments->drawing};
  const char *directory = arguments->output;
  if (directory == NULL) {
    cli_folder_name(arguments->design, "fab", &name);
    directory = dea_text_get(&name);
  }
  dea_status status =
      name.failed ? DEA_E_MEMORY : dea_workshop_prepare(cli->ctx, workshop, directory, &options);
  if (status == DEA_OK) {
    status = dea_workshop_write(cli->ctx, workshop, directory, &options);
  }
  if (status == DEA_OK && arguments->json) {
    print_json(workshop, arguments, &options, directory);
    fflush(stdout);
  } else if (status == DEA_OK && !cli->quiet) {
    fprintf(stderr, "files for the workshop are in %s\n", directory);
  }
  dea_text_free(&name);
  return status;
}

static int run(struct dea_cli *cli, int argc, char **argv)
{
  struct cli_design_arguments arguments;
  struct dea_design *design = NULL;
  struct dea_device *device = NULL;
  struct dea_workshop *workshop = NULL;
  int wrong = cli_parse_design_arguments(cli, &cmd_fab, CLI_WRITES_FOLDER, argc, argv, &arguments);
  if (wrong >= 0) {
    return wrong;
  }
  dea_status status = cli_build_device(cli, &arguments, &design, &device);
  if (status == DEA_OK) {
    status = dea_workshop_create(cli->ctx, design, device, &workshop);
  }
  if (status == DEA_OK) {
    status = write_files(cli, &arguments, workshop);
  }
  int code = cli_report(cli, status);
  dea_workshop_destroy(cli->ctx, workshop);
  dea_device_destroy(cli->ctx, device);
  dea_design_destroy(cli->ctx, design);
  return code;
}

const struct dea_command cmd_fab = {
    .name = "fab",
    .summary = "Make the files for the workshop: masks, fibres, frame, process sheet",
    .usage =
        "dea fab DESIGN [-o DIR] [--force] [--drawing] [--set KEY=VALUE]... [--json]\n\n"
        "Writes for each part a DXF and an SVG file in mm, with the kerf taken into account,\n"
        "drawings at 1:1 with dimensions, the process sheet, and a drawing of the actuator.\n"
        "Kerf, sheet, leads, tabs and the like are in the section 'fabrication' of DESIGN.\n\n"
        "  -o, --output DIR   folder for the files; DESIGN's name with .fab if not given\n"
        "  -f, --force        replace files that are there; sheets of fibres go when DESIGN has\n"
        "                     none\n"
        "      --drawing      only the drawing of the actuator\n"
        "      --set KEY=VALUE  take VALUE in place of the file's, for example\n"
        "                     --set fabrication.kerf=0.15mm\n"
        "      --json         areas, lengths and names of files as JSON\n",
    .run = run,
};

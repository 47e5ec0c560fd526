/* dea fab: design -> files for the workshop. */
#include "cli/cli.h"

#include "base/json.h"
#include "fabricate/files.h"
#include "fabricate/process.h"

struct request {
  const char *design, *output; // output: NULL for the folder of the design's name
  struct cli_overrides overrides;
  bool force, drawing, json;
};

/* What one actuator needs; what the design does not say is left out. */
static json_t *amounts_json(const struct dea_workshop *w)
{
  struct dea_amounts a;
  json_t *json = json_object();
  dea_amounts_find(w, &a);
  dea_json_add(json, "film_area_m2", a.film_area_m2);
  dea_json_add(json, "ink_area_m2", a.ink_area_m2);
  dea_json_add(json, "ink_volume_m3", a.ink_volume_m3);
  dea_json_add(json, "transfer_glue_area_m2", a.transfer_glue_area_m2);
  dea_json_add(json, "bond_area_m2", a.bond_area_m2);
  dea_json_add(json, "bond_volume_m3", a.bond_volume_m3);
  dea_json_add(json, "mass_kg", a.mass_kg);
  return json;
}

/* Sizes of the finished parts, and what was written where. */
static void print_json(const struct dea_workshop *w, const struct request *request,
                       const struct dea_workshop_options *options)
{
  json_t *parts = json_array(), *files = json_array();
  for (size_t i = 0; i < w->count; i++) {
    const struct dea_part *part = &w->part[i];
    json_t *row =
        json_pack("{s:s, s:s, s:i, s:f, s:f}", "name", part->name, "film", dea_part_film_name(part),
                  "copies", w->layout[i].count, "area_m2", dea_part_area_m2(part), "cut_length_m",
                  dea_part_length_m(part, DEA_LAYER_CUT_INNER) +
                      dea_part_length_m(part, DEA_LAYER_CUT_OUTER));
    if (part->quantity > 1) {
      json_object_set_new(row, "times", json_integer((json_int_t)part->quantity));
    }
    json_array_append_new(parts, row);
  }
  char name[DEA_WORKSHOP_NAME_SIZE];
  for (size_t i = 0; dea_workshop_file(w, options, i, name); i++) {
    json_array_append_new(files, json_string(name));
  }
  json_t *json = json_object();
  dea_json_add_text(json, "design", request->design);
  dea_json_add_text(json, "folder", request->output);
  json_object_set_new(json, "copies", json_integer(w->plan.copies));
  dea_json_add(json, "kerf_m", w->plan.kerf_m);
  json_object_set_new(json, "parts", parts);
  json_object_set_new(json, "files", files);
  json_object_set_new(json, "amounts_of_one", amounts_json(w));
  cli_print_json(json);
}

static dea_status write_files(struct dea_cli *cli, const struct request *request,
                              const struct dea_workshop *workshop)
{
  const struct dea_workshop_options options = {request->force, request->drawing};
  DEA_TRY(cli->ctx, dea_workshop_prepare(cli->ctx, workshop, request->output, &options));
  DEA_TRY(cli->ctx, dea_workshop_write(cli->ctx, workshop, request->output, &options));
  if (request->json) {
    print_json(workshop, request, &options);
  } else if (!cli->quiet) {
    fprintf(stderr, "files for the workshop are in %s\n", request->output);
  }
  return DEA_OK;
}

static dea_status build(struct dea_cli *cli, const void *request, const struct dea_design *design,
                        const struct dea_device *device)
{
  struct dea_workshop *workshop;
  DEA_TRY(cli->ctx, dea_workshop_create(cli->ctx, design, device, &workshop));
  const dea_status status = write_files(cli, request, workshop);
  dea_workshop_destroy(cli->ctx, workshop);
  return status;
}

static dea_status run(struct dea_cli *cli, void *user)
{
  struct request *request = user;
  DEA_TRY(cli->ctx, cli_output_name(cli, request->design, "fab", &request->output));
  return cli_with_device(cli, request->design, &request->overrides, build, request);
}

static const struct cli_option options[] = {
    CLI_DESIGN_ROW,
    CLI_OUTPUT_ROW(CLI_FOLDER, "DIR", "folder for the files; DESIGN's name with .fab if not given"),
    CLI_FORCE_ROW('f', "replace files that are there"),
    {"drawing", 0, CLI_FLAG, NULL, "only the drawing of the actuator", CLI_AT(drawing)},
    CLI_SET_ROW(0, CLI_KEY, "fabrication.kerf=0.15mm"),
    CLI_JSON_ROW("areas, lengths and names of files as JSON"),
    {0}};

const struct dea_command cmd_fab = {
    .name = "fab",
    .summary = "Make the files for the workshop: masks, fibres, frame, process sheet",
    .about = "Writes for each part a DXF and an SVG file in mm, with the kerf taken into account, "
             "drawings at 1:1 with dimensions, the process sheet, and a drawing of the actuator. "
             "Kerf, sheet, leads, tabs and the like are in the section 'fabrication' of DESIGN.",
    CLI_RUN};

#include "cli/cli.h"

#include "base/text.h"
#include "base/write_file.h"
#include "cli/print_layout.h"
#include "device/device.h"
#include "figures/device_drawing.h"
#include "job/job.h"
#include "study/design_file.h"
#include "study/study.h"

#include <math.h>
#include <string.h>

struct request {
  const char *design, *svg;
  struct cli_overrides overrides;
  bool json, all;
};

enum { DERIVED_MAX = 16 };

/* A number that follows from the design. */
struct derived {
  const char *key, *meaning;
  double si;
  const char *unit;
  double factor; // SI -> unit
};

static const char *const origin_names[] = {"absent", "default", "given", "override"};

static size_t derive(const struct dea_device *device, struct derived rows[DERIVED_MAX])
{
  size_t n = 0;
  rows[n++] = (struct derived){"film_thickness_m", "film thickness (stretched)",
                               device->film_thickness_m, "um", 1e6};
  rows[n++] = (struct derived){"frame_radius_m", "frame radius", device->frame_radius_m, "mm", 1e3};
  rows[n++] = (struct derived){"electrode_radius_m", "electrode radius (stretched)",
                               device->electrode_radius_m, "mm", 1e3};
  rows[n++] = (struct derived){"coverage", "coverage (paper eq 17)", device->coverage, "", 1};
  if (device->fibre_count > 0) {
    rows[n++] = (struct derived){"fibre_tip_radius_m", "fibre tip from the centre",
                                 device->fibre_tip_radius_m, "mm", 1e3};
    rows[n++] =
        (struct derived){"fibre_length_m", "fibre length", device->fibre_length_m, "mm", 1e3};
    rows[n++] = (struct derived){"fibre_overlap_m", "fibre overlap with the electrode",
                                 device->fibre_overlap_m, "mm", 1e3};
  }
  return n;
}

static void print_values(const struct dea_design *design)
{
  int width = 0;
  for (size_t i = 0; i < design->values.count; i++) {
    int length = (int)strlen(design->values.items[i].path);
    width = length > width && length < 40 ? length : width;
  }
  for (size_t i = 0; i < design->values.count; i++) {
    const struct dea_listed *value = &design->values.items[i];
    printf("  %-*s  %-24s  ", width, value->path, value->text);
    if (value->origin == DEA_GIVEN) {
      printf("line %zu\n", value->location.line);
    } else if (value->origin == DEA_OVERRIDE) {
      puts("--set");
    } else {
      puts(value->origin == DEA_DEFAULT ? "default" : "not given");
    }
  }
}

/* "width 38 mm" of "shapes[0].width"; names, kinds, and further elements of a list by their value
 * alone. */
static void add_given(struct dea_text *row, const struct dea_listed *value, size_t part)
{
  const char *key = value->path[part] == '.' ? value->path + part + 1 : "",
             *list = strchr(key, '[');
  const char *inner = list != NULL ? strrchr(list, '.') : NULL;
  const bool alone = strcmp(key, "name") == 0 || strcmp(key, "kind") == 0;
  const bool more = list != NULL && inner == NULL && strstr(list, "[0]") == NULL;
  key = inner != NULL ? inner + 1 : key;
  const int shown = alone || more ? 0 : (int)strcspn(key, "[");
  dea_text_add(row, "%s%.*s%s%s%s", row->length > 0 ? ", " : "", shown, key, shown > 0 ? " " : "",
               value->text, value->origin == DEA_OVERRIDE ? " (--set)" : "");
}

/* What the file and --set give, a row for each part. */
static dea_status print_given(struct dea_context *ctx, const struct dea_design *design)
{
  struct dea_text row = {.ctx = ctx};
  const char *name = "";
  size_t length = 0;
  for (size_t i = 0; i < design->values.count; i++) {
    const struct dea_listed *value = &design->values.items[i];
    const size_t part = strcspn(value->path, ".");
    if ((value->origin != DEA_GIVEN && value->origin != DEA_OVERRIDE) ||
        strcmp(value->path, "dea") == 0 || strcmp(value->path, "title") == 0) {
      continue;
    }
    if (part != length || strncmp(value->path, name, part) != 0) {
      DEA_TRY(ctx, cli_row_print(name, length, &row));
      name = value->path;
      length = part;
    }
    add_given(&row, value, part);
  }
  return cli_row_print(name, length, &row);
}

static dea_status print_text(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device, bool all)
{
  printf("%s%s%s\n\n%s\n", design->file, design->title.text[0] != '\0' ? ": " : "",
         design->title.text, all ? "Values" : "Given (--all lists the defaults too)");
  if (all) {
    print_values(design);
  } else {
    DEA_TRY(ctx, print_given(ctx, design));
  }
  puts("\nDerived");
  struct derived rows[DERIVED_MAX];
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a design without errors has its device
  const size_t count = device->disc ? derive(device, rows) : 0;
  for (size_t i = 0; i < count; i++) {
    printf("  %-32s  %.6g%s%s\n", rows[i].meaning, rows[i].factor * rows[i].si,
           rows[i].unit[0] != '\0' ? " " : "", rows[i].unit);
  }
  const size_t last = design->compute.voltage_count - 1;
  printf("  %-32s  %zu, from %g kV to %g kV\n", "voltages", design->compute.voltage_count,
         1e-3 * design->compute.voltages_V[0], 1e-3 * design->compute.voltages_V[last]);
  return cli_layout_print(ctx, device->layout);
}

static json_t *values_json(const struct dea_design *design)
{
  json_t *array = json_array();
  for (size_t i = 0; i < design->values.count; i++) {
    const struct dea_listed *value = &design->values.items[i];
    json_t *row =
        json_pack("{s:s, s:s, s:s, s:I, s:I}", "key", value->path, "text", value->text, "origin",
                  origin_names[value->origin], "line", (json_int_t)value->location.line, "column",
                  (json_int_t)value->location.column);
    if (value->unit != NULL && !isnan(value->si)) {
      json_object_set_new(row, "si", json_real(value->si));
      json_object_set_new(row, "unit", json_string(value->unit));
    }
    json_array_append_new(array, row);
  }
  return array;
}

/* design and device may be NULL after an error. */
static void print_json(const struct dea_cli *cli, const struct request *request,
                       const struct dea_design *design, const struct dea_device *device)
{
  json_t *json = json_pack("{s:s, s:b, s:o}", "file", request->design, "good",
                           dea_finding_count(cli->ctx, DEA_ERROR) == 0 && device != NULL,
                           "findings", cli_findings_json(cli->ctx));
  if (design != NULL) {
    json_object_set_new(json, "values", values_json(design));
  }
  if (device != NULL) {
    struct derived rows[DERIVED_MAX];
    size_t count = device->disc ? derive(device, rows) : 0;
    json_t *derived = cli_layout_json(device->layout);
    for (size_t i = 0; i < count; i++) {
      json_object_set_new(derived, rows[i].key, json_real(rows[i].si));
    }
    json_object_set_new(json, "derived", derived);
  }
  cli_print_json(json);
}

/* The drawing of a device into a file. */
static dea_status write_drawing(struct dea_cli *cli, const char *file,
                                const struct dea_device *device)
{
  struct dea_text out = {.ctx = cli->ctx};
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a design without errors has its device
  const struct dea_device_drawing drawing = {.layout = device->layout};
  dea_status status = dea_device_drawing_add_svg(&drawing, 1, &out);
  if (status == DEA_OK) {
    status = dea_file_write(cli->ctx, file, dea_text_get(&out), out.length);
  }
  dea_text_free(&out);
  return status;
}

/* All that a run would refuse, and what it would leave out. */
static dea_status check(struct dea_context *ctx, const struct dea_design *design,
                        struct dea_device **device)
{
  struct dea_job job = {.folder = NULL};
  const dea_status known = dea_job_models(ctx, design, &job);
  dea_status status = dea_device_build(ctx, design, device);
  status = status != DEA_OK ? status : known;
  const struct dea_result result = {.design = design, .device = *device};
  const dea_status good = dea_job_check(ctx, &job, true, &result);
  status = status != DEA_OK ? status : good;
  return status == DEA_OK ? dea_study_warn(ctx, design, *device) : status;
}

static int run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  struct dea_design *design = NULL;
  struct dea_device *device = NULL;
  dea_status status = dea_design_read(cli->ctx, request->design, request->overrides.at,
                                      request->overrides.count, &design);
  status = status == DEA_OK ? check(cli->ctx, design, &device) : status;
  if (request->svg != NULL && status == DEA_OK) {
    status = write_drawing(cli, request->svg, device);
  }
  if (request->json) {
    print_json(cli, request, design, device);
  } else if (status == DEA_OK) {
    status = print_text(cli->ctx, design, device, request->all);
    fflush(stdout);
  }
  int code = cli_report(cli, status);
  dea_device_destroy(cli->ctx, device);
  dea_design_destroy(cli->ctx, design);
  return code;
}

static const struct cli_option options[] = {
    CLI_DESIGN_ROW,
    CLI_SET_ROW(0, CLI_KEY, "film.thickness=200um; 'null' takes a key away"),
    {"all", 0, CLI_FLAG, NULL, "every value with its line, defaults too", CLI_AT(all)},
    {"svg", 0, CLI_NEW_FILE, "FILE", "a drawing of the device", CLI_AT(svg)},
    CLI_JSON_ROW("values, derived numbers and findings as JSON"),
    {0}};

const struct dea_command cmd_check = {
    .name = "check",
    .summary = "Check a design file; say what it gives and what follows from it",
    CLI_RUN};

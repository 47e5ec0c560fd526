#include "cli/cli.h"

#include "base/text.h"
#include "base/write_file.h"
#include "cli/print_layout.h"
#include "device/device.h"
#include "job/job.h"
#include "output/drawing/device_drawing.h"
#include "study/design_file.h"
#include "study/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct request {
  const char *design, *svg;
  struct cli_overrides overrides;
  bool json, changed;
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

/* Whether a value is listed: with `changed` only one that the file or --set gives. */
static bool is_listed(const struct dea_listed *value, bool changed)
{
  return !changed || value->origin == DEA_GIVEN || value->origin == DEA_OVERRIDE;
}

static void print_values(const struct dea_design *design, bool changed)
{
  int width = 0;
  for (size_t i = 0; i < design->values.count; i++) {
    int length = (int)strlen(design->values.items[i].path);
    width = length > width && length < 40 ? length : width;
  }
  for (size_t i = 0; i < design->values.count; i++) {
    const struct dea_listed *value = &design->values.items[i];
    if (!is_listed(value, changed)) {
      continue;
    }
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

static void print_material(const char *what, const struct dea_material *material)
{
  if (material->name[0] == '\0') {
    return;
  }
  printf("  %-32s  %s", what, material->name);
  if (material->law != NULL) {
    printf(", %s (%s)", material->law->name, material->law_id);
  }
  if (material->permittivity.at_rest > 0) {
    printf(", eps_r %g", material->permittivity.at_rest);
  }
  if (material->permittivity.slope != 0) {
    printf(" %+g (s - 1)", material->permittivity.slope);
  }
  if (material->breakdown.known) {
    const struct dea_breakdown *b = &material->breakdown;
    printf(", E_b %.4g V/um", 1e-6 * b->at_rest_V_per_m);
    if (b->exponent != 0) {
      printf(" s^%g", b->exponent);
    }
    if (b->law.high > b->law.low) {
      printf(" (%.4g to %.4g by source)", 1e-6 * b->law.low * b->at_rest_V_per_m,
             1e-6 * b->law.high * b->at_rest_V_per_m);
    }
    if (b->law.shape > 0) {
      printf(", Weibull shape %g", b->law.shape);
    }
  }
  if (material->young_modulus_Pa > 0) {
    printf(", E %g MPa", 1e-6 * material->young_modulus_Pa);
  }
  putchar('\n');
}

static void print_voltages(const struct dea_design *design)
{
  size_t last = design->compute.voltage_count - 1;
  printf("  %-32s  %zu, from %g kV to %g kV\n", "voltages", design->compute.voltage_count,
         1e-3 * design->compute.voltages_V[0], 1e-3 * design->compute.voltages_V[last]);
}

static void print_disc(const struct dea_design *design, const struct dea_device *device)
{
  struct derived rows[DERIVED_MAX];
  size_t count = derive(device, rows);
  for (size_t i = 0; i < count; i++) {
    printf("  %-32s  %.6g%s%s\n", rows[i].meaning, rows[i].factor * rows[i].si,
           rows[i].unit[0] != '\0' ? " " : "", rows[i].unit);
  }
  print_voltages(design);
  printf("  %-32s  %g%s\n", "end of the path (total stretch)", design->compute.path_max_stretch.si,
         design->compute.path_max_stretch.origin == DEA_DEFAULT
             ? ", or that of the highest voltage if larger"
             : "");
  print_material("film", &device->film);
  print_material("electrodes", &device->electrode);
  print_material("fibres", &device->fibre);
}

static void print_text(const struct dea_design *design, const struct dea_device *device,
                       bool changed)
{
  printf("%s\n\nValues\n", design->file);
  print_values(design, changed);
  puts("\nDerived");
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a design without errors has its device
  if (device->general) {
    print_voltages(design);
    cli_layout_print(device->layout);
  } else {
    print_disc(design, device);
  }
}

static json_t *values_json(const struct dea_design *design, bool changed)
{
  json_t *array = json_array();
  for (size_t i = 0; i < design->values.count; i++) {
    const struct dea_listed *value = &design->values.items[i];
    if (!is_listed(value, changed)) {
      continue;
    }
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
    json_object_set_new(json, "values", values_json(design, request->changed));
  }
  if (device != NULL && device->general) {
    json_object_set_new(json, "derived", cli_layout_json(device->layout));
  } else if (device != NULL) {
    struct derived rows[DERIVED_MAX];
    size_t count = derive(device, rows);
    json_t *derived = json_object();
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
    print_text(design, device, request->changed);
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
    {"changed", 0, CLI_FLAG, NULL, "only the values that the file or --set gives, no defaults",
     CLI_AT(changed)},
    {"svg", 0, CLI_NEW_FILE, "FILE", "a drawing of the device", CLI_AT(svg)},
    CLI_JSON_ROW("values, derived numbers and findings as JSON"),
    {0}};

const struct dea_command cmd_check = {
    .name = "check",
    .summary = "Check a design file and list every value with its origin",
    .options = options,
    .request_size = sizeof(struct request),
    .run = run,
};

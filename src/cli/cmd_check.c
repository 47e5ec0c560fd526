#include "base/rounded.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cli/cli.h"
#include "device/device.h"
#include "figures/device_drawing.h"
#include "job/job.h"
#include "study/design_file.h"
#include "study/study.h"

#include <math.h>
#include <stdio.h>
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

// The layout --------------------------------------------------------------------------------------

enum { NAME_WIDTH = 14, LABEL_SIZE = 128 };

static const double degree = 57.29577951308232;

static dea_status print_row(const char *name, size_t length, struct dea_text *text)
{
  struct dea_text row = {.ctx = text->ctx};
  if (text->length > 0) {
    const int width = length > NAME_WIDTH ? (int)length : NAME_WIDTH;
    dea_text_add(&row, "  %-*.*s  ", width, (int)length, name);
    cli_add_wrapped(&row, NAME_WIDTH + 4, dea_text_get(text), text->length);
    fputs(dea_text_get(&row), stdout);
  }
  dea_text_free_in(&row, text);
  return dea_text_free(text);
}

static void add_material(const struct dea_material *m, struct dea_text *out)
{
  dea_text_add(out, ", %s", m->name);
  if (m->law != NULL) {
    dea_text_add(out, ", %s (%s)", m->law->name, m->law_id);
  }
  if (m->permittivity.at_rest > 0) {
    dea_text_add(out, ", eps_r %g", m->permittivity.at_rest);
  }
  if (m->permittivity.slope != 0) {
    dea_text_add(out, " %+g (s - 1)", m->permittivity.slope);
  }
  const struct dea_breakdown *b = &m->breakdown;
  if (b->known) {
    dea_text_add(out, ", E_b %.4g V/um", 1e-6 * b->at_rest_V_per_m);
  }
  if (b->known && b->exponent != 0) {
    dea_text_add(out, " s^%g", b->exponent);
  }
  if (b->known && b->law.high > b->law.low) {
    dea_text_add(out, " (%.4g to %.4g by source)", 1e-6 * b->law.low * b->at_rest_V_per_m,
                 1e-6 * b->law.high * b->at_rest_V_per_m);
  }
  if (b->known && b->law.shape > 0) {
    dea_text_add(out, ", Weibull shape %g", b->law.shape);
  }
  if (m->young_modulus_Pa > 0) {
    dea_text_add(out, ", E %g MPa", 1e-6 * m->young_modulus_Pa);
  }
}

static void add_channel(const struct dea_layout_channel *c, struct dea_text *out)
{
  dea_text_add(out, "%s%s %g x voltage", out->length > 0 ? ", " : "", c->name, c->ratio);
  if (c->own_V != 0) {
    dea_text_add(out, " %+g V", c->own_V);
  }
  if (c->waveform != NULL) {
    dea_text_add(out, " (in time a waveform of its own, %s)", c->waveform);
  }
}

static void add_symmetry(const struct dea_symmetry *s, struct dea_text *out)
{
  if (s->order == 0) {
    dea_text_add(out, "every turn and every mirror");
  } else if (s->order == 1 && s->mirrors == 0) {
    dea_text_add(out, "none");
    return;
  } else if (s->order == 1) {
    dea_text_add(out, "one mirror, at %.4g degree", dea_rounded(degree * s->mirror_rad));
  } else {
    dea_text_add(out, "%zu turns, %zu mirror%s", s->order, s->mirrors, s->mirrors == 1 ? "" : "s");
  }
  if (s->order > 1 && s->mirrors > 0) {
    dea_text_add(out, ", the first at %.4g degree", dea_rounded(degree * s->mirror_rad));
  }
  dea_text_add(out, ", about (%.4g, %.4g) mm", dea_rounded(1e3 * s->centre_m[0]),
               dea_rounded(1e3 * s->centre_m[1]));
}

static dea_status print_layout(struct dea_context *ctx, const struct dea_layout *l)
{
  struct dea_text text = {.ctx = ctx};
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_layout_ply *ply = &l->plies[i];
    char name[LABEL_SIZE];
    snprintf(name, sizeof name, "ply %zu, %s", i + 1, ply->name);
    const size_t layers = dea_ply_layers(ply);
    if (layers > 1) {
      dea_text_add(&text, "%zu layers of ", layers);
    }
    dea_text_add(&text, "%.6g um", 1e6 * dea_ply_stretched_layer_m(ply));
    add_material(&ply->material, &text);
    dea_text_add(&text, "%s", dea_layout_is_dielectric(l, i) ? ", between electrodes" : "");
    DEA_TRY(ctx, print_row(name, strlen(name), &text));
  }
  for (size_t i = 0; i < l->region_count; i++) {
    dea_text_add(&text, "%s%s %.6g mm2", i > 0 ? ", " : "", l->regions[i].name,
                 1e6 * dea_region_area_m2(&l->regions[i].region));
  }
  DEA_TRY(ctx, print_row("areas", strlen("areas"), &text));
  for (size_t i = 1; i < l->channel_count; i++) {
    add_channel(&l->channels[i], &text);
  }
  DEA_TRY(ctx, print_row("channels", strlen("channels"), &text));
  add_symmetry(&l->symmetry, &text);
  return print_row("symmetry", strlen("symmetry"), &text);
}

static json_t *layout_json(const struct dea_layout *l)
{
  const struct dea_symmetry *s = &l->symmetry;
  json_t *regions = json_object(), *plies = json_array(), *channels = json_array();
  for (size_t i = 0; i < l->region_count; i++) {
    json_object_set_new(regions, l->regions[i].name,
                        json_real(dea_region_area_m2(&l->regions[i].region)));
  }
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_layout_ply *ply = &l->plies[i];
    json_array_append_new(plies, json_pack("{s:s, s:s, s:s, s:f, s:I, s:b}", "name", ply->name,
                                           "shape", l->regions[ply->region].name, "material",
                                           ply->material.name, "thickness_m", ply->thickness_m,
                                           "layers", (json_int_t)dea_ply_layers(ply), "dielectric",
                                           dea_layout_is_dielectric(l, i)));
  }
  for (size_t i = 1; i < l->channel_count; i++) {
    const struct dea_layout_channel *c = &l->channels[i];
    json_array_append_new(channels, json_pack("{s:s, s:f, s:f}", "name", c->name, "ratio", c->ratio,
                                              "own_V", c->own_V));
  }
  return json_pack("{s:o, s:o, s:o, s:{s:[ff], s:I, s:I, s:f}}", "area_m2", regions, "plies", plies,
                   "channels", channels, "symmetry", "centre_m", s->centre_m[0], s->centre_m[1],
                   "order", (json_int_t)s->order, "mirrors", (json_int_t)s->mirrors, "mirror_rad",
                   s->mirrors > 0 ? s->mirror_rad : 0.0);
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
      DEA_TRY(ctx, print_row(name, length, &row));
      name = value->path;
      length = part;
    }
    add_given(&row, value, part);
  }
  return print_row(name, length, &row);
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
  return print_layout(ctx, device->layout);
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
    json_t *derived = layout_json(device->layout);
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
  status = status == DEA_OK ? dea_text_write_path(cli->ctx, &out, file) : status;
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

static dea_status run(struct dea_cli *cli, void *user)
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
  }
  dea_device_destroy(cli->ctx, device);
  dea_design_destroy(cli->ctx, design);
  return status;
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

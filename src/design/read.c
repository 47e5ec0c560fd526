#include "base/file.h"
#include "base/file_kind.h"
#include "design/design_schema.h"
#include "design/design_sections.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* A design file's text with what the command line overrides. */
struct source {
  const struct dea_design_sections *sections;
  const char *name, *bytes;
  size_t length;
  const struct dea_override *overrides; // [override_count]
  size_t override_count;
};

/* The voltages from `from` to `to`: their number, 0 after an error, and the last one. */
static dea_status find_sweep(struct dea_context *ctx, const struct dea_design_raw *raw,
                             size_t *count, double *end)
{
  const double from = raw->from_V.si, to = raw->to_V.si, step = raw->step_V.si;
  const double whole = fabs(to - from), steps = floor(whole / step * (1 + 1e-12) + 1e-9);
  *count = 0;
  *end = to;
  if (isnan(from) || isnan(to) || isnan(step)) {
    return DEA_OK; // already an error
  }
  if (!(steps < DEA_DESIGN_VOLTAGES_MAX)) {
    return dea_finding_add(ctx, DEA_ERROR, raw->step_V.location,
                           "step: from %g V to %g V in steps of %g V are more than %d voltages",
                           from, to, step, DEA_DESIGN_VOLTAGES_MAX);
  }
  *count = (size_t)steps + 1;
  if (fabs(step * steps - whole) <= 1e-6 * step) {
    return DEA_OK;
  }
  *end = from + copysign(step * steps, to - from);
  return dea_finding_add(ctx, DEA_WARNING, raw->step_V.location,
                         "step: steps of %g V from %g V do not meet %g V; the last voltage "
                         "is %g V",
                         step, from, to, *end);
}

/* Those that are listed or of the sweep; and the same way back, without the last one twice. */
static dea_status read_voltages(struct dea_context *ctx, struct dea_design_raw *raw)
{
  struct dea_design *design = &raw->design;
  const bool listed = raw->voltage_count > 0;
  const double from = raw->from_V.si;
  size_t count = raw->voltage_count;
  double end = NAN;
  design->compute.voltages_place = listed ? raw->voltages_V[0].location : raw->to_V.location;
  DEA_TRY(ctx, listed ? DEA_OK : find_sweep(ctx, raw, &count, &end));
  if (count == 0) {
    return DEA_OK;
  }
  const size_t all = raw->back.value == 1 ? 2 * count - 1 : count;
  double *voltages_V = dea_alloc(ctx, all, sizeof *voltages_V);
  DEA_TRY_MEMORY(voltages_V != NULL);
  for (size_t i = 0; i < all; i++) {
    const size_t k = i < count ? i : 2 * count - 2 - i;
    voltages_V[i] = listed      ? raw->voltages_V[k].si
                    : count > 1 ? from + (end - from) * (double)k / (double)(count - 1)
                                : from;
  }
  design->compute.voltages_V = voltages_V;
  design->compute.voltage_count = all;
  return DEA_OK;
}

double dea_design_highest_V(const struct dea_design *design)
{
  double highest_V = 0;
  for (size_t i = 0; i < design->compute.voltage_count; i++) {
    highest_V = fmax(highest_V, design->compute.voltages_V[i]);
  }
  return highest_V;
}

/* The end of the path: by default 1.5 times the pre-stretch, which is past pull-in of usual films,
 * and what the sweep reaches (study/path.c). */
static dea_status read_path(struct dea_context *ctx, struct dea_design *design)
{
  struct dea_quantity *end = &design->compute.path_max_stretch;
  double pre_stretch = design->pre_stretch.si;
  if (end->origin == DEA_ABSENT) {
    end->si = design->parts != NULL ? INFINITY : 1.5 * pre_stretch; // plies differ in theirs
    end->origin = DEA_DEFAULT;
    return DEA_OK;
  }
  if (end->si <= pre_stretch) {
    return dea_finding_add(ctx, DEA_ERROR, end->location,
                           "max_stretch %g is the total stretch and must be above the pre-stretch "
                           "%g",
                           end->si, pre_stretch);
  }
  return DEA_OK;
}

static dea_status read_drive(const struct dea_reader *reader, struct dea_design *design)
{
  struct dea_context *ctx = reader->ctx;
  if (design->drive.section != NULL) {
    DEA_TRY(ctx, dea_waveform_read(reader, design->drive.section, "drive.waveform", design->file,
                                   &design->drive.waveform));
  }
  return DEA_OK;
}

/* Sections of studies, whose checks may look at the whole design. */
static dea_status read_sections(struct dea_context *ctx, const struct dea_design_sections *sections,
                                struct dea_design *design)
{
  design->compute.settings_count = sections->count;
  for (size_t i = 0; i < sections->count; i++) {
    design->compute.settings[i].section = sections->items[i];
  }
  for (size_t i = 0; i < sections->count; i++) {
    const struct dea_settings *settings = &design->compute.settings[i];
    if (settings->section->check != NULL && settings->values != NULL) {
      DEA_TRY(ctx, settings->section->check(ctx, design, settings));
    }
  }
  return DEA_OK;
}

static dea_status check_models(struct dea_context *ctx, const struct dea_design *design)
{
  for (size_t i = 1; i < design->compute.model_count; i++) {
    const struct dea_label *model = &design->compute.models[i];
    for (size_t j = 0; j < i; j++) {
      if (strcmp(model->text, design->compute.models[j].text) == 0 && model->text[0] != '\0') {
        DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, model->location,
                                     "the model '%.60s' stands twice in the list", model->text));
        break;
      }
    }
  }
  return DEA_OK;
}

/* Names of models that there are not, beside the other errors of the file. Where it has none, who
 * runs the design decides by which models. */
static dea_status name_models(struct dea_context *ctx, const struct dea_design_sections *sections,
                              const struct dea_design *design)
{
  for (size_t i = 0; sections->check_model != NULL && i < design->compute.model_count; i++) {
    if (design->compute.models[i].text[0] != '\0') {
      DEA_TRY(ctx, sections->check_model(ctx, &design->compute.models[i]));
    }
  }
  return DEA_OK;
}

static void set_figures(struct dea_design_raw *raw)
{
  for (size_t i = 0; i < raw->figure_count; i++) {
    raw->design.report.svg |= raw->figures[i].value == DEA_FIGURE_SVG;
    raw->design.report.pdf |= raw->figures[i].value == DEA_FIGURE_PDF;
    raw->design.report.png |= raw->figures[i].value == DEA_FIGURE_PNG;
  }
}

/* Voltages at which fields are wanted must be among those of the sweep. */
static dea_status read_fields(struct dea_context *ctx, struct dea_design_raw *raw)
{
  struct dea_design *design = &raw->design;
  for (size_t i = 0; i < raw->fields_at_count; i++) {
    double wanted = raw->fields_at_V[i].si;
    bool found = isnan(wanted); // already an error
    for (size_t k = 0; k < design->compute.voltage_count && !found; k++) {
      found = fabs(design->compute.voltages_V[k] - wanted) <= 1e-9 * (1 + fabs(wanted));
    }
    if (!found) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, raw->fields_at_V[i].location,
                                   "fields_at: %g V is not a voltage of the sweep "
                                   "(compute.voltage)",
                                   wanted));
    }
    design->report.fields_at_V[design->report.fields_at_count++] = wanted;
  }
  return DEA_OK;
}

static dea_status read_materials(const struct dea_reader *reader, struct dea_design *design)
{
  struct dea_context *ctx = reader->ctx;
  for (size_t i = 0; i < design->material_count; i++) {
    char path[32];
    snprintf(path, sizeof path, "materials[%zu]", i);
    DEA_TRY(ctx, dea_material_data_finish(reader, path, &design->materials[i]));
  }
  return dea_check_names(ctx, "material", design->materials, design->material_count,
                         sizeof *design->materials, offsetof(struct dea_material_data, name));
}

/* The document of a source with all that changes it. */
static dea_status parse(struct dea_context *ctx, const struct source *source,
                        const struct dea_node *changes, struct dea_yaml **out)
{
  DEA_TRY(ctx, dea_yaml_parse(ctx, source->name, source->bytes, source->length, out));
  for (size_t i = 0; i < source->override_count; i++) {
    dea_status status =
        dea_yaml_override(ctx, *out, source->overrides[i].key, source->overrides[i].value);
    if (status != DEA_OK && status != DEA_E_DESIGN) {
      return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
    }
  }
  if (changes == NULL) {
    return DEA_OK;
  }
  dea_status status = dea_yaml_merge(ctx, *out, changes);
  if (status == DEA_E_DESIGN) { // a finding that is counted with the others
    status = DEA_OK;
  }
  return DEA_CHAIN(ctx, status);
}

/* Fills *raw from text; all of its owned members are in raw->design, also after a failure. */
static dea_status read_raw(struct dea_context *ctx, const struct source *source,
                           const struct dea_node *changes, struct dea_design_raw *raw)
{
  struct dea_design *design = &raw->design;
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  design->file = dea_intern(ctx, source->name);
  DEA_TRY_MEMORY(design->file != NULL);
  DEA_TRY(ctx, parse(ctx, source, changes, &design->document));
  struct dea_reader reader = {ctx, design->document, &design->values};
  DEA_TRY(ctx, dea_file_kind_check(ctx, design->document, "dea"));
  DEA_TRY(ctx, dea_material_lines_expand(ctx, design->document));
  struct dea_design_schema schema;
  dea_design_schema_fill(source->sections, &schema);
  const struct dea_node *root = dea_yaml_root(design->document);
  const struct dea_node *plies = dea_node_find(root, "plies");
  DEA_TRY(ctx,
          dea_schema_read(&reader, plies != NULL ? &schema.general.record : &schema.disc.record,
                          root, "", raw));
  if (plies != NULL) {
    design->parts = dea_alloc(ctx, 1, sizeof *design->parts);
    DEA_TRY_MEMORY(design->parts != NULL);
    *design->parts = raw->parts;
    raw->parts = (struct dea_parts){0};
    design->parts->place = plies->key_place;
    DEA_TRY(ctx, dea_parts_read(&reader, &schema.shapes, design->file, raw->shapes,
                                raw->shape_count, design->parts));
  }
  if (root->kind == DEA_NODE_SECTION) {
    DEA_TRY(ctx, read_materials(&reader, design));
    DEA_TRY(ctx, read_voltages(ctx, raw));
    DEA_TRY(ctx, read_path(ctx, design));
    DEA_TRY(ctx, check_models(ctx, design));
    DEA_TRY(ctx, read_drive(&reader, design));
    DEA_TRY(ctx, read_sections(ctx, source->sections, design));
    set_figures(raw);
    DEA_TRY(ctx, read_fields(ctx, raw));
  }
  if (dea_finding_count(ctx, DEA_ERROR) > errors) {
    DEA_TRY(ctx, name_models(ctx, source->sections, design));
    size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
    return dea_fail(ctx, DEA_E_DESIGN, "'%s' has %zu error%s", source->name, found,
                    found > 1 ? "s" : "");
  }
  return DEA_OK;
}

/* Frees what a design owns, not the design. */
static void clear_design(struct dea_context *ctx, struct dea_design *design)
{
  for (size_t i = 0; i < design->compute.compare_count; i++) {
    dea_design_destroy(ctx, design->compute.compare[i].design);
  }
  for (size_t i = 0; i < DEA_DESIGN_SECTIONS_MAX; i++) {
    dea_free(ctx, design->compute.settings[i].values);
  }
  dea_waveform_destroy(design->drive.waveform);
  dea_parts_destroy(ctx, design->parts);
  dea_free(ctx, design->compute.voltages_V);
  dea_free(ctx, design->materials);
  dea_listing_free(ctx, &design->values);
  dea_yaml_destroy(ctx, design->document);
}

/* Reads a design with the values of a section in the place of its own (keys may be dotted; NULL: no
 * changes). The designs that it compares itself with are not read. changes: outlives the design. */
static dea_status read_source(struct dea_context *ctx, const struct source *source,
                              const struct dea_node *changes, struct dea_design **out)
{
  *out = NULL;
  struct dea_design_raw *raw = dea_alloc(ctx, 1, sizeof *raw);
  DEA_TRY_MEMORY(raw != NULL);
  dea_status status = read_raw(ctx, source, changes, raw);
  if (status == DEA_OK) {
    *out = dea_alloc(ctx, 1, sizeof **out);
    status = *out != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  if (status == DEA_OK) {
    **out = raw->design;
  } else {
    clear_design(ctx, &raw->design);
    dea_parts_clear(ctx, &raw->parts);
  }
  dea_free(ctx, raw);
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

// Designs beside it -------------------------------------------------------------------------------

/* Place of what is wrong with a variant. The command line has none of its own (a line counts from
 * 1): there it is the design file that was named. */
static struct dea_location place_of(struct dea_context *ctx,
                                    const struct dea_design_variant *variant,
                                    const struct dea_location *own)
{
  const char *file = own->line == 0 && variant->file.origin != DEA_ABSENT
                         ? dea_intern(ctx, variant->file.text)
                         : NULL;
  return file != NULL ? (struct dea_location){file, 0, 0} : *own;
}

/* Another design, which compares itself with none. */
static dea_status read_other(struct dea_context *ctx, const struct source *source,
                             struct dea_design_variant *variant)
{
  DEA_TRY(ctx, read_source(ctx, source, variant->set, &variant->design));
  variant->design->compute.compare_count = 0;
  return DEA_OK;
}

static dea_status read_other_file(struct dea_context *ctx, const struct source *source,
                                  struct dea_design_variant *variant)
{
  char *bytes = NULL, *path = dea_path_beside(ctx, source->name, variant->file.text);
  struct source other = *source;
  DEA_TRY_MEMORY(path != NULL);
  dea_status status = dea_file_read(ctx, path, DEA_YAML_SIZE_MAX, &bytes, &other.length);
  if (status == DEA_E_IO) {
    const bool in_file = variant->file.location.line > 0; // else said as of a first file
    status = dea_finding_add(ctx, DEA_ERROR,
                             in_file ? variant->file.location : (struct dea_location){"", 0, 0},
                             "%s", dea_context_message(ctx));
    status = status == DEA_OK ? DEA_E_DESIGN : status;
  } else if (status == DEA_OK) {
    other.name = path;
    other.bytes = bytes;
    status = read_other(ctx, &other, variant);
  }
  dea_free(ctx, bytes);
  dea_free(ctx, path);
  return status;
}

static dea_status check_name(struct dea_context *ctx, const struct dea_design *design, size_t i)
{
  const struct dea_label *name = &design->compute.compare[i].name;
  const struct dea_location place = place_of(ctx, &design->compute.compare[i], &name->location);
  if (strlen(name->text) >= DEA_NAME_SIZE || strchr(name->text, '/') != NULL) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, place, "name: at most %d characters, and no '/'",
                                 DEA_NAME_SIZE - 1));
  }
  for (size_t k = 0; k < i && name->text[0] != '\0'; k++) {
    if (strcmp(design->compute.compare[k].name.text, name->text) == 0) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, place,
                                   "the name '%.60s' stands twice among the designs", name->text));
    }
  }
  return DEA_OK;
}

/* Reads the designs that a design compares itself with. DEA_E_DESIGN after all were tried. */
static dea_status read_variants(struct dea_context *ctx, const struct source *source,
                                struct dea_design *design)
{
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  for (size_t i = 0; i < design->compute.compare_count; i++) {
    struct dea_design_variant *variant = &design->compute.compare[i];
    DEA_TRY(ctx, check_name(ctx, design, i));
    dea_status status = DEA_OK;
    if (variant->file.origin != DEA_ABSENT) {
      status = read_other_file(ctx, source, variant);
    } else if (variant->set != NULL) {
      status = read_other(ctx, source, variant);
    }
    if (status != DEA_OK && status != DEA_E_DESIGN) {
      return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
    }
  }
  size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  if (found > 0) {
    return dea_fail(ctx, DEA_E_DESIGN, "the designs that '%s' compares have %zu error%s",
                    source->name, found, found > 1 ? "s" : "");
  }
  return DEA_OK;
}

// All ---------------------------------------------------------------------------------------------

dea_status dea_design_read_memory_with(struct dea_context *ctx,
                                       const struct dea_design_sections *sections, const char *name,
                                       const char *bytes, size_t length,
                                       const struct dea_override *overrides, size_t override_count,
                                       struct dea_design **out)
{
  const struct source source = {sections, name, bytes, length, overrides, override_count};
  struct dea_design *design;
  *out = NULL;
  DEA_TRY(ctx, read_source(ctx, &source, NULL, &design));
  DEA_TRY_ELSE(ctx, read_variants(ctx, &source, design), dea_design_destroy(ctx, design));
  *out = design;
  return DEA_OK;
}

dea_status dea_design_read_with(struct dea_context *ctx, const struct dea_design_sections *sections,
                                const char *file, const struct dea_override *overrides,
                                size_t override_count, struct dea_design **out)
{
  char *bytes;
  size_t length;
  *out = NULL;
  DEA_TRY(ctx, dea_file_read(ctx, file, DEA_YAML_SIZE_MAX, &bytes, &length));
  dea_status status = dea_design_read_memory_with(ctx, sections, file, bytes, length, overrides,
                                                  override_count, out);
  dea_free(ctx, bytes);
  return status;
}

const struct dea_settings *dea_design_settings(const struct dea_design *design,
                                               const struct dea_design_section *section)
{
  for (size_t i = 0; design != NULL && i < design->compute.settings_count; i++) {
    if (design->compute.settings[i].section == section) {
      return &design->compute.settings[i];
    }
  }
  return NULL;
}

void dea_design_destroy(struct dea_context *ctx, struct dea_design *design)
{
  if (design != NULL) {
    clear_design(ctx, design);
    dea_free(ctx, design);
  }
}

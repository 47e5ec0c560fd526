/* The design: drawing, every value with its place, materials with their sources. */
#include "figures/device_drawing.h"
#include "report/section.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *origin_of(const struct dea_listed *value, char *text, size_t size)
{
  switch (value->origin) {
  case DEA_GIVEN:
    snprintf(text, size, "line %zu", value->location.line);
    return text;
  case DEA_OVERRIDE:
    return "--set";
  case DEA_DEFAULT:
    return "default";
  default:
    return "not given";
  }
}

static void add_values(struct dea_report *report, const struct dea_report_run *run)
{
  const struct dea_listing *values = &run->design->values;
  struct dea_text *out = &report->text;
  dea_table_begin(report, "Every value of the design and where it comes from");
  dea_table_head(report, "Key|Value|From");
  for (size_t i = 0; i < values->count; i++) {
    const struct dea_listed *value = &values->items[i];
    char origin[40];
    dea_html_add(out,
                 "<tr class=\"%s\"><th scope=\"row\" class=\"code\">%s</th><td>%s</td><td>%s</td>"
                 "</tr>",
                 value->origin == DEA_GIVEN || value->origin == DEA_OVERRIDE ? "" : "faint",
                 value->path, value->text, origin_of(value, origin, sizeof origin));
  }
  dea_table_end(report);
}

dea_status dea_section_design(struct dea_report *report, const struct dea_report_run *run)
{
  dea_section_begin(report, "design", run->number, "Design");
  if (run->device == NULL) {
    dea_html_add(&report->text,
                 "<p class=\"note\">The design cannot be built again, so that there is no drawing: "
                 "%s.</p>",
                 run->missing);
    dea_section_end(report);
    return DEA_OK;
  }
  const struct dea_device_drawing drawing = {.layout = run->device->layout};
  dea_text_add(&report->text, "<figure class=\"layout\">");
  DEA_TRY(report->ctx, dea_device_drawing_add_svg(&drawing, run->number, &report->text));
  dea_text_add(&report->text,
               "<figcaption>From above and cut, to scale but for the thickness, as it "
               "is stretched when parts are bonded to it</figcaption></figure>");
  dea_text_add(&report->text, "<details><summary>All values</summary>");
  add_values(report, run);
  dea_text_add(&report->text, "</details>");
  dea_section_end(report);
  return DEA_OK;
}

static void add_notes(struct dea_text *out, const struct dea_data_notes *notes)
{
  dea_html_add(out, "<td>%s</td><td>%s</td><td>%s", notes->uncertainty, notes->range,
               notes->source != NULL ? notes->source : "no source");
  if (notes->note != NULL) {
    dea_html_add(out, "<br><small>%s</small>", notes->note);
  }
  dea_text_add(out, "</td></tr>");
}

/* Row up to its notes: what, value with unit. */
static void add_row(struct dea_text *out, const char *what, double value, const char *unit)
{
  const bool none = strcmp(unit, "1") == 0;
  dea_html_add(out, "<tr><th scope=\"row\">%s</th><td class=\"n\">%.6G%s%s</td>", what, value,
               none ? "" : " ", none ? "" : unit);
}

/* A pressure in the unit that people read. */
static void add_pressure(struct dea_text *out, const char *what, double Pa)
{
  bool mega = fabs(Pa) >= 1e6;
  add_row(out, what, Pa * (mega ? 1e-6 : 1e-3), mega ? "MPa" : "kPa");
}

static void add_law(struct dea_text *out, const struct dea_law_set *set)
{
  for (size_t i = 0; set->law != NULL && i < set->law->param_count; i++) {
    char what[128];
    const struct dea_law_param *param = &set->law->params[i];
    snprintf(what, sizeof what, "%s: %s", set->law->name, param->key);
    if (isnan(set->param[i].si)) {
      continue;
    }
    if (strcmp(param->unit, "Pa") == 0) {
      add_pressure(out, what, set->param[i].si);
    } else {
      add_row(out, what, set->param[i].si, param->unit);
    }
    add_notes(out, &set->head.notes);
  }
}

/* A row a branch: its share of the shear modulus, or its modulus, and how long it lasts. */
static void add_viscosity(struct dea_text *out, const struct dea_viscosity_set *set)
{
  for (size_t i = 0; i < set->branch_count; i++) {
    const struct dea_branch_data *branch = &set->branches[i];
    bool share = !isnan(branch->ratio.si);
    dea_html_add(out,
                 "<tr><th scope=\"row\">viscosity%s: branch %zu</th><td class=\"n\">%.6G %s, %.6G s"
                 "</td>",
                 set->assumed.value == 1 ? " (assumed)" : "", i + 1,
                 share ? 100.0 * branch->ratio.si : 1e-3 * branch->modulus_Pa.si,
                 share ? "% of the shear modulus" : "kPa", branch->time_s.si);
    add_notes(out, &set->head.notes);
  }
}

/* What was measured, and what follows for a film of this thickness under these electrodes. */
static void add_breakdown(struct dea_text *out, const struct dea_breakdown_set *set,
                          const struct dea_breakdown *used)
{
  static const char unit[] = "V/\302\265m";
  char what[128] = "breakdown field";
  if (set->values.count == 2) {
    snprintf(what, sizeof what, "breakdown field, by source %.4g to %.4g",
             1e-6 * set->values.limits[0].si, 1e-6 * set->values.limits[1].si);
  }
  add_row(out, what, 1e-6 * set->at_rest_V_per_m.si, unit);
  add_notes(out, &set->head.notes);
  if (used->at_rest_V_per_m != set->at_rest_V_per_m.si || used->exponent != used->law.exponent) {
    snprintf(what, sizeof what, "of this film; grows with the stretch to the power %.3g",
             used->exponent);
    add_row(out, what, 1e-6 * used->at_rest_V_per_m, unit);
    dea_text_add(out, "<td></td><td></td><td>by thickness, electrodes and area, from the row "
                      "above</td></tr>");
  }
}

/* Index of the set that a value of the material is of; the first of several alike. */
#define FIND_SET(sets, count, is_it, found)                                                        \
  size_t found = 0;                                                                                \
  for (size_t i = (count); i-- > 0;) {                                                             \
    found = (is_it) ? i : found;                                                                   \
  }

static void add_material(struct dea_report *report, const struct dea_material_data *data,
                         const struct dea_material *used, const char *part)
{
  struct dea_text *out = &report->text;
  char caption[2 * DEA_TITLE_SIZE];
  snprintf(caption, sizeof caption, "%s: %s%s%s%s", part, used->name,
           data->title.text[0] != '\0' ? " (" : "", data->title.text,
           data->title.text[0] != '\0' ? ")" : "");
  dea_table_begin(report, caption);
  dea_table_head(report, "Property|#Value|Uncertainty|Range|Source");
  if (used->law != NULL) {
    FIND_SET(data->laws, data->law_count, strcmp(data->laws[i].head.id.text, used->law_id) == 0,
             law)
    add_law(out, &data->laws[law]);
  }
  if (data->permittivity_count > 0) {
    FIND_SET(data->permittivity, data->permittivity_count,
             data->permittivity[i].at_rest.si == used->permittivity.at_rest, set)
    add_row(out, "relative permittivity", data->permittivity[set].at_rest.si, "1");
    add_notes(out, &data->permittivity[set].head.notes);
  }
  if (data->breakdown_count > 0) {
    FIND_SET(data->breakdown, data->breakdown_count,
             data->breakdown[i].at_rest_V_per_m.si == used->breakdown.law.at_rest_V_per_m, set)
    add_breakdown(out, &data->breakdown[set], &used->breakdown);
  }
  if (used->viscosity_id[0] != '\0' && data->viscosity_count > 0) { // "" for none
    FIND_SET(data->viscosity, data->viscosity_count,
             strcmp(data->viscosity[i].head.id.text, used->viscosity_id) == 0, set)
    add_viscosity(out, &data->viscosity[set]);
  }
  if (data->has_elastic) {
    add_pressure(out, "Young's modulus", data->elastic.young_modulus_Pa.si);
    add_notes(out, &data->elastic.notes);
    add_row(out, "Poisson's ratio", data->elastic.poisson_ratio.si, "1");
    add_notes(out, &data->elastic.notes);
  }
  if (data->has_density) {
    add_row(out, "density", data->density.value_kg_per_m3.si, "kg/m\302\263");
    add_notes(out, &data->density.notes);
  }
  dea_table_end(report);
}

/* The data of a material: the design's own, else the catalogue's (*entry is the caller's). */
static const struct dea_material_data *find_data(struct dea_context *ctx,
                                                 const struct dea_design *design, const char *name,
                                                 struct dea_catalogue_entry **entry)
{
  *entry = NULL;
  for (size_t i = 0; i < design->material_count; i++) {
    if (strcmp(design->materials[i].name.text, name) == 0) {
      return &design->materials[i];
    }
  }
  if (dea_catalogue_read(ctx, name, (struct dea_location){0}, entry) != DEA_OK) {
    dea_context_clear(ctx); // the device was built with it, so this is rare
    return NULL;
  }
  return &(*entry)->data;
}

static void add_part(struct dea_report *report, const struct dea_design *design,
                     const struct dea_material *used, const char *name)
{
  struct dea_catalogue_entry *entry = NULL;
  const struct dea_material_data *data =
      used->name[0] != '\0' ? find_data(report->ctx, design, used->name, &entry) : NULL;
  if (data != NULL) {
    add_material(report, data, used, name);
  }
  dea_catalogue_destroy(report->ctx, entry);
}

/* Materials of plies, each once, and of electrodes that are no plies. */
dea_status dea_section_materials(struct dea_report *report, const struct dea_report_run *run)
{
  if (run->device == NULL) {
    return DEA_OK;
  }
  const struct dea_layout *l = run->device->layout;
  dea_section_begin(report, "materials", run->number, "Materials and their sources");
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_material *used = &l->plies[i].material;
    size_t first = 0;
    while (strcmp(l->plies[first].material.name, used->name) != 0) {
      first++;
    }
    if (first == i) {
      add_part(report, run->design, used, l->plies[i].name);
    }
  }
  if (!(run->device->electrode_thickness_m > 0)) {
    add_part(report, run->design, &run->device->electrode, "electrodes");
  }
  dea_section_end(report);
  return DEA_OK;
}

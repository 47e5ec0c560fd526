/* The explorer's numbers: the device as it was built, what may be chosen, and the C core as
 * WebAssembly (web/explorer.c). */
#include "base/assets.h"
#include "report/section.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void add_number(struct dea_text *out, const char *key, double value)
{
  dea_text_add(out, "\"%s\":", key);
  dea_html_json_number(out, value, 17);
  dea_text_add(out, ",");
}

static void add_word(struct dea_text *out, const char *key, const char *text)
{
  dea_text_add(out, "\"%s\":\"", key);
  dea_html_json_text(out, text);
  dea_text_add(out, "\",");
}

/* A material as the core takes it. */
static void add_material(struct dea_text *out, const struct dea_material *m, const char *label)
{
  dea_text_add(out, "{");
  add_word(out, "label", label);
  add_word(out, "law", m->law->name);
  add_number(out, "permittivity", m->permittivity.at_rest);
  add_number(out, "permittivity_slope", m->permittivity.slope);
  const struct dea_breakdown_law *law = &m->breakdown.law;
  bool known = m->breakdown.known;
  add_number(out, "breakdown_V_per_m", known ? law->electrode_factor * law->at_rest_V_per_m : 0);
  add_number(out, "breakdown_exponent", law->exponent);
  add_number(out, "breakdown_thickness_exponent", law->thickness_exponent);
  add_number(out, "breakdown_thickness_m", law->thickness_m);
  add_number(out, "breakdown_shape", law->shape);
  add_number(out, "breakdown_area_m2", law->area_m2);
  add_number(out, "fibre_angle_rad", m->fibre_angle_rad);
  dea_text_add(out, "\"param\":[");
  for (int i = 0; i < DEA_LAW_PARAM_MAX; i++) {
    dea_text_add(out, "%s", i > 0 ? "," : "");
    dea_html_json_number(out, m->param[i], 17);
  }
  dea_text_add(out, "]}");
}

static void add_parameter_set(struct dea_context *ctx, struct dea_text *out,
                              const struct dea_material_data *data, const char *law)
{
  const struct dea_material_choice choice = {.law = law};
  struct dea_material material;
  char label[2 * DEA_TITLE_SIZE + 8];
  if (dea_material_select(ctx, data, &choice, &material) != DEA_OK) {
    dea_context_clear(ctx); // what cannot be used is not offered
    return;
  }
  if (material.law == NULL || !(material.permittivity.at_rest > 0) || material.law->anisotropic) {
    return;
  }
  snprintf(label, sizeof label, "%s%s%s", material.name, law[0] != '\0' ? ", " : "", law);
  dea_text_add(out, ",");
  add_material(out, &material, label);
}

/* The run's film, then every elastomer of the catalogue with each of its laws. */
static dea_status add_materials(struct dea_context *ctx, struct dea_text *out,
                                const struct dea_device *device)
{
  const char **names;
  size_t count;
  char label[2 * DEA_NAME_SIZE + 24];
  snprintf(label, sizeof label, "%s, %s (this run)", device->film.name, device->film.law->name);
  dea_text_add(out, "\"materials\":[");
  add_material(out, &device->film, label);
  DEA_TRY(ctx, dea_catalogue_names(ctx, &names, &count));
  for (size_t i = 0; i < count; i++) {
    struct dea_catalogue_entry *entry;
    if (dea_catalogue_read(ctx, names[i], (struct dea_location){0}, &entry) != DEA_OK) {
      dea_context_clear(ctx);
      continue;
    }
    for (size_t k = 0; k < entry->data.law_count; k++) {
      add_parameter_set(ctx, out, &entry->data, entry->data.laws[k].id.text);
    }
    dea_catalogue_destroy(ctx, entry);
  }
  dea_free(ctx, names);
  dea_finding_clear(ctx);
  dea_text_add(out, "],");
  return DEA_OK;
}

/* A length with the film state that it is given in: it moves with the pre-stretch or not. */
static void add_length(struct dea_text *out, const char *key,
                       const struct dea_inplane_length *length)
{
  dea_text_add(out, "\"%s\":{\"unstretched\":%s,\"m\":", key,
               length->state == DEA_UNSTRETCHED ? "true" : "false");
  dea_html_json_number(out, length->length.si, 17);
  dea_text_add(out, "},");
}

static void add_device(struct dea_text *out, const struct dea_design *design,
                       const struct dea_device *device)
{
  add_number(out, "thickness_m", device->film_thickness_unstretched_m);
  add_number(out, "pre_stretch", device->pre_stretch);
  add_number(out, "frame_radius_m", device->frame_radius_m);
  add_length(out, "electrode_radius", &design->electrodes.radius);
  add_number(out, "electrode_thickness_m", device->electrode_thickness_m);
  add_number(out, "fibres", device->fibre_count);
  if (device->fibre_count > 0) {
    bool by_length = design->fibres.length.length.origin != DEA_ABSENT;
    bool by_radius = !by_length && design->fibres.tip_radius.length.origin != DEA_ABSENT;
    add_word(out, "tip_by", by_length ? "length" : by_radius ? "radius" : "overlap");
    add_length(out, "tip",
               by_length   ? &design->fibres.length
               : by_radius ? &design->fibres.tip_radius
                           : &design->fibres.overlap);
  }
  bool given = design->compute.coverage.origin != DEA_ABSENT;
  add_word(out, "coverage_by",
           given                                                    ? "value"
           : design->compute.coverage_by.value == DEA_COVERAGE_AREA ? "area"
                                                                    : "radius");
  add_number(out, "coverage", device->coverage);
  if (device->electrode.law != NULL) {
    dea_text_add(out, "\"electrode_material\":");
    add_material(out, &device->electrode, device->electrode.name);
    dea_text_add(out, ",");
  }
}

dea_status dea_section_explorer(struct dea_report *report, const struct dea_report_run *run)
{
  struct dea_text *out = &report->text;
  if (run->device == NULL || run->device->film.law == NULL ||
      !(run->device->film.permittivity.at_rest > 0)) {
    return DEA_OK;
  }
  dea_section_begin(report, "explorer", run->number, "Explorer");
  if (dea_asset_core_length == 0) {
    dea_text_add(out, "<p class=\"note\">This program was built without a compiler for "
                      "WebAssembly, so that nothing can be computed in the page.</p>");
    dea_section_end(report);
    return DEA_OK;
  }
  double last_V = 1;
  for (size_t i = 0; i < run->design->compute.voltage_count; i++) {
    last_V = fmax(last_V, run->design->compute.voltages_V[i]);
  }
  dea_text_add(out, "<p class=\"still\">With scripts, the models lumped and axisymmetric are "
                    "computed here for other designs.</p><div class=\"explorer interactive\" "
                    "hidden></div><script type=\"application/json\" class=\"device\">{");
  dea_status status = add_materials(report->ctx, out, run->device);
  add_device(out, run->design, run->device);
  dea_text_add(out, "\"voltage_V\":%.17g}</script>", last_V);
  dea_section_end(report);
  return status;
}

void dea_explorer_add_core(struct dea_report *report)
{
  if (dea_asset_core_length > 0) {
    dea_text_add(&report->text, "<script type=\"text/plain\" id=\"core\">");
    dea_html_base64(&report->text, dea_asset_core, dea_asset_core_length);
    dea_text_add(&report->text, "</script>\n");
  }
}

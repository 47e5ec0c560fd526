/* The design of a device as it was fitted, as a file that every command takes. */
#include "job/device_evaluation.h"

#include "base/file.h"
#include "base/units.h"
#include "base/version.h"
#include "base/write_file.h"
#include "base/yaml_write.h"
#include "study/numbers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Adds a comment of one line; sources and titles may hold anything. */
static void add_comment(struct dea_text *out, const char *text)
{
  dea_text_add(out, "# ");
  for (const char *c = text; *c != '\0'; c++) {
    dea_text_add(out, "%c", (unsigned char)*c < 0x20 ? ' ' : *c);
  }
  dea_text_add(out, "\n");
}

static void add_head(struct dea_text *out, const struct dea_device_fit *fit)
{
  const struct dea_device_file *file = fit->file;
  dea_text_add(out, "# Written by dea %s fit: %s as it was built, by its measured curves.\n",
               DEA_VERSION, dea_path_name(fit->design_file));
  if (file->head.source.text[0] != '\0') {
    add_comment(out, file->head.source.text);
  }
  dea_text_add(out, "# Fit file %s (SHA-256 %s), design %s (%s), model %s\n",
               dea_path_name(file->head.file), file->head.sha256, dea_path_name(fit->design_file),
               fit->design_sha256, fit->model);
  for (size_t c = 0; c < fit->curve_count; c++) {
    if (fit->curves[c].text->use.value == DEA_FIT_USED) {
      dea_text_add(out, "# %s of %s (%s)\n", fit->curves[c].quantity->key,
                   dea_path_name(fit->curves[c].file), fit->curves[c].sha256);
    }
  }
  for (size_t j = 0; j < fit->param_count; j++) {
    const struct dea_device_param *param = &fit->params[j];
    const struct dea_fit_value *value = &fit->core.values[j];
    const char *unit = strcmp(param->param.unit, "1") == 0 ? "" : param->param.unit;
    dea_text_add(out, "#   %s = %.6g", param->param.name, value->value);
    if (value->fixed || value->at_bound || isinf(value->std)) {
      dea_text_add(out, " %s%s (%s)\n", unit, param->state,
                   value->fixed      ? "fixed"
                   : value->at_bound ? "at its bound"
                                     : "not determined");
    } else {
      dea_text_add(out, " +- %.2g%s%s%s\n", value->std, unit[0] != '\0' ? " " : "", unit,
                   param->state);
    }
  }
}

/* Ends a section with its source, in lines of their own. */
static void add_source(struct dea_text *out, const char *indent,
                       const struct dea_material *material)
{
  dea_text_add(out, "%ssource: \"this file; what it did not change is that of %s\"\n", indent,
               material->name);
}

static void add_rest(struct dea_text *out, const struct dea_material *material)
{
  if (material->density_kg_per_m3 > 0) {
    dea_text_add(out, "    density:\n      value: %.10g kg/m^3\n", material->density_kg_per_m3);
    add_source(out, "      ", material);
  }
  if (material->breakdown.known) {
    dea_text_add(out, "    breakdown:\n      - id: fit\n        at_rest: %.10g V/m\n",
                 material->breakdown.at_rest_V_per_m);
    if (material->breakdown.exponent_known) {
      dea_text_add(out, "        exponent: %.10g\n", material->breakdown.exponent);
    }
    add_source(out, "        ", material);
  }
  if (material->resistivity_ohm_m > 0) {
    dea_text_add(out, "    resistivity:\n      value: %.10g ohm m\n", material->resistivity_ohm_m);
    add_source(out, "      ", material);
  }
  if (material->branch_count > 0) {
    dea_text_add(out, "    viscosity:\n      - id: fit\n        assumed: %s\n        branches:\n",
                 material->viscosity_assumed ? "yes" : "no");
    for (size_t b = 0; b < material->branch_count; b++) {
      dea_text_add(out, "          - {modulus: %.10g Pa, time: %.10g s}\n",
                   material->branches[b].modulus_Pa, material->branches[b].time_s);
    }
    add_source(out, "        ", material);
  }
}

static void add_law(struct dea_text *out, const struct dea_material *material)
{
  const struct dea_law *law = material->law;
  dea_text_add(out, "    laws:\n      - id: fit\n        law: %s\n        parameters: {",
               law->name);
  for (size_t i = 0; i < law->param_count; i++) {
    dea_text_add(out, "%s%s: %.10g%s%s", i > 0 ? ", " : "", law->params[i].key, material->param[i],
                 DEA_UNIT_BEHIND(law->params[i].unit));
  }
  dea_text_add(out, "}\n");
  if (law->anisotropic) {
    dea_text_add(out, "        fibre_angle: %.10g radian\n", material->fibre_angle_rad);
  }
  add_source(out, "        ", material);
}

/* A material that is not the catalogue's. */
struct changed {
  size_t material; // of the device
  char name[DEA_NAME_SIZE];
  struct dea_material with; // what was found
};

/* One of them as an item of `materials`. */
static void add_material(struct dea_text *out, const struct changed *changed)
{
  const struct dea_material *material = &changed->with;
  dea_text_add(out, "  - name: %s\n    kind: %s\n", changed->name,
               material->law != NULL ? "elastomer" : "plastic");
  if (material->law != NULL) {
    add_law(out, material);
  } else {
    dea_text_add(out, "    elastic:\n      young_modulus: %.10g Pa\n      poisson_ratio: %.10g\n",
                 material->young_modulus_Pa, material->poisson_ratio);
    add_source(out, "      ", material);
  }
  if (material->permittivity.at_rest > 0) {
    dea_text_add(out, "    permittivity:\n      - id: fit\n        at_rest: %.10g\n",
                 material->permittivity.at_rest);
    dea_text_add(out, "        slope: %.10g\n", material->permittivity.slope);
    add_source(out, "        ", material);
  }
  add_rest(out, material);
}

/* Adds materials behind "materials:" of the written design, or with that at the end. */
static void add_with_material(struct dea_text *out, const char *design, const char *material)
{
  static const char key[] = "\nmaterials:\n";
  const char *at = strstr(design, key);
  if (at == NULL) {
    dea_text_add(out, "%smaterials:\n%s", design, material);
  } else {
    at += strlen(key);
    dea_text_add(out, "%.*s%s%s", (int)(at - design), design, material, at);
  }
}

static bool is_known(const struct dea_fit_value *value)
{
  return !value->fixed && !value->at_bound && isfinite(value->std) && value->std > 0;
}

/* What study "uncertainty" makes bands of: standard uncertainties and correlations. */
static void add_uncertainty(struct dea_text *out, const struct dea_device_fit *fit)
{
  const size_t n = fit->param_count;
  size_t known = 0;
  for (size_t j = 0; j < n; j++) {
    const struct dea_fit_param *param = &fit->params[j].param;
    if (is_known(&fit->core.values[j])) {
      dea_text_add(out, "%s{name: %s, std: %.6g%s%s}", known++ > 0 ? ", " : "{parameters: [",
                   param->name, fit->core.values[j].std, DEA_UNIT_BEHIND(param->unit));
    }
  }
  if (known > 0) {
    dea_text_add(out, known > 1 ? "], correlations: [" : "]");
  }
  const char *separator = "";
  for (size_t j = 0; j < n; j++) {
    for (size_t k = 0; k < j && is_known(&fit->core.values[j]); k++) {
      if (is_known(&fit->core.values[k])) {
        dea_text_add(out, "%s%.9f", separator, fit->core.statistics.correlation[j * n + k]);
        separator = ", ";
      }
    }
  }
  if (known > 0) {
    dea_text_add(out, known > 1 ? "]}" : "}");
  }
}

/* That of a parameter, as it is so far. */
static struct changed *find_changed(const struct dea_device *device,
                                    const struct dea_device_values *with, size_t material,
                                    struct changed *all, size_t *count)
{
  size_t i = 0;
  while (i < *count && all[i].material != material) {
    i++;
  }
  if (i == *count) {
    char prefix[DEA_MATERIAL_PREFIX_SIZE];
    dea_material_prefix(device, material, prefix);
    const char *dot = strchr(prefix, '.'); // plies.NAME
    const char *part = dot != NULL ? dot + 1 : prefix;
    all[i] = (struct changed){.material = material, .with = *dea_material_of(device, material)};
    if (strlen(part) <= 30) {
      snprintf(all[i].name, sizeof all[i].name, "%.30s-%.30s", with->name, part);
    } else { // others may begin alike
      snprintf(all[i].name, sizeof all[i].name, "%.30s-%.20s-%zu", with->name, part,
               material % 1000);
    }
    (*count)++;
  }
  return &all[i];
}

static dea_status add_key(struct dea_context *ctx, struct dea_yaml *document, const char *prefix,
                          const char *key, const char *value)
{
  char path[DEA_NUMBER_KEY_SIZE];
  snprintf(path, sizeof path, "%.90s.%.20s", prefix, key);
  return dea_yaml_override(ctx, document, path, value);
}

/* Has a part take a material from `materials`. */
static dea_status set_material(struct dea_context *ctx, const struct dea_device *device,
                               struct dea_yaml *document, const struct changed *changed)
{
  static const char *const gone[] = {"law", "permittivity", "breakdown"};
  char prefix[DEA_MATERIAL_PREFIX_SIZE];
  dea_material_prefix(device, changed->material, prefix);
  DEA_TRY(ctx, add_key(ctx, document, prefix, "material", changed->name));
  if (changed->material == DEA_OF_ELECTRODES || changed->material == DEA_OF_FIBRES) {
    return DEA_OK; // they have no such keys
  }
  for (size_t k = 0; k < sizeof gone / sizeof gone[0]; k++) {
    DEA_TRY(ctx, add_key(ctx, document, prefix, gone[k], "null"));
  }
  const bool viscous = changed->with.branch_count > 0;
  return add_key(ctx, document, prefix, "viscosity", viscous ? "null" : "none");
}

/* Puts the values of keys into the document, and has parts take their materials from `materials`
 * where these have other numbers. */
static dea_status add_values(struct dea_context *ctx, const struct dea_device *device,
                             const struct dea_device_values *with, struct dea_yaml *document,
                             struct changed *all, size_t *count)
{
  char text[DEA_TITLE_SIZE + 8];
  for (size_t j = 0; j < with->count; j++) {
    const struct dea_device_param *param;
    // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): as many values as parameters
    const double value = with->values[j];
    for (size_t k = 0; (param = dea_device_param_tie(&with->params[j], k)) != NULL; k++) {
      if (param->kind == DEA_DEVICE_KEY) {
        dea_device_param_text(param, value, with->digits, text);
        DEA_TRY(ctx, dea_yaml_override(ctx, document, param->param.name, text));
      } else {
        struct changed *changed = find_changed(device, with, param->material, all, count);
        dea_device_param_set(param, value, &changed->with);
      }
    }
  }
  for (size_t i = 0; i < *count; i++) {
    DEA_TRY(ctx, set_material(ctx, device, document, &all[i]));
  }
  return DEA_OK;
}

static dea_status add_title(struct dea_context *ctx, struct dea_yaml *document, const char *title)
{
  struct dea_text text = {.ctx = ctx};
  dea_text_add(&text, "\"");
  dea_yaml_add_quoted(&text, title, strlen(title));
  dea_text_add(&text, "\"");
  dea_status status =
      text.failed ? DEA_E_MEMORY : dea_yaml_override(ctx, document, "title", dea_text_get(&text));
  dea_text_free(&text);
  return status;
}

dea_status dea_device_design_text(struct dea_context *ctx, const struct dea_design_bytes *file,
                                  const struct dea_device *device,
                                  const struct dea_device_values *with, struct dea_text *out)
{
  struct dea_text design = {.ctx = ctx}, material = {.ctx = ctx};
  struct dea_yaml *document;
  size_t count = 0;
  struct changed *changed =
      dea_alloc(ctx, with->count * (1 + DEA_DEVICE_TIES_MAX) + 1, sizeof *changed);
  DEA_TRY_MEMORY(changed != NULL);
  dea_status status = dea_yaml_parse(ctx, file->design->file, file->bytes, file->length, &document);
  DEA_TRY_ELSE(ctx, status, dea_free(ctx, changed));
  status = add_values(ctx, device, with, document, changed, &count);
  if (status == DEA_OK && with->uncertainty[0] != '\0') {
    status = dea_yaml_override(ctx, document, "compute.uncertainty", with->uncertainty);
  }
  if (status == DEA_OK && with->title[0] != '\0') {
    status = add_title(ctx, document, with->title);
  }
  if (status == DEA_OK) {
    dea_yaml_write(dea_yaml_root(document), &design);
    for (size_t i = 0; i < count; i++) {
      add_material(&material, &changed[i]);
    }
    if (count > 0) {
      add_with_material(out, dea_text_get(&design), dea_text_get(&material));
    } else {
      dea_text_add(out, "%s", dea_text_get(&design));
    }
    status = design.failed || material.failed || out->failed ? DEA_E_MEMORY : DEA_OK;
  }
  dea_text_free(&material);
  dea_text_free(&design);
  dea_yaml_destroy(ctx, document);
  dea_free(ctx, changed);
  return status;
}

dea_status dea_device_design_build(struct dea_context *ctx, struct dea_device_fit *fit,
                                   const struct dea_design_bytes *file,
                                   const struct dea_device *device)
{
  double values[DEA_DEVICE_PARAMS_MAX];
  for (size_t j = 0; j < fit->param_count; j++) {
    values[j] = fit->core.values[j].value;
  }
  struct dea_text uncertainty = {.ctx = ctx};
  add_uncertainty(&uncertainty, fit);
  add_head(&fit->design, fit);
  const struct dea_device_values with = {.params = fit->params,
                                         .values = values,
                                         .count = fit->param_count,
                                         .digits = 10,
                                         .name = fit->file->head.name.text,
                                         .title = fit->file->head.title.text,
                                         .uncertainty = dea_text_get(&uncertainty)};
  dea_status status = uncertainty.failed
                          ? DEA_E_MEMORY
                          : dea_device_design_text(ctx, file, device, &with, &fit->design);
  dea_text_free(&uncertainty);
  return status;
}

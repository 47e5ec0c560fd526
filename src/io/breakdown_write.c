#include "base/file.h"
#include "base/version.h"
#include "base/write_file.h"
#include "base/yaml_write.h"
#include "figures/weibull_picture.h"
#include "io/fit_common.h"
#include "material/catalogue.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the material ---- */

static void add_power(struct dea_text *out, const struct dea_breakdown_fit *fit,
                      enum dea_weibull_param k, const struct dea_quantity *given, const char *key)
{
  if (!fit->data.held[k] || given->origin != DEA_ABSENT) {
    dea_text_add(out, ", %s: %.6g", key, fit->fit.value[k]);
    if (k == DEA_WEIBULL_THICKNESS) {
      dea_text_add(out, ", reference_thickness: %.6g m", fit->data.thickness0_m);
    }
  }
}

/* The item of `breakdown`, in one line. */
static void add_law(struct dea_text *out, const struct dea_breakdown_fit *fit)
{
  const struct dea_breakdown_file *file = fit->file;
  const struct dea_weibull_fit *w = &fit->fit;
  dea_text_add(out, "[{id: fit, at_rest: %.6g V/m, value_range: [%.6g V/m, %.6g V/m]",
               w->value[DEA_WEIBULL_FIELD], w->low_95, w->high_95);
  add_power(out, fit, DEA_WEIBULL_STRETCH, &file->exponent, "exponent");
  add_power(out, fit, DEA_WEIBULL_THICKNESS, &file->thickness_exponent, "thickness_exponent");
  dea_text_add(out, ", weibull_shape: %.6g, reference_area: %.6g m^2, uncertainty: \"",
               w->value[DEA_WEIBULL_SHAPE], fit->data.area0_m2);
  dea_text_add(out,
               "value_range is the 95 %% interval of at_rest; standard uncertainties: at_rest "
               "%.3g V/um, weibull_shape %.2g",
               1e-6 * w->std[DEA_WEIBULL_FIELD], w->std[DEA_WEIBULL_SHAPE]);
  if (!fit->data.held[DEA_WEIBULL_STRETCH]) {
    dea_text_add(out, ", exponent %.2g", w->std[DEA_WEIBULL_STRETCH]);
  }
  if (!fit->data.held[DEA_WEIBULL_THICKNESS]) {
    dea_text_add(out, ", thickness_exponent %.2g", w->std[DEA_WEIBULL_THICKNESS]);
  }
  dea_text_add(out, "\", source: \"");
  if (file->head.source.text[0] != '\0') {
    dea_yaml_add_quoted(out, file->head.source.text, strlen(file->head.source.text));
    dea_text_add(out, "; ");
  }
  dea_text_add(out, "dea %s fit of %s (SHA-256 %s) to %s (%s)\"", DEA_VERSION,
               dea_path_name(file->head.file), file->head.sha256, dea_path_name(fit->tests_file),
               fit->sha256);
  const double stretch = dea_breakdown_fit_stretch(fit);
  dea_text_add(out, ", note: \"%zu films, of which %zu broke; the others count as survivors",
               fit->rows, w->broken);
  if (fabs(stretch - 1) > 1e-9) {
    dea_text_add(out, "; at_rest is that of films at the stretch %.4g, all that were tested",
                 stretch);
  }
  dea_text_add(out, "\"}]");
}

/* The catalogue's material with another name and this law. */
static dea_status add_material(struct dea_context *ctx, const struct dea_breakdown_fit *fit,
                               struct dea_text *out)
{
  const struct dea_breakdown_file *file = fit->file;
  struct dea_catalogue_entry *entry;
  struct dea_text law = {.ctx = ctx};
  DEA_TRY(ctx, dea_catalogue_read(ctx, file->material.text, file->material.location, &entry));
  add_law(&law, fit);
  dea_status status = law.failed ? DEA_E_MEMORY : DEA_OK;
  status =
      status == DEA_OK ? dea_yaml_override(ctx, entry->yaml, "name", file->head.name.text) : status;
  status = status == DEA_OK ? dea_yaml_override(ctx, entry->yaml, "breakdown", dea_text_get(&law))
                            : status;
  if (status == DEA_OK) {
    dea_text_add(out, "# Written by dea %s fit: %s with the breakdown law of %s.\n", DEA_VERSION,
                 file->material.text, dea_path_name(fit->tests_file));
    dea_yaml_write(dea_yaml_root(entry->yaml), out);
    status = out->failed ? DEA_E_MEMORY : DEA_OK;
  }
  dea_text_free(&law);
  dea_catalogue_destroy(ctx, entry);
  return status;
}

/* ---- CSV and JSON ---- */

static void add_rows(struct dea_text *csv, const struct dea_breakdown_fit *fit)
{
  dea_text_add(csv, "line,field (V/um),survived,stretch,thickness (um),area (mm^2),"
                    "field on the reference (V/um),chance by the law\n");
  for (size_t i = 0; i < fit->rows; i++) {
    const double reference = dea_breakdown_fit_reference_field(fit, i);
    double std;
    const double z = dea_weibull_z(&fit->fit, reference, &std);
    dea_text_add(csv, "%zu,%.8g,%d,%.8g,%.8g,%.8g,%.8g,%.6g\n", fit->line[i],
                 1e-6 * fit->field_V_per_m[i], fit->survived[i], fit->stretch[i],
                 1e6 * fit->thickness_m[i], 1e6 * fit->area_m2[i], 1e-6 * reference,
                 -expm1(-exp(z)));
  }
}

json_t *dea_breakdown_fit_json(const struct dea_breakdown_fit *fit, const char *command)
{
  static const char *const keys[DEA_WEIBULL_PARAMS] = {"at_rest_V_per_m", "weibull_shape",
                                                       "exponent", "thickness_exponent"};
  json_t *root = dea_fit_json_begin(&fit->file->head, command), *list = json_array();
  dea_json_add_text(root, "tests", fit->tests_file);
  dea_json_add_text(root, "tests_sha256", fit->sha256);
  dea_json_add_count(root, "films", fit->rows);
  dea_json_add_count(root, "broken", fit->fit.broken);
  dea_json_add(root, "log_likelihood", fit->fit.log_likelihood);
  dea_json_add(root, "reference_thickness_m", fit->data.thickness0_m);
  dea_json_add(root, "reference_area_m2", fit->data.area0_m2);
  for (size_t k = 0; k < DEA_WEIBULL_PARAMS; k++) {
    json_t *object = dea_fit_json_weibull(&fit->fit, k, keys[k]);
    json_object_set_new(object, "fixed", json_boolean(fit->data.held[k]));
    json_array_append_new(list, object);
  }
  json_object_set_new(root, "parameters", list);
  dea_json_add(root, "at_rest_low_95_V_per_m", fit->fit.low_95);
  dea_json_add(root, "at_rest_high_95_V_per_m", fit->fit.high_95);
  return root;
}

/* ---- the figure ---- */

static dea_status draw(struct dea_context *ctx, const struct dea_breakdown_fit *fit,
                       const struct dea_plot_format *format, const char *directory)
{
  double *field = dea_alloc(ctx, fit->rows, sizeof *field);
  DEA_TRY_MEMORY(field != NULL);
  for (size_t i = 0; i < fit->rows; i++) {
    field[i] = dea_breakdown_fit_reference_field(fit, i);
  }
  const struct dea_weibull_picture picture = {
      .caption = "share of films that have broken over the true field on the reference film, and "
                 "Weibull's law of it",
      .x_label = "Field on the reference film (V/\302\265m)",
      .y_label = "Films broken (%)",
      .points = "films",
      .factor = 1e-6,
      .rows = fit->rows,
      .values = field,
      .survived = fit->survived,
      .fit = &fit->fit,
  };
  dea_status status = dea_weibull_draw(ctx, &picture, format, directory);
  dea_free(ctx, field);
  return status;
}

dea_status dea_breakdown_fit_write(struct dea_context *ctx, const struct dea_breakdown_fit *fit,
                                   const struct dea_fit_folder *to)
{
  static const char *const figures[] = {"fit"};
  struct dea_text csv = {.ctx = ctx}, material = {.ctx = ctx};
  void *before = dea_c_locale_enter();
  add_rows(&csv, fit);
  dea_status status = add_material(ctx, fit, &material);
  dea_c_locale_leave(before);
  status = status == DEA_OK
               ? dea_fit_folder_write(ctx, to, fit->file->head.name.text, figures, 1, &material,
                                      &csv, dea_breakdown_fit_json(fit, to->command))
               : status;
  dea_text_free(&csv);
  dea_text_free(&material);
  DEA_TRY(ctx, status);
  return draw(ctx, fit, to->format, to->path);
}

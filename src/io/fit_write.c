#include "base/file.h"
#include "base/version.h"
#include "base/write_file.h"
#include "base/yaml_write.h"
#include "figures/fit_figures.h"
#include "io/csv.h"
#include "io/fit_common.h"
#include "material/catalogue.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the material ---- */

static void add_key(struct dea_text *out, const char *indent, const char *key, const char *text)
{
  if (text != NULL && text[0] != '\0') {
    dea_text_add(out, "%s%s: \"", indent, key);
    dea_yaml_add_quoted(out, text, strlen(text));
    dea_text_add(out, "\"\n");
  }
}

static void add_temperature(struct dea_text *out, const char *indent,
                            const struct dea_quantity *temperature)
{
  if (!isnan(temperature->si)) {
    dea_text_add(out, "%stemperature: %.10g K\n", indent, temperature->si);
  }
}

/* Temperature of all tests; with a shift the reference, and the range of those that were fitted. */
static void add_temperatures(struct dea_text *out, const char *indent, const struct dea_fit *fit)
{
  double low = INFINITY, high = -INFINITY;
  if (fit->file->reference_K.origin == DEA_ABSENT) {
    add_temperature(out, indent, &fit->file->temperature_K);
    return;
  }
  for (size_t s = 0; s < fit->series_count; s++) {
    if (dea_fit_series_used(&fit->series[s])) {
      const double here_K = dea_fit_temperature_K(fit->file, fit->series[s].test);
      low = fmin(low, here_K);
      high = fmax(high, here_K);
    }
  }
  add_temperature(out, indent, &fit->file->reference_K);
  if (low < high) {
    dea_text_add(out, "%stemperature_range: [%.10g K, %.10g K]\n", indent, low, high);
  }
}

/* This fit and its files, with their hashes. */
static void add_source(struct dea_text *out, const char *indent, const struct dea_fit *fit)
{
  struct dea_text source = {.ctx = out->ctx};
  if (fit->file->head.source.text[0] != '\0') {
    dea_text_add(&source, "%s; ", fit->file->head.source.text);
  }
  dea_text_add(&source, "dea %s fit of %s (SHA-256 %s) to", DEA_VERSION,
               dea_path_name(fit->file->head.file), fit->file->head.sha256);
  const char *separator = " ";
  for (size_t s = 0; s < fit->series_count; s++) {
    if (dea_fit_series_used(&fit->series[s])) {
      dea_text_add(&source, "%s%s (%s)", separator, dea_path_name(fit->series[s].file),
                   fit->series[s].sha256);
      separator = ", ";
    }
  }
  add_key(out, indent, "source", dea_text_get(&source));
  add_temperatures(out, indent, fit);
  out->failed = out->failed || source.failed;
  dea_text_free(&source);
}

static const char *unit_text(const char *unit)
{
  return strcmp(unit, "1") == 0 ? "" : unit;
}

static void add_value(struct dea_text *out, const char *separator, const char *key, double value,
                      const char *unit)
{
  dea_text_add(out, "%s%s: %.10g%s%s", separator, key, value, unit_text(unit)[0] != '\0' ? " " : "",
               unit_text(unit));
}

static bool has_std(const struct dea_fit *fit, size_t j)
{
  return isfinite(fit->values[j].std) && fit->values[j].std > 0;
}

static void add_law(struct dea_text *out, const struct dea_fit *fit)
{
  const struct dea_fit_model *model = &fit->model;
  const size_t n = model->count;
  dea_text_add(out, "laws:\n  - id: fit\n    law: %s\n    parameters: {", model->law->name);
  for (size_t j = 0; j < model->law_count; j++) {
    add_value(out, j > 0 ? ", " : "", model->params[j].name, fit->values[j].value,
              model->params[j].unit);
  }
  dea_text_add(out, "}\n");
  size_t known = 0;
  for (size_t j = 0; j < model->law_count; j++) {
    if (has_std(fit, j)) {
      add_value(out, known++ > 0 ? ", " : "    standard_uncertainties: {", model->params[j].name,
                fit->values[j].std, model->params[j].unit);
    }
  }
  dea_text_add(out, known > 0 ? "}\n" : "");
  const char *separator = "    correlations: [";
  for (size_t j = 0; j < model->law_count; j++) {
    for (size_t l = 0; l < j; l++) {
      if (has_std(fit, j) && has_std(fit, l)) {
        dea_text_add(out, "%s%.6f", separator, fit->statistics.correlation[j * n + l]);
        separator = ", ";
      }
    }
  }
  dea_text_add(out, known > 1 ? "]\n" : "");
  dea_text_add(out, "    stretch_range: [%.6g, %.6g]\n", fit->stretch_min, fit->stretch_max);
  add_source(out, "    ", fit);
  struct dea_text note = {.ctx = out->ctx};
  for (size_t k = 0; k < fit->weak_count; k++) {
    dea_text_add(&note, "%s%s", k > 0 ? "; " : "", fit->weak[k]);
  }
  for (int mode = 0; mode < DEA_COUPON_MODES; mode++) {
    if (!isnan(fit->stability[mode].unstable_from)) {
      dea_text_add(&note, "%snot stable in %s tension from the stretch %.3g on",
                   note.length > 0 ? "; " : "", dea_coupon_mode_names[mode],
                   fit->stability[mode].unstable_from);
    }
  }
  add_key(out, "    ", "note", dea_text_get(&note));
  out->failed = out->failed || note.failed;
  dea_text_free(&note);
}

/* The branches' shift, and the temperatures of the tests. */
static void add_shift(struct dea_text *out, const struct dea_fit *fit)
{
  const size_t j = fit->model.count - 2;
  add_value(out, "    wlf: {", "c1", fit->values[j].value, "1");
  add_value(out, ", ", "c2", fit->values[j + 1].value, "K");
  if (has_std(fit, j) && has_std(fit, j + 1)) {
    add_value(out, ", ", "c1_uncertainty", fit->values[j].std, "1");
    add_value(out, ", ", "c2_uncertainty", fit->values[j + 1].std, "K");
  }
  dea_text_add(out, "}\n");
}

static void add_viscosity(struct dea_text *out, const struct dea_fit *fit)
{
  bool any = false;
  for (size_t b = 0; b < fit->model.branch_count; b++) {
    const size_t j = fit->model.law_count + 2 * b;
    if (fit->values[j].value <= 0) { // a branch that the data do not want
      continue;
    }
    dea_text_add(out, any ? "" : "viscosity:\n  - id: fit\n    branches:\n");
    any = true;
    add_value(out, "      - {", "modulus", fit->values[j].value, "Pa");
    add_value(out, ", ", "time", fit->values[j + 1].value, "s");
    if (has_std(fit, j)) {
      add_value(out, ", ", "modulus_uncertainty", fit->values[j].std, "Pa");
    }
    if (has_std(fit, j + 1)) {
      add_value(out, ", ", "time_uncertainty", fit->values[j + 1].std, "s");
    }
    dea_text_add(out, "}\n");
  }
  if (any && fit->model.law_count + 2 * fit->model.branch_count < fit->model.count) {
    add_shift(out, fit);
  }
  if (any) {
    add_source(out, "    ", fit);
    dea_text_add(out, "    note: belongs to the law fit\n");
  }
}

/* What was not fitted, as the catalogue has it. */
static dea_status add_rest(struct dea_context *ctx, const struct dea_fit_file *file,
                           struct dea_text *out)
{
  static const char *const own[] = {"dea_material", "name", "title", "kind", "laws", "viscosity"};
  struct dea_catalogue_entry *entry;
  DEA_TRY(ctx, dea_catalogue_read(ctx, file->material.text, file->material.location, &entry));
  dea_status status = DEA_OK;
  for (size_t k = 0; k < sizeof own / sizeof own[0] && status == DEA_OK; k++) {
    status = dea_yaml_override(ctx, entry->yaml, own[k], "null");
  }
  dea_yaml_write(dea_yaml_root(entry->yaml), out);
  dea_catalogue_destroy(ctx, entry);
  return status;
}

static dea_status add_material(struct dea_context *ctx, const struct dea_fit *fit,
                               struct dea_text *out)
{
  dea_text_add(out,
               "# Written by dea fit. For dea to find it, DEA_MATERIALS names the folder that this "
               "file is in.\ndea_material: 1\nname: %s\n",
               fit->file->head.name.text);
  add_key(out, "", "title", fit->file->head.title.text);
  dea_text_add(out, "kind: elastomer\n");
  add_law(out, fit);
  add_viscosity(out, fit);
  DEA_TRY(ctx, fit->file->material.text[0] != '\0' ? add_rest(ctx, fit->file, out) : DEA_OK);
  return out->failed ? DEA_E_MEMORY : DEA_OK;
}

/* ---- CSV and JSON ---- */

static void add_rows(struct dea_text *out, const struct dea_fit_curve *curve)
{
  const struct dea_fit_series *series = curve->series;
  for (size_t i = 0; i < series->rows; i++) {
    dea_csv_add_name(out, series->test->name.text);
    dea_text_add(out, ",%s,%zu", dea_fit_use_names[series->test->use.value], series->line[i]);
    DEA_CSV_ADD(out, 8, series->time_s != NULL ? series->time_s[i] : NAN, series->stretch[i],
                1e-3 * series->stress_Pa[i], 1e-3 * series->std_Pa[i], 1e-3 * curve->stress_Pa[i],
                1e-3 * curve->std_Pa[i], 1e-3 * (curve->stress_Pa[i] - series->stress_Pa[i]));
    dea_text_add(out, "\n");
  }
}

static json_t *values_json(const struct dea_fit *fit)
{
  json_t *array = json_array();
  for (size_t j = 0; j < fit->model.count; j++) {
    json_t *object = json_object();
    dea_json_add_text(object, "name", fit->model.params[j].name);
    dea_json_add_text(object, "unit", fit->model.params[j].unit);
    dea_fit_json_value(object, &fit->values[j]);
    json_array_append_new(array, object);
  }
  return array;
}

static json_t *laws_json(const struct dea_fit *fit)
{
  json_t *array = json_array();
  for (size_t i = 0; i < fit->candidate_count; i++) {
    const struct dea_fit_candidate *candidate = &fit->candidates[i];
    json_t *object = json_object();
    dea_json_add_text(object, "law", candidate->name);
    json_object_set_new(object, "failed", json_boolean(candidate->failed));
    if (candidate->failed) {
      dea_json_add_text(object, "why", candidate->why);
    } else {
      dea_json_add_count(object, "free_parameters", candidate->free_count);
      dea_json_add_count(object, "branches", candidate->branch_count);
      dea_json_add(object, "chi_square", candidate->chi2);
      dea_json_add(object, "aicc", candidate->aicc);
      dea_json_add(object, "held_out", candidate->held_out);
      dea_json_add(object, "held_out_share", candidate->held_out_share);
      dea_json_add(object, "unstable_from", candidate->unstable_from);
    }
    json_array_append_new(array, object);
  }
  return array;
}

static json_t *tests_json(const struct dea_fit *fit)
{
  json_t *array = json_array();
  for (size_t s = 0; s < fit->series_count; s++) {
    const struct dea_fit_curve *curve = &fit->curves[s];
    json_t *object = json_object();
    dea_json_add_text(object, "name", curve->series->test->name.text);
    dea_json_add_text(object, "use", dea_fit_use_names[curve->series->test->use.value]);
    dea_json_add_text(object, "kind", dea_fit_kind_names[curve->series->test->kind.value]);
    dea_fit_json_rows(object, curve->series->file, curve->series->sha256, curve->series->rows,
                      curve->series->slack, curve->lag, curve->effective);
    dea_json_add_count(object, "repeated_rows", curve->series->repeated);
    dea_json_add(object, "rms_Pa", curve->rms_Pa);
    dea_json_add(object, "largest_relative", curve->largest);
    json_array_append_new(array, object);
  }
  return array;
}

static json_t *advice_json(const struct dea_fit *fit)
{
  json_t *object = json_object(), *stability = json_array(), *spreads = json_array();
  dea_fit_json_advice(object, fit->weak, fit->weak_count, "next_tests", "test", fit->next,
                      fit->next_count);
  for (int mode = 0; mode < DEA_COUPON_MODES; mode++) {
    json_t *row = json_object();
    dea_json_add_text(row, "mode", dea_coupon_mode_names[mode]);
    json_object_set_new(row, "measured", json_boolean(fit->stability[mode].measured));
    dea_json_add(row, "to_stretch", fit->stability[mode].to);
    dea_json_add(row, "unstable_from", fit->stability[mode].unstable_from);
    json_array_append_new(stability, row);
  }
  json_object_set_new(object, "stability", stability);
  for (size_t k = 0; k < fit->spread_count; k++) {
    json_t *row = json_object();
    dea_json_add_text(row, "mode", dea_coupon_mode_names[fit->spreads[k].mode]);
    dea_json_add(row, "stretch", fit->spreads[k].stretch);
    dea_json_add_text(row, "other_law", fit->spreads[k].other);
    dea_json_add(row, "differs_by_share", fit->spreads[k].share);
    json_array_append_new(spreads, row);
  }
  json_object_set_new(object, "not_measured", spreads);
  return object;
}

json_t *dea_fit_json(const struct dea_fit *fit, const char *command)
{
  json_t *root = dea_fit_json_begin(&fit->file->head, command);
  dea_json_add_text(root, "material", fit->file->head.name.text);
  dea_json_add_text(root, "law", fit->model.law->name);
  json_object_set_new(root, "laws", laws_json(fit));
  json_object_set_new(root, "parameters", values_json(fit));
  dea_fit_json_statistics(root, fit->scale_known, "scatter_Pa", fit->scatter_Pa,
                          &fit->least_squares, &fit->statistics);
  json_object_set_new(root, "tests", tests_json(fit));
  json_object_set_new(root, "advice", advice_json(fit));
  return root;
}

/* ---- the folder ---- */

dea_status dea_fit_write(struct dea_context *ctx, const struct dea_fit *fit,
                         const struct dea_fit_folder *to)
{
  static const char *const figures[] = {"fit", "fit_time"};
  struct dea_text csv = {.ctx = ctx}, material = {.ctx = ctx};
  void *before = dea_c_locale_enter();
  dea_text_add(&csv, "test,use,line,time (s),stretch,stress (kPa),stress std (kPa),fit (kPa),"
                     "fit std (kPa),residual (kPa)\n");
  for (size_t s = 0; s < fit->series_count; s++) {
    add_rows(&csv, &fit->curves[s]);
  }
  dea_status status = add_material(ctx, fit, &material);
  status = status == DEA_OK ? dea_fit_folder_write(ctx, to, fit->file->head.name.text, figures, 2,
                                                   &material, &csv, dea_fit_json(fit, to->command))
                            : status;
  dea_text_free(&material);
  dea_text_free(&csv);
  dea_c_locale_leave(before);
  DEA_TRY(ctx, status);
  return dea_fit_draw(ctx, fit, to->format, to->path);
}

/* The files of a fit: NAME.yaml, fit.csv, fit.json and figures. */
#include "io/fit_files.h"

#include "base/csv_line.h"
#include "base/file.h"
#include "base/units.h"
#include "base/version.h"
#include "base/write_file.h"
#include "base/yaml_write.h"
#include "figures/fit_figures.h"
#include "figures/weibull_picture.h"
#include "io/csv.h"
#include "material/catalogue.h"
#include "plot/plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FIT_JSON_SCHEMA = 1 };

// What kinds have in common -----------------------------------------------------------------------

/* A new fit.json with program, command (NULL: none) and fit file. */
static json_t *begin_json(const struct dea_fit_head *head, const char *command)
{
  json_t *root = json_object();
  json_object_set_new(root, "schema", json_integer(FIT_JSON_SCHEMA));
  dea_json_add_text(root, "program", "dea " DEA_VERSION);
  dea_json_add_text(root, "command", command);
  dea_json_add_text(root, "file", head->file);
  dea_json_add_text(root, "sha256", head->sha256);
  return root;
}

/* Adds value, uncertainty, interval and what is said of them. */
static void add_value_json(json_t *object, const struct dea_fit_value *value)
{
  dea_json_add(object, "value", value->value);
  dea_json_add(object, "standard_uncertainty", value->std);
  dea_json_add(object, "interval_low", value->low);
  dea_json_add(object, "interval_high", value->high);
  json_object_set_new(object, "fixed", json_boolean(value->fixed));
  json_object_set_new(object, "at_bound", json_boolean(value->at_bound));
  json_object_set_new(object, "determined", json_boolean(!isinf(value->std)));
  json_object_set_new(object, "interval_bends", json_boolean(value->bends));
}

/* A parameter of Weibull's law as an object. */
static json_t *weibull_json(const struct dea_weibull_fit *fit, size_t param, const char *name)
{
  json_t *object = json_object();
  dea_json_add_text(object, "name", name);
  dea_json_add(object, "value", fit->value[param]);
  dea_json_add(object, "standard_uncertainty", fit->std[param]);
  dea_json_add(object, "interval_low", fit->low[param]);
  dea_json_add(object, "interval_high", fit->high[param]);
  return object;
}

/* Adds "correlations", chi-square, rows, condition. scatter_key: of the scatter, where no
 * uncertainty was given. */
static void add_statistics_json(json_t *root, const struct dea_fit_core *core,
                                const char *scatter_key)
{
  const struct dea_lsq_statistics *statistics = &core->statistics;
  const bool known = core->scale_known;
  const size_t n = statistics->params;
  json_t *rows = dea_json_add_list(root, "correlations");
  for (size_t j = 0; j < n; j++) {
    json_t *row = json_array();
    for (size_t l = 0; l < n; l++) {
      json_array_append_new(row, json_real(statistics->correlation[j * n + l]));
    }
    json_array_append_new(rows, row);
  }
  json_object_set_new(root, "uncertainty_given", json_boolean(known));
  dea_json_add(root, scatter_key, known ? NAN : core->scatter);
  dea_json_add(root, "chi_square", known ? core->least_squares.chi2 : NAN);
  dea_json_add(root, "reduced_chi_square", known ? statistics->reduced_chi2 : NAN);
  json_object_set_new(root, "widened", json_boolean(statistics->widened));
  dea_json_add_count(root, "rows", core->least_squares.rows);
  dea_json_add(root, "effective_rows", statistics->effective_rows);
  dea_json_add(root, "condition", statistics->condition);
}

/* Adds file, hash and number of rows of measurements, and how many of them count. */
static void add_rows_json(json_t *object, const char *file, const char *sha256, size_t rows,
                          size_t slack_rows, double lag, double effective)
{
  dea_json_add_text(object, "file", file);
  dea_json_add_text(object, "sha256", sha256);
  dea_json_add_count(object, "rows", rows);
  dea_json_add_count(object, "slack_rows", slack_rows);
  dea_json_add(object, "neighbour_correlation", lag);
  dea_json_add(object, "effective_rows", effective);
}

/* Adds "weak", and the next measurements as `next_key`, each called `word`. */
static void add_advice_json(json_t *object, const struct dea_fit_core *core, const char *next_key,
                            const char *word)
{
  json_t *combinations = dea_json_add_list(object, "weak");
  json_t *measurements = dea_json_add_list(object, next_key);
  for (size_t k = 0; k < core->weak_count; k++) {
    json_array_append_new(combinations, json_string(core->weak[k]));
  }
  for (size_t k = 0; k < core->next_count; k++) {
    json_t *row = dea_json_append(measurements);
    dea_json_add_text(row, word, core->next[k].what);
    dea_json_add(row, "error_bars_times", core->next[k].shrink);
  }
}

/* Adds the rows of fit.csv, and NAME.yaml where a kind has one. */
typedef dea_status fill_texts(struct dea_context *ctx, const void *fit, struct dea_text *csv,
                              struct dea_text *yaml);

/* The folder with NAME.yaml, fit.csv and fit.json; root: taken. */
static dea_status write_folder(struct dea_context *ctx, const struct dea_fit_folder *to,
                               const struct dea_fit_head *head, const char *const figures[],
                               size_t figure_count, fill_texts *fill, const void *fit, json_t *root)
{
  char file[DEA_NAME_SIZE + 8], *json = NULL;
  struct dea_text csv = {.ctx = ctx}, yaml = {.ctx = ctx};
  snprintf(file, sizeof file, "%.63s.yaml", head->name.text);
  dea_status status = dea_json_text(ctx, root, &json);
  status = status == DEA_OK ? fill(ctx, fit, &csv, &yaml) : status;
  const char *const files[] = {file, "fit.json", "fit.csv"};
  for (size_t k = 0; k < 3 + figure_count && status == DEA_OK; k++) { // of an earlier fit
    status =
        dea_gnuplot_create_folders(ctx, to->path, k < 3 ? files[k] : figures[k - 3], to->force);
  }
  status = status == DEA_OK ? dea_folder_create(ctx, to->path) : status;
  if (status == DEA_OK && (yaml.length > 0 || yaml.failed)) {
    status = dea_text_write(ctx, &yaml, to->path, file);
  }
  status = status == DEA_OK ? dea_text_write(ctx, &csv, to->path, "fit.csv") : status;
  status = status == DEA_OK ? dea_text_file_write(ctx, to->path, "fit.json", json) : status;
  dea_text_free(&yaml);
  dea_text_free(&csv);
  dea_free(ctx, json);
  return status;
}

// A material --------------------------------------------------------------------------------------

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
  dea_text_free_in(&source, out);
}

static void add_value(struct dea_text *out, const char *separator, const char *key, double value,
                      const char *unit)
{
  dea_text_add(out, "%s%s: %.10g%s%s", separator, key, value, DEA_UNIT_BEHIND(unit));
}

static bool has_std(const struct dea_fit *fit, size_t j)
{
  return isfinite(fit->core.values[j].std) && fit->core.values[j].std > 0;
}

static void add_law(struct dea_text *out, const struct dea_fit *fit)
{
  const struct dea_fit_model *model = &fit->model;
  const size_t n = model->count;
  dea_text_add(out, "laws:\n  - id: fit\n    law: %s\n    parameters: {", model->law->name);
  for (size_t j = 0; j < model->law_count; j++) {
    add_value(out, j > 0 ? ", " : "", model->params[j].name, fit->core.values[j].value,
              model->params[j].unit);
  }
  dea_text_add(out, "}\n");
  size_t known = 0;
  for (size_t j = 0; j < model->law_count; j++) {
    if (has_std(fit, j)) {
      add_value(out, known++ > 0 ? ", " : "    standard_uncertainties: {", model->params[j].name,
                fit->core.values[j].std, model->params[j].unit);
    }
  }
  dea_text_add(out, known > 0 ? "}\n" : "");
  const char *separator = "    correlations: [";
  for (size_t j = 0; j < model->law_count; j++) {
    for (size_t l = 0; l < j; l++) {
      if (has_std(fit, j) && has_std(fit, l)) {
        dea_text_add(out, "%s%.6f", separator, fit->core.statistics.correlation[j * n + l]);
        separator = ", ";
      }
    }
  }
  dea_text_add(out, known > 1 ? "]\n" : "");
  dea_text_add(out, "    stretch_range: [%.6g, %.6g]\n", fit->stretch_min, fit->stretch_max);
  add_source(out, "    ", fit);
  struct dea_text note = {.ctx = out->ctx};
  for (size_t k = 0; k < fit->core.weak_count; k++) {
    dea_text_add(&note, "%s%s", k > 0 ? "; " : "", fit->core.weak[k]);
  }
  for (int mode = 0; mode < DEA_COUPON_MODES; mode++) {
    if (!isnan(fit->stability[mode].unstable_from)) {
      dea_text_add(&note, "%snot stable in %s tension from the stretch %.3g on",
                   note.length > 0 ? "; " : "", dea_coupon_mode_names[mode],
                   fit->stability[mode].unstable_from);
    }
  }
  add_key(out, "    ", "note", dea_text_get(&note));
  dea_text_free_in(&note, out);
}

/* The branches' shift, and the temperatures of the tests. */
static void add_shift(struct dea_text *out, const struct dea_fit *fit)
{
  const size_t j = fit->model.count - 2;
  add_value(out, "    wlf: {", "c1", fit->core.values[j].value, "1");
  add_value(out, ", ", "c2", fit->core.values[j + 1].value, "K");
  if (has_std(fit, j) && has_std(fit, j + 1)) {
    add_value(out, ", ", "c1_uncertainty", fit->core.values[j].std, "1");
    add_value(out, ", ", "c2_uncertainty", fit->core.values[j + 1].std, "K");
  }
  dea_text_add(out, "}\n");
}

static void add_viscosity(struct dea_text *out, const struct dea_fit *fit)
{
  bool any = false;
  for (size_t b = 0; b < fit->model.branch_count; b++) {
    const size_t j = fit->model.law_count + 2 * b;
    if (fit->core.values[j].value <= 0) { // a branch that the data do not want
      continue;
    }
    dea_text_add(out, any ? "" : "viscosity:\n  - id: fit\n    branches:\n");
    any = true;
    add_value(out, "      - {", "modulus", fit->core.values[j].value, "Pa");
    add_value(out, ", ", "time", fit->core.values[j + 1].value, "s");
    if (has_std(fit, j)) {
      add_value(out, ", ", "modulus_uncertainty", fit->core.values[j].std, "Pa");
    }
    if (has_std(fit, j + 1)) {
      add_value(out, ", ", "time_uncertainty", fit->core.values[j + 1].std, "s");
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

static void add_values_json(json_t *root, const struct dea_fit *fit)
{
  json_t *array = dea_json_add_list(root, "parameters");
  for (size_t j = 0; j < fit->model.count; j++) {
    json_t *object = dea_json_append(array);
    dea_json_add_text(object, "name", fit->model.params[j].name);
    dea_json_add_text(object, "unit", fit->model.params[j].unit);
    add_value_json(object, &fit->core.values[j]);
  }
}

static void add_laws_json(json_t *root, const struct dea_fit *fit)
{
  json_t *array = dea_json_add_list(root, "laws");
  for (size_t i = 0; i < fit->candidate_count; i++) {
    const struct dea_fit_candidate *candidate = &fit->candidates[i];
    json_t *object = dea_json_append(array);
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
  }
}

static void add_tests_json(json_t *root, const struct dea_fit *fit)
{
  json_t *array = dea_json_add_list(root, "tests");
  for (size_t s = 0; s < fit->series_count; s++) {
    const struct dea_fit_curve *curve = &fit->curves[s];
    json_t *object = dea_json_append(array);
    dea_json_add_text(object, "name", curve->series->test->name.text);
    dea_json_add_text(object, "use", dea_fit_use_names[curve->series->test->use.value]);
    dea_json_add_text(object, "kind", dea_fit_kind_names[curve->series->test->kind.value]);
    add_rows_json(object, curve->series->file, curve->series->sha256, curve->series->rows,
                  curve->series->slack, curve->lag, curve->effective);
    dea_json_add_count(object, "repeated_rows", curve->series->repeated);
    dea_json_add(object, "rms_Pa", curve->rms_Pa);
    dea_json_add(object, "largest_relative", curve->largest);
  }
}

static json_t *advice_json(const struct dea_fit *fit)
{
  json_t *object = json_object();
  add_advice_json(object, &fit->core, "next_tests", "test");
  json_t *stability = dea_json_add_list(object, "stability");
  for (int mode = 0; mode < DEA_COUPON_MODES; mode++) {
    json_t *row = dea_json_append(stability);
    dea_json_add_text(row, "mode", dea_coupon_mode_names[mode]);
    json_object_set_new(row, "measured", json_boolean(fit->stability[mode].measured));
    dea_json_add(row, "to_stretch", fit->stability[mode].to);
    dea_json_add(row, "unstable_from", fit->stability[mode].unstable_from);
  }
  json_t *spreads = dea_json_add_list(object, "not_measured");
  for (size_t k = 0; k < fit->spread_count; k++) {
    json_t *row = dea_json_append(spreads);
    dea_json_add_text(row, "mode", dea_coupon_mode_names[fit->spreads[k].mode]);
    dea_json_add(row, "stretch", fit->spreads[k].stretch);
    dea_json_add_text(row, "other_law", fit->spreads[k].other);
    dea_json_add(row, "differs_by_share", fit->spreads[k].share);
  }
  return object;
}

json_t *dea_fit_json(const struct dea_fit *fit, const char *command)
{
  json_t *root = begin_json(&fit->file->head, command);
  dea_json_add_text(root, "material", fit->file->head.name.text);
  dea_json_add_text(root, "law", fit->model.law->name);
  add_laws_json(root, fit);
  add_values_json(root, fit);
  add_statistics_json(root, &fit->core, "scatter_Pa");
  add_tests_json(root, fit);
  json_object_set_new(root, "advice", advice_json(fit));
  return root;
}

static dea_status fill_fit(struct dea_context *ctx, const void *of, struct dea_text *csv,
                           struct dea_text *yaml)
{
  const struct dea_fit *fit = of;
  dea_text_add(csv, "test,use,line,time (s),stretch,stress (kPa),stress std (kPa),fit (kPa),"
                    "fit std (kPa),residual (kPa)\n");
  for (size_t s = 0; s < fit->series_count; s++) {
    add_rows(csv, &fit->curves[s]);
  }
  return add_material(ctx, fit, yaml);
}

dea_status dea_fit_write(struct dea_context *ctx, const struct dea_fit *fit,
                         const struct dea_fit_folder *to)
{
  static const char *const figures[] = {"fit", "fit_time"};
  DEA_TRY(ctx, write_folder(ctx, to, &fit->file->head, figures, 2, fill_fit, fit,
                            dea_fit_json(fit, to->command)));
  return dea_fit_draw(ctx, fit, to->format, to->path);
}

// A device ----------------------------------------------------------------------------------------

static void add_device_rows(struct dea_text *out, const struct dea_device_curve *curve)
{
  const struct dea_column *column = curve->quantity;
  for (size_t i = 0; i < curve->rows; i++) {
    dea_csv_add_name(out, curve->text->name.text);
    dea_text_add(out, ",%s,%s,%zu,%s", column->key, dea_fit_use_names[curve->text->use.value],
                 curve->line[i], curve->used[i] ? "yes" : "no");
    DEA_CSV_ADD(out, 8, 1e-3 * curve->voltage_V[i], 1e3 * curve->depth_m[i],
                column->factor * curve->value[i], column->factor * curve->std[i],
                column->factor * curve->model[i], column->factor * curve->model_std[i],
                column->factor * curve->designed[i]);
    dea_text_add(out, ",%s", column->display_unit);
    DEA_CSV_ADD(out, 8, curve->time_s[i]);
    dea_text_add(out, "\n");
  }
}

static void add_device_values_json(json_t *root, const struct dea_device_fit *fit)
{
  json_t *array = dea_json_add_list(root, "parameters");
  for (size_t j = 0; j < fit->param_count; j++) {
    const struct dea_device_param *param = &fit->params[j];
    json_t *object = dea_json_append(array);
    dea_json_add_text(object, "name", param->param.name);
    dea_json_add_text(object, "unit", param->param.unit);
    dea_json_add_text(object, "film", param->state[0] != '\0' ? param->state + 1 : "");
    dea_json_add(object, "designed", param->designed);
    add_value_json(object, &fit->core.values[j]);
    dea_json_add(object, "prior", param->param.prior);
    dea_json_add(object, "prior_std", param->param.prior_std);
    dea_json_add_text(object, "prior_of", param->prior_of);
  }
}

static void add_curves_json(json_t *root, const struct dea_device_fit *fit)
{
  json_t *array = dea_json_add_list(root, "curves");
  for (size_t c = 0; c < fit->curve_count; c++) {
    const struct dea_device_curve *curve = &fit->curves[c];
    json_t *object = dea_json_append(array);
    dea_json_add_text(object, "name", curve->text->name.text);
    dea_json_add_text(object, "quantity", curve->quantity->key);
    dea_json_add_text(object, "unit", curve->quantity->si_unit);
    dea_json_add_text(object, "use", dea_fit_use_names[curve->text->use.value]);
    add_rows_json(object, curve->file, curve->sha256, curve->rows, curve->slack, curve->lag,
                  curve->effective);
    dea_json_add(object, "slack_from_V", curve->slack_from_V);
    dea_json_add(object, "rms", curve->rms);
    dea_json_add(object, "largest_relative", curve->largest);
  }
}

static json_t *device_advice_json(const struct dea_device_fit *fit)
{
  json_t *object = json_object();
  add_advice_json(object, &fit->core, "next_measurements", "measurement");
  json_t *pairs = dea_json_add_list(object, "not_told_apart");
  for (size_t k = 0; k < fit->pair_count; k++) {
    const struct dea_device_pair *pair = &fit->pairs[k];
    json_t *row = dea_json_append(pairs);
    dea_json_add_text(row, "first", fit->params[pair->first].param.name);
    dea_json_add_text(row, "second", fit->params[pair->second].param.name);
    dea_json_add(row, "correlation", pair->correlation);
    dea_json_add_text(row, "would_tell", pair->next);
  }
  return object;
}

json_t *dea_device_fit_json(const struct dea_device_fit *fit, const char *command)
{
  json_t *root = begin_json(&fit->file->head, command);
  dea_json_add_text(root, "name", fit->file->head.name.text);
  dea_json_add_text(root, "design", fit->design_file);
  dea_json_add_text(root, "design_sha256", fit->design_sha256);
  dea_json_add_text(root, "model", fit->model);
  add_device_values_json(root, fit);
  add_statistics_json(root, &fit->core, "scatter");
  dea_json_add_count(root, "evaluations", fit->evaluations);
  add_curves_json(root, fit);
  json_object_set_new(root, "slack_settled", json_boolean(fit->settled));
  json_object_set_new(root, "advice", device_advice_json(fit));
  return root;
}

static dea_status fill_device(struct dea_context *ctx, const void *of, struct dea_text *csv,
                              struct dea_text *yaml)
{
  const struct dea_device_fit *fit = of;
  (void)ctx;
  dea_text_add(csv, "curve,quantity,use,line,fitted,V (kV),tip depth (mm),measured,measured std,"
                    "model,model std,as designed,unit,time (s)\n");
  for (size_t c = 0; c < fit->curve_count; c++) {
    add_device_rows(csv, &fit->curves[c]);
  }
  dea_text_add(yaml, "%s", dea_text_get(&fit->design));
  return DEA_OK;
}

dea_status dea_device_fit_write(struct dea_context *ctx, const struct dea_device_fit *fit,
                                const struct dea_fit_folder *to)
{
  const size_t count = 2 * (size_t)dea_column_count(ctx);
  struct dea_arena memory = {.ctx = ctx};
  char(*names)[64] = dea_arena_alloc(&memory, count, sizeof *names);
  const char **figures = dea_arena_alloc(&memory, count, sizeof *figures);
  for (size_t c = 0; figures != NULL && c < count; c++) {
    snprintf(names[c], sizeof names[c], "fit_%s%.50s", c % 2 == 0 ? "" : "time_",
             dea_column_at(ctx, (int)(c / 2))->key);
    figures[c] = names[c];
  }
  dea_status status = dea_arena_status(&memory);
  status = status == DEA_OK ? write_folder(ctx, to, &fit->file->head, figures, count, fill_device,
                                           fit, dea_device_fit_json(fit, to->command))
                            : status;
  dea_arena_free(&memory);
  DEA_TRY(ctx, status);
  return dea_device_fit_draw(ctx, fit, to->format, to->path);
}

// Breakdown ---------------------------------------------------------------------------------------

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
static void add_breakdown_law(struct dea_text *out, const struct dea_breakdown_fit *fit)
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
static dea_status add_breakdown_material(struct dea_context *ctx,
                                         const struct dea_breakdown_fit *fit, struct dea_text *out)
{
  const struct dea_breakdown_file *file = fit->file;
  struct dea_catalogue_entry *entry;
  struct dea_text law = {.ctx = ctx};
  DEA_TRY(ctx, dea_catalogue_read(ctx, file->material.text, file->material.location, &entry));
  add_breakdown_law(&law, fit);
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

static void add_film_rows(struct dea_text *csv, const struct dea_breakdown_fit *fit)
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
  json_t *root = begin_json(&fit->file->head, command);
  dea_json_add_text(root, "tests", fit->tests_file);
  dea_json_add_text(root, "tests_sha256", fit->sha256);
  dea_json_add_count(root, "films", fit->rows);
  dea_json_add_count(root, "broken", fit->fit.broken);
  dea_json_add(root, "log_likelihood", fit->fit.log_likelihood);
  dea_json_add(root, "reference_thickness_m", fit->data.thickness0_m);
  dea_json_add(root, "reference_area_m2", fit->data.area0_m2);
  json_t *list = dea_json_add_list(root, "parameters");
  for (size_t k = 0; k < DEA_WEIBULL_PARAMS; k++) {
    json_t *object = weibull_json(&fit->fit, k, keys[k]);
    json_object_set_new(object, "fixed", json_boolean(fit->data.held[k]));
    json_array_append_new(list, object);
  }
  dea_json_add(root, "at_rest_low_95_V_per_m", fit->fit.low_95);
  dea_json_add(root, "at_rest_high_95_V_per_m", fit->fit.high_95);
  return root;
}

static dea_status draw_breakdown(struct dea_context *ctx, const struct dea_breakdown_fit *fit,
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

static dea_status fill_breakdown(struct dea_context *ctx, const void *fit, struct dea_text *csv,
                                 struct dea_text *yaml)
{
  add_film_rows(csv, fit);
  return add_breakdown_material(ctx, fit, yaml);
}

dea_status dea_breakdown_fit_write(struct dea_context *ctx, const struct dea_breakdown_fit *fit,
                                   const struct dea_fit_folder *to)
{
  static const char *const figures[] = {"fit"};
  DEA_TRY(ctx, write_folder(ctx, to, &fit->file->head, figures, 1, fill_breakdown, fit,
                            dea_breakdown_fit_json(fit, to->command)));
  return draw_breakdown(ctx, fit, to->format, to->path);
}

// Lives -------------------------------------------------------------------------------------------

static dea_status fill_life(struct dea_context *ctx, const void *of, struct dea_text *csv,
                            struct dea_text *yaml)
{
  const struct dea_life_fit *fit = of;
  (void)ctx, (void)yaml; // there is none
  dea_text_add(csv, "specimen,failed,why,cycles,time (h),under voltage (h),charge (mC),"
                    "last over first stroke,chance of a shorter life by the law\n");
  for (size_t i = 0; i < fit->rows; i++) {
    const struct dea_life *life = &fit->lives[i];
    dea_csv_add_name(csv, fit->file->specimens[i].name.text);
    dea_text_add(csv, ",%d,%s", !fit->survived[i], dea_life_end_names[life->end]);
    for (int k = 0; k < DEA_LIFE_CLOCKS; k++) {
      DEA_CSV_ADD(csv, 8, dea_life_clock_factors[k] * life->clock[k]);
    }
    double std;
    DEA_CSV_ADD(csv, 8, fabs(life->last_stroke) / life->first_stroke,
                fit->has_law ? -expm1(-exp(dea_weibull_z(&fit->fit, fit->value[i], &std)))
                             : (double)NAN);
    dea_text_add(csv, "\n");
  }
  return DEA_OK;
}

static void add_specimens_json(json_t *root, const struct dea_life_fit *fit)
{
  static const char *const keys[DEA_LIFE_CLOCKS] = {"cycles", "time_s", "under_voltage_s",
                                                    "charge_C"};
  json_t *list = dea_json_add_list(root, "lives");
  for (size_t i = 0; i < fit->rows; i++) {
    const struct dea_life *life = &fit->lives[i];
    json_t *object = dea_json_append(list);
    dea_json_add_text(object, "name", fit->file->specimens[i].name.text);
    dea_json_add_text(object, "end", dea_life_end_names[life->end]);
    for (int k = 0; k < DEA_LIFE_CLOCKS; k++) {
      dea_json_add(object, keys[k], life->clock[k]);
    }
    dea_json_add(object, "first_stroke", life->first_stroke);
    dea_json_add(object, "last_stroke", life->last_stroke);
  }
}

json_t *dea_life_fit_json(const struct dea_life_fit *fit, const char *command)
{
  static const char *const keys[2] = {"scale", "shape"};
  const struct dea_life_file *file = fit->file;
  json_t *root = begin_json(&file->head, command);
  dea_json_add_text(root, "clock", dea_life_clock_names[file->clock.value]);
  dea_json_add_count(root, "specimens", fit->rows);
  dea_json_add_count(root, "failed", fit->failed);
  add_specimens_json(root, fit);
  json_t *list = dea_json_add_list(root, "parameters");
  for (size_t k = 0; k < 2 && fit->has_law; k++) {
    json_array_append_new(list, weibull_json(&fit->fit, k, keys[k]));
  }
  if (fit->has_law) {
    dea_json_add(root, "log_likelihood", fit->fit.log_likelihood);
    dea_json_add(root, "scale_low_95", fit->fit.low_95);
    dea_json_add(root, "scale_high_95", fit->fit.high_95);
  }
  return root;
}

static dea_status draw_life(struct dea_context *ctx, const struct dea_life_fit *fit,
                            const struct dea_plot_format *format, const char *directory)
{
  static const char *const labels[DEA_LIFE_CLOCKS] = {
      "Cycles", "Time (h)", "Time under voltage (h)", "Charge brought to the film (mC)"};
  const int clock = fit->file->clock.value;
  const struct dea_weibull_picture picture = {
      .caption = "share of specimens that have failed over their life, and Weibull's law of it",
      .x_label = labels[clock],
      .y_label = "Specimens failed (%)",
      .points = "failed",
      .logarithmic = true,
      .factor = dea_life_clock_factors[clock],
      .rows = fit->rows,
      .values = fit->value,
      .survived = fit->survived,
      .fit = &fit->fit,
  };
  return dea_weibull_draw(ctx, &picture, format, directory);
}

dea_status dea_life_fit_write(struct dea_context *ctx, const struct dea_life_fit *fit,
                              const struct dea_fit_folder *to)
{
  static const char *const figures[] = {"fit"};
  DEA_TRY(ctx, write_folder(ctx, to, &fit->file->head, figures, 1, fill_life, fit,
                            dea_life_fit_json(fit, to->command)));
  return fit->has_law ? draw_life(ctx, fit, to->format, to->path) : DEA_OK;
}

#include "base/version.h"
#include "base/write_file.h"
#include "output/csv.h"
#include "output/device_fit_files.h"
#include "output/fit_files.h"
#include "plot/gnuplot.h"

#include <math.h>
#include <stdio.h>

static const char *const use_names[] = {"fit", "check"};

// CSV ---------------------------------------------------------------------------------------------

static void add_field(struct dea_text *out, double value)
{
  if (isfinite(value)) {
    dea_text_add(out, ",%.8g", value);
  } else {
    dea_text_add(out, ",");
  }
}

static void add_rows(struct dea_text *out, const struct dea_device_curve *curve)
{
  const struct dea_column *column = &dea_point_columns[curve->column];
  for (size_t i = 0; i < curve->rows; i++) {
    dea_csv_add_name(out, curve->text->name.text);
    dea_text_add(out, ",%s,%s,%zu,%s", column->key, use_names[curve->text->use.value],
                 curve->line[i], curve->used[i] ? "yes" : "no");
    add_field(out, 1e-3 * curve->voltage_V[i]);
    add_field(out, 1e3 * curve->depth_m[i]);
    add_field(out, column->factor * curve->value[i]);
    add_field(out, column->factor * curve->std[i]);
    add_field(out, column->factor * curve->model[i]);
    add_field(out, column->factor * curve->model_std[i]);
    add_field(out, column->factor * curve->designed[i]);
    dea_text_add(out, ",%s\n", column->display_unit);
  }
}

// JSON --------------------------------------------------------------------------------------------

static json_t *values_json(const struct dea_device_fit *fit)
{
  json_t *array = json_array();
  for (size_t j = 0; j < fit->param_count; j++) {
    const struct dea_device_param *param = &fit->params[j];
    const struct dea_fit_value *value = &fit->values[j];
    json_t *object = json_object();
    dea_json_put_text(object, "name", param->param.name);
    dea_json_put_text(object, "unit", param->param.unit);
    dea_json_put_text(object, "film", param->state[0] != '\0' ? param->state + 1 : "");
    dea_json_put(object, "designed", param->designed);
    dea_json_put(object, "value", value->value);
    dea_json_put(object, "standard_uncertainty", value->std);
    dea_json_put(object, "interval_low", value->low);
    dea_json_put(object, "interval_high", value->high);
    dea_json_put(object, "prior", param->param.prior);
    dea_json_put(object, "prior_std", param->param.prior_std);
    dea_json_put_text(object, "prior_of", param->prior_of);
    json_object_set_new(object, "fixed", json_boolean(value->fixed));
    json_object_set_new(object, "at_bound", json_boolean(value->at_bound));
    json_object_set_new(object, "determined", json_boolean(!isinf(value->std)));
    json_object_set_new(object, "interval_bends", json_boolean(value->bends));
    json_array_append_new(array, object);
  }
  return array;
}

static json_t *correlations_json(const struct dea_device_fit *fit)
{
  json_t *rows = json_array();
  const size_t n = fit->param_count;
  for (size_t j = 0; j < n; j++) {
    json_t *row = json_array();
    for (size_t l = 0; l < n; l++) {
      json_array_append_new(row, json_real(fit->statistics.correlation[j * n + l]));
    }
    json_array_append_new(rows, row);
  }
  return rows;
}

static json_t *curves_json(const struct dea_device_fit *fit)
{
  json_t *array = json_array();
  for (size_t c = 0; c < fit->curve_count; c++) {
    const struct dea_device_curve *curve = &fit->curves[c];
    json_t *object = json_object();
    dea_json_put_text(object, "name", curve->text->name.text);
    dea_json_put_text(object, "quantity", dea_point_columns[curve->column].key);
    dea_json_put_text(object, "unit", dea_point_columns[curve->column].si_unit);
    dea_json_put_text(object, "use", use_names[curve->text->use.value]);
    dea_json_put_text(object, "file", curve->file);
    dea_json_put_text(object, "sha256", curve->sha256);
    dea_json_put_count(object, "rows", curve->rows);
    dea_json_put_count(object, "slack_rows", curve->slack);
    dea_json_put(object, "slack_from_V", curve->slack_from_V);
    dea_json_put(object, "neighbour_correlation", curve->lag);
    dea_json_put(object, "effective_rows", curve->effective);
    dea_json_put(object, "rms", curve->rms);
    dea_json_put(object, "largest_relative", curve->largest);
    json_array_append_new(array, object);
  }
  return array;
}

static json_t *derived_json(const struct dea_device_fit *fit)
{
  json_t *array = json_array();
  for (size_t k = 0; k < fit->derived_count; k++) {
    const struct dea_device_derived *derived = &fit->derived[k];
    json_t *object = json_object();
    dea_json_put_text(object, "quantity", dea_point_columns[derived->column].key);
    dea_json_put(object, "voltage_V", derived->voltage_V);
    dea_json_put(object, "value", derived->value);
    dea_json_put(object, "standard_uncertainty", derived->std);
    dea_json_put(object, "designed", derived->designed);
    json_array_append_new(array, object);
  }
  return array;
}

static json_t *advice_json(const struct dea_device_fit *fit)
{
  json_t *object = json_object(), *weak = json_array(), *pairs = json_array(), *next = json_array();
  for (size_t k = 0; k < fit->weak_count; k++) {
    json_array_append_new(weak, json_string(fit->weak[k]));
  }
  for (size_t k = 0; k < fit->pair_count; k++) {
    const struct dea_device_pair *pair = &fit->pairs[k];
    json_t *row = json_object();
    dea_json_put_text(row, "first", fit->params[pair->first].param.name);
    dea_json_put_text(row, "second", fit->params[pair->second].param.name);
    dea_json_put(row, "correlation", pair->correlation);
    dea_json_put_text(row, "would_tell", pair->next);
    json_array_append_new(pairs, row);
  }
  for (size_t k = 0; k < fit->next_count; k++) {
    json_t *row = json_object();
    dea_json_put_text(row, "measurement", fit->next[k].what);
    dea_json_put(row, "error_bars_times", fit->next[k].shrink);
    json_array_append_new(next, row);
  }
  json_object_set_new(object, "weak", weak);
  json_object_set_new(object, "not_told_apart", pairs);
  json_object_set_new(object, "next_measurements", next);
  return object;
}

json_t *dea_device_fit_json(const struct dea_device_fit *fit, const char *command)
{
  const bool known = fit->scale_known;
  json_t *root = json_object();
  json_object_set_new(root, "schema", json_integer(DEA_FIT_JSON_SCHEMA));
  dea_json_put_text(root, "program", "dea " DEA_VERSION);
  dea_json_put_text(root, "command", command);
  dea_json_put_text(root, "file", fit->file->file);
  dea_json_put_text(root, "sha256", fit->file->sha256);
  dea_json_put_text(root, "name", fit->file->name.text);
  dea_json_put_text(root, "design", fit->design_file);
  dea_json_put_text(root, "design_sha256", fit->design_sha256);
  dea_json_put_text(root, "model", fit->model);
  json_object_set_new(root, "parameters", values_json(fit));
  json_object_set_new(root, "correlations", correlations_json(fit));
  json_object_set_new(root, "uncertainty_given", json_boolean(known));
  dea_json_put(root, "scatter", known ? NAN : fit->scatter);
  dea_json_put(root, "chi_square", known ? fit->least_squares.chi2 : NAN);
  dea_json_put(root, "reduced_chi_square", known ? fit->statistics.reduced_chi2 : NAN);
  json_object_set_new(root, "widened", json_boolean(fit->statistics.widened));
  dea_json_put_count(root, "rows", fit->least_squares.rows);
  dea_json_put(root, "effective_rows", fit->statistics.effective_rows);
  dea_json_put(root, "condition", fit->statistics.condition);
  dea_json_put_count(root, "evaluations", fit->evaluations);
  json_object_set_new(root, "curves", curves_json(fit));
  json_object_set_new(root, "follows", derived_json(fit));
  json_object_set_new(root, "advice", advice_json(fit));
  return root;
}

// The folder --------------------------------------------------------------------------------------

dea_status dea_device_fit_folder(struct dea_context *ctx, const struct dea_device_file *file,
                                 const char *directory, bool force)
{
  char name[DEA_NAME_SIZE + 32];
  snprintf(name, sizeof name, "%.63s.yaml", file->name.text);
  DEA_TRY(ctx, dea_gnuplot_make_way(ctx, directory, name, force));
  DEA_TRY(ctx, dea_gnuplot_make_way(ctx, directory, "fit.json", force));
  DEA_TRY(ctx, dea_gnuplot_make_way(ctx, directory, "fit.csv", force));
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    snprintf(name, sizeof name, "fit_%s", dea_point_columns[c].key);
    DEA_TRY(ctx, dea_gnuplot_make_way(ctx, directory, name, force));
  }
  return dea_folder_make(ctx, directory);
}

static dea_status write_texts(struct dea_context *ctx, const struct dea_device_fit *fit,
                              const char *command, const char *directory)
{
  struct dea_text csv = {.ctx = ctx};
  char name[DEA_NAME_SIZE + 8], *json = NULL;
  dea_text_add(&csv, "curve,quantity,use,line,fitted,V (kV),tip depth (mm),measured,measured std,"
                     "model,model std,as designed,unit\n");
  for (size_t c = 0; c < fit->curve_count; c++) {
    add_rows(&csv, &fit->curves[c]);
  }
  snprintf(name, sizeof name, "%.63s.yaml", fit->file->name.text);
  dea_status status = dea_text_write(ctx, &fit->design, directory, name);
  status = status == DEA_OK ? dea_text_write(ctx, &csv, directory, "fit.csv") : status;
  status = status == DEA_OK ? dea_json_text(ctx, dea_device_fit_json(fit, command), &json) : status;
  status = status == DEA_OK ? dea_text_file_write(ctx, directory, "fit.json", json) : status;
  dea_free(ctx, json);
  dea_text_free(&csv);
  return status;
}

dea_status dea_device_fit_write(struct dea_context *ctx, const struct dea_device_fit *fit,
                                const char *command, const struct dea_plot_format *format,
                                const char *directory)
{
  void *before = dea_c_locale_enter();
  dea_status status = write_texts(ctx, fit, command, directory);
  dea_c_locale_leave(before);
  DEA_TRY(ctx, status);
  return dea_device_fit_draw(ctx, fit, format, directory);
}

#include "io/fit_common.h"

#include "base/version.h"
#include "base/write_file.h"
#include "plot/plot.h"

#include <math.h>
#include <stdio.h>

// JSON --------------------------------------------------------------------------------------------

json_t *dea_fit_json_begin(const struct dea_fit_head *head, const char *command)
{
  json_t *root = json_object();
  json_object_set_new(root, "schema", json_integer(DEA_FIT_JSON_SCHEMA));
  dea_json_add_text(root, "program", "dea " DEA_VERSION);
  dea_json_add_text(root, "command", command);
  dea_json_add_text(root, "file", head->file);
  dea_json_add_text(root, "sha256", head->sha256);
  return root;
}

void dea_fit_json_value(json_t *object, const struct dea_fit_value *value)
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

json_t *dea_fit_json_weibull(const struct dea_weibull_fit *fit, size_t param, const char *name)
{
  json_t *object = json_object();
  dea_json_add_text(object, "name", name);
  dea_json_add(object, "value", fit->value[param]);
  dea_json_add(object, "standard_uncertainty", fit->std[param]);
  dea_json_add(object, "interval_low", fit->low[param]);
  dea_json_add(object, "interval_high", fit->high[param]);
  return object;
}

void dea_fit_json_statistics(json_t *root, bool known, const char *scatter_key, double scatter,
                             const struct dea_lsq_fit *least_squares,
                             const struct dea_lsq_statistics *statistics)
{
  const size_t n = statistics->params;
  json_t *rows = json_array();
  for (size_t j = 0; j < n; j++) {
    json_t *row = json_array();
    for (size_t l = 0; l < n; l++) {
      json_array_append_new(row, json_real(statistics->correlation[j * n + l]));
    }
    json_array_append_new(rows, row);
  }
  json_object_set_new(root, "correlations", rows);
  json_object_set_new(root, "uncertainty_given", json_boolean(known));
  dea_json_add(root, scatter_key, known ? NAN : scatter);
  dea_json_add(root, "chi_square", known ? least_squares->chi2 : NAN);
  dea_json_add(root, "reduced_chi_square", known ? statistics->reduced_chi2 : NAN);
  json_object_set_new(root, "widened", json_boolean(statistics->widened));
  dea_json_add_count(root, "rows", least_squares->rows);
  dea_json_add(root, "effective_rows", statistics->effective_rows);
  dea_json_add(root, "condition", statistics->condition);
}

void dea_fit_json_rows(json_t *object, const char *file, const char *sha256, size_t rows,
                       size_t slack_rows, double lag, double effective)
{
  dea_json_add_text(object, "file", file);
  dea_json_add_text(object, "sha256", sha256);
  dea_json_add_count(object, "rows", rows);
  dea_json_add_count(object, "slack_rows", slack_rows);
  dea_json_add(object, "neighbour_correlation", lag);
  dea_json_add(object, "effective_rows", effective);
}

void dea_fit_json_advice(json_t *object, const char weak[][DEA_FIT_WEAK_SIZE], size_t weak_count,
                         const char *next_key, const char *word, const struct dea_fit_next *next,
                         size_t next_count)
{
  json_t *combinations = json_array(), *measurements = json_array();
  for (size_t k = 0; k < weak_count; k++) {
    json_array_append_new(combinations, json_string(weak[k]));
  }
  for (size_t k = 0; k < next_count; k++) {
    json_t *row = json_object();
    dea_json_add_text(row, word, next[k].what);
    dea_json_add(row, "error_bars_times", next[k].shrink);
    json_array_append_new(measurements, row);
  }
  json_object_set_new(object, "weak", combinations);
  json_object_set_new(object, next_key, measurements);
}

// The folder --------------------------------------------------------------------------------------

static dea_status create(struct dea_context *ctx, const struct dea_fit_folder *to, const char *yaml,
                         const char *const figures[], size_t figure_count)
{
  const char *const files[] = {yaml, "fit.json", "fit.csv"};
  for (size_t k = 0; k < 3 + figure_count; k++) {
    DEA_TRY(ctx, dea_gnuplot_create_folders(ctx, to->path, k < 3 ? files[k] : figures[k - 3],
                                            to->force));
  }
  return dea_folder_create(ctx, to->path);
}

dea_status dea_fit_folder_write(struct dea_context *ctx, const struct dea_fit_folder *to,
                                const char *name, const char *const figures[], size_t figure_count,
                                const struct dea_text *yaml, const struct dea_text *csv,
                                json_t *root)
{
  char file[DEA_NAME_SIZE + 8], *json = NULL;
  snprintf(file, sizeof file, "%.63s.yaml", name);
  dea_status status = dea_json_text(ctx, root, &json);
  status = status == DEA_OK ? create(ctx, to, file, figures, figure_count) : status;
  status = status == DEA_OK && yaml != NULL ? dea_text_write(ctx, yaml, to->path, file) : status;
  status = status == DEA_OK ? dea_text_write(ctx, csv, to->path, "fit.csv") : status;
  status = status == DEA_OK ? dea_text_file_write(ctx, to->path, "fit.json", json) : status;
  dea_free(ctx, json);
  return status;
}

#include "base/write_file.h"
#include "figures/fit_figures.h"
#include "io/csv.h"
#include "io/fit_common.h"

#include <math.h>
#include <stdio.h>

// CSV ---------------------------------------------------------------------------------------------

static void add_rows(struct dea_text *out, const struct dea_device_curve *curve)
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

// JSON --------------------------------------------------------------------------------------------

static json_t *values_json(const struct dea_device_fit *fit)
{
  json_t *array = json_array();
  for (size_t j = 0; j < fit->param_count; j++) {
    const struct dea_device_param *param = &fit->params[j];
    json_t *object = json_object();
    dea_json_add_text(object, "name", param->param.name);
    dea_json_add_text(object, "unit", param->param.unit);
    dea_json_add_text(object, "film", param->state[0] != '\0' ? param->state + 1 : "");
    dea_json_add(object, "designed", param->designed);
    dea_fit_json_value(object, &fit->values[j]);
    dea_json_add(object, "prior", param->param.prior);
    dea_json_add(object, "prior_std", param->param.prior_std);
    dea_json_add_text(object, "prior_of", param->prior_of);
    json_array_append_new(array, object);
  }
  return array;
}

static json_t *curves_json(const struct dea_device_fit *fit)
{
  json_t *array = json_array();
  for (size_t c = 0; c < fit->curve_count; c++) {
    const struct dea_device_curve *curve = &fit->curves[c];
    json_t *object = json_object();
    dea_json_add_text(object, "name", curve->text->name.text);
    dea_json_add_text(object, "quantity", curve->quantity->key);
    dea_json_add_text(object, "unit", curve->quantity->si_unit);
    dea_json_add_text(object, "use", dea_fit_use_names[curve->text->use.value]);
    dea_fit_json_rows(object, curve->file, curve->sha256, curve->rows, curve->slack, curve->lag,
                      curve->effective);
    dea_json_add(object, "slack_from_V", curve->slack_from_V);
    dea_json_add(object, "rms", curve->rms);
    dea_json_add(object, "largest_relative", curve->largest);
    json_array_append_new(array, object);
  }
  return array;
}

static json_t *advice_json(const struct dea_device_fit *fit)
{
  json_t *object = json_object(), *pairs = json_array();
  dea_fit_json_advice(object, fit->weak, fit->weak_count, "next_measurements", "measurement",
                      fit->next, fit->next_count);
  for (size_t k = 0; k < fit->pair_count; k++) {
    const struct dea_device_pair *pair = &fit->pairs[k];
    json_t *row = json_object();
    dea_json_add_text(row, "first", fit->params[pair->first].param.name);
    dea_json_add_text(row, "second", fit->params[pair->second].param.name);
    dea_json_add(row, "correlation", pair->correlation);
    dea_json_add_text(row, "would_tell", pair->next);
    json_array_append_new(pairs, row);
  }
  json_object_set_new(object, "not_told_apart", pairs);
  return object;
}

json_t *dea_device_fit_json(const struct dea_device_fit *fit, const char *command)
{
  json_t *root = dea_fit_json_begin(&fit->file->head, command);
  dea_json_add_text(root, "name", fit->file->head.name.text);
  dea_json_add_text(root, "design", fit->design_file);
  dea_json_add_text(root, "design_sha256", fit->design_sha256);
  dea_json_add_text(root, "model", fit->model);
  json_object_set_new(root, "parameters", values_json(fit));
  dea_fit_json_statistics(root, fit->scale_known, "scatter", fit->scatter, &fit->least_squares,
                          &fit->statistics);
  dea_json_add_count(root, "evaluations", fit->evaluations);
  json_object_set_new(root, "curves", curves_json(fit));
  json_object_set_new(root, "slack_settled", json_boolean(fit->settled));
  json_object_set_new(root, "advice", advice_json(fit));
  return root;
}

// The folder --------------------------------------------------------------------------------------

/* NAME.yaml, fit.csv and fit.json. */
static dea_status write_texts(struct dea_context *ctx, const struct dea_device_fit *fit,
                              const struct dea_fit_folder *to)
{
  const size_t count = 2 * (size_t)dea_column_count(ctx);
  struct dea_arena memory = {.ctx = ctx};
  struct dea_text csv = {.ctx = ctx};
  char(*names)[64] = dea_arena_alloc(&memory, count, sizeof *names);
  const char **figures = dea_arena_alloc(&memory, count, sizeof *figures);
  for (size_t c = 0; figures != NULL && c < count; c++) {
    snprintf(names[c], sizeof names[c], "fit_%s%.50s", c % 2 == 0 ? "" : "time_",
             dea_column_at(ctx, (int)(c / 2))->key);
    figures[c] = names[c];
  }
  dea_text_add(&csv, "curve,quantity,use,line,fitted,V (kV),tip depth (mm),measured,measured std,"
                     "model,model std,as designed,unit,time (s)\n");
  for (size_t c = 0; c < fit->curve_count; c++) {
    add_rows(&csv, &fit->curves[c]);
  }
  dea_status status = dea_arena_status(&memory);
  status = status == DEA_OK
               ? dea_fit_folder_write(ctx, to, fit->file->head.name.text, figures, count,
                                      &fit->design, &csv, dea_device_fit_json(fit, to->command))
               : status;
  dea_text_free(&csv);
  dea_arena_free(&memory);
  return status;
}

dea_status dea_device_fit_write(struct dea_context *ctx, const struct dea_device_fit *fit,
                                const struct dea_fit_folder *to)
{
  void *before = dea_c_locale_enter();
  dea_status status = write_texts(ctx, fit, to);
  dea_c_locale_leave(before);
  DEA_TRY(ctx, status);
  return dea_device_fit_draw(ctx, fit, to->format, to->path);
}

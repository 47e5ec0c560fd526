#include "base/csv_line.h"
#include "base/write_file.h"
#include "figures/weibull_picture.h"
#include "io/fit_common.h"

#include <math.h>

/* ---- CSV and JSON ---- */

static void add_rows(struct dea_text *csv, const struct dea_life_fit *fit)
{
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
}

static json_t *specimens_json(const struct dea_life_fit *fit)
{
  static const char *const keys[DEA_LIFE_CLOCKS] = {"cycles", "time_s", "under_voltage_s",
                                                    "charge_C"};
  json_t *list = json_array();
  for (size_t i = 0; i < fit->rows; i++) {
    const struct dea_life *life = &fit->lives[i];
    json_t *object = json_object();
    dea_json_add_text(object, "name", fit->file->specimens[i].name.text);
    dea_json_add_text(object, "end", dea_life_end_names[life->end]);
    for (int k = 0; k < DEA_LIFE_CLOCKS; k++) {
      dea_json_add(object, keys[k], life->clock[k]);
    }
    dea_json_add(object, "first_stroke", life->first_stroke);
    dea_json_add(object, "last_stroke", life->last_stroke);
    json_array_append_new(list, object);
  }
  return list;
}

json_t *dea_life_fit_json(const struct dea_life_fit *fit, const char *command)
{
  static const char *const keys[2] = {"scale", "shape"};
  const struct dea_life_file *file = fit->file;
  json_t *root = dea_fit_json_begin(&file->head, command), *list = json_array();
  dea_json_add_text(root, "clock", dea_life_clock_names[file->clock.value]);
  dea_json_add_count(root, "specimens", fit->rows);
  dea_json_add_count(root, "failed", fit->failed);
  json_object_set_new(root, "lives", specimens_json(fit));
  for (size_t k = 0; k < 2 && fit->has_law; k++) {
    json_array_append_new(list, dea_fit_json_weibull(&fit->fit, k, keys[k]));
  }
  json_object_set_new(root, "parameters", list);
  if (fit->has_law) {
    dea_json_add(root, "log_likelihood", fit->fit.log_likelihood);
    dea_json_add(root, "scale_low_95", fit->fit.low_95);
    dea_json_add(root, "scale_high_95", fit->fit.high_95);
  }
  return root;
}

/* ---- the folder ---- */

static dea_status draw(struct dea_context *ctx, const struct dea_life_fit *fit,
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
  struct dea_text csv = {.ctx = ctx};
  void *before = dea_c_locale_enter();
  add_rows(&csv, fit);
  dea_c_locale_leave(before);
  dea_status status = dea_fit_folder_write(ctx, to, fit->file->head.name.text, figures, 1, NULL,
                                           &csv, dea_life_fit_json(fit, to->command));
  dea_text_free(&csv);
  DEA_TRY(ctx, status);
  return fit->has_law ? draw(ctx, fit, to->format, to->path) : DEA_OK;
}

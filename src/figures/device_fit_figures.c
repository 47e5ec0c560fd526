/* Figures of a fit of a device: measurements with the model and its band, residuals below. */
#include "base/sort.h"
#include "figures/fit_figures.h"
#include "result/figure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const enum dea_colour colours[] = {DEA_BLUE,   DEA_GREEN, DEA_PURPLE,
                                          DEA_ORANGE, DEA_SKY,   DEA_VERMILLION};
enum { COLOURS = sizeof colours / sizeof colours[0] };

struct place {
  double at; // kV, or s of a transient
  size_t row;
};

/* Whether the times of the transients of a quantity are best seen on a logarithmic axis. */
static bool spans_decades(const struct dea_device_fit *fit, int column)
{
  double first = INFINITY, last = 0;
  for (size_t c = 0; c < fit->curve_count; c++) {
    const struct dea_device_curve *curve = &fit->curves[c];
    for (size_t i = 0;
         i < curve->rows && dea_device_curve_in_time(curve) && curve->column == column; i++) {
      first = fmin(first, curve->time_s[i]);
      last = fmax(last, curve->time_s[i]);
    }
  }
  return first > 0 && last > 30 * first;
}

/* What is drawn of one curve. */
struct look {
  struct dea_series *band, *designed, *model, *data, *left_out, *residual;
};

static dea_status add_series(struct dea_context *ctx, struct dea_plot *plot,
                             const struct dea_device_curve *curve, size_t number, struct look *out)
{
  const enum dea_colour colour = colours[number % COLOURS];
  struct dea_panel *top = &plot->panels[0], *below = &plot->panels[1];
  const size_t n = curve->rows;
  DEA_TRY(ctx, dea_panel_add(ctx, top, n, DEA_BAND, DEA_GREY, "", &out->band));
  DEA_TRY(ctx, dea_panel_add(ctx, top, n, DEA_DASHED, DEA_BLACK, number == 0 ? "as designed" : "",
                             &out->designed));
  DEA_TRY(ctx, dea_panel_add(ctx, top, n, DEA_LINE, colour, number == 0 ? "as fitted" : "",
                             &out->model));
  DEA_TRY(ctx, dea_panel_add(ctx, top, n, DEA_ERROR_BARS, colour, "", &out->data));
  DEA_TRY(ctx, dea_panel_add(ctx, top, n, DEA_MARKERS, DEA_GREY,
                             curve->slack > 0 ? "slack, left out" : "", &out->left_out));
  DEA_TRY(ctx, dea_panel_add(ctx, below, n, DEA_ERROR_BARS, colour, "", &out->residual));
  out->data->marker = out->residual->marker = (int)number;
  out->left_out->marker = (int)number;
  dea_label_escape(curve->text->name.text, out->data->title, sizeof out->data->title);
  return DEA_OK;
}

static void fill(const struct dea_device_curve *curve, const struct place *places, struct look *to)
{
  const double factor = curve->quantity->factor;
  const size_t n = curve->rows;
  struct dea_series *all[] = {to->band, to->designed, to->model,
                              to->data, to->left_out, to->residual};
  for (size_t k = 0; k < n; k++) {
    const size_t i = places[k].row;
    const double y = factor * curve->model[i], half = 2 * factor * curve->model_std[i];
    const bool counts = curve->used[i] || curve->text->use.value != DEA_FIT_USED;
    for (size_t s = 0; s < sizeof all / sizeof all[0]; s++) {
      all[s]->values[k] = places[k].at;
    }
    to->band->values[n + k] = y - half;
    to->band->values[2 * n + k] = y + half;
    to->designed->values[n + k] = factor * curve->designed[i];
    to->model->values[n + k] = y;
    to->data->values[n + k] = counts ? factor * curve->value[i] : NAN;
    to->data->values[2 * n + k] = factor * curve->std[i];
    to->left_out->values[n + k] = counts ? NAN : factor * curve->value[i];
    to->residual->values[n + k] = counts ? y - factor * curve->value[i] : NAN;
    to->residual->values[2 * n + k] = factor * curve->std[i];
  }
}

static dea_status add_curve(struct dea_context *ctx, struct dea_plot *plot,
                            const struct dea_device_curve *curve, size_t number)
{
  struct look look;
  struct place *places = dea_alloc(ctx, curve->rows, sizeof *places);
  DEA_TRY_MEMORY(places != NULL);
  for (size_t i = 0; i < curve->rows; i++) {
    places[i] = (struct place){
        dea_device_curve_in_time(curve) ? curve->time_s[i] : 1e-3 * curve->voltage_V[i], i};
  }
  qsort(places, curve->rows, sizeof *places, dea_rising);
  dea_status status = add_series(ctx, plot, curve, number, &look);
  if (status == DEA_OK) {
    fill(curve, places, &look);
  }
  dea_free(ctx, places);
  return status;
}

static dea_status draw(struct dea_plot_folder *folder, const struct dea_device_fit *fit, int column,
                       bool in_time)
{
  enum { SHOWN_MAX = 7 }; // of the 48 series that a panel holds
  struct dea_context *ctx = folder->ctx;
  struct dea_plot *plot;
  size_t number = 0;
  char name[64];
  snprintf(name, sizeof name, "fit_%s%.50s", in_time ? "time_" : "",
           dea_column_at(ctx, column)->key);
  DEA_TRY(ctx, dea_plot_create(ctx, name,
                               "measurements with the fitted device, its band of two standard "
                               "uncertainties and the design; model less measurement",
                               &plot));
  plot->panel_count = 2;
  plot->second_height = 0.5;
  dea_status status = DEA_OK;
  for (size_t c = 0; c < fit->curve_count && status == DEA_OK && number < SHOWN_MAX; c++) {
    if (fit->curves[c].column == column && dea_device_curve_in_time(&fit->curves[c]) == in_time) {
      status = add_curve(ctx, plot, &fit->curves[c], number++);
    }
  }
  if (status == DEA_OK && number > 0) {
    dea_figure_label(dea_column_at(ctx, column), plot->panels[0].y_label,
                     sizeof plot->panels[0].y_label);
    const char *unit = strrchr(plot->panels[0].y_label, '(');
    snprintf(plot->panels[1].y_label, sizeof plot->panels[1].y_label, "Residual %.60s",
             unit != NULL ? unit : "");
    for (size_t p = 0; p < 2; p++) {
      if (in_time) {
        plot->panels[p].logarithmic_x = spans_decades(fit, column);
        snprintf(plot->panels[p].x_label, sizeof plot->panels[p].x_label, "Time {/:Italic t} (s)");
      } else {
        dea_panel_voltage_axis(&plot->panels[p]);
        plot->panels[p].x_max *= 1.03; // room for the last sign
        plot->panels[p].x_min *= 1.03;
      }
      dea_panel_even_tics(&plot->panels[p], p == 0 ? 7 : 4);
    }
    dea_panel_begin_at_zero(&plot->panels[0]);
    dea_panel_mark(&plot->panels[1], 0, "");
    dea_panel_place_key(&plot->panels[0]);
  }
  return dea_plot_folder_add(folder, plot, status);
}

dea_status dea_device_fit_draw(struct dea_context *ctx, const struct dea_device_fit *fit,
                               const struct dea_plot_format *format, const char *directory)
{
  struct dea_plot_folder folder = {.ctx = ctx, .format = format, .path = directory};
  dea_status status = DEA_OK;
  for (int k = 0; k < 2 * dea_column_count(ctx) && status == DEA_OK; k++) {
    status = draw(&folder, fit, k / 2, k % 2 == 1);
  }
  return dea_plot_folder_draw(&folder, status);
}

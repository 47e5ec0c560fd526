/* Figures of a fit: measurements with the law and its band, residuals below. */
#include "figures/fit_figures.h"
#include "result/figure.h"

#include <math.h>
#include <stdio.h>

enum { COLOURS = 6, TESTS_MAX = 12 };
static const enum dea_colour colours[COLOURS] = {DEA_BLUE,   DEA_VERMILLION, DEA_GREEN,
                                                 DEA_PURPLE, DEA_ORANGE,     DEA_SKY};

static double x_of(const struct dea_fit_series *series, size_t i, bool time)
{
  return time ? series->time_s[i] : series->stretch[i];
}

static dea_status add(struct dea_context *ctx, struct dea_panel *panel, size_t count,
                      enum dea_series_style style, size_t number, struct dea_series **out)
{
  DEA_TRY(ctx, dea_panel_add(ctx, panel, count, style, colours[number % COLOURS], "", out));
  (*out)->marker = (int)number;
  return DEA_OK;
}

/* Band, law, measurements and residuals of one test. */
static dea_status add_test(struct dea_context *ctx, struct dea_plot *plot,
                           const struct dea_fit_curve *curve, bool time, size_t number)
{
  const struct dea_fit_series *series = curve->series;
  const size_t n = series->rows;
  const bool measured = series->test->use.value != DEA_FIT_PREDICTED;
  struct dea_series *band, *law, *data = NULL, *residual = NULL;
  DEA_TRY(ctx, add(ctx, &plot->panels[0], n, DEA_BAND, number, &band));
  band->colour = DEA_GREY;
  DEA_TRY(ctx, add(ctx, &plot->panels[0], n,
                   series->test->use.value == DEA_FIT_USED ? DEA_LINE : DEA_DASHED, number, &law));
  char title[DEA_LABEL_SIZE];
  dea_label_escape(series->test->name.text, title, sizeof title);
  if (measured) {
    DEA_TRY(ctx, add(ctx, &plot->panels[0], n, n > 60 ? DEA_THIN : DEA_MARKERS, number, &data));
    DEA_TRY(ctx, add(ctx, &plot->panels[1], n, n > 60 ? DEA_THIN : DEA_MARKERS, number, &residual));
    data->colour = n > 60 ? DEA_BLACK : data->colour;
    snprintf(data->title, sizeof data->title, "%s", title);
  } else {
    snprintf(law->title, sizeof law->title, "%s", title);
  }
  for (size_t i = 0; i < n; i++) {
    const double x = x_of(series, i, time), y = 1e-3 * curve->stress_Pa[i];
    const double half = 2e-3 * curve->std_Pa[i];
    band->values[i] = law->values[i] = x;
    band->values[n + i] = isfinite(half) ? y - half : NAN;
    band->values[2 * n + i] = isfinite(half) ? y + half : NAN;
    law->values[n + i] = y;
    if (measured) {
      data->values[i] = residual->values[i] = x;
      data->values[n + i] = 1e-3 * series->stress_Pa[i];
      residual->values[n + i] = y - 1e-3 * series->stress_Pa[i];
    }
  }
  return DEA_OK;
}

/* The x axis from the first to the last point of a panel, a logarithmic one without the time 0. */
static void limit(const struct dea_panel *from, struct dea_panel *to)
{
  double low = INFINITY, high = 0;
  for (size_t s = 0; s < from->series_count; s++) {
    for (size_t i = 0; i < from->series[s].count; i++) {
      const double x = from->series[s].values[i];
      low = x > 0 ? fmin(low, x) : low;
      high = fmax(high, x);
    }
  }
  if (low < high) {
    to->x_min = to->logarithmic_x ? low / 1.1 : fmin(1, low);
    to->x_max = to->logarithmic_x ? high * 1.1 : high + 0.03 * (high - low);
  }
}

/* A line at 0 of the residuals, and one where a law that was measured so ends to be stable. */
static dea_status add_lines(struct dea_context *ctx, const struct dea_fit *fit, bool time,
                            struct dea_plot *plot)
{
  struct dea_series *line;
  const struct dea_panel *panel = &plot->panels[0];
  DEA_TRY(ctx, add(ctx, &plot->panels[1], 2, DEA_THIN, 0, &line));
  line->colour = DEA_BLACK;
  line->values[0] = panel->x_min;
  line->values[1] = panel->x_max;
  line->values[2] = line->values[3] = 0;
  double most = 0;
  for (size_t s = 0; s < fit->series_count; s++) {
    for (size_t i = 0; i < fit->series[s].rows; i++) {
      most = fmax(most, 1e-3 * fit->curves[s].stress_Pa[i]);
    }
  }
  for (int mode = 0; mode < DEA_COUPON_MODES && !time; mode++) {
    const struct dea_fit_stability *stability = &fit->stability[mode];
    if (stability->measured && !isnan(stability->unstable_from)) {
      DEA_TRY(ctx, add(ctx, &plot->panels[0], 2, DEA_DASHED, 0, &line));
      line->colour = DEA_GREY;
      line->values[0] = line->values[1] = stability->unstable_from;
      line->values[2] = 0;
      line->values[3] = most;
      snprintf(line->title, sizeof line->title, "%s: not stable beyond",
               dea_coupon_mode_names[mode]);
    }
  }
  return DEA_OK;
}

static dea_status draw(struct dea_plot_folder *folder, const struct dea_fit *fit, bool time,
                       const char *name)
{
  struct dea_context *ctx = folder->ctx;
  struct dea_plot *plot;
  size_t number = 0;
  DEA_TRY(ctx, dea_plot_create(ctx, name,
                               "measurements with the fitted law and its band of two standard "
                               "uncertainties; law less measurement",
                               &plot));
  plot->panel_count = 2;
  plot->second_height = 0.5;
  dea_status status = DEA_OK;
  for (size_t s = 0; s < fit->series_count && status == DEA_OK && number < TESTS_MAX; s++) {
    const struct dea_fit_curve *curve = &fit->curves[s];
    const int kind = curve->series->test->kind.value;
    if ((kind == DEA_FIT_RELAXATION || kind == DEA_FIT_CREEP) == time) {
      status = add_test(ctx, plot, curve, time, number++);
    }
  }
  for (size_t p = 0; p < 2; p++) {
    struct dea_panel *panel = &plot->panels[p];
    panel->logarithmic_x = time;
    panel->key = time ? "top right" : "top left";
    if (number > 4) {
      dea_panel_key_above(panel, (number + 1) / 2); // in two columns
    }
    limit(&plot->panels[0], panel);
    dea_panel_even_tics(panel, p == 0 ? 7 : 4);
    snprintf(panel->x_label, sizeof panel->x_label,
             time ? "Time {/:Italic t} (s)" : "Stretch {/:Italic \316\273}");
    snprintf(panel->y_label, sizeof panel->y_label,
             p == 0 ? "Nominal stress (kPa)" : "Residual (kPa)");
  }
  if (plot->panels[1].series_count == 0) {
    plot->panel_count = 1;
  } else if (status == DEA_OK) {
    status = add_lines(ctx, fit, time, plot);
  }
  return dea_plot_folder_add(folder, plot, status);
}

dea_status dea_fit_draw(struct dea_context *ctx, const struct dea_fit *fit,
                        const struct dea_plot_format *format, const char *directory)
{
  struct dea_plot_folder folder = {.ctx = ctx, .format = format, .path = directory};
  dea_status status = draw(&folder, fit, false, "fit");
  status = status == DEA_OK ? draw(&folder, fit, true, "fit_time") : status;
  return dea_plot_folder_draw(&folder, status);
}

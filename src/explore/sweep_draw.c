/* Figures of a sweep: of samples at several voltages the band of each quantity's curve. */
#include "explore/statistics.h"
#include "explore/sweep.h"
#include "plot/gnuplot.h"
#include "plot/plot.h"
#include "result/columns.h"
#include "result/figure.h"

#include <stdio.h>

enum { OUTER, INNER, MEDIAN, KINDS };

static dea_status add_series(struct dea_context *ctx, struct dea_panel *panel, size_t count,
                             struct dea_series *out[KINDS])
{
  static const struct {
    const char *title;
    enum dea_series_style style;
    enum dea_colour colour;
  } looks[KINDS] = {{"95 %", DEA_BAND, DEA_GREY},
                    {"68 %", DEA_BAND, DEA_VERMILLION},
                    {"median", DEA_LINE_MARKED, DEA_BLUE}};
  for (size_t k = 0; k < KINDS; k++) {
    DEA_TRY(ctx, dea_panel_add(ctx, panel, count, &out[k]));
    snprintf(out[k]->title, sizeof out[k]->title, "%s", looks[k].title);
    out[k]->style = looks[k].style;
    out[k]->colour = looks[k].colour;
  }
  return DEA_OK;
}

/* Spreads of quantity i at every voltage, [voltages]. Samples without a value are in no band: where
 * there are any the key says so. */
static dea_status fill_panel(const struct dea_question *question, const struct dea_spread *spreads,
                             size_t samples, size_t i, struct dea_panel *panel)
{
  const size_t n = question->voltage_count;
  size_t least = samples;
  const struct dea_column *column = &question->quantities[i].shown;
  struct dea_series *series[KINDS];
  DEA_TRY(question->ctx, add_series(question->ctx, panel, n, series));
  for (size_t v = 0; v < n; v++) {
    const struct dea_spread *spread = &spreads[v * question->quantity_count + i];
    const double *quantile = spread->quantile;
    least = spread->count < least ? spread->count : least;
    for (size_t k = 0; k < KINDS; k++) { // from the outer pair inwards
      series[k]->values[v] = 1e-3 * question->voltages_V[v];
      series[k]->values[n + v] = column->factor * quantile[k];
      series[k]->values[2 * n + v] = column->factor * quantile[DEA_SHARES - 1 - k];
    }
  }
  if (least < samples) {
    snprintf(series[MEDIAN]->title, sizeof series[MEDIAN]->title, "median (%zu or more of %zu)",
             least, samples);
  }
  dea_figure_label(column, panel->y_label, sizeof panel->y_label);
  dea_panel_voltage_axis(panel);
  dea_panel_place_key(panel);
  return DEA_OK;
}

dea_status dea_sweep_draw(const struct dea_question *question, const struct dea_spread *spreads,
                          size_t samples, const struct dea_plot_format *format, const char *folder)
{
  char names[DEA_EXPLORE_QUANTITIES_MAX][64];
  const char *list[DEA_EXPLORE_QUANTITIES_MAX];
  for (size_t i = 0; i < question->quantity_count; i++) {
    struct dea_plot *plot;
    snprintf(names[i], sizeof names[i], "band_%.50s", question->quantities[i].key);
    list[i] = names[i];
    DEA_TRY(question->ctx, dea_plot_create(question->ctx, names[i],
                                           "median of the samples, and where 68 and 95 % of them "
                                           "lie",
                                           &plot));
    dea_status status = fill_panel(question, spreads, samples, i, &plot->panels[0]);
    if (status == DEA_OK) {
      status = dea_plot_write(question->ctx, plot, format, folder);
    }
    dea_plot_destroy(question->ctx, plot);
    DEA_TRY(question->ctx, status);
  }
  return dea_gnuplot_draw(question->ctx, folder, list, question->quantity_count);
}

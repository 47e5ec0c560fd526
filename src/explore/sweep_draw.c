/* Figures of a sweep: of samples at several voltages the band of each quantity's curve. */
#include "explore/statistics.h"
#include "explore/sweep.h"
#include "plot/gnuplot.h"
#include "plot/plot.h"
#include "result/columns.h"
#include "result/figure.h"

#include <stdio.h>

static dea_status add_series(struct dea_context *ctx, struct dea_panel *panel, size_t count,
                             enum dea_series_style style, enum dea_colour colour,
                             struct dea_series **out)
{
  DEA_TRY(ctx, dea_panel_add(ctx, panel, count, out));
  (*out)->style = style;
  (*out)->colour = colour;
  return DEA_OK;
}

/* Spreads of a quantity at all voltages and how it is shown. */
struct shown {
  const struct dea_question *question;
  const struct dea_spread *spreads; // of the quantity: [voltages * quantities] from it on
  const struct dea_column *column;
  size_t samples;
  const size_t *doubted; // [voltages]
};

/* Puts quantiles `low` and its opposite at voltage v. */
static void put(const struct shown *shown, size_t v, size_t low, struct dea_series *out)
{
  const size_t n = shown->question->voltage_count;
  const double *quantile = shown->spreads[v * shown->question->quantity_count].quantile;
  out->values[v] = 1e-3 * shown->question->voltages_V[v];
  out->values[n + v] = shown->column->factor * quantile[low];
  out->values[2 * n + v] = shown->column->factor * quantile[DEA_SHARES - 1 - low];
}

static dea_status add_bands(const struct shown *shown, struct dea_panel *panel)
{
  static const char *const titles[] = {"95 %", "68 %"};
  static const enum dea_colour colours[] = {DEA_GREY, DEA_VERMILLION};
  const size_t n = shown->question->voltage_count;
  for (size_t k = 0; k < 2; k++) { // from the outer pair inwards
    struct dea_series *band;
    DEA_TRY(shown->question->ctx,
            add_series(shown->question->ctx, panel, n, DEA_BAND, colours[k], &band));
    snprintf(band->title, sizeof band->title, "%s", titles[k]);
    for (size_t v = 0; v < n; v++) {
      put(shown, v, k, band);
    }
  }
  return DEA_OK;
}

/* The median, dashed where samples are not to be trusted. Samples without a value are in neither
 * median nor bands: the key says so. */
static dea_status add_median(const struct shown *shown, struct dea_panel *panel)
{
  const size_t n = shown->question->voltage_count;
  size_t most = 0, least = shown->samples, good = 0;
  char of[64] = "", doubts[80] = "";
  for (size_t v = 0; v < n; v++) {
    const size_t count = shown->spreads[v * shown->question->quantity_count].count;
    most = shown->doubted[v] > most ? shown->doubted[v] : most;
    least = count < least ? count : least;
    good += shown->doubted[v] == 0 ? 1U : 0U;
  }
  if (least < shown->samples) {
    snprintf(of, sizeof of, " of %zu or more of %zu", least, shown->samples);
  }
  snprintf(doubts, sizeof doubts, "up to %zu of %zu not to be trusted", most, shown->samples);
  for (size_t dashed = good > 0 ? 0 : 1; dashed < (most > 0 ? 2 : 1); dashed++) {
    struct dea_series *series;
    DEA_TRY(shown->question->ctx,
            add_series(shown->question->ctx, panel, n, dashed == 1 ? DEA_DASHED : DEA_LINE_MARKED,
                       DEA_BLUE, &series));
    snprintf(series->title, sizeof series->title, "%s%.50s%s%.60s",
             dashed == 0 || good == 0 ? "median" : "", dashed == 0 || good == 0 ? of : "",
             dashed == 1 && good == 0 ? ", " : "", dashed == 1 ? doubts : "");
    for (size_t v = 0; v < n; v++) {
      const bool here = shown->doubted[v] > 0;
      const bool beside =
          (v > 0 && shown->doubted[v - 1] > 0) || (v + 1 < n && shown->doubted[v + 1] > 0);
      if (dashed == 1 ? here || beside : !here) {
        put(shown, v, DEA_SHARES / 2, series);
      }
    }
  }
  return DEA_OK;
}

static dea_status fill_panel(const struct shown *shown, struct dea_panel *panel)
{
  DEA_TRY(shown->question->ctx, add_bands(shown, panel));
  DEA_TRY(shown->question->ctx, add_median(shown, panel));
  dea_figure_label(shown->column, panel->y_label, sizeof panel->y_label);
  dea_panel_voltage_axis(panel);
  dea_panel_place_key(panel);
  return DEA_OK;
}

dea_status dea_sweep_draw(const struct dea_question *question, const struct dea_spread *spreads,
                          size_t samples, const size_t *doubted,
                          const struct dea_plot_format *format, const char *folder)
{
  char names[DEA_EXPLORE_QUANTITIES_MAX][64];
  const char *list[DEA_EXPLORE_QUANTITIES_MAX];
  for (size_t i = 0; i < question->quantity_count; i++) {
    struct dea_plot *plot;
    const struct shown shown = {question, spreads + i, &question->quantities[i].shown, samples,
                                doubted};
    snprintf(names[i], sizeof names[i], "band_%.50s", question->quantities[i].key);
    list[i] = names[i];
    DEA_TRY(question->ctx, dea_plot_create(question->ctx, names[i],
                                           "median of the samples, and where 68 and 95 % of them "
                                           "lie",
                                           &plot));
    dea_status status = fill_panel(&shown, &plot->panels[0]);
    if (status == DEA_OK) {
      status = dea_plot_write(question->ctx, plot, format, folder);
    }
    dea_plot_destroy(question->ctx, plot);
    DEA_TRY(question->ctx, status);
  }
  return dea_gnuplot_draw(question->ctx, folder, list, question->quantity_count);
}

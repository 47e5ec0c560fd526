/* Figures of a sweep: of samples at several voltages the band of each quantity's curve. */
#include "explore/explore_sweep.h"
#include "explore/sample_statistics.h"
#include "plot/plot.h"
#include "result/columns.h"
#include "result/figure.h"

#include <stdio.h>

/* Spreads of a quantity at all voltages and how it is shown. */
struct shown {
  const struct dea_case_key *case_key;
  const struct dea_spread *spreads; // of the quantity: [voltages * quantities] from it on
  const struct dea_column *column;
  size_t samples;
  const size_t *doubted; // [voltages]
};

/* Puts quantiles `low` and its opposite at voltage v. */
static void add_point(const struct shown *shown, size_t v, size_t low, struct dea_series *out)
{
  const size_t n = shown->case_key->voltage_count;
  const double *quantile = shown->spreads[v * shown->case_key->quantity_count].quantile;
  out->values[v] = 1e-3 * shown->case_key->voltages_V[v];
  out->values[n + v] = shown->column->factor * quantile[low];
  out->values[2 * n + v] = shown->column->factor * quantile[DEA_SHARES - 1 - low];
}

static dea_status add_bands(const struct shown *shown, struct dea_panel *panel)
{
  static const char *const titles[] = {"95 %", "68 %"};
  static const enum dea_colour colours[] = {DEA_GREY, DEA_VERMILLION};
  const size_t n = shown->case_key->voltage_count;
  for (size_t k = 0; k < 2; k++) { // from the outer pair inwards
    struct dea_series *band;
    DEA_TRY(shown->case_key->ctx,
            dea_panel_add(shown->case_key->ctx, panel, n, DEA_BAND, colours[k], titles[k], &band));
    for (size_t v = 0; v < n; v++) {
      add_point(shown, v, k, band);
    }
  }
  return DEA_OK;
}

/* Whether a voltage has samples that are not to be trusted; none lies beyond the last one. */
static bool is_doubted(const struct shown *shown, size_t v)
{
  return v < shown->case_key->voltage_count && shown->doubted[v] > 0;
}

/* The median where all samples are to be trusted, or dashed where some are not, up to the points
 * beside these. */
static dea_status add_line(const struct shown *shown, struct dea_panel *panel, bool dashed,
                           const char *title)
{
  const size_t n = shown->case_key->voltage_count;
  struct dea_series *line;
  DEA_TRY(shown->case_key->ctx,
          dea_panel_add(shown->case_key->ctx, panel, n, dashed ? DEA_DASHED : DEA_LINE_MARKED,
                        DEA_BLUE, title, &line));
  for (size_t v = 0; v < n; v++) {
    const bool beside = (v > 0 && is_doubted(shown, v - 1)) || is_doubted(shown, v + 1);
    if (dashed ? is_doubted(shown, v) || beside : !is_doubted(shown, v)) {
      add_point(shown, v, DEA_SHARES / 2, line);
    }
  }
  return DEA_OK;
}

/* Samples without a value are in neither median nor bands, and those that are not to be trusted
 * are: the key says both. */
static dea_status add_median(const struct shown *shown, struct dea_panel *panel)
{
  size_t most = 0, least = shown->samples, good = 0;
  char median[64] = "median", doubts[62], both[DEA_LABEL_SIZE];
  for (size_t v = 0; v < shown->case_key->voltage_count; v++) {
    const size_t count = shown->spreads[v * shown->case_key->quantity_count].count;
    most = shown->doubted[v] > most ? shown->doubted[v] : most;
    least = count < least ? count : least;
    good += is_doubted(shown, v) ? 0U : 1U;
  }
  if (least < shown->samples) {
    snprintf(median, sizeof median, "median of %zu or more of %zu", least, shown->samples);
  }
  snprintf(doubts, sizeof doubts, "up to %zu of %zu not to be trusted", most, shown->samples);
  if (good == 0) {
    snprintf(both, sizeof both, "%s, %s", median, doubts);
    return add_line(shown, panel, true, both);
  }
  DEA_TRY(shown->case_key->ctx, add_line(shown, panel, false, median));
  return most > 0 ? add_line(shown, panel, true, doubts) : DEA_OK;
}

static dea_status fill_panel(const struct shown *shown, struct dea_panel *panel)
{
  DEA_TRY(shown->case_key->ctx, add_bands(shown, panel));
  DEA_TRY(shown->case_key->ctx, add_median(shown, panel));
  dea_figure_label(shown->column, panel->y_label, sizeof panel->y_label);
  dea_panel_voltage_axis(panel);
  dea_panel_place_key(panel);
  return DEA_OK;
}

dea_status dea_sweep_draw(const struct dea_case_key *case_key, const struct dea_spread *spreads,
                          size_t samples, const size_t *doubted,
                          const struct dea_plot_format *format, const char *folder)
{
  struct dea_plot_folder list = {.ctx = case_key->ctx, .format = format, .path = folder};
  dea_status status = DEA_OK;
  for (size_t i = 0; i < case_key->quantity_count && status == DEA_OK; i++) {
    struct dea_plot *plot;
    char name[64];
    const struct shown shown = {case_key, spreads + i, &case_key->quantities[i].shown, samples,
                                doubted};
    snprintf(name, sizeof name, "band_%.50s", case_key->quantities[i].key);
    status = dea_plot_create(case_key->ctx, name,
                             "median of the samples, and where 68 and 95 % of them lie", &plot);
    if (status == DEA_OK) {
      status = dea_plot_folder_add(&list, plot, fill_panel(&shown, &plot->panels[0]));
    }
  }
  return dea_plot_folder_draw(&list, status);
}

/* Stretch and tension along the radius at up to four voltages: full lines radial, dashed hoop. */
#include "result/figure.h"
#include "result/trust.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SHOWN_MAX = 4 };

static dea_status add(struct dea_context *ctx, struct dea_panel *panel,
                      const struct dea_profile_record *record, int column, enum dea_colour colour,
                      enum dea_series_style style, double width, const char *title)
{
  struct dea_series *series;
  size_t n = record->count;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, n, style, colour, title, &series));
  series->width = width;
  for (size_t i = 0; i < n; i++) {
    series->values[i] = dea_profile_columns[0].factor * record->columns[i];
    series->values[n + i] =
        dea_profile_columns[column].factor * record->columns[(size_t)column * n + i];
  }
  return DEA_OK;
}

static dea_status add_record(struct dea_context *ctx, struct dea_plot *plot,
                             const struct dea_result *result,
                             const struct dea_profile_record *record, size_t shown)
{
  static const enum dea_colour order[SHOWN_MAX] = {DEA_BLACK, DEA_SKY, DEA_ORANGE, DEA_VERMILLION};
  static const double widths[SHOWN_MAX] = {0.6, 0.9, 1.2, 1.6}; // that count in grey
  char title[64];
  bool doubtful = dea_result_doubts(result, record->model, record->voltage_V) != 0;
  snprintf(title, sizeof title, "%.3g kV%s", 1e-3 * record->voltage_V, doubtful ? " (?)" : "");
  for (int p = 0; p < 2; p++) {
    struct dea_panel *panel = &plot->panels[p];
    DEA_TRY(ctx, add(ctx, panel, record, 2 + 2 * p, order[shown], DEA_LINE, widths[shown],
                     p == 0 ? title : ""));
    DEA_TRY(ctx, add(ctx, panel, record, 3 + 2 * p, order[shown], DEA_DASHED, widths[shown], ""));
  }
  return DEA_OK;
}

/* Key entries of the two directions. */
static dea_status add_directions(struct dea_context *ctx, struct dea_panel *panel,
                                 const struct dea_profile_record *record)
{
  static const char *const titles[2] = {"radial", "hoop"};
  for (size_t d = 0; d < 2; d++) {
    double tension = dea_profile_columns[4 + d].factor * record->columns[(4 + d) * record->count];
    DEA_TRY(ctx, dea_figure_add_entry(ctx, panel, d == 0 ? DEA_LINE : DEA_DASHED, titles[d], 0.0,
                                      tension));
  }
  return DEA_OK;
}

/* The key above: in one row, or in two where voltages are not to be trusted and their titles
 * longer. */
static void place_key(struct dea_panel *panel)
{
  bool doubtful = false;
  for (size_t i = 0; i < panel->series_count; i++) {
    doubtful = doubtful || strchr(panel->series[i].title, '?') != NULL;
  }
  dea_panel_key_above(panel, doubtful ? 2 : 1);
}

static void set_labels(struct dea_plot *plot, const struct dea_profile_record *last)
{
  plot->panel_count = 2;
  for (int p = 0; p < 2; p++) {
    struct dea_panel *panel = &plot->panels[p];
    snprintf(panel->x_label, sizeof panel->x_label,
             "Radius in the stretched flat film {/:Italic R} (mm)");
    panel->x_min = last->count > 0 ? fmin(0, 1e3 * last->columns[0]) : 0;
    panel->x_max = last->count > 0 ? 1e3 * last->columns[last->count - 1] : panel->x_max;
  }
  place_key(&plot->panels[0]);
  plot->panels[1].key = "inside vertical top right maxrows auto samplen 2.2 width 0";
  snprintf(plot->panels[0].y_label, DEA_LABEL_SIZE, "Total stretch {/:Italic \316\273}");
  snprintf(plot->panels[1].y_label, DEA_LABEL_SIZE, "Tension {/:Italic T} (N/m)");
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  const struct dea_profile_record *records = result->profiles;
  size_t count = 0, index[SHOWN_MAX], seen = 0;
  for (size_t i = 0; i < result->profile_count; i++) {
    count += strcmp(records[i].model, records[0].model) == 0;
  }
  size_t shown = count < SHOWN_MAX ? count : SHOWN_MAX;
  for (size_t k = 0; k < shown; k++) {
    index[k] = shown > 1 ? k * (count - 1) / (shown - 1) : 0; // first to last, evenly
  }
  size_t next = 0;
  for (size_t i = 0; i < result->profile_count && next < shown; i++) {
    if (strcmp(records[i].model, records[0].model) == 0 && seen++ == index[next]) {
      DEA_TRY(ctx, add_record(ctx, plot, result, &records[i], next++));
    }
  }
  if (shown > 0) {
    set_labels(plot, &records[0]);
    for (size_t i = 0; i < result->profile_count; i++) { // at 0 V the sections do not differ
      if (strcmp(records[i].model, records[0].model) == 0) {
        dea_figure_sides(&plot->panels[1], &records[i]);
      }
    }
    DEA_TRY(ctx, add_directions(ctx, &plot->panels[1], &records[0]));
    dea_panel_even_tics(&plot->panels[0], 7);
    dea_panel_even_tics(&plot->panels[1], 7);
  }
  return DEA_OK;
}

const struct dea_figure dea_figure_profile = {
    .name = "profile",
    .caption = "stretch and tension along the radius (full: radial, dashed: hoop; ?: not to be "
               "trusted; of model 3d two sections)",
    .build = build,
};

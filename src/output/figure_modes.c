/* Frequencies of the lowest modes against the voltage. */
#include "output/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLOURS = 6, MARKERS = 5 }; // the first of them

/* The k-th mode of a curve; nothing where it has no such one. */
static dea_status add_mode(struct dea_context *ctx, struct dea_panel *panel,
                           const struct dea_curve *curve, int k)
{
  struct dea_series *series;
  size_t count = 0;
  for (size_t i = 0; i < curve->count; i++) {
    count += (int)curve->points[i].mode == k;
  }
  if (count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_panel_add(ctx, panel, count, &series));
  series->style = DEA_LINE_MARKED;
  series->colour = (enum dea_colour)((k - 1) % COLOURS);
  series->marker = (k - 1) % MARKERS;
  snprintf(series->title, sizeof series->title, "%d", k);
  for (size_t i = 0, n = 0; i < curve->count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    if ((int)p->mode == k) {
      series->values[n] = 1e-3 * p->voltage_V;
      series->values[count + n++] = p->frequency_Hz > 0 ? p->frequency_Hz : 0; // unstable
    }
  }
  return DEA_OK;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    for (int k = 1; k <= DEA_DESIGN_MODES_MAX && strcmp(curve->kind, "modal") == 0; k++) {
      DEA_TRY(ctx, add_mode(ctx, panel, curve, k));
    }
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Frequency {/:Italic f} (Hz)");
  dea_figure_voltage_axis(panel);
  panel->y_min = 0;
  panel->key = "above horizontal maxrows 1 samplen 1.5";
  return DEA_OK;
}

const struct dea_figure dea_figure_modes = {
    .name = "modes",
    .caption = "frequencies of the lowest modes in vacuo against the voltage; 0: unstable",
    .build = build,
};

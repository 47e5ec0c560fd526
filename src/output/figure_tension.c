/* Smallest tension against the voltage; below zero the film is slack. */
#include "result/figure.h"

#include <math.h>
#include <stdio.h>

/* The line below which the film is slack, where the curves come near to it. */
static dea_status add_zero(struct dea_context *ctx, struct dea_panel *panel)
{
  double low = INFINITY, high = -INFINITY;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count; i++) {
      double tension = series->values[series->count + i];
      low = isfinite(tension) ? fmin(low, tension) : low;
      high = isfinite(tension) ? fmax(high, tension) : high;
    }
  }
  if (!(low < 0.25 * high) || !isfinite(panel->x_max)) {
    return DEA_OK;
  }
  struct dea_series *zero;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, 2, &zero));
  zero->style = DEA_DOTTED;
  zero->colour = DEA_BLACK;
  snprintf(zero->title, sizeof zero->title, "slack below");
  zero->values[0] = panel->x_min;
  zero->values[1] = panel->x_max;
  zero->values[2] = zero->values[3] = 0.0;
  return DEA_OK;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  DEA_TRY(ctx, dea_figure_add_models(ctx, panel, result,
                                     dea_point_column_find("min_tension_N_per_m"), false));
  if (panel->series_count == 0) {
    return DEA_OK;
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Smallest principal tension (N/m)");
  dea_panel_voltage_axis(panel);
  DEA_TRY(ctx, add_zero(ctx, panel));
  DEA_TRY(ctx,
          dea_figure_add_events(ctx, panel, result, dea_point_column_find("min_tension_N_per_m"),
                                1.0, 0.0, false));
  dea_panel_place_key(panel);
  return DEA_OK;
}

const struct dea_figure dea_figure_tension = {
    .name = "tension",
    .caption = "smallest principal tension of the film against the voltage",
    .build = build,
};

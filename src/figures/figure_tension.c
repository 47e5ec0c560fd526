/* Smallest tension against the voltage; below zero the film is slack. */
#include "result/figure.h"

#include <stdio.h>

/* Marks below what the film is slack, where the curves come near to it. */
static void add_zero(struct dea_panel *panel)
{
  double low, high;
  if (dea_panel_range(panel, false, &low, &high) && low < 0.25 * high) {
    dea_panel_mark(panel, false, 0, "slack below");
  }
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
  add_zero(panel);
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

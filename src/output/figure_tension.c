/* Smallest tension against the voltage; below zero the film is slack. */
#include "output/figure.h"

#include <stdio.h>

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_figure_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    struct dea_series look = dea_figure_look(models[m], m);
    DEA_TRY(ctx, dea_figure_add(ctx, panel, dea_figure_curve(result, models[m], false),
                                dea_point_column_find("min_tension_N_per_m"), 1.0, 0.0, &look));
  }
  if (panel->series_count == 0) {
    return DEA_OK;
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Smallest principal tension (N/m)");
  panel->key = "bottom left";
  dea_figure_voltage_axis(panel);
  dea_panel_mark(panel, false, 0.0, "slack below");
  return dea_figure_add_events(ctx, panel, result, dea_point_column_find("min_tension_N_per_m"),
                               1.0, 0.0, false);
}

const struct dea_figure dea_figure_tension = {
    .name = "tension",
    .caption = "smallest principal tension of the film against the voltage",
    .build = build,
};

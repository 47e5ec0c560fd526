/* Electrode stretch against the voltage along the whole equilibrium path, with its events. */
#include "output/figure.h"

#include <stdio.h>

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    struct dea_series look = dea_figure_style(models[m], m);
    DEA_TRY(ctx, dea_figure_add(ctx, panel, dea_figure_curve(result, models[m], true),
                                dea_point_column_find("electrode_stretch"), 1.0, 0.0, &look));
  }
  DEA_TRY(ctx, dea_figure_add_events(ctx, panel, result, dea_point_column_find("electrode_stretch"),
                                     1.0, 0.0, true));
  snprintf(panel->y_label, sizeof panel->y_label, "Electrode stretch {/:Italic \316\273}_a");
  dea_figure_voltage_axis(panel);
  dea_figure_even_tics(panel, 7);
  dea_figure_place_key(panel);
  return DEA_OK;
}

const struct dea_figure dea_figure_stretch = {
    .name = "stretch",
    .caption = "electrode stretch (relative to the pre-stretched state) along the equilibrium path",
    .build = build,
};

/* Electrode stretch against the voltage along the whole equilibrium path, with its events. */
#include "result/figure.h"

#include <stdio.h>

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  DEA_TRY(ctx, dea_figure_add_models(ctx, panel, result, dea_point_column_find("electrode_stretch"),
                                     true));
  DEA_TRY(ctx, dea_figure_add_events(ctx, panel, result, dea_point_column_find("electrode_stretch"),
                                     1.0, 0.0, true));
  snprintf(panel->y_label, sizeof panel->y_label, "Electrode stretch {/:Italic \316\273}_a");
  dea_panel_voltage_axis(panel);
  dea_panel_even_tics(panel, 7);
  dea_panel_place_key(panel);
  return DEA_OK;
}

const struct dea_figure dea_figure_stretch = {
    .name = "stretch",
    .caption = "electrode stretch (relative to the pre-stretched state) along the equilibrium path",
    .build = build,
};

/* Out-of-plane force against the voltage. */
#include "result/figure.h"

#include <stdio.h>

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  int column = dea_point_column_find("force_N");
  DEA_TRY(ctx, dea_figure_add_models(ctx, panel, result, column, false));
  snprintf(panel->y_label, sizeof panel->y_label, "Out-of-plane force {/:Italic F} (mN)");
  dea_panel_voltage_axis(panel);
  DEA_TRY(ctx, dea_figure_add_events(ctx, panel, result, column, dea_point_columns[column].factor,
                                     0.0, false));
  dea_panel_place_key(panel);
  return DEA_OK;
}

const struct dea_figure dea_figure_force = {
    .name = "force",
    .caption = "out-of-plane force against the voltage",
    .build = build,
};

/* Force on a tip against the voltage, a curve for each depth that it is held at. */
#include "output/figure.h"
#include "output/figure_stops.h"

#include <stdio.h>

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  struct dea_stops stops;
  int column = dea_point_column_find("force_N");
  dea_stops_find(result, &stops);
  for (size_t i = 0; i < stops.count; i++) {
    struct dea_curve part = *stops.curve; // lent points: a curve of one stop
    part.points = stops.curve->points + stops.first[i];
    part.count = stops.first[i + 1] - stops.first[i];
    struct dea_series look = dea_stops_style(i);
    snprintf(look.title, sizeof look.title, "%.4g mm", 1e3 * part.points[0].tip_depth_m);
    DEA_TRY(ctx, dea_figure_add(ctx, panel, &part, column, dea_point_columns[column].factor, 0.0,
                                &look));
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Force on the tip {/:Italic F} (mN)");
  dea_figure_voltage_axis(panel);
  dea_figure_place_key(panel);
  return DEA_OK;
}

const struct dea_figure dea_figure_tip_force = {
    .name = "tip_force",
    .caption = "force on the tip against the voltage, for each depth that it is held at",
    .build = build,
};

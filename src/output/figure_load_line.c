/* Force on a tip against the depth that it is held at, a curve a voltage: the actuator's load
 * lines.
 */
#include "output/figure.h"
#include "output/figure_stops.h"

#include <math.h>
#include <stdio.h>

enum { SHOWN_MAX = 6 };

/* Force over depth at the k-th voltage of each stop that came so far. */
static dea_status add_line(struct dea_context *ctx, struct dea_panel *panel,
                           const struct dea_stops *stops, size_t k, size_t number)
{
  const struct dea_series look = dea_stops_style(number);
  struct dea_series *series;
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, stops->count, &look, &series));
  snprintf(series->title, sizeof series->title, "%.4g kV",
           1e-3 * stops->curve->points[k].voltage_V);
  for (size_t i = 0; i < stops->count; i++) {
    size_t at = stops->first[stops->by_depth[i]] + k;
    if (at < stops->first[stops->by_depth[i] + 1]) {
      series->values[i] = 1e3 * stops->curve->points[at].tip_depth_m;
      series->values[stops->count + i] = 1e3 * stops->curve->points[at].force_N;
    }
  }
  return DEA_OK;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  struct dea_stops stops;
  dea_stops_find(result, &stops);
  if (stops.count < 2) { // one depth is no line
    return DEA_OK;
  }
  size_t voltages = stops.first[1] - stops.first[0];
  size_t shown = voltages < SHOWN_MAX ? voltages : SHOWN_MAX;
  for (size_t i = 0; i < shown; i++) {
    size_t k = shown < 2 ? 0 : (i * (voltages - 1) + (shown - 1) / 2) / (shown - 1);
    DEA_TRY(ctx, add_line(ctx, panel, &stops, k, i));
  }
  snprintf(panel->x_label, sizeof panel->x_label, "Depth of the tip (mm)");
  snprintf(panel->y_label, sizeof panel->y_label, "Force on the tip {/:Italic F} (mN)");
  dea_figure_place_key(panel);
  return DEA_OK;
}

const struct dea_figure dea_figure_load_line = {
    .name = "load_line",
    .caption = "force on the tip against the depth that it is held at, for some voltages",
    .build = build,
};

/* Electrode stretch against the voltage along the whole equilibrium path, with its events. */
#include "result/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Largest voltage of the sweeps [kV], to which the figures beside this one go; NAN: none above 0.
 */
static double sweep_end(const struct dea_result *result)
{
  double end = NAN;
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    for (size_t k = 0; strcmp(curve->kind, "sweep") == 0 && k < curve->count; k++) {
      end = fmax(end, 1e-3 * curve->points[k].voltage_V); // NAN counts as nothing
    }
  }
  return end > 0 ? end : NAN;
}

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
  panel->x_max = fmin(panel->x_max, sweep_end(result));
  panel->y_min = panel->y_max = NAN;
  dea_panel_limit(panel);
  dea_panel_even_tics(panel, 7);
  dea_panel_place_key(panel);
  return DEA_OK;
}

const struct dea_figure dea_figure_stretch = {
    .name = "stretch",
    .caption = "electrode stretch (relative to the pre-stretched state) along the equilibrium path",
    .build = build,
};

/* Several designs in one figure: out-of-plane displacement of the centre above, radial strain of
 * the electrode below, against the voltage. */
#include "output/figure_variants.h"

#include <math.h>
#include <stdio.h>

enum { SHOWN_MAX = 16 };

/* True where some design has a displacement beyond noise. */
static bool moves(const struct dea_figure_variant list[], size_t count, int column)
{
  for (size_t i = 0; i < count; i++) {
    const struct dea_curve *curve = &list[i].variant->curve;
    for (size_t k = 0; k < curve->count; k++) {
      if (fabs(dea_point_get(&curve->points[k], column)) > 1e-9) {
        return true;
      }
    }
  }
  return false;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_figure_variant list[SHOWN_MAX];
  struct dea_panel *panels = plot->panels;
  size_t count = dea_figure_variants(result, "compare-design", false, list, SHOWN_MAX);
  int z = dea_point_column_find("centre_z_m"), stretch = dea_point_column_find("electrode_stretch");
  plot->panel_count = moves(list, count, z) ? 2 : 1;
  struct dea_panel *last = &panels[plot->panel_count - 1];
  if (plot->panel_count == 2) {
    DEA_TRY(ctx, dea_figure_add_variants(ctx, &panels[0], list, count, z, 1e6, 0));
    snprintf(panels[0].y_label, DEA_LABEL_SIZE, "Centre {/:Italic z} (\302\265m)");
  }
  DEA_TRY(ctx, dea_figure_add_variants(ctx, last, list, count, stretch, 100, -1));
  snprintf(last->y_label, DEA_LABEL_SIZE, "Electrode strain (%%)");
  for (size_t p = 0; p < plot->panel_count; p++) {
    dea_figure_voltage_axis(&panels[p]);
  }
  panels[0].x_max = last->x_max; // all designs have a strain, and the panels share the axis
  if (panels[0].series_count > 0) {
    DEA_TRY(ctx, dea_figure_add_variant_key(ctx, &panels[0], list, count, false));
  }
  return DEA_OK;
}

const struct dea_figure dea_figure_designs = {
    .name = "designs",
    .caption = "displacement and strain of several designs against the voltage",
    .build = build,
};

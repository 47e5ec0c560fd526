/* Several designs in one figure: displacement of the fibre tip against the voltage. */
#include "output/figure_variants.h"

#include <stdio.h>

enum { SHOWN_MAX = 16 };

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_figure_variant list[SHOWN_MAX];
  struct dea_panel *panel = &plot->panels[0];
  size_t count = dea_figure_variants(result, "compare-design", false, list, SHOWN_MAX);
  int column = dea_point_column_find("fibre_tip_z_m");
  DEA_TRY(ctx, dea_figure_add_variants(ctx, panel, list, count, column, 1e6, 0));
  snprintf(panel->y_label, DEA_LABEL_SIZE, "Fibre tip {/:Italic z} (\302\265m)");
  dea_figure_voltage_axis(panel);
  if (panel->series_count > 0) {
    DEA_TRY(ctx, dea_figure_add_variant_key(ctx, panel, list, count, false));
  }
  return DEA_OK;
}

const struct dea_figure dea_figure_design_tips = {
    .name = "design_tips",
    .caption = "displacement of the fibre tip of several designs against the voltage",
    .build = build,
};

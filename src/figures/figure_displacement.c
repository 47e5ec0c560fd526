/* Radial strain of the electrode, and below it the displacement out of the plane, against the
 * voltage: what Fig 2 of the paper shows. */
#include "result/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Displacements of less than half a millimetre are read in micrometres. */
static double z_factor(const struct dea_result *result, const char *const models[], size_t count,
                       const int columns[2])
{
  for (size_t m = 0; m < count; m++) {
    const struct dea_curve *curve = dea_figure_curve(result, models[m], false);
    for (size_t k = 0; curve != NULL && k < curve->count; k++) {
      for (int c = 0; c < 2; c++) {
        bool shown = !dea_figure_leaves_out(result, curve, columns[c]);
        if (shown && fabs(dea_point_get(&curve->points[k], columns[c])) > 0.5e-3) {
          return 1e3;
        }
      }
    }
  }
  return 1e6;
}

/* True when a curve says the same of both quantities; one of them is then enough. */
static bool are_equal(const struct dea_curve *curve, const int columns[2])
{
  for (size_t i = 0; curve != NULL && i < curve->count; i++) {
    double first = dea_point_get(&curve->points[i], columns[0]);
    double second = dea_point_get(&curve->points[i], columns[1]);
    if (!(fabs(first - second) <= 1e-9 * fabs(first))) {
      return false;
    }
  }
  return true;
}

/* Displacements of centre and fibre tip of a model, the tip's with a full marker. */
static dea_status add_model(struct dea_context *ctx, struct dea_panel *panel,
                            const struct dea_result *result, const struct dea_curve *curve,
                            const struct dea_series *model, const int z[2], double factor)
{
  static const char *const words[2] = {"centre", "fibre tip"};
  enum { FULL = 5 }; // from an open marker to the full one of its shape
  bool once = are_equal(curve, z);
  for (int c = 0; c < (once ? 1 : 2) && !dea_figure_leaves_out(result, curve, z[0]); c++) {
    struct dea_series look = *model;
    look.style = c == 0 ? look.style : DEA_LINE_MARKED;
    look.marker += c == 0 ? 0 : FULL;
    size_t n = strlen(look.title);
    snprintf(look.title + n, sizeof look.title - n, ", {/:Italic z}%s%s", once ? "" : " ",
             once ? "" : words[c]);
    DEA_TRY(ctx, dea_figure_add(ctx, panel, curve, z[c], factor, 0.0, &look));
  }
  return DEA_OK;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  const int z[2] = {dea_point_column_find("centre_z_m"), dea_point_column_find("fibre_tip_z_m")};
  const int stretch = dea_point_column_find("electrode_stretch");
  struct dea_panel *strain = &plot->panels[0], *height = &plot->panels[1];
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  double factor = z_factor(result, models, count, z);
  for (size_t m = 0; m < count; m++) {
    const struct dea_curve *curve = dea_figure_curve(result, models[m], false);
    struct dea_series look = dea_figure_model_style(models[m], m);
    struct dea_series strain_look = look;
    size_t n = strlen(look.title);
    snprintf(strain_look.title + n, sizeof look.title - n, ", strain");
    DEA_TRY(ctx, dea_figure_add(ctx, strain, curve, stretch, 100.0, -1.0, &strain_look));
    DEA_TRY(ctx, add_model(ctx, height, result, curve, &look, z, factor));
  }
  plot->panel_count = height->series_count > 0 ? 2 : 1;
  plot->second_height = 0.8;
  snprintf(strain->y_label, sizeof strain->y_label, "Radial strain of the electrode (%%)");
  snprintf(height->y_label, sizeof height->y_label, "Displacement {/:Italic z} (%s)",
           factor < 1e5 ? "mm" : "\302\265m");
  dea_panel_voltage_axis(strain);
  dea_panel_voltage_axis(height);
  height->x_max = strain->x_max; // all models have a strain, and the panels share the axis
  DEA_TRY(ctx, dea_figure_add_events(ctx, strain, result, stretch, 100.0, -1.0, false));
  dea_panel_place_key(strain);
  dea_panel_place_key(height);
  return DEA_OK;
}

const struct dea_figure dea_figure_displacement = {
    .name = "displacement",
    .caption = "radial strain and out-of-plane displacement against the voltage",
    .build = build,
};

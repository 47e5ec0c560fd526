/* Radial strain of the electrode (left axis) and out-of-plane displacement (right axis) against the
 * voltage: the form of Fig 2 of the paper. */
#include "result/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Displacements of less than half a millimetre are read in micrometres. */
static double z_factor(const struct dea_result *result, const int columns[2])
{
  for (size_t i = 0; i < result->curve_count; i++) {
    for (size_t k = 0; k < result->curves[i].count; k++) {
      for (int c = 0; c < 2; c++) {
        bool shown = !dea_figure_leaves_out(result, &result->curves[i], columns[c]);
        if (shown && fabs(dea_point_get(&result->curves[i].points[k], columns[c])) > 0.5e-3) {
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

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  static const char *const words[2] = {"centre", "fibre tip"};
  const int z[2] = {dea_point_column_find("centre_z_m"), dea_point_column_find("fibre_tip_z_m")};
  struct dea_panel *panel = &plot->panels[0];
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  double factor = z_factor(result, z);
  size_t strain_count = 0;
  for (size_t m = 0; m < count; m++) {
    struct dea_series look = dea_figure_style(models[m], m);
    snprintf(look.title + strlen(look.title), sizeof look.title - strlen(look.title), ", strain");
    DEA_TRY(ctx, dea_figure_add(ctx, panel, dea_figure_curve(result, models[m], false),
                                dea_point_column_find("electrode_stretch"), 100.0, -1.0, &look));
  }
  strain_count = panel->series_count;
  // colours that no model's strain has
  static const enum dea_colour colours[] = {DEA_GREEN, DEA_PURPLE, DEA_SKY, DEA_ORANGE, DEA_BLACK};
  enum { COLOURS = sizeof colours / sizeof colours[0] };
  size_t next = count > 2 ? 1 : 0;
  for (size_t m = 0; m < count; m++) {
    const struct dea_curve *curve = dea_figure_curve(result, models[m], false);
    bool once = are_equal(curve, z), out = dea_figure_leaves_out(result, curve, z[0]);
    for (int c = 0; c < (out ? 0 : once ? 1 : 2); c++) {
      struct dea_series look = dea_figure_style(models[m], m);
      look.style = DEA_LINE_MARKED;
      look.colour = colours[next % COLOURS];
      look.marker = 2 + (int)next;
      look.right = true;
      size_t n = strlen(look.title);
      snprintf(look.title + n, sizeof look.title - n, ", {/:Italic z}%s%s", once ? "" : " ",
               once ? "" : words[c]);
      size_t before = panel->series_count;
      DEA_TRY(ctx, dea_figure_add(ctx, panel, curve, z[c], factor, 0.0, &look));
      next += panel->series_count > before;
    }
  }
  if (panel->series_count > strain_count) {
    panel->y2_colour = panel->series_count == strain_count + 1 ? DEA_GREEN : DEA_BLACK;
    snprintf(panel->y2_label, sizeof panel->y2_label, "Out-of-plane displacement {/:Italic z} (%s)",
             factor < 1e5 ? "mm" : "\302\265m");
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Radial strain of the electrode (%%)");
  dea_panel_voltage_axis(panel);
  DEA_TRY(ctx, dea_figure_add_events(ctx, panel, result, dea_point_column_find("electrode_stretch"),
                                     100.0, -1.0, false));
  dea_panel_place_key(panel);
  return DEA_OK;
}

const struct dea_figure dea_figure_displacement = {
    .name = "displacement",
    .caption = "radial strain and out-of-plane displacement against the voltage",
    .build = build,
};

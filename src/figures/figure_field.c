/* True field against the voltage, below the breakdown field where that is known. */
#include "result/figure.h"

#include <math.h>
#include <stdio.h>

/* Largest field [V/m] of a curve. */
static double largest_field(const struct dea_curve *curve)
{
  double largest = 0.0;
  for (size_t i = 0; i < curve->count; i++) {
    largest = fmax(largest, curve->points[i].true_field_V_per_m);
  }
  return largest;
}

/* Breakdown field of a point from its margin, 1 - E/E_b; NAN without field. */
static double breakdown_field(const struct dea_load_point *point)
{
  double share = 1.0 - point->breakdown_margin;
  return share > 1e-9 ? point->true_field_V_per_m / share : NAN;
}

/* Band from the breakdown field up to the top of the figure, with its lower edge as a line. */
static dea_status add_breakdown(struct dea_context *ctx, struct dea_panel *panel,
                                const struct dea_curve *curve, double top)
{
  struct dea_series *band, *line;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, curve->count, DEA_BAND, DEA_VERMILLION, "", &band));
  DEA_TRY(ctx,
          dea_panel_add(ctx, panel, curve->count, DEA_DOTTED, DEA_BLACK, "breakdown field", &line));
  band->to_top = true;
  for (size_t i = 0; i < curve->count; i++) {
    double at = breakdown_field(&curve->points[i]);
    if (!isfinite(at) && i + 1 < curve->count) {
      at = breakdown_field(&curve->points[i + 1]); // 0 V: the film is as good as at the next point
    }
    at *= 1e-6;
    band->values[i] = line->values[i] = 1e-3 * curve->points[i].voltage_V;
    band->values[curve->count + i] = line->values[curve->count + i] = at;
    band->values[2 * curve->count + i] = fmax(at, top);
    panel->y_max = top;
  }
  return DEA_OK;
}

static double largest_breakdown(const struct dea_curve *curve)
{
  double largest = 0.0;
  for (size_t i = 0; i < curve->count; i++) {
    double at = breakdown_field(&curve->points[i]);
    largest = isfinite(at) ? fmax(largest, at) : largest;
  }
  return largest;
}

/* Curve with a breakdown margin that reaches the largest voltage, or NULL: its breakdown field
 * spans the figure (those of the models differ only by their stretch). */
static const struct dea_curve *furthest_curve(const struct dea_result *result,
                                              const char *const models[], size_t count)
{
  const struct dea_curve *furthest = NULL;
  double reached = -1.0;
  for (size_t m = 0; m < count; m++) {
    const struct dea_curve *curve = dea_figure_curve(result, models[m], false);
    if (curve == NULL || largest_breakdown(curve) <= 0.0) {
      continue;
    }
    double last = curve->points[curve->count - 1].voltage_V;
    if (last > reached) {
      reached = last;
      furthest = curve;
    }
  }
  return furthest;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  int column = dea_point_column_find("true_field_V_per_m");
  double top = 0.0;
  for (size_t m = 0; m < count; m++) {
    const struct dea_curve *curve = dea_figure_curve(result, models[m], false);
    if (curve != NULL) {
      top = fmax(top, 1.1e-6 * fmax(largest_field(curve), largest_breakdown(curve)));
    }
  }
  const struct dea_curve *furthest = furthest_curve(result, models, count);
  DEA_TRY(ctx, furthest != NULL ? add_breakdown(ctx, panel, furthest, top) : DEA_OK);
  DEA_TRY(ctx, dea_figure_add_models(ctx, panel, result, column, false));
  snprintf(panel->y_label, sizeof panel->y_label, "True field {/:Italic E} (V/\302\265m)");
  panel->y_min = 0.0;
  panel->key = "at graph 0.03, 0.66 top left";
  dea_panel_voltage_axis(panel);
  return dea_figure_add_events(ctx, panel, result, column, dea_point_columns[column].factor, 0.0,
                               false);
}

const struct dea_figure dea_figure_field = {
    .name = "field",
    .caption = "largest true field and breakdown field against the voltage",
    .build = build,
};

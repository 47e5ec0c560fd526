/* What happens in time: voltage above displacement, force, current. */
#include "output/figure.h"

#include "result/time_series.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Adds a column of a curve against time. Nothing when the curve has no such number. */
static dea_status add(struct dea_context *ctx, struct dea_panel *panel,
                      const struct dea_curve *curve, const char *key, double factor,
                      const struct dea_series *look)
{
  struct dea_series *series;
  int column = dea_point_column_find(key);
  if (!dea_points_have(curve->points, curve->count, column)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, curve->count, look, &series));
  for (size_t i = 0; i < curve->count; i++) {
    series->values[i] = curve->points[i].time_s;
    series->values[curve->count + i] = factor * dea_point_get(&curve->points[i], column);
  }
  return DEA_OK;
}

/* From 0 to the end of the longest curve. */
static void set_time_axis(struct dea_panel *panel)
{
  panel->x_min = 0;
  panel->x_max = 0;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    panel->x_max = fmax(panel->x_max, series->values[series->count - 1]);
  }
  snprintf(panel->x_label, sizeof panel->x_label, "Time {/:Italic t} (s)");
  dea_figure_place_key(panel);
}

/* Many cycles lie close to each other. */
static enum dea_series_style line_of(const struct dea_curve *curve)
{
  enum { FEW = 800 };
  return curve->count > FEW ? DEA_THIN : DEA_LINE;
}

/* One panel with a column of all models. */
static dea_status add_models(struct dea_context *ctx, const struct dea_result *result,
                             struct dea_panel *panel, const char *key, double factor)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    const struct dea_curve *curve = dea_result_find(result, models[m], "transient");
    if (curve != NULL && curve->count > 1) {
      struct dea_series look = dea_figure_style(models[m], m);
      look.style = line_of(curve);
      DEA_TRY(ctx, add(ctx, panel, curve, key, factor, &look));
    }
  }
  return DEA_OK;
}

/* True where the film's voltage is another than that of the supply for long enough to be seen. */
static bool lags(const struct dea_curve *curve)
{
  double area = 0, largest_V = 0;
  for (size_t i = 1; i < curve->count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    area += fabs(p->voltage_V - p->source_voltage_V) * (p->time_s - curve->points[i - 1].time_s);
    largest_V = fmax(largest_V, fabs(p->source_voltage_V));
  }
  return area > 1e-3 * largest_V * curve->points[curve->count - 1].time_s;
}

static dea_status add_voltages(struct dea_context *ctx, const struct dea_curve *curve,
                               struct dea_panel *panel)
{
  struct dea_series look = {.style = line_of(curve), .colour = DEA_BLACK};
  if (lags(curve)) {
    struct dea_series source = {.style = DEA_DASHED, .colour = DEA_GREY};
    snprintf(source.title, sizeof source.title, "supply");
    snprintf(look.title, sizeof look.title, "film");
    DEA_TRY(ctx, add(ctx, panel, curve, "source_voltage_V", 1e-3, &source));
  }
  return add(ctx, panel, curve, "voltage_V", 1e-3, &look);
}

/* Column that shows the motion, and its factor: micrometres below half a millimetre. */
static int motion_of(const struct dea_curve *curve, double *factor)
{
  int column = dea_time_series_column(curve);
  double largest = 0;
  for (size_t i = 0; i < curve->count && column >= 0; i++) {
    double value = fabs(dea_point_get(&curve->points[i], column));
    largest = fmax(largest, isfinite(value) ? value : 0);
  }
  *factor = largest > 0.5e-3 ? 1e3 : 1e6;
  return column;
}

/* First curve in time of the result, or NULL. */
static const struct dea_curve *first_curve(const struct dea_result *result)
{
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    if (strcmp(curve->kind, "transient") == 0 && curve->count > 1) {
      return curve;
    }
  }
  return NULL;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  const struct dea_curve *curve = first_curve(result);
  double factor;
  if (curve == NULL) {
    return DEA_OK;
  }
  int column = motion_of(curve, &factor);
  struct dea_panel *upper = &plot->panels[0], *lower = &plot->panels[1];
  plot->panel_count = column >= 0 ? 2 : 1;
  plot->second_height = 1.0;
  DEA_TRY(ctx, add_voltages(ctx, curve, upper));
  snprintf(upper->y_label, sizeof upper->y_label, "Voltage {/:Italic V} (kV)");
  set_time_axis(upper);
  if (column < 0) {
    return DEA_OK;
  }
  const struct dea_column *c = &dea_point_columns[column];
  DEA_TRY(ctx, add_models(ctx, result, lower, c->key, factor));
  snprintf(lower->y_label, sizeof lower->y_label, "%s (%s)",
           strcmp(c->key, "centre_z_m") == 0 ? "Displacement of the centre {/:Italic z}"
                                             : "Displacement of the edge {/:Italic u}",
           factor < 1e5 ? "mm" : "\302\265m");
  set_time_axis(lower);
  return DEA_OK;
}

static dea_status build_one(struct dea_context *ctx, const struct dea_result *result,
                            struct dea_plot *plot, const char *key, const char *label)
{
  struct dea_panel *panel = &plot->panels[0];
  int column = dea_point_column_find(key);
  DEA_TRY(ctx, add_models(ctx, result, panel, key, dea_point_columns[column].factor));
  snprintf(panel->y_label, sizeof panel->y_label, "%s", label);
  if (panel->series_count > 0) {
    set_time_axis(panel);
  }
  return DEA_OK;
}

static dea_status build_force(struct dea_context *ctx, const struct dea_result *result,
                              struct dea_plot *plot)
{
  return build_one(ctx, result, plot, "force_N", "Out-of-plane force {/:Italic F} (mN)");
}

static dea_status build_current(struct dea_context *ctx, const struct dea_result *result,
                                struct dea_plot *plot)
{
  return build_one(ctx, result, plot, "current_A", "Current {/:Italic I} (\302\265A)");
}

const struct dea_figure dea_figure_history = {
    .name = "history",
    .caption = "voltage and displacement against time",
    .build = build,
};
const struct dea_figure dea_figure_history_force = {
    .name = "history_force",
    .caption = "out-of-plane force against time",
    .build = build_force,
};
const struct dea_figure dea_figure_history_current = {
    .name = "history_current",
    .caption = "current of the supply against time",
    .build = build_current,
};

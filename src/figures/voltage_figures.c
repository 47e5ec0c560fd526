/* Figures of the sweeps and paths against the voltage. */
#include "result/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Radial strain of the electrode, and below it the displacement out of the plane: Fig 2 of the
// paper

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

static dea_status build_displacement(struct dea_context *ctx, const struct dea_result *result,
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
    .build = build_displacement,
};

// Electrode stretch along the whole equilibrium path, with its events

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

static dea_status build_stretch(struct dea_context *ctx, const struct dea_result *result,
                                struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  const int column = dea_point_column_find("electrode_stretch");
  DEA_TRY(ctx, dea_figure_add_models(ctx, panel, result, column, true));
  DEA_TRY(ctx, dea_figure_add_events(ctx, panel, result, column, 1.0, 0.0, true));
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
    .build = build_stretch,
};

// True field, below the breakdown field where that is known

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

static dea_status build_field(struct dea_context *ctx, const struct dea_result *result,
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
    .build = build_field,
};

// Smallest tension and force

/* A column of all models with its events, and where curves come near to 0 a mark with `zero`; NULL:
 * none. */
static dea_status build_column(struct dea_context *ctx, const struct dea_result *result,
                               const char *key, const char *label, const char *zero,
                               struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  const int column = dea_point_column_find(key);
  double low, high;
  DEA_TRY(ctx, dea_figure_add_models(ctx, panel, result, column, false));
  if (panel->series_count == 0) {
    return DEA_OK;
  }
  snprintf(panel->y_label, sizeof panel->y_label, "%s", label);
  dea_panel_voltage_axis(panel);
  if (zero != NULL && dea_panel_range(panel, &low, &high) && low < 0.25 * high) {
    dea_panel_mark(panel, 0, zero);
  }
  DEA_TRY(ctx, dea_figure_add_events(ctx, panel, result, column, dea_point_columns[column].factor,
                                     0.0, false));
  dea_panel_place_key(panel);
  return DEA_OK;
}

static dea_status build_tension(struct dea_context *ctx, const struct dea_result *result,
                                struct dea_plot *plot)
{
  return build_column(ctx, result, "min_tension_N_per_m", "Smallest principal tension (N/m)",
                      "slack below", plot);
}

const struct dea_figure dea_figure_tension = {
    .name = "tension",
    .caption = "smallest principal tension of the film against the voltage",
    .build = build_tension,
};

static dea_status build_force(struct dea_context *ctx, const struct dea_result *result,
                              struct dea_plot *plot)
{
  return build_column(ctx, result, "force_N", "Out-of-plane force {/:Italic F} (mN)", NULL, plot);
}

const struct dea_figure dea_figure_force = {
    .name = "force",
    .caption = "out-of-plane force against the voltage",
    .build = build_force,
};

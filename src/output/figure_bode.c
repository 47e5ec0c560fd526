/* Response to an AC excitation of the voltage: amplitude and phase against the frequency, for each
 * bias. */
#include "output/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLOURS = 6 }; // the first of them
static const double pi = 3.14159265358979323846;

/* Points of a curve from one on that have its bias. */
static size_t count_bias(const struct dea_curve *curve, size_t from)
{
  size_t count = 0;
  while (from + count < curve->count &&
         curve->points[from + count].voltage_V == curve->points[from].voltage_V) {
    count++;
  }
  return count;
}

/* Amplitude in nm into the upper panel, phase in degrees without jumps into the lower one. */
static dea_status add_answer(struct dea_context *ctx, struct dea_plot *plot,
                             const struct dea_load_point *points, size_t count, bool tip,
                             const struct dea_series *look)
{
  double turns = 0, before = 0;
  for (int p = 0; p < 2; p++) {
    struct dea_series *series;
    DEA_TRY(ctx, dea_panel_add_as(ctx, &plot->panels[p], count, look, &series));
    series->title[0] = p == 0 ? series->title[0] : '\0';
    for (size_t i = 0; i < count; i++) {
      double phase = tip ? points[i].fibre_tip_phase_rad : points[i].centre_phase_rad;
      double amplitude = tip ? points[i].fibre_tip_amplitude_m : points[i].centre_amplitude_m;
      turns += i == 0 ? (phase < 0 ? 1 : 0) : round((before - phase) / (2 * pi)) - turns;
      before = phase + 2 * pi * turns;
      series->values[i] = points[i].frequency_Hz;
      series->values[count + i] = p == 0 ? 1e9 * amplitude : before * 180 / pi;
    }
  }
  return DEA_OK;
}

static dea_status add_curve(struct dea_context *ctx, struct dea_plot *plot,
                            const struct dea_curve *curve)
{
  size_t bias = 0;
  for (size_t from = 0; from < curve->count; bias++) {
    const struct dea_load_point *points = curve->points + from;
    size_t count = count_bias(curve, from);
    bool tip = isfinite(points[0].fibre_tip_amplitude_m);
    for (int k = 0; k < (tip ? 2 : 1); k++) {
      struct dea_series look = {.style = k == 0 ? DEA_LINE : DEA_DASHED,
                                .colour = (enum dea_colour)(bias % COLOURS)};
      snprintf(look.title, sizeof look.title, "%.4g kV, %s", 1e-3 * points[0].voltage_V,
               k == 0 ? "centre" : "fibre tip");
      DEA_TRY(ctx, add_answer(ctx, plot, points, count, k == 1, &look));
    }
    from += count;
  }
  return DEA_OK;
}

/* Around the points; above an amplitude with room for the key. */
static void set_limits(struct dea_panel *panel, bool amplitude)
{
  double low = INFINITY, high = -INFINITY;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    panel->x_min = series->values[0];
    panel->x_max = series->values[series->count - 1];
    for (size_t i = 0; i < series->count; i++) {
      low = fmin(low, series->values[series->count + i]);
      high = fmax(high, series->values[series->count + i]);
    }
  }
  panel->y_min = amplitude ? low / 1.5 : 90 * floor(low / 90 - 0.05);
  panel->y_max = amplitude ? high * 1.5 : 90 * ceil(high / 90 + 0.05);
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  double ripple_V = NAN;
  plot->panel_count = 2;
  for (size_t i = 0; i < result->curve_count; i++) {
    if (strcmp(result->curves[i].kind, "frequency") == 0 && result->curves[i].count > 0) {
      ripple_V = result->curves[i].points[0].ripple_V;
      DEA_TRY(ctx, add_curve(ctx, plot, &result->curves[i]));
    }
  }
  for (int p = 0; p < 2; p++) {
    struct dea_panel *panel = &plot->panels[p];
    snprintf(panel->x_label, sizeof panel->x_label, "Frequency {/:Italic f} (Hz)");
    set_limits(panel, p == 0);
    panel->logarithmic = p == 0;
    panel->logarithmic_x = p == 1;
    panel->y_step = p == 1 ? 90 : 0;
  }
  snprintf(plot->panels[0].y_label, sizeof plot->panels[0].y_label, "Amplitude for %.4g V (nm)",
           ripple_V);
  snprintf(plot->panels[1].y_label, sizeof plot->panels[1].y_label, "Phase (degrees)");
  plot->panels[0].key = "top left samplen 2";
  plot->second_height = 0.7;
  return DEA_OK;
}

const struct dea_figure dea_figure_bode = {
    .name = "bode",
    .caption = "displacement that a small AC excitation of the voltage makes, and its phase",
    .build = build,
};

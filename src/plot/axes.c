/* Axes of panels. */
#include "plot/plot.h"

#include <math.h>
#include <stdio.h>

static const double nice[] = {1.0, 2.0, 5.0, 10.0};

/* Smallest of 1, 2, 5 times a power of ten that is not below `least`. */
static double nice_above(double least)
{
  double power = pow(10.0, floor(log10(least)));
  for (size_t i = 0; i < sizeof nice / sizeof nice[0]; i++) {
    if (nice[i] * power >= 0.999 * least) {
      return nice[i] * power;
    }
  }
  return 10.0 * power;
}

struct range {
  double low, high;
};

/* Of series of an axis that are secondary, or that are not. */
static struct range range_of(const struct dea_panel *panel, bool right, bool secondary)
{
  struct range range = {INFINITY, -INFINITY};
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0;
         i < series->count && series->right == right && series->secondary == secondary; i++) {
      double x = series->values[i], y = series->values[series->count + i];
      if (isfinite(y) && !(x < panel->x_min) && !(x > panel->x_max)) {
        range.low = fmin(range.low, y);
        range.high = fmax(range.high, y);
      }
    }
  }
  return range;
}

bool dea_panel_range(const struct dea_panel *panel, bool right, double *low, double *high)
{
  static const double beyond = 0.5;
  struct range own = range_of(panel, right, false), secondary = range_of(panel, right, true);
  double more = own.high > own.low ? beyond * (own.high - own.low) : INFINITY;
  *low = fmin(own.low, fmax(secondary.low, own.low - more));
  *high = fmax(own.high, fmin(secondary.high, own.high + more));
  if (!(own.low <= own.high)) {
    *low = secondary.low;
    *high = secondary.high;
  }
  return *low <= *high;
}

void dea_panel_limit(struct dea_panel *panel)
{
  struct range secondary = range_of(panel, false, true);
  double low, high;
  if (!dea_panel_range(panel, false, &low, &high) || !(high > low)) {
    return;
  }
  double step = nice_above((high - low) / 7);
  if (secondary.low < low && isnan(panel->y_min)) {
    panel->y_min = step * floor(low / step);
  }
  if (secondary.high > high && isnan(panel->y_max)) {
    panel->y_max = step * ceil(high / step);
  }
}

void dea_panel_voltage_axis(struct dea_panel *panel)
{
  static const double noise = 0.01; // of a monitor about 0, of the span
  double lowest = 0.0, largest = 0.0;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count; i++) {
      if (isfinite(series->values[series->count + i])) {
        lowest = fmin(lowest, series->values[i]);
        largest = fmax(largest, series->values[i]);
      }
    }
  }
  const double least = noise * (largest - lowest);
  panel->x_min = lowest < -least ? lowest : 0.0;
  panel->x_max = largest > least ? largest : 0.0;
  if (!(panel->x_max > panel->x_min)) { // gnuplot has no axis from 0 to 0
    panel->x_max = 1.0;
  }
  snprintf(panel->x_label, sizeof panel->x_label, "Voltage {/:Italic V} (kV)");
  dea_panel_limit(panel);
}

void dea_panel_begin_at_zero(struct dea_panel *panel)
{
  double low = 0.0, high = 0.0;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count; i++) {
      low = fmin(low, series->values[series->count + i]); // not NAN
      high = fmax(high, series->values[series->count + i]);
    }
  }
  if (low > -0.08 * high) {
    panel->y_min = fmin(1.2 * low, -0.02 * high);
  }
}

void dea_panel_even_tics(struct dea_panel *panel, int most)
{
  static const char *const formats[] = {"%.0f", "%.1f", "%.2f", "%.3f", "%.4f"};
  double low, high;
  if (!dea_panel_range(panel, false, &low, &high) || !(high > low)) {
    return;
  }
  low = isfinite(panel->y_min) ? fmin(low, panel->y_min) : low; // what is shown may be more
  high = isfinite(panel->y_max) ? fmax(high, panel->y_max) : high;
  panel->y_step = nice_above((high - low) / most);
  int decimals = (int)-floor(log10(panel->y_step) + 1e-9);
  panel->y_format = decimals > 4 ? NULL : formats[decimals > 0 ? decimals : 0];
}

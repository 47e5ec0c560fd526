/* Axes of panels. */
#include "plot/plot.h"

#include <math.h>
#include <stdio.h>

void dea_panel_voltage_axis(struct dea_panel *panel)
{
  double largest = 0.0;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count; i++) {
      bool counts = isfinite(series->values[series->count + i]);
      largest = counts ? fmax(largest, series->values[i]) : largest;
    }
  }
  panel->x_min = 0.0;
  panel->x_max = largest > 0.0 ? largest : NAN;
  snprintf(panel->x_label, sizeof panel->x_label, "Voltage {/:Italic V} (kV)");
}

void dea_panel_even_tics(struct dea_panel *panel, int most)
{
  static const double nice[] = {1.0, 2.0, 5.0, 10.0};
  static const char *const formats[] = {"%.0f", "%.1f", "%.2f", "%.3f", "%.4f"};
  double low = INFINITY, high = -INFINITY;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count && !series->right; i++) {
      double y = series->values[series->count + i];
      low = isfinite(y) ? fmin(low, y) : low;
      high = isfinite(y) ? fmax(high, y) : high;
    }
  }
  if (!(high > low)) {
    return;
  }
  double least = (high - low) / most, power = pow(10.0, floor(log10(least)));
  for (size_t i = 0; i < sizeof nice / sizeof nice[0]; i++) {
    if (nice[i] * power >= 0.999 * least) {
      panel->y_step = nice[i] * power;
      break;
    }
  }
  int decimals = (int)-floor(log10(panel->y_step) + 1e-9);
  panel->y_format = decimals > 4 ? NULL : formats[decimals > 0 ? decimals : 0];
}

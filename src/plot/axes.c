/* Axes of panels, and of drawings. */
#include "plot/axis.h"
#include "plot/plot.h"

#include <math.h>
#include <stdio.h>

/* Smallest of 1, 2, 5 times a power of ten that is not below `least`. */
static double nice_above(double least)
{
  static const double nice[] = {1.0, 2.0, 5.0, 10.0};
  double power = pow(10.0, floor(log10(least)));
  for (size_t i = 0; i < sizeof nice / sizeof nice[0]; i++) {
    if (nice[i] * power >= 0.999 * least) {
      return nice[i] * power;
    }
  }
  return 10.0 * power;
}

void dea_range_widen(struct dea_range *range, double value)
{
  if (isfinite(value)) {
    range->low = fmin(range->low, value);
    range->high = fmax(range->high, value);
  }
}

/* Of series that are secondary, or that are not. */
static struct dea_range range_of(const struct dea_panel *panel, bool secondary)
{
  struct dea_range range = DEA_RANGE_EMPTY;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count && series->secondary == secondary; i++) {
      double x = series->values[i];
      if (!(x < panel->x_min) && !(x > panel->x_max)) {
        dea_range_widen(&range, series->values[series->count + i]);
      }
    }
  }
  return range;
}

bool dea_panel_range(const struct dea_panel *panel, double *low, double *high)
{
  static const double beyond = 0.5;
  struct dea_range own = range_of(panel, false), secondary = range_of(panel, true);
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
  struct dea_range secondary = range_of(panel, true);
  double low, high;
  if (!dea_panel_range(panel, &low, &high) || !(high > low)) {
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
  struct dea_range range = {0.0, 0.0};
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count; i++) {
      dea_range_widen(&range,
                      isfinite(series->values[series->count + i]) ? series->values[i] : NAN);
    }
  }
  const double least = noise * (range.high - range.low);
  panel->x_min = range.low < -least ? range.low : 0.0;
  panel->x_max = range.high > least ? range.high : 0.0;
  if (!(panel->x_max > panel->x_min)) { // gnuplot has no axis from 0 to 0
    panel->x_max = 1.0;
  }
  snprintf(panel->x_label, sizeof panel->x_label, "Voltage {/:Italic V} (kV)");
  dea_panel_limit(panel);
}

void dea_panel_begin_at_zero(struct dea_panel *panel)
{
  struct dea_range range = {0.0, 0.0};
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count; i++) {
      dea_range_widen(&range, series->values[series->count + i]);
    }
  }
  if (range.low > -0.08 * range.high) {
    panel->y_min = fmin(1.2 * range.low, -0.02 * range.high);
  }
}

void dea_panel_even_tics(struct dea_panel *panel, int most)
{
  static const char *const formats[] = {"%.0f", "%.1f", "%.2f", "%.3f", "%.4f"};
  double low, high;
  if (!dea_panel_range(panel, &low, &high) || !(high > low)) {
    return;
  }
  low = isfinite(panel->y_min) ? fmin(low, panel->y_min) : low; // what is shown may be more
  high = isfinite(panel->y_max) ? fmax(high, panel->y_max) : high;
  panel->y_step = nice_above((high - low) / most);
  int decimals = (int)-floor(log10(panel->y_step) + 1e-9);
  panel->y_format = decimals > 4 ? NULL : formats[decimals > 0 ? decimals : 0];
}

// Drawings ----------------------------------------------------------------------------------------

struct dea_axis dea_axis_create(double low, double high, const double fixed[2], bool logarithmic,
                                int most_tics)
{
  if (!(high >= low)) { // nothing to show
    low = 0;
    high = 1;
  }
  low = isfinite(fixed[0]) ? fixed[0] : low;
  high = isfinite(fixed[1]) ? fixed[1] : high;
  struct dea_axis axis = {.low = low, .high = high, .logarithmic = logarithmic, .step = 1};
  if (logarithmic) {
    axis.low = pow(10, floor(log10(fmax(low, 1e-30)) + 1e-9));
    axis.high = pow(10, ceil(log10(fmax(high, 1e-30)) - 1e-9));
    axis.high = axis.high > axis.low ? axis.high : 10 * axis.low;
    return axis;
  }
  if (high - low <= 1e-12 * fmax(fabs(high), fabs(low))) { // one value: room on both sides
    double capacity = high != 0 ? 0.1 * fabs(high) : 1;
    axis.low = low -= capacity;
    axis.high = high += capacity;
  }
  axis.step = nice_above((high - low) / most_tics);
  if (!isfinite(fixed[0])) {
    axis.low = axis.step * floor(low / axis.step + 1e-9);
  }
  if (!isfinite(fixed[1])) {
    axis.high = axis.step * ceil(high / axis.step - 1e-9);
  }
  return axis;
}

double dea_axis_place(const struct dea_axis *axis, double value)
{
  double share = axis->logarithmic ? log(value / axis->low) / log(axis->high / axis->low)
                                   : (value - axis->low) / (axis->high - axis->low);
  return axis->at_low + share * (axis->at_high - axis->at_low);
}

bool dea_axis_tic(const struct dea_axis *axis, int i, double *value)
{
  if (axis->logarithmic) {
    *value = axis->low * pow(10, i);
    return *value <= axis->high * (1 + 1e-9);
  }
  double first = ceil(axis->low / axis->step - 1e-9);
  *value = (first + i) * axis->step;
  return *value <= axis->high + 1e-9 * axis->step && i < 100;
}

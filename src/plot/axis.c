#include "plot/axis.h"

#include <math.h>

static double nice_step(double span, int most)
{
  static const double nice[] = {1, 2, 5, 10};
  double least = span / most, power = pow(10, floor(log10(least)));
  for (int i = 0; i < 4; i++) {
    if (nice[i] * power >= 0.999 * least) {
      return nice[i] * power;
    }
  }
  return 10 * power;
}

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
  axis.step = nice_step(high - low, most_tics);
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

#include "study/number_rows.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void dea_number_text(double value, const char *unit, char *out, size_t size)
{
  static const struct {
    const char *unit, *shown;
    double least, factor;
  } scales[] = {{"m", " mm", 0.9995e-3, 1e3},
                {"m", " um", 0, 1e6},
                {"N", " mN", 0, 1e3},
                {"Pa", " MPa", 1e6, 1e-6},
                {"Pa", " kPa", 1e3, 1e-3},
                {"V", " kV", 1e3, 1e-3},
                {"1", "", 0, 1}};
  for (size_t i = 0; i < DEA_COUNT(scales); i++) {
    if (strcmp(unit, scales[i].unit) == 0 && fabs(value) >= scales[i].least) {
      snprintf(out, size, "%.5g%s", scales[i].factor * value, scales[i].shown);
      return;
    }
  }
  snprintf(out, size, "%.5g %.20s", value, unit);
}

struct dea_tolerated dea_number_tolerated(const struct dea_design_number *number, double slope,
                                          const char *unit)
{
  struct dea_tolerated out = {"", ""};
  if (number->tolerance > 0) {
    dea_number_text(number->tolerance, number->unit, out.tolerance, sizeof out.tolerance);
    dea_number_text(slope * number->tolerance, unit, out.change, sizeof out.change);
  }
  return out;
}

size_t dea_numbers_order(const double *sizes, size_t count, size_t *order)
{
  size_t placed = 0;
  for (size_t i = 0; i < count; i++) {
    if (sizes[i] > 0) { // not of NAN
      size_t at = placed++;
      for (; at > 0 && sizes[order[at - 1]] < sizes[i]; at--) {
        order[at] = order[at - 1];
      }
      order[at] = i;
    }
  }
  return placed;
}

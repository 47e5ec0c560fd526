#include "reduce/reduce_parts.h"

/* Slope of z over |r| for the points of one side from low to high, and its variance. false: fewer
 * than 5 points. */
static bool side_slope(const double *r, const double *z, size_t points, double side, double low,
                       double high, double *work, double *slope, double *variance)
{
  double *x = work, *y = work + points, uncertainty;
  size_t n = 0;
  for (size_t i = 0; i < points; i++) {
    double distance = side * r[i];
    if (distance >= low && distance <= high && !isnan(z[i])) {
      x[n] = distance;
      y[n++] = z[i];
    }
  }
  if (n < 5) {
    return false;
  }
  dea_line_fit(x, y, n, slope, &uncertainty);
  *variance = uncertainty * uncertainty;
  return true;
}

double dea_shape_index(const double *r_m, const double *z_m, size_t points,
                       double electrode_radius_m, double film_radius_m, double *work,
                       double *uncertainty)
{
  double a = electrode_radius_m, inner = 0.0, outer = 0.0, inner_variance = 0.0,
         outer_variance = 0.0;
  *uncertainty = NAN;
  if (!(a > 0.0) || !(film_radius_m > a)) {
    return NAN;
  }
  for (int k = 0; k < 2; k++) {
    double side = k == 0 ? -1.0 : 1.0, slope, variance;
    if (!side_slope(r_m, z_m, points, side, 0.1 * a, 0.9 * a, work, &slope, &variance)) {
      return NAN;
    }
    inner += 0.5 * slope;
    inner_variance += 0.25 * variance;
    double from = 1.1 * a, to = film_radius_m - 0.1 * (film_radius_m - a);
    if (!side_slope(r_m, z_m, points, side, from, to, work, &slope, &variance)) {
      return NAN;
    }
    outer += 0.5 * slope;
    outer_variance += 0.25 * variance;
  }
  if (!(fabs(outer) > 5.0 * sqrt(outer_variance))) { // nothing that moved
    return NAN;
  }
  double index = inner / outer;
  *uncertainty = sqrt(inner_variance + index * index * outer_variance) / fabs(outer);
  return index;
}

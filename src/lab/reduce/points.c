#include "lab/reduce/reduce_parts.h"

enum { HALF = 5 };                // of the running median: 11 points
static const double beyond = 5.0; // spreads; an outlier

void dea_points_clean(struct dea_levelling *levelling, const double *x_m, const double *z_m,
                      size_t points, double offset_m, double *work, double *out)
{
  const struct dea_levelling *l = levelling;
  double slope = tan(l->tilt_rad), *median = work, *off = work + points;
  double margin = l->by_frame ? 0.005 * (l->edges_m[1] - l->edges_m[0]) : 0.0;
  size_t n = 0;
  for (size_t i = 0; i < points; i++) {
    bool film = x_m[i] >= l->edges_m[0] + margin && x_m[i] <= l->edges_m[1] - margin;
    out[i] = film ? z_m[i] - offset_m - slope * (x_m[i] - l->centre_m) : NAN;
    levelling->total += film;
    levelling->invalid += film && isnan(z_m[i]);
  }
  dea_running_median(out, points, HALF, median);
  for (size_t i = 0; i < points; i++) {
    if (!isnan(out[i])) {
      off[n++] = out[i] - median[i];
    }
  }
  double limit = beyond * dea_spread(off, n, 0.0);
  for (size_t i = 0; i < points && limit > 0.0; i++) {
    if (fabs(out[i] - median[i]) > limit) {
      out[i] = NAN;
      levelling->outliers++;
    }
  }
}

double dea_points_value(const double *x_m, const double *z_m, size_t points, double x,
                        double width_m)
{
  size_t low = 0, high = points, all = 0;
  double n = 0.0, su = 0.0, sz = 0.0, suu = 0.0, suz = 0.0;
  while (low < high) { // first point within
    size_t middle = low + (high - low) / 2;
    if (x_m[middle] < x - 0.5 * width_m) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  for (size_t i = low; i < points && x_m[i] <= x + 0.5 * width_m; i++, all++) {
    if (!isnan(z_m[i])) {
      double u = x_m[i] - x;
      n += 1.0;
      su += u;
      sz += z_m[i];
      suu += u * u;
      suz += u * z_m[i];
    }
  }
  if (n == 0.0 || 2.0 * n < (double)all) {
    return NAN;
  }
  double spread = suu - su * su / n;
  bool sloped = n >= 3.0 && spread > 0.0;
  return (sz - (sloped ? (suz - su * sz / n) / spread * su : 0.0)) / n;
}

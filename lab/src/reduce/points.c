/* Points of a frame: what is no part of the film is left out, heights are read off the rest. */
#include "reduce/reduce_parts.h"

enum { HALF = 5, SIDE = 7 };      // of the running median: 11 points; of a line on one side
static const double beyond = 5.0; // standard deviations of a line's end against a point; an outlier

/* Standard deviation of the points' noise, by what three neighbours are off a straight line: slopes
 * and kinks of the film count little. NAN without any. work: [points]. */
static double noise_of(const double *x_m, const double *z_m, size_t points, double *work)
{
  size_t n = 0;
  for (size_t i = 1; i + 1 < points; i++) {
    double w = (x_m[i] - x_m[i - 1]) / (x_m[i + 1] - x_m[i - 1]);
    double off = z_m[i] - (1.0 - w) * z_m[i - 1] - w * z_m[i + 1];
    if (!isnan(off)) {
      work[n++] = off / sqrt(1.0 + (1.0 - w) * (1.0 - w) + w * w);
    }
  }
  return dea_spread(work, n, 0.0);
}

/* What the points on one side (step -1 or 1) of point i say of it: the median of the slopes between
 * any two of them, and the median of what each of them says with it. NAN with fewer than 3. */
static double seen_from(const double *x_m, const double *z_m, size_t points, size_t i, int step)
{
  double x[SIDE], z[SIDE], slopes[SIDE * (SIDE - 1) / 2], heights[SIDE];
  size_t n = 0, pairs = 0;
  for (size_t k = 1; k <= SIDE && (step < 0 ? i >= k : i + k < points); k++) {
    size_t j = step < 0 ? i - k : i + k;
    if (!isnan(z_m[j])) {
      x[n] = x_m[j] - x_m[i];
      z[n++] = z_m[j];
    }
  }
  for (size_t a = 0; a < n; a++) {
    for (size_t b = 0; b < a; b++) {
      slopes[pairs++] = (z[a] - z[b]) / (x[a] - x[b]);
    }
  }
  double slope = dea_median(slopes, pairs);
  for (size_t k = 0; k < n; k++) {
    heights[k] = z[k] - slope * x[k];
  }
  return n < 3 ? NAN : dea_median(heights, n);
}

/* True when a point fits neither of its sides. At a kink, where the running median is off, it fits
 * both; on a flank the running median alone would find nothing. */
static bool fits_nowhere(const double *x_m, const double *z_m, size_t points, size_t i,
                         double limit_m)
{
  double left = fabs(z_m[i] - seen_from(x_m, z_m, points, i, -1));
  double right = fabs(z_m[i] - seen_from(x_m, z_m, points, i, 1));
  return !(left <= limit_m) && !(right <= limit_m);
}

void dea_points_clean(struct dea_levelling *levelling, const double *x_m, const double *z_m,
                      size_t points, double offset_m, double *work, double *out)
{
  const struct dea_levelling *l = levelling;
  double slope = tan(l->tilt_rad), *median = work, *off = work + points;
  double margin = l->by_frame ? 0.005 * (l->edges_m[1] - l->edges_m[0]) : 0.0;
  for (size_t i = 0; i < points; i++) {
    bool film = x_m[i] >= l->edges_m[0] + margin && x_m[i] <= l->edges_m[1] - margin;
    out[i] = film ? z_m[i] - offset_m - slope * (x_m[i] - l->centre_m) : NAN;
    levelling->total += film;
    levelling->invalid += film && isnan(z_m[i]);
  }
  dea_running_median(out, points, HALF, median);
  // a line through SIDE points is at its end about as uncertain as one of them
  double limit = beyond * sqrt(2.0) * noise_of(x_m, out, points, off);
  size_t n = 0;
  for (size_t i = 0; i < points && limit > 0.0; i++) {
    if (fabs(out[i] - median[i]) > limit && fits_nowhere(x_m, out, points, i, limit)) {
      off[n++] = (double)i;
    }
  }
  for (size_t k = 0; k < n; k++) { // afterwards: each was judged by the same neighbours
    out[(size_t)off[k]] = NAN;
  }
  levelling->outliers += n;
}

/* Straight line through some points. */
struct line {
  double n, su, sz, suu, suz;
  size_t all;
};

static void line_add(struct line *line, double u, double z)
{
  line->all++;
  if (!isnan(z)) {
    line->n += 1.0;
    line->su += u;
    line->sz += z;
    line->suu += u * u;
    line->suz += u * z;
  }
}

/* Height at u = 0: by the line, by the mean when there are fewer than 3 points, NAN when fewer than
 * half are valid. */
static double line_end(const struct line *line)
{
  double n = line->n, spread = n > 0.0 ? line->suu - line->su * line->su / n : 0.0;
  if (n == 0.0 || 2.0 * n < (double)line->all) {
    return NAN;
  }
  bool sloped = n >= 3.0 && spread > 0.0;
  double slope = sloped ? (line->suz - line->su * line->sz / n) / spread : 0.0;
  return (line->sz - slope * line->su) / n;
}

double dea_points_value(const double *x_m, const double *z_m, size_t points, double x,
                        double width_m)
{
  size_t low = 0, high = points;
  struct line sides[2] = {{0}}, both = {0};
  while (low < high) { // first point within
    size_t middle = low + (high - low) / 2;
    if (x_m[middle] < x - 0.5 * width_m) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  for (size_t i = low; i < points && x_m[i] <= x + 0.5 * width_m; i++) {
    line_add(&sides[x_m[i] >= x], x_m[i] - x, z_m[i]);
    line_add(&both, x_m[i] - x, z_m[i]);
  }
  return sides[0].n >= 3.0 && sides[1].n >= 3.0 ? 0.5 * (line_end(&sides[0]) + line_end(&sides[1]))
                                                : line_end(&both);
}

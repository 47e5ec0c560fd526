#include "reduce/reduce_parts.h"

#include <string.h>

/* The valid points of a profile, without gaps. */
struct valid {
  double *x, *z, *sorted; // [n], [n], room for [n]
  size_t n, k;            // k: points on each side that a step is seen with
};

static double median_of(const struct valid *v, size_t begin, size_t end)
{
  memcpy(v->sorted, v->z + begin, (end - begin) * sizeof *v->sorted);
  return dea_median(v->sorted, end - begin);
}

/* Step up, to the right, between points i - 1 and i. */
static double step_at(const struct valid *v, size_t i)
{
  return median_of(v, i, i + v->k) - median_of(v, i - v->k, i);
}

/* Largest step up to the right (sign 1) or to the left (-1) at x from low to high; 0: none. */
static size_t best_step(const struct valid *v, double sign, double low, double high)
{
  size_t best = 0;
  double largest = 0.0;
  for (size_t i = v->k; i + v->k <= v->n; i++) {
    if (v->x[i] >= low && v->x[i] <= high) {
      double step = sign * step_at(v, i);
      if (step > largest) {
        largest = step;
        best = i;
      }
    }
  }
  return best;
}

static double lower_step(const struct valid *v, const size_t pair[2])
{
  return pair[0] == 0 || pair[1] <= pair[0] ? 0.0 : fmin(-step_at(v, pair[0]), step_at(v, pair[1]));
}

/* Two edges. Where their distance is known (a chord is shorter than the diameter), each side's best
 * one takes the best partner at that distance. */
static void find_pair(const struct valid *v, double radius_m, size_t pair[2])
{
  double first = v->x[0], last = v->x[v->n - 1];
  pair[0] = best_step(v, -1.0, first, last);
  pair[1] = best_step(v, 1.0, first, last);
  if (isnan(radius_m)) {
    return;
  }
  double low = 1.8 * radius_m, high = 2.06 * radius_m;
  double apart = v->x[pair[1]] - v->x[pair[0]];
  if (pair[0] > 0 && pair[1] > 0 && apart >= low && apart <= high) {
    return;
  }
  size_t with_left[2] = {pair[0], 0}, with_right[2] = {0, pair[1]};
  with_left[1] = best_step(v, 1.0, v->x[pair[0]] + low, v->x[pair[0]] + high);
  with_right[0] = best_step(v, -1.0, v->x[pair[1]] - high, v->x[pair[1]] - low);
  const size_t *better =
      lower_step(v, with_left) > lower_step(v, with_right) ? with_left : with_right;
  memcpy(pair, better, 2 * sizeof *pair);
}

/* Where the profile is half way up: so that most points before it are below and most behind it
 * above, which an outlier does not shift. The middle of a gap in which that lies. */
static double refine(const struct valid *v, size_t i, double sign)
{
  double half = 0.5 * (median_of(v, i - v->k, i) + median_of(v, i, i + v->k));
  double pitch = (v->x[v->n - 1] - v->x[0]) / (double)(v->n - 1);
  ptrdiff_t right = 0, most = -1; // more points below than above before the place
  size_t best = i;
  for (size_t a = i - v->k; a + 1 < i + v->k; a++) {
    right += sign * (v->z[a] - half) < 0.0 ? 1 : -1;
    if (right > most) {
      most = right;
      best = a;
    }
  }
  double p = v->z[best] - half, q = v->z[best + 1] - half, gap = v->x[best + 1] - v->x[best];
  bool crosses = p * q < 0.0 && gap <= 3.0 * pitch;
  return v->x[best] + gap * (crosses ? p / (p - q) : 0.5);
}

/* Range of the film between the edges without its straight line, and its noise. */
static void film_range(const struct valid *v, const size_t pair[2], double *range, double *noise)
{
  size_t n = 0, begin = pair[0] + v->k, end = pair[1] - v->k;
  for (size_t i = begin + 1; i + 1 < end; i++) {
    v->sorted[n++] = v->z[i - 1] - 2.0 * v->z[i] + v->z[i + 1];
  }
  *noise = n > 0 ? dea_spread(v->sorted, n, 0.0) / sqrt(6.0) : 0.0;
  double za = median_of(v, begin, begin + v->k), zb = median_of(v, end - v->k, end);
  n = 0;
  for (size_t i = begin; i < end; i++) {
    double share = (v->x[i] - v->x[begin]) / (v->x[end - 1] - v->x[begin]);
    v->sorted[n++] = v->z[i] - za - share * (zb - za);
  }
  *range = dea_quantile(v->sorted, n, 0.95);
  *range -= dea_quantile(v->sorted, n, 0.05);
}

bool dea_frame_edges(const double *x_m, const double *z_m, size_t points, double radius_m,
                     double *work, double edges_m[2], double *height_m)
{
  struct valid v = {.x = work, .z = work + points, .sorted = work + 2 * points};
  for (size_t i = 0; i < points; i++) {
    if (!isnan(z_m[i])) {
      v.x[v.n] = x_m[i];
      v.z[v.n++] = z_m[i];
    }
  }
  v.k = v.n / 50 > 5 ? v.n / 50 : 5;
  edges_m[0] = edges_m[1] = *height_m = NAN;
  if (v.n < 8 * v.k) {
    return false;
  }
  size_t pair[2];
  double range, noise;
  find_pair(&v, radius_m, pair);
  double height = lower_step(&v, pair);
  if (!(height > 0.0) || pair[1] - pair[0] < 4 * v.k) {
    return false;
  }
  double apart = v.x[pair[1]] - v.x[pair[0]];
  film_range(&v, pair, &range, &noise);
  if (!(height > 10.0 * noise && height > 2.0 * range) ||
      (!isnan(radius_m) && (apart < 1.75 * radius_m || apart > 2.1 * radius_m))) {
    return false;
  }
  edges_m[0] = refine(&v, pair[0], -1.0);
  edges_m[1] = refine(&v, pair[1], 1.0);
  *height_m = 0.5 * (step_at(&v, pair[1]) - step_at(&v, pair[0]));
  return true;
}

#include "reduce/reduce_parts.h"

/* Share of a frame's half width that lies between its inner edge and what is taken for its top. */
static const double top_begin = 0.01, top_end = 0.12;

/* True for points on the top of the frame, or, without one, on the film's outer part. */
static bool supports(const struct dea_levelling *l, double x)
{
  double half = 0.5 * (l->edges_m[1] - l->edges_m[0]);
  double outside = fmax(l->edges_m[0] - x, x - l->edges_m[1]);
  return l->by_frame ? outside >= top_begin * half && outside <= top_end * half
                     : outside <= 0.0 && outside >= -0.15 * half;
}

/* Straight line z = a + b (x - centre) through the points that support, those far off left out in
 * turn: a bevel, a cable. false: too few, or on one side only. */
static bool robust_line(const struct dea_levelling *l, const double *x, const double *z,
                        size_t points, double *work, double *a, double *b)
{
  double limit = INFINITY, middle = 0.5 * (l->edges_m[0] + l->edges_m[1]);
  *a = *b = 0.0;
  for (int pass = 0; pass < 8; pass++) {
    double n[2] = {0}, sx = 0, sz = 0, sxx = 0, sxz = 0;
    size_t m = 0;
    for (size_t i = 0; i < points; i++) {
      double u = x[i] - l->centre_m, off = z[i] - *a - *b * u;
      if (supports(l, x[i]) && fabs(off) <= limit) {
        n[x[i] > middle] += 1.0;
        sx += u;
        sz += z[i];
        sxx += u * u;
        sxz += u * z[i];
      }
    }
    double all = n[0] + n[1], spread = sxx - sx * sx / all;
    if (n[0] < 3.0 || n[1] < 3.0 || !(spread > 0.0)) {
      return false;
    }
    *b = (sxz - sx * sz / all) / spread;
    *a = (sz - *b * sx) / all;
    for (size_t i = 0; i < points; i++) {
      if (supports(l, x[i]) && !isnan(z[i])) {
        work[m++] = z[i] - *a - *b * (x[i] - l->centre_m);
      }
    }
    limit = 4.0 * dea_spread(work, m, 0.0);
    if (!(limit > 0.0)) {
      break;
    }
  }
  return true;
}

/* Middle of what moves: between the two places at half of the largest displacement. NAN without. */
static double moving_middle(const double *x, const double *moved, size_t points, double *work)
{
  double ends[2] = {NAN, NAN};
  dea_running_median(moved, points, 5, work);
  double peak = 0.0;
  for (size_t i = 0; i < points; i++) {
    peak = fabs(work[i]) > fabs(peak) ? work[i] : peak;
  }
  for (size_t i = 0; i < points && peak != 0.0; i++) {
    if (work[i] / peak >= 0.5) {
      ends[0] = isnan(ends[0]) ? x[i] : ends[0];
      ends[1] = x[i];
    }
  }
  return 0.5 * (ends[0] + ends[1]);
}

/* Without a frame: the ends of the picture are the ends of the film. */
static void without_frame(const double *x, const double *rest, const double *moved, size_t points,
                          double *work, struct dea_levelling *l)
{
  size_t first = 0, last = points - 1;
  while (first < last && isnan(rest[first])) {
    first++;
  }
  while (last > first && isnan(rest[last])) {
    last--;
  }
  l->centre_m = moved != NULL ? moving_middle(x, moved, points, work) : NAN;
  if (!(l->centre_m > x[first] && l->centre_m < x[last])) {
    l->centre_m = 0.5 * (x[first] + x[last]);
  }
  l->edges_m[0] = x[first];
  l->edges_m[1] = x[last];
  if (!isnan(l->film_radius_m)) {
    l->edges_m[0] = fmax(l->edges_m[0], l->centre_m - l->film_radius_m);
    l->edges_m[1] = fmin(l->edges_m[1], l->centre_m + l->film_radius_m);
  }
}

dea_status dea_levelling_find(struct dea_context *ctx, const double *x_m, const double *rest,
                              const double *moved, size_t points, struct dea_levelling *levelling)
{
  struct dea_levelling *l = levelling;
  double *work = dea_alloc(ctx, points, 3 * sizeof *work), slope;
  DEA_TRY_MEMORY(work != NULL);
  l->by_frame =
      dea_frame_edges(x_m, rest, points, l->film_radius_m, work, l->edges_m, &l->frame_height_m);
  l->beside_m = NAN;
  if (l->by_frame) {
    double half = 0.5 * (l->edges_m[1] - l->edges_m[0]);
    l->centre_m = 0.5 * (l->edges_m[0] + l->edges_m[1]);
    l->beside_m = half < l->film_radius_m ? sqrt(l->film_radius_m * l->film_radius_m - half * half)
                  : isnan(l->film_radius_m) ? NAN
                                            : 0.0;
    l->film_radius_m = isnan(l->film_radius_m) ? half : l->film_radius_m;
    l->by_frame = robust_line(l, x_m, rest, points, work, &l->offset_m, &slope);
  }
  if (!l->by_frame) {
    l->frame_height_m = NAN;
    without_frame(x_m, rest, moved, points, work, l);
    if (!robust_line(l, x_m, rest, points, work, &l->offset_m, &slope)) {
      l->offset_m = slope = 0.0;
    }
  }
  l->tilt_rad = atan(slope);
  dea_free(ctx, work);
  return DEA_OK;
}

double dea_levelling_offset(const struct dea_levelling *levelling, const double *x_m,
                            const double *z_m, size_t points, double *work)
{
  size_t n = 0;
  double slope = tan(levelling->tilt_rad);
  for (size_t i = 0; i < points; i++) {
    if (!isnan(z_m[i]) && supports(levelling, x_m[i])) {
      work[n++] = z_m[i] - slope * (x_m[i] - levelling->centre_m);
    }
  }
  return n >= 5 ? dea_median(work, n) : NAN;
}

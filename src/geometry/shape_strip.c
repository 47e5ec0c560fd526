/* Shape "strip": a band of constant width along straight lines from point to point. Its outer
 * corners are arcs about the points, its inner ones sharp, its ends straight. From the first point
 * back to it, it is closed: an outline with a hole. */
#include "geometry/shape.h"

#include <math.h>

struct strip {
  const double (*point)[2];
  size_t count; // of points, without the repeated one
  bool closed;
  double half; // of the width
  struct dea_location location;
  struct dea_vertex *v;
  size_t v_count;
};

/* Unit vector from point i on, and the length. */
static double direction(const struct strip *s, size_t i, double out[2])
{
  const double *p = s->point[i % s->count], *q = s->point[(i + 1) % s->count];
  double length = hypot(q[0] - p[0], q[1] - p[1]);
  out[0] = (q[0] - p[0]) / length;
  out[1] = (q[1] - p[1]) / length;
  return length;
}

static void add_vertex(struct strip *s, const double at[2], double x, double y, double bulge)
{
  s->v[s->v_count++] =
      (struct dea_vertex){at[0] + s->half * x, at[1] + s->half * y, bulge, s->location};
}

/* The corner at a point between directions a and b, on the side of the normals that point to the
 * right of the way: an arc where the way turns left, else the crossing of both sides. */
static bool add_corner(struct strip *s, const double at[2], const double a[2], const double b[2],
                       double shorter)
{
  double sine = a[0] * b[1] - a[1] * b[0], cosine = a[0] * b[0] + a[1] * b[1];
  double turn = atan2(sine, cosine);
  if (fabs(turn) > 3.1) {
    return false;
  }
  if (turn > 1e-12) {
    add_vertex(s, at, a[1], -a[0], tan(0.25 * turn));
    add_vertex(s, at, b[1], -b[0], 0);
    return true;
  }
  add_vertex(s, at, (a[1] + b[1]) / (1 + cosine), -(a[0] + b[0]) / (1 + cosine), 0);
  return s->half * tan(0.5 * fabs(turn)) < shorter;
}

/* One side, forwards (on the right) or backwards. NULL, or the point at which it cannot be made. */
static const double *add_side(struct strip *s, bool back)
{
  size_t n = s->count;
  for (size_t k = 0; k < n; k++) {
    size_t i = back ? n - 1 - k : k;
    double before[2] = {0, 0}, after[2] = {0, 0}, length = 0, other = 0;
    bool starts = !s->closed && i == 0, ends = !s->closed && i == n - 1;
    if (!starts) {
      length = direction(s, i + n - 1, before);
    }
    if (!ends) {
      other = direction(s, i, after);
    }
    double sign = back ? -1 : 1;
    if (starts) {
      add_vertex(s, s->point[i], sign * after[1], -sign * after[0], 0);
    } else if (ends) {
      add_vertex(s, s->point[i], sign * before[1], -sign * before[0], 0);
    } else {
      double in[2] = {before[0], before[1]}, out[2] = {after[0], after[1]};
      for (int c = 0; c < 2 && back; c++) {
        in[c] = -after[c];
        out[c] = -before[c];
      }
      if (!add_corner(s, s->point[i], in, out, fmin(length, other))) {
        return s->point[i];
      }
    }
  }
  return NULL;
}

static dea_status build(struct strip *s, struct dea_region *own)
{
  size_t sides[2] = {0, 0};
  for (int back = 0; back < 2; back++) {
    size_t first = s->v_count;
    const double *at = add_side(s, back == 1);
    if (at != NULL) {
      return dea_region_fault(own->ctx, s->location, at[0], at[1],
                              "the strip is too wide for its corner");
    }
    sides[back] = s->v_count - first;
  }
  if (!s->closed) {
    dea_region_add(own, s->v, s->v_count);
    return dea_region_status(own);
  }
  // the outline first: on the right of a way that goes counter-clockwise
  const struct dea_contour right = {s->v, sides[0], true};
  bool first = dea_contour_area_m2(&right) > 0;
  dea_region_add(own, s->v + (first ? 0 : sides[0]), sides[first ? 0 : 1]);
  dea_region_add(own, s->v + (first ? sides[0] : 0), sides[first ? 1 : 0]);
  return dea_region_status(own);
}

static dea_status add_strip(struct dea_region *region, const double *value,
                            const double (*point_m)[2], size_t point_count,
                            struct dea_location location)
{
  const double *last = point_m[point_count - 1];
  struct strip s = {
      .point = point_m, .count = point_count, .half = 0.5 * value[0], .location = location};
  s.closed = point_count > 3 && last[0] == point_m[0][0] && last[1] == point_m[0][1];
  s.count -= s.closed;
  for (size_t i = 0; i + 1 < point_count; i++) {
    if (point_m[i][0] == point_m[i + 1][0] && point_m[i][1] == point_m[i + 1][1]) {
      return dea_region_fault(region->ctx, location, last[0], last[1],
                              "two points of the strip lie on each other");
    }
  }
  struct dea_region own = {.ctx = region->ctx};
  s.v = dea_alloc(region->ctx, 4 * point_count, sizeof *s.v);
  dea_status status = s.v != NULL ? build(&s, &own) : DEA_E_MEMORY;
  status = status == DEA_OK ? dea_region_add_checked(region, &own) : status;
  dea_region_free(&own);
  dea_free(region->ctx, s.v);
  return status;
}

static const struct dea_shape_parameter strip[] = {
    {"width", DEA_SHAPE_LENGTH, false, "across the line"}};

const struct dea_shape_type dea_shape_strip = {
    .name = "strip",
    .doc = "a band along straight lines, with round outer corners and straight ends",
    .parameter = strip,
    .count = 1,
    .points_min = 2,
    .points_doc = "its middle line; closed when the last point is the first one",
    .add = add_strip,
};

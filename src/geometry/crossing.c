/* Where lines and circles cross, by closed forms (docs/theory/geometry.md). */
#include "geometry/contour.h"

#include <math.h>

/* Half of the chord that a line or circle at a distance cuts off a circle: sqrt(r^2 - off^2), 0 for
 * what is tangent; -1 for what passes by. */
static double half_chord(double radius, double off, double tolerance)
{
  double rest = radius * radius - off * off;
  if (fabs(fabs(off) - radius) <= tolerance && tolerance > 0) {
    return 0;
  }
  return rest < 0 ? -1 : sqrt(rest);
}

/* A circle with a line through `at` along the unit vector t. */
static int line_circle(const double at[2], const double t[2], const double centre[2], double radius,
                       double tolerance, double out[2][2])
{
  double px = at[0] - centre[0], py = at[1] - centre[1];
  double along = px * t[0] + py * t[1], off = px * t[1] - py * t[0];
  double half = half_chord(radius, off, tolerance);
  if (half < 0) {
    return 0;
  }
  for (int k = 0; k < 2; k++) {
    double s = -along + (k == 0 ? -1 : 1) * half;
    out[k][0] = at[0] + s * t[0];
    out[k][1] = at[1] + s * t[1];
  }
  return half == 0 && tolerance > 0 ? 1 : 2;
}

static int circle_circle(const struct dea_piece *a, const struct dea_piece *b, double tolerance,
                         double out[2][2])
{
  double dx = b->centre[0] - a->centre[0], dy = b->centre[1] - a->centre[1], d = hypot(dx, dy);
  if (d == 0 || (d <= tolerance && fabs(a->radius_m - b->radius_m) <= tolerance)) {
    return 0;
  }
  double along = 0.5 * (d + (a->radius_m * a->radius_m - b->radius_m * b->radius_m) / d);
  double rest = a->radius_m * a->radius_m - along * along;
  bool touch = tolerance > 0 && (fabs(d - a->radius_m - b->radius_m) <= tolerance ||
                                 fabs(d - fabs(a->radius_m - b->radius_m)) <= tolerance);
  if (rest < 0 && !touch) {
    return 0;
  }
  if (touch) {
    along = copysign(a->radius_m, along);
  }
  for (int k = 0; k < 2; k++) {
    double across = touch ? 0 : (k == 0 ? -1 : 1) * sqrt(rest);
    out[k][0] = a->centre[0] + (along * dx - across * dy) / d;
    out[k][1] = a->centre[1] + (along * dy + across * dx) / d;
  }
  return touch ? 1 : 2;
}

int dea_piece_crossings(const struct dea_piece *a, const struct dea_piece *b, double tolerance_m,
                        double out[2][2])
{
  double ta[2], tb[2];
  if (a->arc && b->arc) {
    return circle_circle(a, b, tolerance_m, out);
  }
  if (!a->arc) {
    dea_piece_tangent(a, true, ta);
  }
  if (!b->arc) {
    dea_piece_tangent(b, false, tb);
  }
  if (a->arc) {
    return line_circle(b->from, tb, a->centre, a->radius_m, tolerance_m, out);
  }
  if (b->arc) {
    return line_circle(a->to, ta, b->centre, b->radius_m, tolerance_m, out);
  }
  double cross = ta[0] * tb[1] - ta[1] * tb[0];
  if (cross == 0) {
    return 0;
  }
  double s = ((b->from[0] - a->to[0]) * tb[1] - (b->from[1] - a->to[1]) * tb[0]) / cross;
  out[0][0] = a->to[0] + s * ta[0];
  out[0][1] = a->to[1] + s * ta[1];
  return 1;
}

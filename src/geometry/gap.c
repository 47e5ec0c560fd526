/* How narrow a contour is: webs of material, slots of waste, and contours that cross. */
#include "geometry/contour.h"

#include <math.h>

/* The nearest points of two pieces. */
struct near {
  double distance, p[2], q[2];
};

static void keep_nearest(struct near *best, const double p[2], const double q[2])
{
  double distance = hypot(p[0] - q[0], p[1] - q[1]);
  if (distance < best->distance) {
    *best = (struct near){distance, {p[0], p[1]}, {q[0], q[1]}};
  }
}

/* From a point that may be on a to the nearest one of b. */
static void try_from(struct near *best, const struct dea_piece *a, const struct dea_piece *b,
                     double x, double y)
{
  double start[2] = {x, y}, p[2], q[2];
  dea_piece_nearest(a, start, p);
  dea_piece_nearest(b, p, q);
  keep_nearest(best, p, q);
}

static void try_line_circle(struct near *best, const struct dea_piece *line,
                            const struct dea_piece *arc)
{
  double t[2];
  dea_piece_tangent(line, false, t);
  double px = line->from[0] - arc->centre[0], py = line->from[1] - arc->centre[1];
  double along = -(px * t[0] + py * t[1]), off = px * t[1] - py * t[0];
  double rest = arc->radius_m * arc->radius_m - off * off;
  for (int k = -1; k <= 1; k++) { // the foot of the perpendicular lies between the crossings
    double s = along + (rest > 0 ? k * sqrt(rest) : 0);
    try_from(best, line, arc, line->from[0] + s * t[0], line->from[1] + s * t[1]);
  }
}

static void try_circles(struct near *best, const struct dea_piece *a, const struct dea_piece *b)
{
  double dx = b->centre[0] - a->centre[0], dy = b->centre[1] - a->centre[1], d = hypot(dx, dy);
  if (d == 0) {
    return;
  }
  double along = 0.5 * (d + (a->radius_m * a->radius_m - b->radius_m * b->radius_m) / d);
  double rest = a->radius_m * a->radius_m - along * along;
  for (int k = -1; k <= 1; k += 2) {
    double x = a->radius_m * k, across = k * sqrt(rest > 0 ? rest : 0);
    try_from(best, a, b, a->centre[0] + x * dx / d, a->centre[1] + x * dy / d);
    if (rest > 0) {
      try_from(best, a, b, a->centre[0] + (along * dx - across * dy) / d,
               a->centre[1] + (along * dy + across * dx) / d);
    }
  }
}

static void try_lines(struct near *best, const struct dea_piece *a, const struct dea_piece *b)
{
  double ta[2], tb[2];
  dea_piece_tangent(a, false, ta);
  dea_piece_tangent(b, false, tb);
  double cross = ta[0] * tb[1] - ta[1] * tb[0];
  if (cross != 0) {
    double s = ((b->from[0] - a->from[0]) * tb[1] - (b->from[1] - a->from[1]) * tb[0]) / cross;
    try_from(best, a, b, a->from[0] + s * ta[0], a->from[1] + s * ta[1]);
  }
}

/* p on a, q on b. */
static struct near nearest(const struct dea_piece *a, const struct dea_piece *b)
{
  struct near best = {.distance = INFINITY};
  if (a->arc && !b->arc) { // the line first
    best = nearest(b, a);
    return (struct near){best.distance, {best.q[0], best.q[1]}, {best.p[0], best.p[1]}};
  }
  try_from(&best, a, b, a->from[0], a->from[1]);
  try_from(&best, a, b, a->to[0], a->to[1]);
  try_from(&best, a, b, b->from[0], b->from[1]);
  try_from(&best, a, b, b->to[0], b->to[1]);
  if (a->arc && b->arc) {
    try_circles(&best, a, b);
  } else if (b->arc) {
    try_line_circle(&best, a, b);
  } else {
    try_lines(&best, a, b);
  }
  return best;
}

/* Unit normal to the left of a piece at one of its points. */
static void normal_at(const struct dea_piece *piece, const double x[2], double out[2])
{
  if (piece->arc) {
    double side = piece->sweep > 0 ? -1 : 1;
    out[0] = side * (x[0] - piece->centre[0]) / piece->radius_m;
    out[1] = side * (x[1] - piece->centre[1]) / piece->radius_m;
    return;
  }
  double t[2];
  dea_piece_tangent(piece, false, t);
  out[0] = -t[1];
  out[1] = t[0];
}

/* Whether what lies between the nearest points of one contour is a web or a slot: both pieces have
 * it on the same side. A step in a contour has it on different ones. */
static bool face_each_other(const struct dea_piece *a, const struct dea_piece *b,
                            const struct near *at)
{
  double na[2], nb[2], dx = (at->q[0] - at->p[0]) / at->distance,
                       dy = (at->q[1] - at->p[1]) / at->distance;
  normal_at(a, at->p, na);
  normal_at(b, at->q, nb);
  return -(na[0] * dx + na[1] * dy) * (nb[0] * dx + nb[1] * dy) > 0.1;
}

/* Whether a contour goes from piece i to piece j without a corner, and by less than this angle
 * [rad] in all: two places of one round edge, between which there is no web. */
static bool is_one_bend(const struct dea_contour *contour, size_t i, size_t j)
{
  static const double corner = 0.02, most = 2.6;
  size_t n = dea_contour_pieces(contour);
  double turn = 0, last[2] = {0, 0};
  for (size_t k = i;; k = (k + 1) % n) {
    const struct dea_piece piece = dea_contour_piece(contour, k);
    double t[2];
    dea_piece_tangent(&piece, false, t);
    if (k != i && fabs(last[0] * t[1] - last[1] * t[0]) > corner) {
      return false;
    }
    turn += piece.arc ? piece.sweep : 0;
    if (k == j || fabs(turn) >= most) {
      return fabs(turn) < most;
    }
    dea_piece_tangent(&piece, true, last);
  }
}

/* A circle around a piece, for a quick look. */
static bool far_apart(const struct dea_piece *a, const struct dea_piece *b, double limit)
{
  double dx = 0.5 * (a->from[0] + a->to[0] - b->from[0] - b->to[0]);
  double dy = 0.5 * (a->from[1] + a->to[1] - b->from[1] - b->to[1]);
  return hypot(dx, dy) > limit + 0.75 * (a->length_m + b->length_m);
}

struct dea_gap dea_contour_gap(const struct dea_contour *first, const struct dea_contour *second,
                               double limit_m)
{
  struct dea_gap out = {.width_m = INFINITY};
  const struct dea_contour *other = second != NULL ? second : first;
  size_t n = dea_contour_pieces(first), m = dea_contour_pieces(other);
  for (size_t i = 0; i < n; i++) {
    const struct dea_piece a = dea_contour_piece(first, i);
    for (size_t j = second != NULL ? 0 : i + 2; j < m; j++) {
      const struct dea_piece b = dea_contour_piece(other, j);
      bool neighbours = second == NULL && first->closed && i == 0 && j == m - 1;
      if (neighbours || far_apart(&a, &b, limit_m)) {
        continue;
      }
      struct near at = nearest(&a, &b);
      bool crosses = at.distance <= 1e-12;
      if (at.distance < fmin(limit_m, out.width_m) &&
          (crosses || second != NULL ||
           (face_each_other(&a, &b, &at) && !is_one_bend(first, i, j) &&
            !(first->closed && is_one_bend(first, j, i))))) {
        out =
            (struct dea_gap){at.distance, 0.5 * (at.p[0] + at.q[0]), 0.5 * (at.p[1] + at.q[1]), i};
      }
    }
  }
  return out;
}

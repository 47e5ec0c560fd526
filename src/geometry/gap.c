/* How narrow a contour is: webs of material, slots of waste, and contours that cross. */
#include "geometry/contour.h"

#include <math.h>

/* The nearest points of two pieces. */
struct near {
  double distance, p[2], q[2];
};

static void keep_nearest(struct near *best, const double p[2], const double q[2])
{
  double distance = dea_apart_m(p, q);
  if (distance < best->distance) {
    *best = (struct near){distance, {p[0], p[1]}, {q[0], q[1]}};
  }
}

/* From a point that may be on a to the nearest one of b. */
static void try_from(struct near *best, const struct dea_piece *a, const struct dea_piece *b,
                     const double start[2])
{
  double p[2], q[2];
  dea_piece_nearest(a, start, p);
  dea_piece_nearest(b, p, q);
  keep_nearest(best, p, q);
}

/* p on a, q on b: from their ends, where they cross, and along the lines through the centres. */
static struct near nearest(const struct dea_piece *a, const struct dea_piece *b)
{
  struct near best = {.distance = INFINITY};
  if (a->arc && !b->arc) { // the line first
    best = nearest(b, a);
    return (struct near){best.distance, {best.q[0], best.q[1]}, {best.p[0], best.p[1]}};
  }
  const double *ends[4] = {a->from, a->to, b->from, b->to};
  for (int k = 0; k < 4; k++) {
    try_from(&best, a, b, ends[k]);
  }
  double at[2][2];
  int count = dea_piece_crossings(a, b, 0, at);
  for (int k = 0; k < count; k++) {
    try_from(&best, a, b, at[k]);
  }
  if (b->arc) {
    try_from(&best, a, b, b->centre);
  }
  if (a->arc) { // and away from it
    try_from(&best, a, b,
             (double[2]){2 * a->centre[0] - b->centre[0], 2 * a->centre[1] - b->centre[1]});
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

/* A contour at a distance from another one: the path of a cutter that removes half its kerf on
 * each side. */
#include "geometry/contour.h"

#include <math.h>
#include <string.h>

/* A piece, moved by the distance to its right; false when an arc shrinks to nothing. */
static bool move_piece(struct dea_piece *piece, double distance)
{
  double t[2], scale = 1;
  if (piece->arc) {
    double radius = piece->radius_m + (piece->sweep > 0 ? distance : -distance);
    scale = radius / piece->radius_m;
    for (int k = 0; k < 2; k++) {
      piece->from[k] = piece->centre[k] + scale * (piece->from[k] - piece->centre[k]);
      piece->to[k] = piece->centre[k] + scale * (piece->to[k] - piece->centre[k]);
    }
    piece->radius_m = radius;
    return scale > 1e-9;
  }
  dea_piece_tangent(piece, false, t);
  for (int k = 0; k < 2; k++) {
    double right = k == 0 ? t[1] : -t[0];
    piece->from[k] += distance * right;
    piece->to[k] += distance * right;
  }
  return true;
}

/* Ends two moved pieces where they cross, at the crossing nearest to their old corner. */
static bool trim(struct dea_piece *a, struct dea_piece *b, const double corner[2])
{
  double at[2][2];
  int count = dea_piece_crossings(a, b, 0, at), best = 0;
  if (count == 0) {
    return false;
  }
  if (count == 2 && dea_apart_m(at[1], corner) < dea_apart_m(at[0], corner)) {
    best = 1;
  }
  memcpy(a->to, at[best], sizeof a->to);
  memcpy(b->from, at[best], sizeof b->from);
  return true;
}

/* Whether a piece still goes the way of the old one; sets the sweep of an arc. */
static bool goes_on(struct dea_piece *piece, const struct dea_piece *old)
{
  if (!piece->arc) {
    double t[2];
    dea_piece_tangent(old, false, t);
    return (piece->to[0] - piece->from[0]) * t[0] + (piece->to[1] - piece->from[1]) * t[1] > 0;
  }
  double start = atan2(piece->from[1] - piece->centre[1], piece->from[0] - piece->centre[0]);
  double end = atan2(piece->to[1] - piece->centre[1], piece->to[0] - piece->centre[0]);
  double sweep = end - start, full = 2 * DEA_PI, shift = floor((old->sweep - sweep) / full + 0.5);
  piece->start = start;
  piece->sweep = sweep + full * shift; // the one next to the old sweep
  return piece->sweep * old->sweep > 0;
}

/* How two neighbours meet after the move. */
enum meeting { SMOOTH, OPEN, CLOSING };

static enum meeting meet(const struct dea_piece *a, const struct dea_piece *b, double distance,
                         double *turn)
{
  double ta[2], tb[2];
  dea_piece_tangent(a, true, ta);
  dea_piece_tangent(b, false, tb);
  *turn = atan2(ta[0] * tb[1] - ta[1] * tb[0], ta[0] * tb[0] + ta[1] * tb[1]);
  return fabs(*turn) < 1e-6 ? SMOOTH : *turn * distance > 0 ? OPEN : CLOSING;
}

static struct dea_vertex vertex_at(const double at[2], double bulge, struct dea_location location)
{
  return (struct dea_vertex){at[0], at[1], bulge, location};
}

/* Moved piece i, cut off where its neighbours are. */
static bool cut_piece(const struct dea_contour *contour, size_t i, double distance,
                      struct dea_piece *piece)
{
  size_t n = contour->count;
  const struct dea_piece old = dea_contour_piece(contour, i);
  struct dea_piece before = dea_contour_piece(contour, (i + n - 1) % n), after;
  double turn;
  *piece = old;
  after = dea_contour_piece(contour, (i + 1) % n);
  enum meeting first = meet(&before, &old, distance, &turn);
  enum meeting last = meet(&old, &after, distance, &turn);
  return move_piece(piece, distance) && move_piece(&before, distance) &&
         move_piece(&after, distance) && (first != CLOSING || trim(&before, piece, old.from)) &&
         (last != CLOSING || trim(piece, &after, old.to)) && goes_on(piece, &old);
}

bool dea_contour_offset(const struct dea_contour *contour, double distance_m,
                        struct dea_vertex *out, size_t *out_count, size_t *at)
{
  size_t n = contour->count;
  *out_count = 0;
  if (distance_m == 0) {
    memcpy(out, contour->vertex, n * sizeof *out);
    *out_count = n;
    return true;
  }
  for (size_t i = 0; i < n; i++) {
    const struct dea_piece old = dea_contour_piece(contour, i);
    const struct dea_piece after = dea_contour_piece(contour, (i + 1) % n);
    struct dea_piece piece;
    double turn;
    *at = i;
    if (!cut_piece(contour, i, distance_m, &piece)) {
      return false;
    }
    struct dea_location location = contour->vertex[i].location;
    out[(*out_count)++] = vertex_at(piece.from, piece.arc ? tan(0.25 * piece.sweep) : 0, location);
    if (meet(&old, &after, distance_m, &turn) == OPEN) { // the cutter goes around the corner
      out[(*out_count)++] = vertex_at(piece.to, tan(0.25 * turn), location);
    }
  }
  return true;
}

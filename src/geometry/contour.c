#include "geometry/contour.h"

#include <string.h>

size_t dea_contour_pieces(const struct dea_contour *contour)
{
  return contour->count - (contour->closed || contour->count == 0 ? 0 : 1);
}

/* For a bulge b and a chord c: angle 4 atan(b), radius c (1 + b^2)/(4 |b|); the centre lies beside
 * the chord's middle, at c (1 - b^2)/(4 b) to the left. */
struct dea_piece dea_contour_piece(const struct dea_contour *contour, size_t i)
{
  const struct dea_vertex *p = &contour->vertex[i];
  const struct dea_vertex *q = &contour->vertex[(i + 1) % contour->count];
  struct dea_piece piece = {.from = {p->x_m, p->y_m}, .to = {q->x_m, q->y_m}};
  double dx = q->x_m - p->x_m, dy = q->y_m - p->y_m, b = p->bulge, chord = hypot(dx, dy);
  piece.length_m = chord;
  if (b != 0 && chord > 0) {
    double side = (1 - b * b) / (4 * b);
    piece.arc = true;
    piece.centre[0] = 0.5 * (p->x_m + q->x_m) - side * dy;
    piece.centre[1] = 0.5 * (p->y_m + q->y_m) + side * dx;
    piece.radius_m = chord * (1 + b * b) / (4 * fabs(b));
    piece.start = atan2(p->y_m - piece.centre[1], p->x_m - piece.centre[0]);
    piece.sweep = 4 * atan(b);
    piece.length_m = piece.radius_m * fabs(piece.sweep);
  }
  return piece;
}

void dea_piece_tangent(const struct dea_piece *piece, bool at_end, double out[2])
{
  if (piece->arc) {
    double angle = piece->start + (at_end ? piece->sweep : 0), sense = piece->sweep > 0 ? 1 : -1;
    out[0] = -sense * sin(angle);
    out[1] = sense * cos(angle);
    return;
  }
  double dx = piece->to[0] - piece->from[0], dy = piece->to[1] - piece->from[1];
  out[0] = dx / hypot(dx, dy); // its length may be that of a piece that was not yet cut off
  out[1] = dy / hypot(dx, dy);
}

void dea_piece_point(const struct dea_piece *piece, double fraction, double out[2])
{
  if (piece->arc) {
    double angle = piece->start + fraction * piece->sweep;
    out[0] = piece->centre[0] + piece->radius_m * cos(angle);
    out[1] = piece->centre[1] + piece->radius_m * sin(angle);
    return;
  }
  for (int k = 0; k < 2; k++) {
    out[k] = piece->from[k] + fraction * (piece->to[k] - piece->from[k]);
  }
}

void dea_piece_nearest(const struct dea_piece *piece, const double x_m[2], double out[2])
{
  double dx = piece->to[0] - piece->from[0], dy = piece->to[1] - piece->from[1];
  const double *end =
      dea_apart_m(x_m, piece->from) < dea_apart_m(x_m, piece->to) ? piece->from : piece->to;
  out[0] = end[0];
  out[1] = end[1];
  if (piece->arc) {
    double cx = x_m[0] - piece->centre[0], cy = x_m[1] - piece->centre[1], r = hypot(cx, cy);
    if (r > 0 && dea_piece_faces(piece, atan2(cy, cx))) {
      out[0] = piece->centre[0] + piece->radius_m * cx / r;
      out[1] = piece->centre[1] + piece->radius_m * cy / r;
    }
    return;
  }
  double s = ((x_m[0] - piece->from[0]) * dx + (x_m[1] - piece->from[1]) * dy) /
             (piece->length_m * piece->length_m);
  s = s < 0 ? 0 : s > 1 ? 1 : s;
  out[0] = piece->from[0] + s * dx;
  out[1] = piece->from[1] + s * dy;
}

double dea_piece_distance_m(const struct dea_piece *piece, const double x_m[2])
{
  double at[2];
  dea_piece_nearest(piece, x_m, at);
  return dea_apart_m(at, x_m);
}

/* Both by Green's theorem: the polygon of the chords, seen from the first vertex so that nothing
 * is lost far from the origin, and the circular segment between each chord and its arc, of area
 * r^2 (s - sin s)/2 and first moment about the centre 2/3 r^3 sin^3(s/2) towards its middle. */
double dea_contour_area_m2(const struct dea_contour *contour)
{
  double twice = 0;
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    const struct dea_piece p = dea_contour_piece(contour, i);
    double x0 = contour->vertex[0].x_m, y0 = contour->vertex[0].y_m;
    twice += (p.from[0] - x0) * (p.to[1] - y0) - (p.from[1] - y0) * (p.to[0] - x0);
    if (p.arc) {
      twice += p.radius_m * p.radius_m * (p.sweep - sin(p.sweep));
    }
  }
  return 0.5 * twice;
}

void dea_contour_moment_m3(const struct dea_contour *contour, double out[2])
{
  double area = 0, moment[2] = {0, 0};
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    const struct dea_piece p = dea_contour_piece(contour, i);
    const double origin[2] = {contour->vertex[0].x_m, contour->vertex[0].y_m};
    double a[2] = {p.from[0] - origin[0], p.from[1] - origin[1]};
    double b[2] = {p.to[0] - origin[0], p.to[1] - origin[1]};
    double triangle = 0.5 * (a[0] * b[1] - a[1] * b[0]), segment = 0, arm = 0;
    if (p.arc) {
      double half = sin(0.5 * p.sweep);
      segment = 0.5 * p.radius_m * p.radius_m * (p.sweep - sin(p.sweep));
      arm = 2.0 / 3 * p.radius_m * p.radius_m * p.radius_m * half * half * half;
    }
    double middle = p.start + 0.5 * p.sweep;
    moment[0] += triangle * (a[0] + b[0]) / 3 + segment * (p.centre[0] - origin[0]);
    moment[1] += triangle * (a[1] + b[1]) / 3 + segment * (p.centre[1] - origin[1]);
    if (p.arc) {
      moment[0] += arm * cos(middle);
      moment[1] += arm * sin(middle);
    }
    area += triangle + segment;
  }
  for (int k = 0; k < 2; k++) {
    out[k] = moment[k] + area * (k == 0 ? contour->vertex[0].x_m : contour->vertex[0].y_m);
  }
}

double dea_contour_length_m(const struct dea_contour *contour)
{
  double length = 0;
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    length += dea_contour_piece(contour, i).length_m;
  }
  return length;
}

bool dea_piece_faces(const struct dea_piece *arc, double angle)
{
  double along = arc->sweep > 0 ? angle - arc->start : arc->start - angle;
  along -= 2 * DEA_PI * floor(along / (2 * DEA_PI));
  return along <= fabs(arc->sweep) || along >= 2 * DEA_PI - 1e-12;
}

static void grow(double box[4], double x, double y)
{
  box[0] = fmin(box[0], x);
  box[1] = fmin(box[1], y);
  box[2] = fmax(box[2], x);
  box[3] = fmax(box[3], y);
}

void dea_piece_grow_box(const struct dea_piece *piece, double box[4])
{
  grow(box, piece->from[0], piece->from[1]);
  grow(box, piece->to[0], piece->to[1]);
  for (int quarter = 0; piece->arc && quarter < 4; quarter++) {
    static const int x[4] = {1, 0, -1, 0}, y[4] = {0, 1, 0, -1};
    if (dea_piece_faces(piece, 0.5 * DEA_PI * quarter)) {
      grow(box, piece->centre[0] + x[quarter] * piece->radius_m,
           piece->centre[1] + y[quarter] * piece->radius_m);
    }
  }
}

void dea_contour_grow_box(const struct dea_contour *contour, double box[4])
{
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    const struct dea_piece p = dea_contour_piece(contour, i);
    dea_piece_grow_box(&p, box);
  }
}

/* Angle by which the direction from the point to the contour turns along a piece. Seen from within
 * its circle, an arc always turns the same way. */
static double turn_along(const struct dea_piece *piece, double x, double y)
{
  double ax = piece->from[0] - x, ay = piece->from[1] - y;
  double bx = piece->to[0] - x, by = piece->to[1] - y;
  double turn = atan2(ax * by - ay * bx, ax * bx + ay * by);
  if (piece->arc && hypot(x - piece->centre[0], y - piece->centre[1]) < piece->radius_m) {
    turn += piece->sweep > 0 && turn < 0   ? 2 * DEA_PI
            : piece->sweep < 0 && turn > 0 ? -2 * DEA_PI
                                           : 0;
  }
  return turn;
}

double dea_contour_distance_m(const struct dea_contour *contour, const double x_m[2])
{
  double least = INFINITY;
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    const struct dea_piece piece = dea_contour_piece(contour, i);
    least = fmin(least, dea_piece_distance_m(&piece, x_m));
  }
  return least;
}

bool dea_contour_inside(const struct dea_contour *contour, double x_m, double y_m)
{
  double turn = 0;
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    const struct dea_piece piece = dea_contour_piece(contour, i);
    turn += turn_along(&piece, x_m, y_m);
  }
  return fabs(turn) > DEA_PI;
}

bool dea_contour_is_circle(const struct dea_contour *contour, double centre[2], double *radius)
{
  const struct dea_piece first = dea_contour_piece(contour, 0);
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    const struct dea_piece piece = dea_contour_piece(contour, i);
    if (!piece.arc || dea_apart_m(piece.centre, first.centre) > 1e-9 * first.radius_m) {
      return false;
    }
  }
  memcpy(centre, first.centre, sizeof first.centre);
  *radius = first.radius_m;
  return true;
}

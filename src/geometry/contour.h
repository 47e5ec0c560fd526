/* Contours: lines and circular arcs in a plane, with exact measures. The form is that of the
 * LWPOLYLINE of a DXF file: a vertex says how the contour goes on to the next one.
 *
 * Closed contours of a part go counter-clockwise, so their inside lies on the left. */
#pragma once

#include "base/context.h"

#include <math.h>

/* Distance of two points. */
static inline double dea_apart_m(const double a[2], const double b[2])
{
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): of points that were found
  return hypot(a[0] - b[0], a[1] - b[1]);
}

struct dea_vertex {
  double x_m, y_m;
  double bulge; // tan of a quarter of the arc's angle to the next vertex; > 0: counter-clockwise,
                // 0: straight
  struct dea_location location; // of the value in the design that made this piece
};

struct dea_contour {
  const struct dea_vertex *vertex; // [count], lent
  size_t count;
  bool closed; // the last vertex goes on to the first
};

/* A piece of a contour: a line, or an arc about a centre. */
struct dea_piece {
  double from[2], to[2];
  bool arc;
  double centre[2], radius_m, start, sweep; // of an arc; angles in radian, sweep signed
  double length_m;
};

/* Number of pieces, and one of them (0 <= i < count). */
size_t dea_contour_pieces(const struct dea_contour *contour);
struct dea_piece dea_contour_piece(const struct dea_contour *contour, size_t i);
/* Unit tangent of a piece at its start or end. */
void dea_piece_tangent(const struct dea_piece *piece, bool at_end, double out[2]);
/* Point of a piece: fraction 0 is its start, 1 its end. */
void dea_piece_point(const struct dea_piece *piece, double fraction, double out[2]);
/* Point of a piece that is nearest to another point. */
void dea_piece_nearest(const struct dea_piece *piece, const double x_m[2], double out[2]);
double dea_piece_distance_m(const struct dea_piece *piece, const double x_m[2]);
/* Grows a box {x min, y min, x max, y max} so that it holds the piece. */
void dea_piece_grow_box(const struct dea_piece *piece, double box[4]);
/* Where the line or circle of a crosses that of b, beyond their ends too; returns 0 to 2. Up to
 * tolerance_m from touching, a line and a circle or two circles count as tangent, with one point
 * (0: never). The same line or circle twice: none. */
int dea_piece_crossings(const struct dea_piece *a, const struct dea_piece *b, double tolerance_m,
                        double out[2][2]);
/* Whether an arc lies in this direction [rad] from its centre; its ends do, for all rounding. */
bool dea_piece_faces(const struct dea_piece *arc, double angle);

/* Enclosed area, > 0 for a counter-clockwise one; of a closed contour. */
double dea_contour_area_m2(const struct dea_contour *contour);
double dea_contour_length_m(const struct dea_contour *contour);
/* First moments of the enclosed area, signed as the area: area times centroid [m3]. */
void dea_contour_moment_m3(const struct dea_contour *contour, double out[2]);
/* Grows a box {x min, y min, x max, y max} so that it holds the contour. */
void dea_contour_grow_box(const struct dea_contour *contour, double box[4]);
/* Distance of a point from a contour. */
double dea_contour_distance_m(const struct dea_contour *contour, const double x_m[2]);
/* Whether a point, not on it, lies inside a closed contour. */
bool dea_contour_inside(const struct dea_contour *contour, double x_m, double y_m);

/* Whether a closed contour is one circle, and its centre and radius. */
bool dea_contour_is_circle(const struct dea_contour *contour, double centre[2], double *radius);

/* The contour at a distance outwards (< 0: inwards), with round corners where it opens. Pieces keep
 * their places. out: room for 2 count vertices. false when a piece vanishes: *at is its number. */
bool dea_contour_offset(const struct dea_contour *contour, double distance_m,
                        struct dea_vertex *out, size_t *out_count, size_t *at);

/* The narrowest place between two pieces that face each other. */
struct dea_gap {
  double width_m; // 0: they cross; INFINITY: none below the limit
  double x_m, y_m;
  size_t piece; // of the first contour
};
/* Within one contour (second NULL; neighbours do not count), or between two of them. Only places
 * narrower than `limit_m` are looked for. */
struct dea_gap dea_contour_gap(const struct dea_contour *first, const struct dea_contour *second,
                               double limit_m);

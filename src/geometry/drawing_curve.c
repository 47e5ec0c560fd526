/* What readers draw: lines, arcs, ellipses and splines, through the matrix of the drawing, become
 * vertices. Circles stay exact; other curves become arcs within a tolerance. */
#include "geometry/drawing.h"

#include <math.h>
#include <string.h>

static const double fit_m = 1e-7; // largest distance of curves from the arcs that they become

enum { SAMPLES = 16, DEPTH_MAX = 12 };

/* A parametric curve in the coordinates of the file. */
struct curve {
  void (*at)(const void *of, double t, double out[2]);
  const void *of;
  bool cubic;
};

struct dea_affine dea_affine_times(const struct dea_affine *m, const struct dea_affine *n)
{
  return (struct dea_affine){m->a * n->a + m->c * n->b,        m->b * n->a + m->d * n->b,
                             m->a * n->c + m->c * n->d,        m->b * n->c + m->d * n->d,
                             m->a * n->e + m->c * n->f + m->e, m->b * n->e + m->d * n->f + m->f};
}

static void to_metres(const struct dea_drawing *d, const double x[2], double out[2])
{
  const struct dea_affine *m = &d->matrix;
  out[0] = m->a * x[0] + m->c * x[1] + m->e;
  out[1] = m->b * x[0] + m->d * x[1] + m->f;
}

static dea_status add_vertex(struct dea_drawing *d, const double x_m[2])
{
  if (!isfinite(x_m[0]) || !isfinite(x_m[1])) {
    return dea_drawing_fault(d, d->line, "a coordinate is no number");
  }
  if (d->vertex_count == d->settings.vertices_max) {
    return dea_drawing_fault(d, d->line,
                             "the drawing has more than %zu vertices, which is too many",
                             d->settings.vertices_max);
  }
  DEA_TRY_STATUS(
      dea_array_grow(d->ctx, &d->vertex, d->vertex_count, &d->vertex_room, sizeof *d->vertex));
  d->vertex[d->vertex_count++] =
      (struct dea_vertex){x_m[0], x_m[1], 0, {d->file, d->line, d->line > 0}};
  return DEA_OK;
}

dea_status dea_drawing_line_to(struct dea_drawing *drawing, const double to[2])
{
  double x_m[2];
  to_metres(drawing, to, x_m);
  return add_vertex(drawing, x_m);
}

static dea_status start(struct dea_drawing *d, const double from[2])
{
  return dea_drawing_open_vertices(d) > 0 ? DEA_OK : dea_drawing_line_to(d, from);
}

/* From the last vertex by an arc. */
static dea_status add_arc(struct dea_drawing *d, double bulge, const double to_m[2])
{
  if (!isfinite(bulge)) {
    return dea_drawing_fault(d, d->line, "a coordinate is no number");
  }
  d->vertex[d->vertex_count - 1].bulge = bulge;
  return add_vertex(d, to_m);
}

/* Whether the matrix makes a circle of the points u cos + v sin; > 0: counter-clockwise, < 0: the
 * other way round, 0: it does not. */
static int makes_circle(const struct dea_affine *m, const double u[2], const double v[2])
{
  double ux = m->a * u[0] + m->c * u[1], uy = m->b * u[0] + m->d * u[1];
  double vx = m->a * v[0] + m->c * v[1], vy = m->b * v[0] + m->d * v[1];
  double one = ux * ux + uy * uy, two = vx * vx + vy * vy;
  bool round = fabs(one - two) <= 1e-9 * one && fabs(ux * vx + uy * vy) <= 1e-9 * one;
  return !round ? 0 : ux * vy - uy * vx > 0 ? 1 : -1;
}

/* One arc through the ends and the middle of a part of the curve, if it is near enough all along,
 * or else the halves of the part one after the other. An arc that passes the middle of a curve
 * whose curvature changes by k' along a length h comes as near as k' h^3/125, so that n of them
 * come n^3 times nearer.
 *
 * A whole cubic stands for an arc of an angle phi where it is as near to it as a cubic comes at
 * all: at 90 degrees 2.7e-4 of the radius with the usual handles, with phi^6 below; 4e-4 leaves
 * room for rounded coordinates. */
static dea_status fit(struct dea_drawing *d, const struct curve *curve, const double between[2],
                      int depth, const double *end_m)
{
  double x[SAMPLES + 1][2], raw[2], worst = 0;
  struct dea_vertex ends[2] = {d->vertex[d->vertex_count - 1]};
  for (int k = 1; k <= SAMPLES; k++) {
    curve->at(curve->of, between[0] + (between[1] - between[0]) * k / SAMPLES, raw);
    to_metres(d, raw, x[k]);
  }
  if (end_m != NULL) {
    memcpy(x[SAMPLES], end_m, sizeof x[SAMPLES]);
  }
  const double *middle = x[SAMPLES / 2], *last = x[SAMPLES];
  double a[2] = {middle[0] - ends[0].x_m, middle[1] - ends[0].y_m};
  double b[2] = {last[0] - middle[0], last[1] - middle[1]};
  double half = atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]); // of the arc's angle
  double chord = hypot(a[0] + b[0], a[1] + b[1]), bulge = tan(0.5 * half);
  bool straight = fabs(bulge) * chord < 0.01 * fit_m;
  ends[0].bulge = straight ? 0 : bulge;
  ends[1].x_m = last[0];
  ends[1].y_m = last[1];
  const struct dea_contour contour = {ends, 2, false};
  const struct dea_piece piece = dea_contour_piece(&contour, 0);
  for (int k = 1; k < SAMPLES; k++) {
    worst = fmax(worst, chord > 0 ? dea_piece_distance_m(&piece, x[k]) : dea_apart_m(x[k], last));
  }
  double near = fit_m, quarters = fabs(half) / (0.25 * DEA_PI);
  if (curve->cubic && depth == 0 && piece.arc && quarters < 1.05) {
    near = fmax(near, 4e-4 * piece.radius_m * pow(quarters, 6));
  }
  if ((worst <= near && fabs(half) < 0.6 * DEA_PI) || depth == DEPTH_MAX) {
    d->deviation_m = fmax(d->deviation_m, worst);
    return add_arc(d, fabs(half) < 0.6 * DEA_PI ? ends[0].bulge : 0, last);
  }
  double centre = 0.5 * (between[0] + between[1]);
  DEA_TRY(d->ctx, fit(d, curve, (double[2]){between[0], centre}, depth + 1, middle));
  return fit(d, curve, (double[2]){centre, between[1]}, depth + 1, last);
}

dea_status dea_drawing_bulge_to(struct dea_drawing *drawing, const double from[2], double bulge,
                                const double to[2])
{
  struct dea_drawing *d = drawing;
  int sense = makes_circle(&d->matrix, (double[2]){1, 0}, (double[2]){0, 1});
  DEA_TRY(d->ctx, start(d, from));
  if (sense != 0 || bulge == 0) {
    double to_m[2];
    to_metres(d, to, to_m);
    return add_arc(d, sense * bulge, to_m);
  }
  const struct dea_vertex ends[2] = {{.x_m = from[0], .y_m = from[1], .bulge = bulge},
                                     {.x_m = to[0], .y_m = to[1]}};
  const struct dea_contour contour = {ends, 2, false};
  const struct dea_piece p = dea_contour_piece(&contour, 0);
  const struct dea_ellipse ellipse = {
      {p.centre[0], p.centre[1]}, {p.radius_m, 0}, {0, p.radius_m}, p.start, p.sweep};
  return p.arc ? dea_drawing_ellipse_to(d, &ellipse, to) : dea_drawing_line_to(d, to);
}

static void ellipse_at(const void *of, double angle, double out[2])
{
  const struct dea_ellipse *e = of;
  for (int k = 0; k < 2; k++) {
    out[k] = e->centre[k] + e->first[k] * cos(angle) + e->second[k] * sin(angle);
  }
}

dea_status dea_drawing_ellipse_to(struct dea_drawing *drawing, const struct dea_ellipse *ellipse,
                                  const double to[2])
{
  struct dea_drawing *d = drawing;
  const struct dea_ellipse *e = ellipse;
  const struct curve curve = {ellipse_at, e, false};
  int sense = makes_circle(&d->matrix, e->first, e->second);
  double quarters = ceil(fabs(e->sweep) / (0.5 * DEA_PI) - 1e-9);
  int parts = sense != 0 ? (fabs(e->sweep) > DEA_PI ? 2 : 1) : (int)fmax(1, fmin(quarters, 4));
  double raw[2], end_m[2];
  ellipse_at(e, e->from, raw);
  DEA_TRY(d->ctx, start(d, raw));
  d->curves += sense == 0;
  for (int k = 0; k < parts; k++) {
    const double between[2] = {e->from + k * e->sweep / parts,
                               e->from + (k + 1) * e->sweep / parts};
    ellipse_at(e, between[1], raw);
    to_metres(d, to != NULL && k + 1 == parts ? to : raw, end_m);
    DEA_TRY(d->ctx, sense != 0 ? add_arc(d, sense * tan(0.25 * e->sweep / parts), end_m)
                               : fit(d, &curve, between, 0, end_m));
  }
  return DEA_OK;
}

/* A span between two knots of a spline. */
struct span {
  const struct dea_spline *spline;
  size_t knot;
};

/* By de Boor's algorithm. */
static void span_at(const void *of, double t, double out[2])
{
  const struct span *span = of;
  const struct dea_spline *s = span->spline;
  size_t p = s->degree, first = span->knot - p;
  double q[DEA_SPLINE_DEGREE_MAX + 1][3];
  memcpy(q, s->point + first, (p + 1) * sizeof *q);
  for (size_t round = 1; round <= p; round++) {
    for (size_t j = p; j >= round; j--) {
      double low = s->knot[first + j], high = s->knot[span->knot + 1 + j - round];
      double part = (t - low) / (high - low);
      for (int k = 0; k < 3; k++) {
        q[j][k] = part * q[j][k] + (1 - part) * q[j - 1][k];
      }
    }
  }
  out[0] = q[p][0] / q[p][2];
  out[1] = q[p][1] / q[p][2];
}

dea_status dea_drawing_spline_to(struct dea_drawing *drawing, const struct dea_spline *spline)
{
  struct dea_drawing *d = drawing;
  const struct dea_spline *s = spline;
  d->curves += s->degree > 1;
  for (size_t k = s->degree; k < s->count; k++) {
    const struct span span = {s, k};
    const struct curve curve = {span_at, &span, s->degree == 3};
    double raw[2];
    if (!(s->knot[k + 1] > s->knot[k])) {
      continue;
    }
    span_at(&span, s->knot[k], raw);
    DEA_TRY(d->ctx, start(d, raw));
    DEA_TRY(d->ctx, fit(d, &curve, s->knot + k, 0, NULL));
  }
  return DEA_OK;
}

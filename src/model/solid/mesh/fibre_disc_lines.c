#include "model/solid/mesh/fibre_disc_lines.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* Circles closer than that are one, relative to the frame. */
static const double same = 1e-9;

static const double free_share = 0.99; // of a sector that fibres may take where they begin

/* Half the angle that a fibre takes where its long edge, a straight line from its tip to its outer
 * end, crosses a circle; inside the tip and beyond the outer end the line goes on to the centre. */
static double fibre_angle(const struct dea_fibre_disc *p, double radius)
{
  double y1 = 0.5 * p->tip_width, x1 = sqrt(p->tip_radius * p->tip_radius - y1 * y1);
  double y2 = 0.5 * p->outer_width, x2 = sqrt(p->outer_radius * p->outer_radius - y2 * y2);
  if (radius <= p->tip_radius) {
    return atan2(y1, x1);
  }
  if (radius >= p->outer_radius) {
    return atan2(y2, x2);
  }
  // |P1 + t (P2 - P1)| = radius, the larger root: from P1 on outwards
  double dx = x2 - x1, dy = y2 - y1, a = dx * dx + dy * dy, b = x1 * dx + y1 * dy;
  double c = x1 * x1 + y1 * y1 - radius * radius;
  double t = -c / (b + sqrt(b * b - a * c));
  return atan2(y1 + t * dy, x1 + t * dx);
}

double dea_fibre_disc_line_angle(const struct dea_fibre_disc_lines *lines, double l, double radius)
{
  double across = (double)lines->across;
  double edge = lines->across > 0 ? fibre_angle(lines->plate, radius) : 0;
  if (l <= across && lines->across > 0) { // equal parts of the width
    return asin(sin(edge) * l / across);
  }
  return edge + (lines->alpha - edge) * (l - across) / ((double)lines->count - across);
}

void dea_fibre_disc_line_point(const struct dea_fibre_disc_lines *lines, double l, double radius,
                               double x[2])
{
  double angle = dea_fibre_disc_line_angle(lines, l, radius);
  x[0] = radius * cos(angle);
  x[1] = radius * sin(angle);
}

static void add_circle(struct dea_fibre_disc_lines *lines, double radius)
{
  size_t at = lines->circle_count;
  for (size_t i = 0; i < lines->circle_count; i++) {
    if (fabs(lines->circle[i] - radius) <= same * lines->plate->frame_radius) {
      return;
    }
  }
  for (; at > 0 && lines->circle[at - 1] > radius; at--) {
    lines->circle[at] = lines->circle[at - 1];
  }
  lines->circle[at] = radius;
  lines->circle_count++;
}

static dea_status check(struct dea_context *ctx, const struct dea_fibre_disc *p)
{
  double frame = p->frame_radius, N = p->fibres > 0 ? p->fibres : 4;
  if (!(p->electrode_radius > 0 && p->electrode_radius < frame && p->film_thickness >= 0 &&
        p->size > 0 && p->edge > 0) ||
      p->fibres < 0 || p->sectors < 1 || p->sectors > dea_fibre_disc_sectors(p)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the mesh of a plate takes an electrode inside the frame");
  }
  if (p->fibres == 0) {
    return DEA_OK;
  }
  double room = fmin(pi / N, 0.5 * pi);
  bool fit = p->tip_radius > 0 && p->outer_radius > p->tip_radius * (1 + same) &&
             p->outer_radius <= frame * (1 + same) && p->tip_width > 0 && p->outer_width > 0 &&
             p->tip_width < 2 * p->tip_radius && p->outer_width < 2 * p->outer_radius &&
             p->fibre_thickness > 0;
  if (!fit || !(asin(0.5 * p->tip_width / p->tip_radius) <= free_share * room) ||
      !(asin(0.5 * p->outer_width / p->outer_radius) <= free_share * room)) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "the mesh of a plate takes fibres that lie between centre and frame and leave "
                    "at least %.0f %% of the film between them",
                    100 * (1 - free_share));
  }
  return DEA_OK;
}

/* Elements of about `size` in a length, at least one. */
static size_t share(double length, double size)
{
  double count = floor(length / size + 0.5);
  return count > DEA_FIBRE_DISC_LINE_MAX ? DEA_FIBRE_DISC_LINE_MAX + 1
         : count > 1                     ? (size_t)count
                                         : 1;
}

dea_status dea_fibre_disc_lines_create(struct dea_context *ctx, const struct dea_fibre_disc *p,
                                       struct dea_fibre_disc_lines *out)
{
  DEA_TRY(ctx, check(ctx, p));
  *out = (struct dea_fibre_disc_lines){.plate = p, .alpha = dea_fibre_disc_angle(p) / p->sectors};
  double a = p->electrode_radius, rest = out->alpha;
  add_circle(out, a);
  add_circle(out, p->frame_radius);
  if (p->fibres > 0) {
    add_circle(out, p->tip_radius);
    add_circle(out, p->outer_radius);
    double width = fmax(p->tip_width, p->outer_width);
    out->across = share(0.5 * width, 0.5 * p->size); // fibres are stiff and bend: half the size
    rest -= fibre_angle(p, a);
  }
  out->count = out->across + share(rest * a, p->fibres > 0 && p->beside > 0 ? p->beside : p->size);
  size_t least = out->alpha > 0.51 * pi ? 4 : 2; // two for each wedge of the core
  out->count = out->count < least ? least : out->count;
  if (out->count > DEA_FIBRE_DISC_LINE_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a mesh takes at most %d elements in a row",
                    DEA_FIBRE_DISC_LINE_MAX);
  }
  return DEA_OK;
}

/* Mesh of a quarter of a disc in a ring, with half a fibre along each axis. */
#include "model/solid/grid.h"

#include <math.h>
#include <string.h>

static const double eighth = 0.78539816339744831; // pi/4

/* The square in the middle and the two rings between it and the circle a. */
struct inner_block {
  int half; // of a ring: 0 angles up to pi/4, 1 beyond
  double core, radius;
};

static const double core_corner = 0.8; // coordinates of the corner over the side: rounder than 1

static void map_core(const void *self, double s, double t, double x[2])
{
  const struct inner_block *b = self;
  double pull = 1 - (1 - core_corner) * s * t;
  x[0] = b->core * s * pull;
  x[1] = b->core * t * pull;
}

static void map_inner_ring(const void *self, double s, double t, double x[2])
{
  const struct inner_block *b = self;
  double angle = eighth * (t + b->half), along = b->half == 0 ? t : 1 - t, edge[2];
  map_core(self, b->half == 0 ? 1 : along, b->half == 0 ? along : 1, edge);
  x[0] = (1 - s) * edge[0] + s * b->radius * cos(angle);
  x[1] = (1 - s) * edge[1] + s * b->radius * sin(angle);
}

/* Outside the circle a: between the angles inner[] there and outer[] at the frame, on straight
 * lines. With angles of equal y at both ends that is the strip of a fibre. */
struct outer_block {
  double a, b, inner[2], outer[2];
};

static void map_outer(const void *self, double s, double t, double x[2])
{
  const struct outer_block *o = self;
  double inner = (1 - t) * o->inner[0] + t * o->inner[1];
  double outer = (1 - t) * o->outer[0] + t * o->outer[1];
  x[0] = (1 - s) * o->a * cos(inner) + s * o->b * cos(outer);
  x[1] = (1 - s) * o->a * sin(inner) + s * o->b * sin(outer);
}

enum { CUTS_MAX = 257 };

/* Cuts of [0, 1] for a strip of `length`: elements that start at `first` and double until they are
 * as wide as `widest`, scaled to fit. Returns their number, 0 when there are too many. */
static size_t graded_cuts(double length, double first, double widest, double *cuts)
{
  size_t count = 0;
  double sum = 0, width = first;
  cuts[0] = 0;
  while (sum < length * (1 - 1e-9)) {
    if (count + 2 > CUTS_MAX) {
      return 0;
    }
    sum += width;
    cuts[++count] = sum;
    width = fmin(2 * width, widest);
  }
  for (size_t i = 1; i <= count; i++) {
    cuts[i] /= sum;
  }
  return count;
}

/* The same seen from the other end. */
static void reverse_cuts(double *cuts, size_t count)
{
  double turned[CUTS_MAX];
  for (size_t i = 0; i <= count; i++) {
    turned[i] = 1 - cuts[count - i];
  }
  memcpy(cuts, turned, (count + 1) * sizeof *cuts);
}

static bool fibre_only_on_fibres(int region, int sheet)
{
  return sheet == DEA_SHEET_FILM || region == DEA_REGION_FIBRE;
}

/* Cuts of the angle from an axis (0) to pi/4 (1): those across half a fibre first. */
static size_t angle_cuts(const struct dea_quarter *q, double share, double *cuts)
{
  size_t across = share > 0 ? q->across : 0;
  for (size_t i = 0; i < across; i++) {
    cuts[i] = share * (double)i / (double)across;
  }
  for (size_t i = 0; i <= q->fine; i++) {
    cuts[across + i] = share + (1 - share) * (double)i / (double)q->fine;
  }
  return across + q->fine;
}

dea_status dea_grid_quarter(struct dea_context *ctx, const struct dea_quarter *q,
                            struct dea_grid **out)
{
  bool fibres = q->fibre_thickness > 0;
  double angle_a = fibres ? asin(0.5 * q->fibre_width / q->a) : 0;
  double angle_b = fibres ? asin(0.5 * q->fibre_width / q->b) : 0;
  double turn[CUTS_MAX], back[CUTS_MAX], ring[CUTS_MAX], rest[CUTS_MAX], film[CUTS_MAX];
  double strip[CUTS_MAX], square = eighth * q->a / (double)(q->fine > 0 ? q->fine : 1);
  double first = q->edge > 0 && q->edge < square ? q->edge : square;
  size_t rings = graded_cuts(0.45 * q->a, first, square, ring);
  size_t rests = graded_cuts(q->b - q->a, first, 2 * square, rest);
  if (q->fine < 1 || q->fine + q->across >= CUTS_MAX || rings == 0 || rests == 0 ||
      !(angle_a < eighth) || (fibres && q->across < 1)) {
    return dea_fail(
        ctx, DEA_E_ARGUMENT,
        "a mesh of a quarter takes 1 to %d elements in a row, and fibres that do not meet",
        CUTS_MAX - 1);
  }
  size_t turns = angle_cuts(q, angle_a / eighth, turn), across = turns - q->fine;
  reverse_cuts(ring, rings);
  memcpy(back, turn, (turns + 1) * sizeof *back);
  reverse_cuts(back, turns);
  for (size_t i = 0; i <= q->fine; i++) {
    film[i] = (double)i / (double)q->fine;
  }
  for (size_t i = 0; i <= across && across > 0; i++) {
    strip[i] = (double)i / (double)across;
  }
  const struct inner_block core = {0, 0.55 * q->a, q->a}, second = {1, core.core, q->a};
  const double right = 2 * eighth;
  const struct outer_block outer[] = {
      {q->a, q->b, {angle_a, eighth}, {angle_b, eighth}},
      {q->a, q->b, {eighth, right - angle_a}, {eighth, right - angle_b}},
      {q->a, q->b, {0, angle_a}, {0, angle_b}},
      {q->a, q->b, {right - angle_a, right}, {right - angle_b, right}},
  };
  const struct dea_block blocks[] = {
      {map_core, &core, turn, turn, turns, turns, DEA_REGION_ELECTRODE},
      {map_inner_ring, &core, ring, turn, rings, turns, DEA_REGION_ELECTRODE},
      {map_inner_ring, &second, ring, back, rings, turns, DEA_REGION_ELECTRODE},
      {map_outer, &outer[0], rest, film, rests, q->fine, DEA_REGION_FILM},
      {map_outer, &outer[1], rest, film, rests, q->fine, DEA_REGION_FILM},
      {map_outer, &outer[2], rest, strip, rests, across, DEA_REGION_FIBRE},
      {map_outer, &outer[3], rest, strip, rests, across, DEA_REGION_FIBRE},
  };
  const struct dea_sheet sheets[] = {{q->film_thickness, 1, q->order_z},
                                     {q->fibre_thickness, 1, q->order_z}};
  DEA_TRY(ctx, dea_grid_create(ctx, q->order, blocks, fibres ? 7 : 5, sheets, fibres ? 2 : 1,
                               fibre_only_on_fibres, -0.5 * q->film_thickness, q->b, out));
  return DEA_OK;
}

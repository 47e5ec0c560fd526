/* Mesh of a quarter of a disc in a ring, with fibres along the axes and the diagonal. */
#include "model/solid/mesh/grid.h"

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

/* The first sheet is the film, solid or not; the others are there for the fibres. */
static bool film_everywhere(int region, int sheet)
{
  return sheet == 0 || region == DEA_REGION_FIBRE;
}

/* Elements between two angles of the circle a, as shares of pi/4, and where their lines meet the
 * frame. */
struct sector {
  double from, to, frame_from, frame_to;
  size_t count;
  bool fibre;
};

enum { SECTORS_MAX = 3 };

/* The sectors from an axis to the diagonal; returns their number. */
static size_t half_sectors(const struct dea_quarter *q, struct sector out[SECTORS_MAX])
{
  if (q->fibres == 0) {
    out[0] = (struct sector){0, 1, 0, 1, q->fine, false};
    return 1;
  }
  double a = asin(0.5 * q->fibre_width / q->a) / eighth;
  double b = asin(0.5 * q->fibre_width / q->b) / eighth;
  double end = q->fibres == 8 ? a : 0, frame_end = q->fibres == 8 ? b : 0;
  out[0] = (struct sector){0, a, 0, b, q->across, true};
  out[1] = (struct sector){a, 1 - end, b, 1 - frame_end, q->fine, false};
  out[2] = (struct sector){1 - a, 1, 1 - b, 1, q->across, true};
  return q->fibres == 8 ? 3 : 2;
}

/* Cuts of the angle from the axis (0) to the diagonal (1) through all sectors; returns their
 * number. */
static size_t turn_cuts(const struct sector *sectors, size_t sector_count, double *cuts)
{
  size_t count = 0;
  cuts[0] = 0;
  for (size_t k = 0; k < sector_count; k++) {
    const struct sector *s = &sectors[k];
    for (size_t i = 1; i <= s->count; i++) {
      cuts[++count] = s->from + (s->to - s->from) * (double)i / (double)s->count;
    }
  }
  return count;
}

/* Blocks outside the circle a: each sector, and its mirror image beyond the diagonal. */
static void outer_blocks(const struct dea_quarter *q, const struct sector *sectors, size_t count,
                         const double *rest, size_t rests, double even[SECTORS_MAX][CUTS_MAX],
                         struct outer_block *outer, struct dea_block *blocks)
{
  for (size_t k = 0; k < count; k++) {
    const struct sector *s = &sectors[k];
    for (size_t i = 0; i <= s->count; i++) {
      even[k][i] = (double)i / (double)s->count;
    }
    outer[2 * k] = (struct outer_block){q->a,
                                        q->b,
                                        {eighth * s->from, eighth * s->to},
                                        {eighth * s->frame_from, eighth * s->frame_to}};
    outer[2 * k + 1] =
        (struct outer_block){q->a,
                             q->b,
                             {eighth * (2 - s->to), eighth * (2 - s->from)},
                             {eighth * (2 - s->frame_to), eighth * (2 - s->frame_from)}};
    for (size_t m = 0; m < 2; m++) {
      blocks[2 * k + m] = (struct dea_block){map_outer,
                                             &outer[2 * k + m],
                                             rest,
                                             even[k],
                                             rests,
                                             s->count,
                                             s->fibre ? DEA_REGION_FIBRE : DEA_REGION_FILM};
    }
  }
}

static dea_status check_quarter(struct dea_context *ctx, const struct dea_quarter *q)
{
  bool fibres = q->fibres == 4 || q->fibres == 8;
  // fibres that meet leave no film between them at the circle a
  double angle = fibres ? asin(fmin(1, 0.5 * q->fibre_width / q->a)) : 0;
  if ((!fibres && q->fibres != 0) || !(angle * (q->fibres == 8 ? 2 : 1) < 0.99 * eighth) ||
      (fibres && !(q->fibre_width > 0 && q->fibre_thickness > 0 && q->across > 0))) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "a mesh of a quarter takes 0, 4 or 8 fibres that do not meet");
  }
  if (q->fine < 1 || q->fine + 2 * q->across >= CUTS_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a mesh takes 1 to %d elements in a row", CUTS_MAX - 1);
  }
  return DEA_OK;
}

dea_status dea_grid_quarter(struct dea_context *ctx, const struct dea_quarter *q,
                            struct dea_grid **out)
{
  enum { INNER_BLOCKS = 3 };
  double turn[CUTS_MAX], back[CUTS_MAX], ring[CUTS_MAX], rest[CUTS_MAX];
  double even[SECTORS_MAX][CUTS_MAX];
  struct sector sectors[SECTORS_MAX];
  struct outer_block outer[2 * SECTORS_MAX];
  struct dea_block blocks[INNER_BLOCKS + 2 * SECTORS_MAX];
  DEA_TRY(ctx, check_quarter(ctx, q));
  double square = eighth * q->a / (double)q->fine;
  double first = q->edge > 0 && q->edge < square ? q->edge : square;
  size_t rings = graded_cuts(0.45 * q->a, first, square, ring);
  size_t rests = graded_cuts(q->b - q->a, first, 2 * square, rest);
  if (rings == 0 || rests == 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a mesh takes 1 to %d elements in a row", CUTS_MAX - 1);
  }
  size_t sector_count = half_sectors(q, sectors);
  size_t turns = turn_cuts(sectors, sector_count, turn);
  reverse_cuts(ring, rings);
  memcpy(back, turn, (turns + 1) * sizeof *back);
  reverse_cuts(back, turns);
  const struct inner_block core = {0, 0.55 * q->a, q->a}, second = {1, core.core, q->a};
  blocks[0] = (struct dea_block){map_core, &core, turn, turn, turns, turns, DEA_REGION_ELECTRODE};
  blocks[1] =
      (struct dea_block){map_inner_ring, &core, ring, turn, rings, turns, DEA_REGION_ELECTRODE};
  blocks[2] =
      (struct dea_block){map_inner_ring, &second, ring, back, rings, turns, DEA_REGION_ELECTRODE};
  outer_blocks(q, sectors, sector_count, rest, rests, even, outer, blocks + INNER_BLOCKS);
  const struct dea_ply film[] = {{q->film_thickness, 1, q->order_z},
                                 {q->fibre_thickness, 1, q->order_z}};
  const struct dea_ply surface[] = {{0, 1, q->order_z},
                                    {0.5 * q->film_thickness, 1, q->order_z},
                                    {q->fibre_thickness, 1, q->order_z}};
  size_t on_fibres = q->fibres > 0 ? (q->membrane ? 2 : 1) : 0;
  DEA_TRY(ctx, dea_grid_create(ctx, q->order, blocks, INNER_BLOCKS + 2 * sector_count,
                               q->membrane ? surface : film, 1 + on_fibres, film_everywhere,
                               q->membrane ? 0 : -0.5 * q->film_thickness, q->b, out));
  return DEA_OK;
}

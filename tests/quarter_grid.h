/* Mesh of a quarter of a disc in a ring, with fibres along the axes and the diagonal: small, and
 * made in another way than the program's meshes of actuators. */
#pragma once

#include "model/solid/mesh/grid.h"

#include <math.h>
#include <string.h>

/* Quarter (x, y >= 0) of a film in a ring, its middle plane at z = 0, with electrodes inside the
 * circle a and fibres from there to the frame, on top of the film: with 4 half a fibre along each
 * axis, with 8 a whole one on the diagonal as well. Lengths in m. */
struct dea_quarter {
  int order, order_z;
  double a, b;           // electrode radius, frame radius
  double film_thickness; // h
  int fibres;            // of the whole actuator: 0, 4 or 8
  double fibre_width, fibre_thickness;
  size_t fine;   // elements along an eighth of the circle a, beside those of the fibres
  size_t across; // elements across half a fibre
  double edge;   // width of the elements on both sides of the circle a, from where they double
                 // up to about square; 0 for no grading
  bool membrane; // the film is a surface, see the plies below
};
enum { DEA_REGION_ELECTRODE, DEA_REGION_FILM, DEA_REGION_FIBRE };
enum { DEA_PLY_FILM, DEA_PLY_FIBRE };
/* The plies with a membrane: the film as a surface at z = 0; under fibres only the layer from
 * there to h/2 that joins them to it (dea_membrane_bond); fibres. */
enum { DEA_PLY_SURFACE, DEA_PLY_BOND, DEA_PLY_FIBRE_ON_BOND };

static const double quarter_eighth = 0.78539816339744831; // pi/4

/* The square in the middle and the two rings between it and the circle a. */
struct quarter_inner_block {
  int half; // of a ring: 0 angles up to pi/4, 1 beyond
  double core, radius;
};

static const double quarter_core_corner =
    0.8; // coordinates of the corner over the side: rounder than 1

static inline void quarter_map_core(const void *self, double s, double t, double x[2])
{
  const struct quarter_inner_block *b = self;
  double pull = 1 - (1 - quarter_core_corner) * s * t;
  x[0] = b->core * s * pull;
  x[1] = b->core * t * pull;
}

static inline void quarter_map_inner_ring(const void *self, double s, double t, double x[2])
{
  const struct quarter_inner_block *b = self;
  double angle = quarter_eighth * (t + b->half), along = b->half == 0 ? t : 1 - t, edge[2];
  quarter_map_core(self, b->half == 0 ? 1 : along, b->half == 0 ? along : 1, edge);
  x[0] = (1 - s) * edge[0] + s * b->radius * cos(angle);
  x[1] = (1 - s) * edge[1] + s * b->radius * sin(angle);
}

/* Outside the circle a: between the angles inner[] there and outer[] at the frame, on straight
 * lines. With angles of equal y at both ends that is the strip of a fibre. */
struct quarter_outer_block {
  double a, b, inner[2], outer[2];
};

static inline void quarter_map_outer(const void *self, double s, double t, double x[2])
{
  const struct quarter_outer_block *o = self;
  double inner = (1 - t) * o->inner[0] + t * o->inner[1];
  double outer = (1 - t) * o->outer[0] + t * o->outer[1];
  x[0] = (1 - s) * o->a * cos(inner) + s * o->b * cos(outer);
  x[1] = (1 - s) * o->a * sin(inner) + s * o->b * sin(outer);
}

enum { QUARTER_CUTS_MAX = 257 };

/* Cuts of [0, 1] for a strip of `length`: elements that start at `first` and double until they are
 * as wide as `widest`, scaled to fit. Returns their number, 0 when there are too many. */
static inline size_t quarter_graded_cuts(double length, double first, double widest, double *cuts)
{
  size_t count = 0;
  double sum = 0, width = first;
  cuts[0] = 0;
  while (sum < length * (1 - 1e-9)) {
    if (count + 2 > QUARTER_CUTS_MAX) {
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
static inline void quarter_reverse_cuts(double *cuts, size_t count)
{
  double turned[QUARTER_CUTS_MAX];
  for (size_t i = 0; i <= count; i++) {
    turned[i] = 1 - cuts[count - i];
  }
  memcpy(cuts, turned, (count + 1) * sizeof *cuts);
}

/* The first ply is the film, solid or not; the others are there for the fibres. */
static inline bool quarter_film_everywhere(const void *self, int region, int ply)
{
  (void)self;
  return ply == 0 || region == DEA_REGION_FIBRE;
}

/* Elements between two angles of the circle a, as shares of pi/4, and where their lines meet the
 * frame. */
struct quarter_sector {
  double from, to, frame_from, frame_to;
  size_t count;
  bool fibre;
};

enum { QUARTER_SECTORS_MAX = 3 };

/* The sectors from an axis to the diagonal; returns their number. */
static inline size_t quarter_half_sectors(const struct dea_quarter *q,
                                          struct quarter_sector out[QUARTER_SECTORS_MAX])
{
  if (q->fibres == 0) {
    out[0] = (struct quarter_sector){0, 1, 0, 1, q->fine, false};
    return 1;
  }
  double a = asin(0.5 * q->fibre_width / q->a) / quarter_eighth;
  double b = asin(0.5 * q->fibre_width / q->b) / quarter_eighth;
  double end = q->fibres == 8 ? a : 0, frame_end = q->fibres == 8 ? b : 0;
  out[0] = (struct quarter_sector){0, a, 0, b, q->across, true};
  out[1] = (struct quarter_sector){a, 1 - end, b, 1 - frame_end, q->fine, false};
  out[2] = (struct quarter_sector){1 - a, 1, 1 - b, 1, q->across, true};
  return q->fibres == 8 ? 3 : 2;
}

/* Cuts of the angle from the axis (0) to the diagonal (1) through all sectors; returns their
 * number. */
static inline size_t quarter_turn_cuts(const struct quarter_sector *sectors, size_t sector_count,
                                       double *cuts)
{
  size_t count = 0;
  cuts[0] = 0;
  for (size_t k = 0; k < sector_count; k++) {
    const struct quarter_sector *s = &sectors[k];
    for (size_t i = 1; i <= s->count; i++) {
      cuts[++count] = s->from + (s->to - s->from) * (double)i / (double)s->count;
    }
  }
  return count;
}

/* Blocks outside the circle a: each sector, and its mirror image beyond the diagonal. */
static inline void quarter_outer_blocks(const struct dea_quarter *q,
                                        const struct quarter_sector *sectors, size_t count,
                                        const double *rest, size_t rests,
                                        double even[QUARTER_SECTORS_MAX][QUARTER_CUTS_MAX],
                                        struct quarter_outer_block *outer, struct dea_block *blocks)
{
  for (size_t k = 0; k < count; k++) {
    const struct quarter_sector *s = &sectors[k];
    for (size_t i = 0; i <= s->count; i++) {
      even[k][i] = (double)i / (double)s->count;
    }
    outer[2 * k] = (struct quarter_outer_block){
        q->a,
        q->b,
        {quarter_eighth * s->from, quarter_eighth * s->to},
        {quarter_eighth * s->frame_from, quarter_eighth * s->frame_to}};
    outer[2 * k + 1] = (struct quarter_outer_block){
        q->a,
        q->b,
        {quarter_eighth * (2 - s->to), quarter_eighth * (2 - s->from)},
        {quarter_eighth * (2 - s->frame_to), quarter_eighth * (2 - s->frame_from)}};
    for (size_t m = 0; m < 2; m++) {
      blocks[2 * k + m] = (struct dea_block){quarter_map_outer,
                                             &outer[2 * k + m],
                                             rest,
                                             even[k],
                                             rests,
                                             s->count,
                                             s->fibre ? DEA_REGION_FIBRE : DEA_REGION_FILM};
    }
  }
}

static inline dea_status dea_grid_quarter(struct dea_context *ctx, const struct dea_quarter *q,
                                          struct dea_grid **out)
{
  enum { INNER_BLOCKS = 3 };
  double turn[QUARTER_CUTS_MAX], back[QUARTER_CUTS_MAX], ring[QUARTER_CUTS_MAX],
      rest[QUARTER_CUTS_MAX];
  double even[QUARTER_SECTORS_MAX][QUARTER_CUTS_MAX];
  struct quarter_sector sectors[QUARTER_SECTORS_MAX];
  struct quarter_outer_block outer[2 * QUARTER_SECTORS_MAX];
  struct dea_block blocks[INNER_BLOCKS + 2 * QUARTER_SECTORS_MAX];
  double square = quarter_eighth * q->a / (double)q->fine;
  double first = q->edge > 0 && q->edge < square ? q->edge : square;
  size_t rings = quarter_graded_cuts(0.45 * q->a, first, square, ring);
  size_t rests = quarter_graded_cuts(q->b - q->a, first, 2 * square, rest);
  if (rings == 0 || rests == 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a mesh takes 1 to %d elements in a row",
                    QUARTER_CUTS_MAX - 1);
  }
  size_t sector_count = quarter_half_sectors(q, sectors);
  size_t turns = quarter_turn_cuts(sectors, sector_count, turn);
  quarter_reverse_cuts(ring, rings);
  memcpy(back, turn, (turns + 1) * sizeof *back);
  quarter_reverse_cuts(back, turns);
  const struct quarter_inner_block core = {0, 0.55 * q->a, q->a}, second = {1, core.core, q->a};
  blocks[0] =
      (struct dea_block){quarter_map_core, &core, turn, turn, turns, turns, DEA_REGION_ELECTRODE};
  blocks[1] = (struct dea_block){quarter_map_inner_ring, &core, ring, turn, rings, turns,
                                 DEA_REGION_ELECTRODE};
  blocks[2] = (struct dea_block){quarter_map_inner_ring, &second, ring, back, rings, turns,
                                 DEA_REGION_ELECTRODE};
  quarter_outer_blocks(q, sectors, sector_count, rest, rests, even, outer, blocks + INNER_BLOCKS);
  const struct dea_ply film[] = {{q->film_thickness, 1, q->order_z},
                                 {q->fibre_thickness, 1, q->order_z}};
  const struct dea_ply surface[] = {{0, 1, q->order_z},
                                    {0.5 * q->film_thickness, 1, q->order_z},
                                    {q->fibre_thickness, 1, q->order_z}};
  size_t on_fibres = q->fibres > 0 ? (q->membrane ? 2 : 1) : 0;
  DEA_TRY(ctx, dea_grid_create(ctx, q->order, blocks, INNER_BLOCKS + 2 * sector_count,
                               q->membrane ? surface : film, 1 + on_fibres, quarter_film_everywhere,
                               q->membrane ? 0 : -0.5 * q->film_thickness, q->b, out));
  return DEA_OK;
}

/* Electrodes on a solid film. */
static inline bool quarter_active(const void *self, int region, int ply)
{
  (void)self;
  return region == DEA_REGION_ELECTRODE && ply == DEA_PLY_FILM;
}

/* Mirror planes x = 0 and y = 0; a frame of 15 mm holds the edge. */
static inline int quarter_held(const void *self, const double X[3])
{
  (void)self;
  if (hypot(X[0], X[1]) > 15e-3 * (1 - 1e-9)) {
    return 1 | 2 | 4;
  }
  return (X[0] < 1e-12 ? 1 : 0) | (X[1] < 1e-12 ? 2 : 0);
}

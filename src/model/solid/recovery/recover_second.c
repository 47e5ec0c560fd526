/* Second derivatives from the slopes of neighbours (docs/theory/trust.md). */
#include "model/solid/recovery/recover_second.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { AXES = 2, SIDES = 4, LINE = 3, TENSOR = 9 }; // side 2 axis: the low end, 2 axis + 1: high

/* One side of an element in the plane, by the corners of its lowest level. */
struct side {
  int low, high; // nodes
  int group;
  int of; // SIDES element + side
};

struct work {
  const struct dea_recover_second *in;
  struct dea_arena memory;
  size_t size;         // numbers of one node
  double *slope;       // [elements][AXES][DEA_RECOVER_LEVELS][size] by the local axis
  double (*length)[2]; // [elements] along the axes
  int *neighbour;      // [SIDES elements] the side on the other side, -1: none
};

/* Node (a, b) of a level: a along the axis, b across it. */
static int place(int axis, int level, int a, int b)
{
  return (level * LINE + (axis == 0 ? b : a)) * LINE + (axis == 0 ? a : b);
}

static const double *node_at(const struct work *w, size_t e, int axis, int a, int b)
{
  const struct dea_grid *grid = w->in->grid;
  return grid->X + 3 * (size_t)grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)place(axis, 0, a, b)];
}

static const double *value_at(const struct work *w, size_t e, int node)
{
  return w->in->value + (e * w->in->nodes + (size_t)node) * w->size;
}

static double *slope_at(const struct work *w, size_t e, int axis, int level)
{
  return w->slope + ((e * AXES + (size_t)axis) * DEA_RECOVER_LEVELS + (size_t)level) * w->size;
}

/* Slopes along an axis, means across it, and how long the element is there. */
static void measure(const struct work *w, size_t e, int axis)
{
  const double *from = node_at(w, e, axis, 0, 1), *to = node_at(w, e, axis, LINE - 1, 1);
  w->length[e][axis] = hypot(to[0] - from[0], to[1] - from[1]);
  for (int level = 0; level < w->in->grid->levels[e]; level++) {
    double *slope = slope_at(w, e, axis, level);
    for (int b = 0; b < LINE; b++) {
      const double *low = value_at(w, e, place(axis, level, 0, b)),
                   *high = value_at(w, e, place(axis, level, LINE - 1, b));
      for (size_t i = 0; i < w->size; i++) {
        slope[i] += (high[i] - low[i]) / (2 * LINE);
      }
    }
  }
}

static int compare(const void *a, const void *b)
{
  const struct side *x = a, *y = b;
  if (x->group != y->group) {
    return x->group < y->group ? -1 : 1;
  }
  if (x->low != y->low) {
    return x->low < y->low ? -1 : 1;
  }
  return (x->high > y->high) - (x->high < y->high);
}

/* Sides that two elements of a group share. */
static void pair(const struct work *w, struct side *sides)
{
  const struct dea_grid *grid = w->in->grid;
  size_t count = SIDES * grid->element_count;
  for (size_t k = 0; k < count; k++) {
    const int *nodes = grid->nodes + k / SIDES * DEA_HEX_NODES_MAX;
    int axis = (int)(k % SIDES) / 2, end = k % 2 == 0 ? 0 : LINE - 1;
    int one = nodes[place(axis, 0, end, 0)], two = nodes[place(axis, 0, end, LINE - 1)];
    sides[k] = (struct side){.low = one < two ? one : two,
                             .high = one < two ? two : one,
                             .group = w->in->group[k / SIDES],
                             .of = (int)k};
    w->neighbour[k] = -1;
  }
  qsort(sides, count, sizeof *sides, compare);
  for (size_t k = 1; k < count; k++) {
    if (compare(&sides[k - 1], &sides[k]) == 0) {
      w->neighbour[sides[k - 1].of] = sides[k].of;
      w->neighbour[sides[k].of] = sides[k - 1].of;
    }
  }
}

/* The normal of the mirror plane that a side lies in; NULL where it lies in none. */
static const double *mirror_of(const struct work *w, size_t e, int axis, int end)
{
  const struct dea_grid *grid = w->in->grid;
  if (w->in->mirror == NULL) {
    return NULL;
  }
  const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
  const double *n = w->in->mirror[nodes[place(axis, 0, end, 1)]];
  const double *from = node_at(w, e, axis, end, 0), *to = node_at(w, e, axis, end, LINE - 1);
  double along[2] = {to[0] - from[0], to[1] - from[1]};
  bool in_it =
      fabs(n[0] * along[0] + n[1] * along[1]) < 1e-6 * hypot(along[0], along[1]); // straight, too
  return in_it && hypot(n[0], n[1]) > 0.5 ? n : NULL;
}

/* out = R v R, R = 1 - 2 n n^T: the tensor beyond the mirror plane of normal n. */
static void reflect(const double n[3], const double v[TENSOR], double out[TENSOR])
{
  double nv[3] = {0}, vn[3] = {0}, nvn = 0;
  for (int i = 0; i < TENSOR; i++) {
    nv[i % 3] += n[i / 3] * v[i];
    vn[i / 3] += v[i] * n[i % 3];
    nvn += n[i / 3] * v[i] * n[i % 3];
  }
  for (int i = 0; i < TENSOR; i++) {
    out[i] =
        v[i] - 2 * (n[i / 3] * nv[i % 3] + vn[i / 3] * n[i % 3]) + 4 * nvn * n[i / 3] * n[i % 3];
  }
}

/* c += share of what one side tells: with the slopes s of the element and s_n of the one beyond, h
 * and h_n their lengths, both outwards, (s_n h / h_n - s) / (3 (1 + h_n / h)). */
static bool add_side(const struct work *w, size_t e, int axis, int end, int level, double *c)
{
  size_t side = SIDES * e + (size_t)(2 * axis + (end > 0));
  const double *own = slope_at(w, e, axis, level), out = end > 0 ? 1 : -1;
  int beyond = w->neighbour[side];
  if (beyond >= 0) {
    size_t other = (size_t)beyond / SIDES;
    int its_axis = beyond % SIDES / 2;
    double back = beyond % 2 == 0 ? 1 : -1; // its axis goes away from here or comes here
    double ratio = w->length[e][axis] / w->length[other][its_axis];
    const double *its = slope_at(w, other, its_axis, level);
    for (size_t i = 0; i < w->size; i++) {
      c[i] += (back * its[i] * ratio - out * own[i]) / (3 * (1 + 1 / ratio));
    }
    return true;
  }
  const double *n = mirror_of(w, e, axis, end);
  for (size_t t = 0; n != NULL && t < w->in->tensors; t++) {
    double image[TENSOR];
    reflect(n, own + TENSOR * t, image);
    for (size_t i = 0; i < TENSOR; i++) {
      c[TENSOR * t + i] -= out * (image[i] + own[TENSOR * t + i]) / 6;
    }
  }
  for (size_t i = TENSOR * w->in->tensors; n != NULL && i < w->size; i++) {
    c[i] -= out * own[i] / 3; // its own image
  }
  return n != NULL;
}

/* The smaller of what both sides tell, nothing where their signs differ: beside a layer of narrow
 * elements only the other side knows how a wide one goes on. One side where only that one tells. */
static void combine(const struct work *w, size_t e, int axis, double *other, double *c)
{
  for (int level = 0; level < w->in->grid->levels[e]; level++) {
    double *at = c + ((e * AXES + (size_t)axis) * DEA_RECOVER_LEVELS + (size_t)level) * w->size;
    memset(other, 0, w->size * sizeof *other);
    bool low = add_side(w, e, axis, 0, level, at);
    bool high = add_side(w, e, axis, LINE - 1, level, low ? other : at);
    for (size_t i = 0; low && high && i < w->size; i++) {
      at[i] = at[i] * other[i] <= 0 ? 0 : fabs(at[i]) < fabs(other[i]) ? at[i] : other[i];
    }
  }
}

dea_status dea_recover_second(struct dea_context *ctx, const struct dea_recover_second *in,
                              double *c)
{
  const struct dea_grid *grid = in->grid;
  struct work w = {.in = in, .memory = {.ctx = ctx}, .size = TENSOR * in->tensors + in->scalars};
  size_t count = grid->element_count;
  w.slope = dea_arena_alloc(&w.memory, count * AXES * DEA_RECOVER_LEVELS * w.size, sizeof *w.slope);
  w.length = dea_arena_alloc(&w.memory, count, sizeof *w.length);
  w.neighbour = dea_arena_alloc(&w.memory, SIDES * count, sizeof *w.neighbour);
  double *other = dea_arena_alloc(&w.memory, w.size, sizeof *other);
  struct side *sides = dea_arena_alloc(&w.memory, SIDES * count, sizeof *sides);
  if (!w.memory.failed) {
    pair(&w, sides);
    for (size_t k = 0; k < AXES * count; k++) {
      measure(&w, k / AXES, (int)(k % AXES));
    }
    for (size_t k = 0; k < AXES * count; k++) {
      combine(&w, k / AXES, (int)(k % AXES), other, c);
    }
  }
  dea_status status = dea_arena_status(&w.memory);
  dea_arena_free(&w.memory);
  return status;
}

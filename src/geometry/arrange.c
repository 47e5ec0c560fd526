/* Which contour is an outline and which a hole: by how often a ray from it meets the others. */
#include "geometry/contour_pieces.h"

#include <math.h>
#include <stdint.h>

enum { LONG_CONTOUR = 200 }; // pieces

/* How often a ray from x towards +x crosses a part of a piece that goes up or down only, from y0 to
 * y1; right: the side of its circle that it is on, 0 for a line. */
static bool crosses(const struct dea_piece *p, const double x[2], double y0, double y1, double side)
{
  if ((y0 <= x[1]) == (y1 <= x[1])) {
    return false;
  }
  if (side == 0) {
    double s = (x[1] - p->from[1]) / (p->to[1] - p->from[1]);
    return p->from[0] + s * (p->to[0] - p->from[0]) > x[0];
  }
  double up = x[1] - p->centre[1], across = sqrt(fmax(0, p->radius_m * p->radius_m - up * up));
  return p->centre[0] + side * across > x[0];
}

/* Whether the ray crosses a piece an odd number of times. An arc is cut at its top and bottom. */
static bool is_crossed(const struct dea_piece *p, const double x[2])
{
  static const double half_pi = 1.57079632679489661923;
  if (!p->arc) {
    return crosses(p, x, p->from[1], p->to[1], 0);
  }
  double low = fmin(p->start, p->start + p->sweep), high = fmax(p->start, p->start + p->sweep);
  bool forward = p->sweep > 0, odd = false;
  double y = forward ? p->from[1] : p->to[1], from = low;
  for (double k = floor(low / half_pi) + 1; k * half_pi < high; k++) {
    if (fmod(k, 2) == 0) {
      continue; // its left or right
    }
    double top = p->centre[1] + (fmod(k, 4) == 1 || fmod(k, 4) == -3 ? 1 : -1) * p->radius_m;
    odd ^= crosses(p, x, y, top, copysign(1, cos(0.5 * (from + k * half_pi))));
    y = top;
    from = k * half_pi;
  }
  return odd ^
         crosses(p, x, y, forward ? p->to[1] : p->from[1], copysign(1, cos(0.5 * (from + high))));
}

/* A point of contour c, whose pieces start at `first`, that no other contour touches. */
static void find_start(const struct dea_pieces *all, size_t first, double out[2])
{
  static const double parts[] = {0.5, 0.31, 0.73, 0.17, 0.89};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
    dea_piece_point(&all->piece[first], parts[k], out);
    const double box[4] = {out[0], out[1], out[0], out[1]};
    size_t cursor = 0, other;
    bool touches = false;
    while (!touches && dea_pieces_next(all, box, &cursor, &other)) {
      touches = all->contour[other] != all->contour[first] &&
                dea_piece_distance_m(&all->piece[other], out) <= all->snap_m;
    }
    if (!touches) {
      return;
    }
  }
}

struct nesting {
  const struct dea_region *region;
  struct dea_pieces all;
  struct dea_box_tree boxes; // of contours
  double *area;              // [contours] not signed
  size_t *mark;              // [contours] 1 + the contour whose ray met this one last
  bool *odd;                 // [contours] that ray met it an odd number of times
  size_t *seen;              // [contours] those that were met
  size_t *parent;            // [contours] the contour around it; itself: none
  bool *hole;                // [contours]
};

/* The contours that a ray from x crosses into n->seen: once all that it crosses an odd number of
 * times, and perhaps others. Returns their number. */
static size_t follow_ray(struct nesting *n, size_t c, const double x[2])
{
  const double ray[4] = {x[0], x[1], INFINITY, x[1]};
  size_t cursor = 0, piece, seen = 0;
  while (dea_pieces_next(&n->all, ray, &cursor, &piece)) {
    size_t other = n->all.contour[piece];
    if (other == c || !is_crossed(&n->all.piece[piece], x)) {
      continue;
    }
    if (n->mark[other] != c + 1) {
      n->mark[other] = c + 1;
      n->odd[other] = false;
      n->seen[seen++] = other;
    }
    n->odd[other] = !n->odd[other];
  }
  return seen;
}

/* The same by looking at contours whose boxes hold x only; SIZE_MAX when one of them is long, so
 * that the ray is quicker. */
static size_t find_around(struct nesting *n, size_t c, const double x[2])
{
  const double at[4] = {x[0], x[1], x[0], x[1]};
  size_t cursor = 0, other, seen = 0;
  while (dea_box_tree_next(&n->boxes, at, &cursor, &other)) {
    size_t first = other > 0 ? n->region->end[other - 1] : 0, end = n->region->end[other];
    if (end - first > LONG_CONTOUR) {
      return SIZE_MAX;
    }
    n->odd[other] = false;
    for (size_t piece = first; piece < end && other != c; piece++) {
      n->odd[other] ^= is_crossed(&n->all.piece[piece], x);
    }
    n->seen[seen++] = other;
  }
  return seen;
}

static void find_parent(struct nesting *n, size_t c)
{
  double x[2];
  find_start(&n->all, c > 0 ? n->region->end[c - 1] : 0, x);
  size_t depth = 0, seen = find_around(n, c, x);
  seen = seen != SIZE_MAX ? seen : follow_ray(n, c, x);
  n->parent[c] = c;
  for (size_t i = 0; i < seen; i++) {
    size_t other = n->seen[i];
    if (n->odd[other]) {
      depth++;
      if (n->parent[c] == c || n->area[other] < n->area[n->parent[c]]) {
        n->parent[c] = other;
      }
    }
  }
  n->hole[c] = depth % 2 == 1;
}

static dea_status build_boxes(struct dea_context *ctx, struct nesting *n)
{
  size_t count = n->region->contour_count;
  struct dea_box *boxes = dea_alloc(ctx, count, sizeof *boxes);
  DEA_TRY_MEMORY(boxes != NULL);
  for (size_t c = 0; c < count; c++) {
    const struct dea_contour contour = dea_region_contour(n->region, c);
    boxes[c] = (struct dea_box){{INFINITY, INFINITY, -INFINITY, -INFINITY}, c};
    dea_contour_grow_box(&contour, boxes[c].side);
    n->area[c] = fabs(dea_contour_area_m2(&contour));
  }
  dea_status status = dea_box_tree_build(ctx, boxes, count, &n->boxes);
  dea_free(ctx, boxes);
  return status;
}

/* Adds contour c of the region to another one: as a hole or an outline, in the sense of it. */
static void add_contour(const struct nesting *n, size_t c, struct dea_region *out)
{
  const struct dea_contour contour = dea_region_contour(n->region, c);
  if ((dea_contour_area_m2(&contour) < 0) == n->hole[c]) {
    dea_region_add(out, contour.vertex, contour.count);
  } else {
    dea_region_add_reversed(out, contour.vertex, contour.count);
  }
}

/* Outlines in their order, each followed by its holes. */
static void add_all(struct nesting *n, struct dea_region *out)
{
  size_t count = n->region->contour_count;
  size_t *first = n->seen, *next = n->mark; // the list of holes of each; `count`: the end
  for (size_t c = 0; c < count; c++) {
    first[c] = next[c] = count;
  }
  for (size_t c = count; c-- > 0;) {
    if (n->hole[c]) {
      next[c] = first[n->parent[c]];
      first[n->parent[c]] = c;
    }
  }
  for (size_t c = 0; c < count; c++) {
    if (!n->hole[c]) {
      add_contour(n, c, out);
      for (size_t hole = first[c]; hole < count; hole = next[hole]) {
        add_contour(n, hole, out);
      }
    }
  }
}

dea_status dea_region_arrange(struct dea_context *ctx, struct dea_region *region)
{
  size_t count = region->contour_count;
  const struct dea_region *const regions[1] = {region};
  struct nesting n = {.region = region};
  struct dea_region out = {.ctx = region->ctx};
  DEA_TRY(ctx, dea_pieces_build(ctx, regions, 1, &n.all));
  struct dea_arena *arena = &n.all.arena;
  n.area = dea_arena_alloc(arena, count, sizeof *n.area);
  n.mark = dea_arena_alloc(arena, count, sizeof *n.mark);
  n.odd = dea_arena_alloc(arena, count, sizeof *n.odd);
  n.seen = dea_arena_alloc(arena, count, sizeof *n.seen);
  n.parent = dea_arena_alloc(arena, count, sizeof *n.parent);
  n.hole = dea_arena_alloc(arena, count, sizeof *n.hole);
  dea_status status = dea_arena_status(arena);
  status = status == DEA_OK ? build_boxes(ctx, &n) : status;
  for (size_t c = 0; c < count && status == DEA_OK; c++) {
    find_parent(&n, c);
    if ((c & 1023) == 0 && dea_interrupted(ctx)) {
      status = dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted while contours were arranged");
    }
  }
  if (status == DEA_OK) {
    add_all(&n, &out);
    status = dea_region_status(&out);
  }
  dea_box_tree_free(ctx, &n.boxes);
  dea_pieces_free(&n.all);
  if (status == DEA_OK) {
    dea_region_free(region);
    *region = out;
  } else {
    dea_region_free(&out);
  }
  return status;
}

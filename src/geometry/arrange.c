/* Which contour is an outline and which a hole: by how many others a point of it lies in. */
#include "geometry/contour_pieces.h"

#include <math.h>

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
  size_t *parent;            // [contours] the contour around it; itself: none
  size_t *first, *next;      // [contours] list of its holes; number of contours: the end
  bool *hole;                // [contours]
};

static void find_parent(struct nesting *n, size_t c)
{
  double x[2];
  find_start(&n->all, c > 0 ? n->region->end[c - 1] : 0, x);
  const double at[4] = {x[0], x[1], x[0], x[1]};
  size_t cursor = 0, other, depth = 0;
  n->parent[c] = c;
  while (dea_box_tree_next(&n->boxes, at, &cursor, &other)) {
    const struct dea_contour contour = dea_region_contour(n->region, other);
    if (other != c && dea_contour_inside(&contour, x[0], x[1])) {
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
  struct dea_box *boxes = dea_arena_alloc(&n->all.arena, count, sizeof *boxes);
  DEA_TRY_MEMORY(boxes != NULL);
  for (size_t c = 0; c < count; c++) {
    const struct dea_contour contour = dea_region_contour(n->region, c);
    boxes[c] = (struct dea_box){{INFINITY, INFINITY, -INFINITY, -INFINITY}, c};
    dea_contour_grow_box(&contour, boxes[c].side);
    n->area[c] = fabs(dea_contour_area_m2(&contour));
  }
  return dea_box_tree_build(ctx, boxes, count, &n->boxes);
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
  for (size_t c = 0; c < count; c++) {
    n->first[c] = count;
  }
  for (size_t c = count; c-- > 0;) {
    if (n->hole[c]) {
      n->next[c] = n->first[n->parent[c]];
      n->first[n->parent[c]] = c;
    }
  }
  for (size_t c = 0; c < count; c++) {
    if (!n->hole[c]) {
      add_contour(n, c, out);
      for (size_t hole = n->first[c]; hole < count; hole = n->next[hole]) {
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
  n.parent = dea_arena_alloc(arena, count, sizeof *n.parent);
  n.first = dea_arena_alloc(arena, count, sizeof *n.first);
  n.next = dea_arena_alloc(arena, count, sizeof *n.next);
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
  dea_region_free(status == DEA_OK ? region : &out);
  if (status == DEA_OK) {
    *region = out;
  }
  return status;
}

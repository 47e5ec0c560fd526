#include "geometry/contour_pieces.h"

#include <math.h>

static dea_status build_tree(struct dea_context *ctx, struct dea_pieces *p)
{
  struct dea_box *boxes = dea_arena_alloc(&p->arena, p->count, sizeof *boxes);
  double all[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  DEA_TRY_MEMORY(boxes != NULL);
  for (size_t i = 0; i < p->count; i++) {
    boxes[i] = (struct dea_box){{INFINITY, INFINITY, -INFINITY, -INFINITY}, i};
    dea_piece_grow_box(&p->piece[i], boxes[i].side);
    dea_piece_grow_box(&p->piece[i], all);
  }
  p->size_m = p->count > 0 ? hypot(all[2] - all[0], all[3] - all[1]) : 0;
  p->snap_m = DEA_GEOMETRY_SNAP * p->size_m;
  return dea_box_tree_build(ctx, boxes, p->count, &p->tree);
}

dea_status dea_pieces_build(struct dea_context *ctx, const struct dea_region *const regions[],
                            size_t count, struct dea_pieces *out)
{
  struct dea_pieces *p = out;
  *p = (struct dea_pieces){.arena = {.ctx = ctx}};
  size_t total = 0, contours = 0;
  for (size_t r = 0; r < count; r++) {
    total += regions[r] != NULL ? regions[r]->vertex_count : 0;
  }
  p->piece = dea_arena_alloc(&p->arena, total, sizeof *p->piece);
  p->contour = dea_arena_alloc(&p->arena, total, sizeof *p->contour);
  p->next = dea_arena_alloc(&p->arena, total, sizeof *p->next);
  p->start = dea_arena_alloc(&p->arena, total, sizeof *p->start);
  for (size_t r = 0; r < count && !p->arena.failed; r++) {
    for (size_t c = 0; regions[r] != NULL && c < regions[r]->contour_count; c++, contours++) {
      const struct dea_contour contour = dea_region_contour(regions[r], c);
      size_t first = p->count;
      for (size_t i = 0; i < contour.count; i++, p->count++) {
        p->piece[p->count] = dea_contour_piece(&contour, i);
        p->contour[p->count] = contours;
        p->next[p->count] = first + (i + 1) % contour.count;
        p->start[p->count] = contour.vertex[i];
      }
    }
  }
  dea_status status = dea_arena_status(&p->arena);
  status = status == DEA_OK ? build_tree(ctx, p) : status;
  DEA_TRY_ELSE(ctx, status, dea_pieces_free(p));
  return DEA_OK;
}

void dea_pieces_free(struct dea_pieces *pieces)
{
  if (pieces->arena.ctx != NULL) {
    dea_box_tree_free(pieces->arena.ctx, &pieces->tree);
  }
  dea_arena_free(&pieces->arena);
}

bool dea_pieces_next(const struct dea_pieces *pieces, const double box[4], size_t *cursor,
                     size_t *found)
{
  double d = pieces->snap_m;
  const double wide[4] = {box[0] - d, box[1] - d, box[2] + d, box[3] + d};
  return dea_box_tree_next(&pieces->tree, wide, cursor, found);
}

/* A layer of a drawing as a region: ends of lines are joined, contours arranged. */
#include "base/text.h"
#include "geometry/contour_pieces.h"
#include "geometry/drawing.h"
#include "geometry/point_map.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* An end of an open path: 2 path + 1 for its last vertex. */
struct joiner {
  const struct dea_drawing *drawing;
  struct dea_arena arena;
  struct dea_point_map node;
  size_t *node_of;            // [2 paths] node at an end
  size_t *ends[2];            // [2 paths] the ends at a node; SIZE_MAX: none
  bool *used;                 // [paths]
  struct dea_vertex *contour; // [vertices] being made
  struct dea_vertex *keep;    // [vertices] of it
  size_t count;
};

static size_t first_vertex(const struct dea_drawing *d, size_t path)
{
  return path > 0 ? d->path[path - 1].end : 0;
}

static const struct dea_vertex *end_vertex(const struct dea_drawing *d, size_t end)
{
  size_t path = end / 2;
  return &d->vertex[end % 2 == 1 ? d->path[path].end - 1 : first_vertex(d, path)];
}

/* Adds a path to the contour from one of its ends on, which is where the first of all ends at its
 * node is, without its last vertex. */
static void follow(struct joiner *j, size_t end)
{
  const struct dea_drawing *d = j->drawing;
  size_t start = j->count, node = j->node_of[end];
  size_t first = first_vertex(d, end / 2), last = d->path[end / 2].end - 1;
  for (size_t k = first; k < last; k++) {
    const struct dea_vertex *v = &d->vertex[end % 2 == 0 ? k : first + last - k];
    const struct dea_vertex *piece = &d->vertex[end % 2 == 0 ? k : first + last - k - 1];
    double bulge = end % 2 == 0 ? piece->bulge : -piece->bulge;
    j->contour[j->count++] = (struct dea_vertex){v->x_m, v->y_m, bulge, piece->location};
  }
  if (node != SIZE_MAX) {
    j->contour[start].x_m = j->node.point[node][0];
    j->contour[start].y_m = j->node.point[node][1];
  }
}

/* Length of the chord from a vertex of the contour to the next one. */
static double chord(const struct joiner *j, size_t vertex)
{
  const struct dea_vertex *v = &j->contour[vertex % j->count];
  const struct dea_vertex *next = &j->contour[(vertex + 1) % j->count];
  return hypot(v->x_m - next->x_m, v->y_m - next->y_m);
}

/* Adds the contour without vertices that lie on the next one: to within `snap`, or, where the
 * pieces on both sides are much longer, to within what ends may be apart. */
static void add_contour(struct joiner *j, double snap, struct dea_region *out)
{
  size_t kept = 0;
  double before = j->count > 0 ? chord(j, j->count - 1) : 0;
  for (size_t i = 0; i < j->count; i++) {
    double length = chord(j, i), beside = fmin(before, chord(j, i + 1));
    bool tiny = length <= DEA_DRAWING_JOIN_M && length < 0.01 * beside;
    if (length > snap && !(tiny && fabs(j->contour[i].bulge) <= 1)) {
      j->keep[kept++] = j->contour[i];
    }
    before = length;
  }
  if (kept > 1) {
    dea_region_add(out, j->keep, kept);
  }
  j->count = 0;
}

static dea_status open_fault(const struct joiner *j, size_t end)
{
  const struct dea_drawing *d = j->drawing;
  const struct dea_vertex *v = end_vertex(d, end);
  double nearest = INFINITY;
  for (size_t path = 0; path < d->path_count; path++) {
    for (size_t other = 2 * path; other < 2 * path + 2 && j->node_of[other] != SIZE_MAX; other++) {
      const struct dea_vertex *u = end_vertex(d, other);
      if (other != end && j->ends[1][j->node_of[other]] == SIZE_MAX) {
        nearest = fmin(nearest, hypot(u->x_m - v->x_m, u->y_m - v->y_m));
      }
    }
  }
  char what[160];
  snprintf(what, sizeof what,
           "the contour is open (the nearest other end is %.3g mm away, ends within %.3g mm are "
           "joined)",
           1e3 * nearest, 1e3 * DEA_DRAWING_JOIN_M);
  return dea_region_fault(d->ctx, v->location, v->x_m, v->y_m, what);
}

/* Whether a path comes no further from its ends, which are one, than they may from each other. */
static bool is_tiny(const struct dea_drawing *d, size_t path)
{
  size_t first = first_vertex(d, path);
  const struct dea_contour contour = {d->vertex + first, d->path[path].end - first, false};
  double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  dea_contour_grow_box(&contour, box);
  return hypot(box[2] - box[0], box[3] - box[1]) <= 2 * DEA_DRAWING_JOIN_M;
}

/* Ends of all open paths of a layer at their nodes, two at each. A path between one and the same
 * node is closed by itself, or too small to be a part of any contour. */
static dea_status find_ends(struct joiner *j, size_t layer)
{
  const struct dea_drawing *d = j->drawing;
  for (size_t end = 0; end < 2 * d->path_count; end++) {
    const struct dea_drawing_path *path = &d->path[end / 2];
    j->node_of[end] = j->ends[0][end] = j->ends[1][end] = SIZE_MAX;
    if (path->layer != layer || path->closed) {
      continue;
    }
    const struct dea_vertex *v = end_vertex(d, end);
    size_t node = dea_point_map_add(&j->node, (double[2]){v->x_m, v->y_m});
    DEA_TRY_MEMORY(!j->node.failed);
    j->node_of[end] = node;
    if (end % 2 == 1 && j->node_of[end - 1] == node) {
      j->node_of[end - 1] = j->node_of[end] = SIZE_MAX;
      j->used[end / 2] = is_tiny(d, end / 2);
    }
  }
  for (size_t end = 0; end < 2 * d->path_count; end++) {
    size_t node = j->node_of[end];
    if (node == SIZE_MAX) {
      continue;
    }
    if (j->ends[1][node] != SIZE_MAX) {
      const struct dea_vertex *v = end_vertex(d, end);
      return dea_region_fault(d->ctx, v->location, v->x_m, v->y_m,
                              "more than two lines meet (one that is drawn twice?)");
    }
    j->ends[j->ends[0][node] == SIZE_MAX ? 0 : 1][node] = end;
  }
  for (size_t end = 0; end < 2 * d->path_count; end++) {
    if (j->node_of[end] != SIZE_MAX && j->ends[1][j->node_of[end]] == SIZE_MAX) {
      return open_fault(j, end);
    }
  }
  return DEA_OK;
}

static dea_status join(struct joiner *j, size_t layer, double snap, struct dea_region *out)
{
  const struct dea_drawing *d = j->drawing;
  DEA_TRY(d->ctx, find_ends(j, layer));
  for (size_t path = 0; path < d->path_count; path++) {
    if (d->path[path].layer != layer || j->used[path]) {
      continue;
    }
    if (d->path[path].closed) {
      size_t first = first_vertex(d, path);
      j->count = d->path[path].end - first;
      memcpy(j->contour, d->vertex + first, j->count * sizeof *j->contour);
    }
    for (size_t end = 2 * path; !d->path[path].closed && !j->used[end / 2];) {
      j->used[end / 2] = true;
      follow(j, end);
      size_t far_end = end ^ 1, node = j->node_of[far_end];
      if (node != SIZE_MAX) {
        end = j->ends[0][node] == far_end ? j->ends[1][node] : j->ends[0][node];
      }
    }
    add_contour(j, snap, out);
  }
  return dea_region_status(out);
}

static dea_status no_layer(const struct dea_drawing *d, const char *layer,
                           struct dea_location asked)
{
  struct dea_text names = {.ctx = d->ctx};
  for (size_t i = 0; i < d->layer_count && names.length < 300; i++) {
    dea_text_add(&names, "%s'%s'", i > 0 ? ", " : "", d->layer[i]);
  }
  if (asked.file == NULL) {
    asked.file = "";
  }
  const char *near = dea_nearest_name(layer, d->layer, d->layer_count);
  char text[600];
  snprintf(text, sizeof text, "'%s' has no layer '%s'; its layers are %s%s%s%s", d->file, layer,
           d->layer_count > 0 ? dea_text_get(&names) : "none", near != NULL ? "; is '" : "",
           near != NULL ? near : "", near != NULL ? "' meant?" : "");
  dea_text_free(&names);
  return dea_refuse(d->ctx, asked, text);
}

dea_status dea_drawing_region(const struct dea_drawing *drawing, const char *layer,
                              struct dea_location asked, struct dea_region *out)
{
  const struct dea_drawing *d = drawing;
  size_t number = dea_drawing_find_layer(d, layer), ends = 2 * d->path_count;
  if (number == d->layer_count) {
    return no_layer(d, layer, asked);
  }
  for (size_t i = 0; i < d->skipped_count; i++) {
    const struct dea_drawing_skipped *s = &d->skipped[i];
    if (s->layer == number) {
      DEA_TRY(d->ctx, dea_finding_add(d->ctx, DEA_WARNING, s->location,
                                      "layer '%s': %zu of the kind %s %s not read", layer, s->count,
                                      s->kind, s->count == 1 ? "is" : "are"));
    }
  }
  struct joiner j = {.drawing = d, .arena = {.ctx = d->ctx}};
  j.node = (struct dea_point_map){.ctx = d->ctx, .tolerance_m = DEA_DRAWING_JOIN_M};
  j.node_of = dea_arena_alloc(&j.arena, ends, sizeof *j.node_of);
  j.ends[0] = dea_arena_alloc(&j.arena, ends, sizeof *j.ends[0]);
  j.ends[1] = dea_arena_alloc(&j.arena, ends, sizeof *j.ends[1]);
  j.used = dea_arena_alloc(&j.arena, d->path_count, sizeof *j.used);
  j.contour = dea_arena_alloc(&j.arena, d->vertex_count, sizeof *j.contour);
  j.keep = dea_arena_alloc(&j.arena, d->vertex_count, sizeof *j.keep);
  double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (size_t i = 0; i < d->vertex_count; i++) {
    const struct dea_piece point = {.from = {d->vertex[i].x_m, d->vertex[i].y_m},
                                    .to = {d->vertex[i].x_m, d->vertex[i].y_m}};
    dea_piece_grow_box(&point, box);
  }
  double snap =
      d->vertex_count > 0 ? DEA_GEOMETRY_SNAP * hypot(box[2] - box[0], box[3] - box[1]) : 0;
  dea_status status = dea_arena_status(&j.arena);
  status = status == DEA_OK ? join(&j, number, snap, out) : status;
  dea_point_map_free(&j.node);
  dea_arena_free(&j.arena);
  if (status == DEA_OK && out->contour_count == 0) {
    char what[300];
    snprintf(what, sizeof what, "layer '%.200s' of the drawing holds no contour", layer);
    status = dea_region_fault(d->ctx, asked, NAN, NAN, what);
  }
  status = status == DEA_OK ? dea_region_check(d->ctx, out, true) : status;
  status = status == DEA_OK ? dea_region_arrange(d->ctx, out) : status;
  if (status == DEA_OK && !(dea_region_area_m2(out) > 0)) {
    status = dea_region_fault(d->ctx, asked, NAN, NAN,
                              "the layer lies so far from the drawing's origin that rounding "
                              "leaves its contours no area");
  }
  DEA_TRY_ELSE(d->ctx, status, dea_region_free(out));
  return DEA_OK;
}

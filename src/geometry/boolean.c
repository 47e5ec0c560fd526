/* Booleans of regions with exact arcs: docs/theory/geometry.md.
 *
 * 1. Every piece is cut at its nodes: its ends, where it crosses others (closed forms), and where
 *    ends of others lie on it. Nodes nearer than the tolerance are one.
 * 2. Between nodes arcs become chords, in the same way for all arcs of one circle.
 * 3. GEOS combines the polygons. Since they meet at common points only, it makes no new ones.
 * 4. Each point of the result is found again: nodes stay, chords of an arc become that arc. */
#include "geometry/boolean.h"

#include "base/module.h"
#include "geometry/contour_pieces.h"
#include "geometry/overlay.h"
#include "geometry/point_map.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Height of an arc over its chords, as a part of the drawing's size, at the first attempt and at
 * the others. */
static const double first_height = 1e-6, finer = 1.0 / 64;
enum { ATTEMPTS = 3, LEAST_CHORDS = 2 };

static const char module_file[] = "dea_geos_module.so";

bool dea_boolean_find(char *out, size_t size)
{
  return dea_module_find(module_file, out, size);
}

/* A node on a piece. */
struct cut {
  size_t piece, node;
  double along; // angle or length from the start of the piece
};

/* What lies between two nodes that follow each other on a piece. */
struct edge {
  size_t from, to; // nodes; an arc goes counter-clockwise from one to the other
  size_t circle;   // SIZE_MAX: a line
  size_t piece;
};

struct work {
  struct dea_context *ctx;
  struct dea_pieces all; // arcs of one circle have its very centre and radius
  size_t *circle;        // [all.count] first of the pieces on the same circle; SIZE_MAX: a line
  struct dea_point_map node;
  struct cut *cut; // sorted by piece and along it; owned
  size_t cut_count, cut_room;
  struct edge *edge; // owned
  size_t edge_count, edge_room;
  double height_m; // of arcs over their chords, at most
  struct dea_point_map chord;
  size_t *chord_edge; // [chord.count] edge that a point between nodes belongs to; owned
  size_t chord_room;
};

/* ---- circles ---- */

static double off_circle(const struct dea_piece *arc, const double x[2])
{
  return fabs(hypot(x[0] - arc->centre[0], x[1] - arc->centre[1]) - arc->radius_m);
}

/* Whether an arc lies on the circle of a longer one. */
static bool on_circle(const struct dea_piece *longer, const struct dea_piece *arc, double snap)
{
  double middle[2];
  dea_piece_point(arc, 0.5, middle);
  return off_circle(longer, arc->from) <= snap && off_circle(longer, arc->to) <= snap &&
         off_circle(longer, middle) <= snap;
}

static int longer_first(const void *one, const void *two)
{
  const struct dea_box *a = one, *b = two;
  int order = (a->side[0] < b->side[0]) - (a->side[0] > b->side[0]);
  return order != 0 ? order : (a->item > b->item) - (a->item < b->item);
}

/* Gives all arcs of one circle the centre and radius of the longest. */
static dea_status find_circles(struct work *w)
{
  struct dea_pieces *all = &w->all;
  w->circle = dea_arena_alloc(&all->arena, all->count, sizeof *w->circle);
  struct dea_box *order = dea_arena_alloc(&all->arena, all->count, sizeof *order); // by length
  DEA_TRY_MEMORY(order != NULL);
  for (size_t i = 0; i < all->count; i++) {
    w->circle[i] = SIZE_MAX;
    order[i] = (struct dea_box){{all->piece[i].length_m}, i};
  }
  qsort(order, all->count, sizeof *order, longer_first);
  for (size_t k = 0; k < all->count; k++) {
    size_t i = order[k].item, cursor = 0, j;
    struct dea_piece *arc = &all->piece[i];
    double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    if (!arc->arc) {
      continue;
    }
    w->circle[i] = i;
    dea_piece_grow_box(arc, box);
    while (w->circle[i] == i && dea_pieces_next(all, box, &cursor, &j)) {
      if (w->circle[j] != SIZE_MAX && j != i && on_circle(&all->piece[j], arc, all->snap_m)) {
        const struct dea_piece *other = &all->piece[j];
        w->circle[i] = w->circle[j];
        memcpy(arc->centre, other->centre, sizeof arc->centre);
        arc->radius_m = other->radius_m;
        arc->start = atan2(arc->from[1] - arc->centre[1], arc->from[0] - arc->centre[0]);
      }
    }
  }
  return DEA_OK;
}

/* ---- nodes ---- */

/* Angle from a to b about the centre of a piece, counter-clockwise, in (0, 2 pi]. */
static double angle_between(const struct dea_piece *circle, const double a[2], const double b[2])
{
  double from = atan2(a[1] - circle->centre[1], a[0] - circle->centre[0]);
  double to = atan2(b[1] - circle->centre[1], b[0] - circle->centre[0]);
  return to > from ? to - from : to - from + 2 * DEA_PI;
}

static dea_status add_cut(struct work *w, size_t piece, const double x[2])
{
  const struct dea_piece *p = &w->all.piece[piece];
  size_t node = dea_point_map_add(&w->node, x);
  DEA_TRY_MEMORY(!w->node.failed);
  DEA_TRY_STATUS(dea_array_grow(w->ctx, &w->cut, w->cut_count, &w->cut_room, sizeof *w->cut));
  const double *at = w->node.point[node];
  double along = dea_apart_m(p->from, at);
  if (p->arc) {
    along = p->sweep > 0 ? angle_between(p, p->from, at) : angle_between(p, at, p->from);
  }
  if (dea_apart_m(p->from, at) <= w->all.snap_m) {
    along = 0;
  } else if (dea_apart_m(p->to, at) <= w->all.snap_m) {
    along = INFINITY;
  }
  w->cut[w->cut_count++] = (struct cut){piece, node, along};
  return DEA_OK;
}

static dea_status cut_pair(struct work *w, size_t i, size_t j)
{
  const struct dea_piece *a = &w->all.piece[i], *b = &w->all.piece[j];
  double snap = w->all.snap_m, at[2][2];
  for (int k = 0; k < 2; k++) {
    const double *of_a = k == 0 ? a->from : a->to, *of_b = k == 0 ? b->from : b->to;
    DEA_TRY(w->ctx, dea_piece_distance_m(b, of_a) <= snap ? add_cut(w, j, of_a) : DEA_OK);
    DEA_TRY(w->ctx, dea_piece_distance_m(a, of_b) <= snap ? add_cut(w, i, of_b) : DEA_OK);
  }
  if (a->arc && b->arc && w->circle[i] == w->circle[j]) {
    return DEA_OK;
  }
  int count = dea_piece_crossings(a, b, snap, at);
  for (int k = 0; k < count; k++) {
    if (dea_piece_distance_m(a, at[k]) <= snap && dea_piece_distance_m(b, at[k]) <= snap) {
      DEA_TRY(w->ctx, add_cut(w, i, at[k]));
      DEA_TRY(w->ctx, add_cut(w, j, at[k]));
    }
  }
  return DEA_OK;
}

static int by_piece(const void *one, const void *two)
{
  const struct cut *a = one, *b = two;
  int order = (a->piece > b->piece) - (a->piece < b->piece);
  return order != 0 ? order : (a->along > b->along) - (a->along < b->along);
}

/* All nodes, the vertices first so that they stay where they are. */
static dea_status find_cuts(struct work *w)
{
  const struct dea_pieces *all = &w->all;
  for (size_t i = 0; i < all->count; i++) {
    DEA_TRY(w->ctx, add_cut(w, i, all->piece[i].from));
    DEA_TRY(w->ctx, add_cut(w, i, all->piece[i].to));
  }
  for (size_t i = 0; i < all->count; i++) {
    double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    size_t cursor = 0, j;
    dea_piece_grow_box(&all->piece[i], box);
    while (dea_pieces_next(all, box, &cursor, &j)) {
      DEA_TRY(w->ctx, j > i ? cut_pair(w, i, j) : DEA_OK);
    }
    if ((i & 255) == 0 && dea_interrupted(w->ctx)) {
      return dea_fail(w->ctx, DEA_E_INTERRUPTED, "interrupted while regions were combined");
    }
  }
  qsort(w->cut, w->cut_count, sizeof *w->cut, by_piece);
  return DEA_OK;
}

static dea_status find_edges(struct work *w)
{
  for (size_t k = 0; k + 1 < w->cut_count; k++) {
    const struct cut *a = &w->cut[k], *b = &w->cut[k + 1];
    if (a->piece != b->piece || a->node == b->node) {
      continue;
    }
    DEA_TRY_STATUS(dea_array_grow(w->ctx, &w->edge, w->edge_count, &w->edge_room, sizeof *w->edge));
    bool clockwise = w->all.piece[a->piece].sweep < 0;
    w->edge[w->edge_count++] =
        (struct edge){clockwise ? b->node : a->node, clockwise ? a->node : b->node,
                      w->circle[a->piece], a->piece};
  }
  return DEA_OK;
}

/* ---- chords ---- */

/* Points of an arc between its nodes: which they are depends on circle and nodes only. */
static size_t chord_count(const struct work *w, const struct edge *edge)
{
  if (edge->circle == SIZE_MAX) {
    return 1;
  }
  const struct dea_piece *circle = &w->all.piece[edge->circle];
  double sweep = angle_between(circle, w->node.point[edge->from], w->node.point[edge->to]);
  double step = fmin(DEA_PI / 16, sqrt(8 * w->height_m / circle->radius_m));
  return (size_t)fmax(LEAST_CHORDS, ceil(sweep / step));
}

static void chord_point(const struct work *w, const struct edge *edge, size_t k, size_t count,
                        double out[2])
{
  const struct dea_piece *circle = &w->all.piece[edge->circle];
  const double *from = w->node.point[edge->from];
  double sweep = angle_between(circle, from, w->node.point[edge->to]);
  double angle = atan2(from[1] - circle->centre[1], from[0] - circle->centre[0]) +
                 (double)k * sweep / (double)count;
  out[0] = circle->centre[0] + circle->radius_m * cos(angle);
  out[1] = circle->centre[1] + circle->radius_m * sin(angle);
}

/* A growing set of rings. */
struct ring_writer {
  struct work *work;
  struct dea_rings *rings;
  size_t point_count, point_room;
};

static dea_status add_point(struct ring_writer *writer, const double x[2])
{
  DEA_TRY_STATUS(dea_array_grow(writer->work->ctx, &writer->rings->point, writer->point_count,
                                &writer->point_room, sizeof *writer->rings->point));
  memcpy(writer->rings->point[writer->point_count++], x, 2 * sizeof *x);
  return DEA_OK;
}

/* Adds an edge without its end, in the sense of its piece. */
static dea_status add_edge(struct ring_writer *writer, size_t number)
{
  struct work *w = writer->work;
  const struct edge *edge = &w->edge[number];
  size_t count = chord_count(w, edge);
  bool clockwise = w->all.piece[edge->piece].sweep < 0;
  DEA_TRY(w->ctx, add_point(writer, w->node.point[clockwise ? edge->to : edge->from]));
  for (size_t k = 1; k < count; k++) {
    double x[2];
    size_t known = w->chord.count;
    chord_point(w, edge, clockwise ? count - k : k, count, x);
    DEA_TRY(w->ctx, add_point(writer, x));
    size_t index = dea_point_map_add(&w->chord, x);
    DEA_TRY_MEMORY(!w->chord.failed);
    DEA_TRY_STATUS(dea_array_grow(w->ctx, &w->chord_edge, w->chord.count, &w->chord_room,
                                  sizeof *w->chord_edge));
    if (index == known) { // an arc that two pieces share is known from the first
      w->chord_edge[index] = number;
    }
  }
  return DEA_OK;
}

/* A region as rings of chords. *edge: its first edge, then the one after its last; contour: the
 * number of its first one. Whether a contour is a hole is told by its sense. */
static dea_status write_rings(struct work *w, const struct dea_region *region, size_t *edge,
                              size_t contour, struct dea_rings *out)
{
  struct ring_writer writer = {.work = w, .rings = out};
  size_t polygon = 0, before = 0;
  out->end = dea_alloc(w->ctx, region->contour_count, sizeof *out->end);
  out->polygon = dea_alloc(w->ctx, region->contour_count, sizeof *out->polygon);
  DEA_TRY_MEMORY(out->end != NULL && out->polygon != NULL);
  for (size_t c = 0; c < region->contour_count; c++) {
    const struct dea_contour own = dea_region_contour(region, c);
    bool hole = dea_contour_area_m2(&own) < 0;
    if (hole && c == 0) {
      return dea_region_fault(w->ctx, own.vertex[0].location, own.vertex[0].x_m, own.vertex[0].y_m,
                              "a hole without an outline");
    }
    polygon += !hole;
    for (; *edge < w->edge_count && w->all.contour[w->edge[*edge].piece] == contour + c; ++*edge) {
      DEA_TRY(w->ctx, add_edge(&writer, *edge));
    }
    if (writer.point_count - before < 3) { // its points are one
      return dea_region_fault(w->ctx, own.vertex[0].location, own.vertex[0].x_m, own.vertex[0].y_m,
                              "the contour is smaller than a billionth of the distance to what it "
                              "is combined with, and nothing is left of it");
    }
    before = writer.point_count;
    out->polygon[c] = polygon;
    out->end[c] = writer.point_count;
    out->count++;
  }
  return DEA_OK;
}

/* ---- back ---- */

/* A piece of the result. */
struct found {
  size_t node, circle, edge;
  double sweep; // signed; 0: a line
  struct dea_location location;
};

/* One ring of the result being read. */
struct reading {
  struct work *work;
  double (*point)[2];
  size_t count;
  const double *unknown; // a point that is not ours
};

/* Node of a point, or SIZE_MAX and the edge between nodes that it belongs to. */
static bool find_node(struct reading *r, size_t i, size_t *node, size_t *edge)
{
  const struct work *w = r->work;
  const double *x = r->point[i % r->count];
  *node = dea_point_map_find(&w->node, x);
  *edge = SIZE_MAX;
  if (*node != SIZE_MAX && dea_apart_m(w->node.point[*node], x) == 0) {
    return true;
  }
  size_t chord = dea_point_map_find(&w->chord, x);
  *node = SIZE_MAX;
  *edge = chord != SIZE_MAX ? w->chord_edge[chord] : SIZE_MAX;
  if (chord == SIZE_MAX) {
    r->unknown = x;
  }
  return chord != SIZE_MAX;
}

static int by_nodes(const void *one, const void *two)
{
  const struct edge *a = one, *b = two;
  size_t a_low = a->from < a->to ? a->from : a->to, b_low = b->from < b->to ? b->from : b->to;
  size_t a_high = a->from + a->to - a_low, b_high = b->from + b->to - b_low;
  int order = (a_low > b_low) - (a_low < b_low);
  return order != 0 ? order : (a_high > b_high) - (a_high < b_high);
}

/* Ring of points -> pieces from node to node; pieces[count] has room for a piece a point. 0 and
 * `unknown` when a point is none of ours. */
static size_t read_pieces(struct reading *r, struct found *pieces)
{
  const struct work *w = r->work;
  size_t node, edge, first = 0, count = 0;
  while (first < r->count && find_node(r, first, &node, &edge) && node == SIZE_MAX) {
    first++;
  }
  if (r->unknown != NULL || first == r->count) {
    r->unknown = r->point[0];
    return 0;
  }
  for (size_t i = first; i < first + r->count;) {
    find_node(r, i, &node, &edge);
    struct found piece = {.node = node, .circle = SIZE_MAX, .edge = SIZE_MAX};
    size_t next = SIZE_MAX, inner = SIZE_MAX;
    do { // over the points between nodes
      i++;
      if (!find_node(r, i, &next, &edge) ||
          (next == SIZE_MAX && inner != SIZE_MAX && edge != inner)) {
        r->unknown = r->point[i % r->count];
        return 0;
      }
      inner = next == SIZE_MAX ? edge : inner;
    } while (next == SIZE_MAX);
    if (inner != SIZE_MAX) {
      const struct edge *arc = &w->edge[inner];
      bool forward = arc->from == piece.node && arc->to == next;
      if (!forward && !(arc->to == piece.node && arc->from == next)) {
        r->unknown = w->node.point[next];
        return 0;
      }
      piece.circle = arc->circle;
      piece.edge = inner;
      piece.sweep = angle_between(&w->all.piece[arc->circle], w->node.point[arc->from],
                                  w->node.point[arc->to]);
      piece.sweep *= forward ? 1 : -1;
    }
    pieces[count++] = piece;
  }
  return count;
}

/* Whether the node between two pieces of the result is no corner: one arc, or one line, goes on. */
static bool goes_on(const struct work *w, const struct found *a, const struct found *b,
                    const struct found *after)
{
  if (a->circle != b->circle) {
    return false;
  }
  if (a->circle != SIZE_MAX) {
    return a->sweep * b->sweep > 0 && fabs(a->sweep + b->sweep) <= 1.5 * DEA_PI;
  }
  const double *p = w->node.point[a->node], *q = w->node.point[b->node];
  const double *s = w->node.point[after->node];
  double cross = (q[0] - p[0]) * (s[1] - p[1]) - (q[1] - p[1]) * (s[0] - p[0]);
  double dot = (q[0] - p[0]) * (s[0] - q[0]) + (q[1] - p[1]) * (s[1] - q[1]);
  return dot > 0 && fabs(cross) <= 1e-13 * w->all.size_m * dea_apart_m(p, s);
}

/* Makes one of pieces that go on; returns how many are left. */
static size_t join_pieces(const struct work *w, struct found *p, size_t count)
{
  size_t start = 0, kept = 0;
  while (start < count &&
         goes_on(w, &p[(start + count - 1) % count], &p[start], &p[(start + 1) % count])) {
    start++;
  }
  // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): called with pieces
  for (size_t turns = start % count; turns > 0; turns--) { // begin at a corner, if there is one
    struct found head = p[0];
    memmove(p, p + 1, (count - 1) * sizeof *p);
    p[count - 1] = head;
  }
  for (size_t i = 0; i < count; i++) {
    if (kept > 0 && goes_on(w, &p[kept - 1], &p[i], &p[(i + 1) % count])) {
      p[kept - 1].sweep += p[i].sweep;
    } else {
      p[kept++] = p[i];
    }
  }
  return kept;
}

/* Place in the input of what a line between two nodes was made of. */
static struct dea_location location_of(const struct work *w, const struct edge *sorted,
                                       const struct found *piece, size_t next)
{
  const struct edge key = {piece->node, next, SIZE_MAX, 0};
  const struct edge *edge = piece->edge != SIZE_MAX
                                ? &w->edge[piece->edge]
                                : bsearch(&key, sorted, w->edge_count, sizeof *sorted, by_nodes);
  return edge != NULL ? w->all.start[edge->piece].location : (struct dea_location){"", 0, 0};
}

/* Room for the largest ring of a result. */
struct ring_room {
  struct found *piece;
  struct dea_vertex *vertex;
};

/* Adds a ring of the result as a contour, counter-clockwise unless it is a hole; not one that is
 * thinner than the tolerance. */
static dea_status add_ring(struct reading *r, const struct edge *sorted, bool hole,
                           const struct ring_room *capacity, struct dea_region *out)
{
  const struct work *w = r->work;
  struct found *p = capacity->piece;
  size_t count = read_pieces(r, p);
  for (size_t i = 0; i < count; i++) { // before they are joined
    p[i].location = location_of(w, sorted, &p[i], p[(i + 1) % count].node);
  }
  count = count > 0 ? join_pieces(w, p, count) : 0;
  for (size_t i = 0; i < count; i++) {
    const double *x = w->node.point[p[i].node];
    capacity->vertex[i] = (struct dea_vertex){x[0], x[1], tan(0.25 * p[i].sweep), p[i].location};
  }
  const struct dea_contour contour = {capacity->vertex, count, true};
  double area = count > 1 ? dea_contour_area_m2(&contour) : 0;
  if (count > 1 && fabs(area) > w->all.snap_m * dea_contour_length_m(&contour)) {
    if ((area < 0) == hole) {
      dea_region_add(out, capacity->vertex, count);
    } else {
      dea_region_add_reversed(out, capacity->vertex, count);
    }
  }
  return dea_region_status(out);
}

/* The result of GEOS as a region; *unknown: a point that is not ours. */
static dea_status read_rings(struct work *w, const struct dea_rings *rings, struct dea_arena *arena,
                             struct dea_region *out, const double **unknown)
{
  size_t longest = 0;
  for (size_t i = 0; i < rings->count; i++) {
    size_t count = rings->end[i] - (i > 0 ? rings->end[i - 1] : 0);
    longest = count > longest ? count : longest;
  }
  struct edge *sorted = dea_arena_alloc(arena, w->edge_count, sizeof *sorted);
  const struct ring_room capacity = {dea_arena_alloc(arena, longest, sizeof *capacity.piece),
                                     dea_arena_alloc(arena, longest, sizeof *capacity.vertex)};
  DEA_TRY(w->ctx, dea_arena_status(arena));
  if (w->edge_count > 0) {
    memcpy(sorted, w->edge, w->edge_count * sizeof *sorted);
    qsort(sorted, w->edge_count, sizeof *sorted, by_nodes);
  }
  for (size_t i = 0; i < rings->count && *unknown == NULL; i++) {
    size_t first = i > 0 ? rings->end[i - 1] : 0;
    struct reading r = {w, rings->point + first, rings->end[i] - first, NULL};
    bool hole = i > 0 && rings->polygon[i] == rings->polygon[i - 1];
    DEA_TRY(w->ctx, add_ring(&r, sorted, hole, &capacity, out));
    *unknown = r.unknown;
  }
  return DEA_OK;
}

/* One attempt with arcs of that height over their chords. *at: a point at which edges are too near
 * to each other for it; NAN when it went well. */
static dea_status attempt(struct work *w, enum dea_boolean what, const struct dea_region *a,
                          const struct dea_region *b, const struct dea_overlay_type *geos,
                          struct dea_region *out, double at[2])
{
  struct dea_rings rings[3] = {{0}, {0}, {0}};
  struct dea_arena arena = {.ctx = w->ctx};
  const double *unknown = NULL;
  size_t edge = 0;
  w->chord = (struct dea_point_map){.ctx = w->ctx, .cell_m = w->height_m};
  dea_status status = write_rings(w, a, &edge, 0, &rings[0]);
  status = status == DEA_OK ? write_rings(w, b, &edge, a->contour_count, &rings[1]) : status;
  status = status == DEA_OK ? geos->overlay(w->ctx, what, &rings[0], &rings[1], &rings[2]) : status;
  status = status == DEA_OK ? read_rings(w, &rings[2], &arena, out, &unknown) : status;
  at[0] = unknown != NULL ? unknown[0] : NAN;
  at[1] = unknown != NULL ? unknown[1] : NAN;
  dea_arena_free(&arena);
  for (int i = 0; i < 3; i++) {
    dea_free(w->ctx, rings[i].point);
    dea_free(w->ctx, rings[i].end);
    dea_free(w->ctx, rings[i].polygon);
  }
  dea_point_map_free(&w->chord);
  dea_free(w->ctx, w->chord_edge);
  w->chord_edge = NULL;
  w->chord_room = 0;
  return status;
}

static dea_status combine(struct work *w, enum dea_boolean what, const struct dea_region *a,
                          const struct dea_region *b, const struct dea_overlay_type *geos,
                          struct dea_region *out)
{
  double at[2] = {NAN, NAN};
  DEA_TRY(w->ctx, find_circles(w));
  w->node = (struct dea_point_map){.ctx = w->ctx, .tolerance_m = w->all.snap_m};
  DEA_TRY(w->ctx, find_cuts(w));
  DEA_TRY(w->ctx, find_edges(w));
  w->height_m = first_height * w->all.size_m;
  for (int k = 0; k < ATTEMPTS; k++, w->height_m *= finer) {
    DEA_TRY(w->ctx, attempt(w, what, a, b, geos, out, at));
    if (isnan(at[0])) {
      return DEA_OK;
    }
    dea_region_free(out);
  }
  return dea_region_fault(w->ctx, w->all.start[0].location, at[0], at[1],
                          "edges are too near to each other to be told apart");
}

dea_status dea_region_combine(struct dea_context *ctx, enum dea_boolean what,
                              const struct dea_region *a, const struct dea_region *b,
                              struct dea_region *out)
{
  const struct dea_region none = {.ctx = ctx};
  b = b != NULL ? b : &none;
  const struct dea_region *const both[2] = {a, b};
  const void *geos = NULL;
  for (int i = 0; i < 2; i++) {
    DEA_TRY(ctx, dea_region_status(both[i]));
    DEA_TRY(ctx, dea_region_check(ctx, both[i], false));
  }
  if (a->contour_count == 0 && (b->contour_count == 0 || what != DEA_UNION)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_module_open(ctx, module_file, "dea_geos_module", "what combines regions",
                               "it is built when libgeos-dev is installed", &geos));
  struct work w = {.ctx = ctx};
  DEA_TRY(ctx, dea_pieces_build(ctx, both, 2, &w.all));
  dea_status status = combine(&w, what, a, b, geos, out);
  dea_free(ctx, w.cut);
  dea_free(ctx, w.edge);
  dea_point_map_free(&w.node);
  dea_pieces_free(&w.all);
  DEA_TRY_ELSE(ctx, status, dea_region_free(out));
  return DEA_OK;
}

/* The elements around a node are parted by the curves into classes; a class that has sides on a
 * curve is moved away from it, and the rows fill what it leaves. All nodes are found again by their
 * places. */
#include "model/solid/mesh/edge_layers.h"

#include "base/arena.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDES = 4, LINE_MAX_NODES = 3, TRIES = 40 };

static const double outermost = 2;     // width of the last of two rows over that of the first
static const double room_share = 0.35; // of an element, that rows may take
static const double parallel = 0.2;    // sine between sides that go on smoothly
static const double longest = 2;       // of a shift at a corner over the width
static const double good = 0.2, usable = 0.1; // smallest Jacobian that is looked for, and taken
static const double close_share = 1e-9;       // of the size of the mesh: nodes that are one

/* Side k of an element goes from its corner k to the next one, the element to its left. */
struct side {
  int low, high; // nodes
  size_t of;     // SIDES element + side
};

/* What nodes of a side without rows had better move along; rather the end of the mesh. */
enum guide { NO_GUIDE, ON_CURVE, AT_END };

/* What moves together at a node. */
struct class
{
  size_t sides;
  enum guide guides;
  double normal[2][2], width[2]; // of its sides on curves, into the elements
  double guide[2];               // along a side that stays one of a curve or of the mesh
  double capacity;               // how far elements reach
  double shift[2];
};

struct work {
  const struct dea_plane_mesh *mesh;
  const struct dea_edge_layers *layers;
  struct dea_arena memory;
  int line, per;         // nodes of a side, of an element
  size_t count;          // of sides, and of corners
  struct side *sorted;   // [count]
  double *width;         // [count] of the rows along a side; 0: none
  bool *cut;             // [count] parts classes
  enum guide *guide;     // [count]
  int *parent;           // [count] of a corner, to its class
  struct class *classes; // [count] by the corner that is its own parent
  double *scale;         // [count] of a class's shift
};

static int corner_place(const struct work *w, int corner)
{
  const int at[SIDES] = {0, w->line - 1, w->per - 1, w->per - w->line};
  return at[corner % SIDES];
}

/* Place in the element of the n-th node of a side. */
static int side_place(const struct work *w, int side, int n)
{
  const int from = corner_place(w, side), to = corner_place(w, side + 1);
  return from + n * (to - from) / (w->line - 1);
}

static int node_of(const struct work *w, size_t e, int place)
{
  return w->mesh->quads[e * (size_t)w->per + (size_t)place];
}

static const double *place_of(const struct work *w, size_t e, int place)
{
  return w->mesh->x + 2 * node_of(w, e, place);
}

static int compare(const void *a, const void *b)
{
  const struct side *x = a, *y = b;
  return x->low != y->low ? (x->low > y->low) - (x->low < y->low)
                          : (x->high > y->high) - (x->high < y->high);
}

static struct side side_between(int a, int b, size_t of)
{
  return (struct side){.low = a < b ? a : b, .high = a < b ? b : a, .of = of};
}

static void sort_sides(struct work *w)
{
  for (size_t k = 0; k < w->count; k++) {
    const int side = (int)(k % SIDES);
    w->sorted[k] = side_between(node_of(w, k / SIDES, corner_place(w, side)),
                                node_of(w, k / SIDES, corner_place(w, side + 1)), k);
  }
  qsort(w->sorted, w->count, sizeof *w->sorted, compare);
}

static bool is_rigid(const struct work *w, size_t e)
{
  const struct dea_plane_mesh *mesh = w->mesh;
  bool rigid = false;
  for (size_t g = 0; g < mesh->group_count; g++) {
    rigid = rigid || (w->layers->rigid[g] &&
                      mesh->within[(size_t)mesh->region[e] * mesh->group_count + g] != 0);
  }
  return rigid;
}

/* Which sides have rows, and which part what moves. */
static void mark_sides(struct work *w)
{
  const struct dea_plane_mesh *mesh = w->mesh;
  for (size_t i = 0; i < mesh->edge_count; i++) {
    const int *nodes = mesh->edges + i * (size_t)w->line;
    const struct side it = side_between(nodes[0], nodes[w->line - 1], 0);
    struct side *at = bsearch(&it, w->sorted, w->count, sizeof it, compare);
    const double width = w->layers->width_m[mesh->edge_curve[i]];
    while (at != NULL && at > w->sorted && compare(at - 1, &it) == 0) {
      at--;
    }
    for (; at != NULL && at < w->sorted + w->count && compare(at, &it) == 0; at++) {
      double *own = &w->width[at->of];
      w->guide[at->of] = ON_CURVE;
      w->cut[at->of] = w->cut[at->of] || width > 0;
      if (width > 0 && !is_rigid(w, at->of / SIDES)) {
        *own = *own > 0 ? fmin(*own, width) : width;
      }
    }
  }
}

static int class_of(const struct work *w, size_t corner)
{
  int at = (int)corner;
  while (w->parent[at] != at) {
    w->parent[at] = w->parent[w->parent[at]];
    at = w->parent[at];
  }
  return at;
}

/* The corner of a side at a node. */
static size_t corner_at(const struct work *w, const struct side *side, int node)
{
  size_t first = side->of % SIDES, e = side->of / SIDES;
  return node_of(w, e, corner_place(w, (int)first)) == node ? SIDES * e + first
                                                            : SIDES * e + (first + 1) % SIDES;
}

/* Corners that share a side which no row lies along are of one class. */
static void build_classes(struct work *w)
{
  for (size_t k = 0; k < w->count; k++) {
    w->parent[k] = (int)k;
  }
  for (size_t k = 0; k < w->count; k++) {
    const struct side *one = &w->sorted[k], *two = one + 1;
    if (k + 1 == w->count || compare(one, two) != 0) {
      if (k == 0 || compare(one - 1, one) != 0) {
        w->guide[one->of] = AT_END;
      }
      continue;
    }
    for (int end = 0; end < 2 && !w->cut[one->of]; end++) {
      const int node = end == 0 ? one->low : one->high;
      w->parent[class_of(w, corner_at(w, one, node))] = class_of(w, corner_at(w, two, node));
    }
  }
}

/* Unit tangent of a side at its first or last node, towards its end. */
static void tangent_of(const struct work *w, size_t e, int side, bool last, double out[2])
{
  const double *x[LINE_MAX_NODES] = {NULL};
  for (int n = 0; n < w->line; n++) {
    x[n] = place_of(w, e, side_place(w, side, last ? w->line - 1 - n : n));
  }
  for (int i = 0; i < 2; i++) {
    out[i] = w->line == 3 ? 4 * x[1][i] - 3 * x[0][i] - x[2][i] : x[1][i] - x[0][i];
    out[i] = last ? -out[i] : out[i];
  }
  const double size = hypot(out[0], out[1]);
  out[0] /= size;
  out[1] /= size;
}

/* How far an element reaches from a side. */
static double height_over(const struct work *w, size_t e, int side)
{
  const double *x[SIDES] = {NULL};
  double area = 0;
  for (int k = 0; k < SIDES; k++) {
    x[k] = place_of(w, e, corner_place(w, k));
  }
  for (int k = 0; k < SIDES; k++) {
    const double *b = x[(k + 1) % SIDES];
    area += 0.5 * (x[k][0] * b[1] - x[k][1] * b[0]);
  }
  const double *a = x[side], *b = x[(side + 1) % SIDES];
  return area / hypot(b[0] - a[0], b[1] - a[1]);
}

/* What a side adds to the class of the corner at its first or last node. */
static void add_side(struct work *w, size_t e, int side, bool last)
{
  struct class *class =
      &w->classes[class_of(w, SIDES * e + (size_t)(last ? side + 1 : side) % SIDES)];
  const size_t of = SIDES * e + (size_t)side;
  double along[2];
  tangent_of(w, e, side, last, along);
  if (w->width[of] > 0) {
    if (class->sides < 2) {
      class->normal[class->sides][0] = -along[1];
      class->normal[class->sides][1] = along[0];
      class->width[class->sides] = w->width[of];
    }
    class->sides++;
    class->capacity = fmin(class->capacity, height_over(w, e, side));
  } else if (w->guide[of] > class->guides) {
    class->guides = w->guide[of];
    class->guide[0] = last ? -along[0] : along[0];
    class->guide[1] = last ? -along[1] : along[1];
  }
}

/* To where both sides are their widths away; along a guide where there is one. False: nowhere. */
static bool find_shift(struct class *class, double scale)
{
  double *d = class->shift;
  const double(*n)[2] = (const double(*)[2]) class->normal;
  const double *width = class->width;
  if (class->sides == 0) {
    return true;
  }
  if (class->sides > 2 || (class->sides == 1 && class->guides == NO_GUIDE)) {
    return false;
  }
  const double sine = class->sides == 2 ? n[0][0] * n[1][1] - n[0][1] * n[1][0] : 0;
  double mean[2] = {n[0][0], n[0][1]}, wide = width[0];
  if (fabs(sine) > parallel) {
    d[0] = (width[0] * n[1][1] - width[1] * n[0][1]) / sine;
    d[1] = (width[1] * n[0][0] - width[0] * n[1][0]) / sine;
  } else {
    if (class->sides == 2) {
      mean[0] += n[1][0];
      mean[1] += n[1][1];
      wide = 0.5 * (width[0] + width[1]);
    }
    const double size = hypot(mean[0], mean[1]);
    if (size < 0.5) {
      return false;
    }
    const double across = (class->guide[0] * mean[0] + class->guide[1] * mean[1]) / size;
    for (int i = 0; i < 2; i++) {
      d[i] = class->guides != NO_GUIDE && across > 1 / longest ? wide * class->guide[i] / across
                                                               : wide * mean[i] / size;
    }
  }
  const double most =
      fmin(room_share * class->capacity, longest * fmax(wide, width[class->sides - 1]));
  const double share = scale * fmin(1, most / hypot(d[0], d[1]));
  d[0] *= share;
  d[1] *= share;
  return true;
}

static bool find_shifts(struct work *w)
{
  bool found = true;
  for (size_t k = 0; k < w->count; k++) {
    w->classes[k] = (struct class){.capacity = INFINITY};
  }
  for (size_t k = 0; k < w->count; k++) {
    add_side(w, k / SIDES, (int)(k % SIDES), false);
    add_side(w, k / SIDES, (int)(k % SIDES), true);
  }
  for (size_t k = 0; k < w->count; k++) {
    found = find_shift(&w->classes[k], w->scale[k]) && found;
  }
  return found;
}

/* Where a node of an element is moved to: corners' shifts, bilinear between them. */
static void moved_to(const struct work *w, size_t e, int place, double out[2])
{
  const double s = (double)(place % w->line) / (w->line - 1),
               t = (double)(place / w->line) / (w->line - 1);
  const double weight[SIDES] = {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
  memcpy(out, place_of(w, e, place), 2 * sizeof *out);
  for (size_t c = 0; c < SIDES; c++) {
    const double *shift = w->classes[class_of(w, SIDES * e + c)].shift;
    out[0] += weight[c] * shift[0];
    out[1] += weight[c] * shift[1];
  }
}

/* Where rows end, from the curve: 0 to 1. */
static double end_of_row(const struct work *w, double row)
{
  const double ratio = outermost * outermost;
  return (pow(ratio, row / (double)w->layers->rows) - 1) / (ratio - 1);
}

/* Node i along a side and j across its r-th row. */
static void row_place(const struct work *w, size_t of, size_t r, int i, int j, double out[2])
{
  const size_t e = of / SIDES;
  const int place = side_place(w, (int)(of % SIDES), i);
  const double low = end_of_row(w, (double)r), high = end_of_row(w, (double)r + 1);
  const double share = low + (high - low) * j / (w->line - 1), *from = place_of(w, e, place);
  moved_to(w, e, place, out);
  for (int k = 0; k < 2; k++) {
    out[k] = from[k] + share * (out[k] - from[k]);
  }
}

/* The moved elements, each with its rows after it. */
static void fill(const struct work *w, struct dea_point_map *nodes, struct dea_plane_mesh *out)
{
  int *node = out->quads, *region = out->region;
  double x[2];
  for (size_t e = 0; e < w->mesh->quad_count; e++) {
    for (int n = 0; n < w->per; n++) {
      moved_to(w, e, n, x);
      *node++ = (int)dea_point_map_add(nodes, x);
    }
    *region++ = w->mesh->region[e];
    for (size_t of = SIDES * e; of < SIDES * (e + 1); of++) {
      for (size_t r = 0; w->width[of] > 0 && r < w->layers->rows; r++) {
        for (int n = 0; n < w->per; n++) {
          row_place(w, of, r, n % w->line, n / w->line, x);
          *node++ = (int)dea_point_map_add(nodes, x);
        }
        *region++ = w->mesh->region[e];
      }
    }
  }
}

/* Named sides, where they are now; those of other curves that rows lie across end at them. */
static void move_edges(const struct work *w, struct dea_point_map *nodes, int *edges)
{
  const struct dea_plane_mesh *mesh = w->mesh;
  for (size_t i = 0; i < mesh->edge_count; i++) {
    const int *old = mesh->edges + i * (size_t)w->line;
    const struct side it = side_between(old[0], old[w->line - 1], 0);
    const struct side *at = bsearch(&it, w->sorted, w->count, sizeof it, compare);
    for (int n = 0; n < w->line; n++) {
      double x[2] = {mesh->x[2 * old[n]], mesh->x[2 * old[n] + 1]};
      for (int k = 0; at != NULL && !w->cut[at->of] && k < w->line; k++) {
        const int place = side_place(w, (int)(at->of % SIDES), k);
        if (node_of(w, at->of / SIDES, place) == old[n]) {
          moved_to(w, at->of / SIDES, place, x);
        }
      }
      edges[i * (size_t)w->line + (size_t)n] = (int)dea_point_map_add(nodes, x);
    }
  }
}

static double size_of(const struct dea_plane_mesh *mesh)
{
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (size_t i = 0; i < 2 * mesh->node_count; i++) {
    low[i % 2] = fmin(low[i % 2], mesh->x[i]);
    high[i % 2] = fmax(high[i % 2], mesh->x[i]);
  }
  return hypot(high[0] - low[0], high[1] - low[1]);
}

static void swap(int **a, int **b)
{
  int *keep = *a;
  *a = *b;
  *b = keep;
}

/* The element that one of the mesh with rows is, or lies in. */
static size_t origin_of(const struct work *w, size_t quad)
{
  size_t e = 0;
  for (size_t count = 0; e < w->mesh->quad_count; e++) {
    count++;
    for (size_t of = SIDES * e; of < SIDES * (e + 1); of++) {
      count += w->width[of] > 0 ? w->layers->rows : 0;
    }
    if (quad < count) {
      break;
    }
  }
  return e;
}

/* With rows, narrower ones around the worst element until it is a good one. *are: whether there are
 * any. */
static dea_status fill_well(struct dea_context *ctx, struct work *w, struct dea_plane_mesh *out,
                            int *edges, bool *are)
{
  const double least = fmin(good, 0.9 * dea_plane_mesh_smallest_jacobian(w->mesh, NULL));
  const double close = close_share * size_of(w->mesh);
  double found = 0;
  *are = false;
  for (int i = 0; i < TRIES && found < least; i++) {
    struct dea_point_map nodes = {.ctx = ctx, .tolerance_m = close};
    size_t worst = 0;
    if (!find_shifts(w)) {
      return DEA_OK;
    }
    fill(w, &nodes, out);
    move_edges(w, &nodes, edges);
    DEA_TRY(ctx, dea_plane_mesh_set_nodes(ctx, out, &nodes));
    found = dea_plane_mesh_smallest_jacobian(out, &worst);
    const size_t first = SIDES * origin_of(w, worst);
    for (size_t c = first; c < first + SIDES && found < least; c++) {
      w->scale[class_of(w, c)] *= 0.5;
    }
  }
  *are = found >= fmin(usable, least);
  return DEA_OK;
}

/* The mesh with rows in the place of the one without. */
static dea_status read_rows(struct dea_context *ctx, struct work *w, struct dea_plane_mesh *mesh)
{
  size_t quads = mesh->quad_count;
  for (size_t k = 0; k < w->count; k++) {
    quads += w->width[k] > 0 ? w->layers->rows : 0;
  }
  struct dea_plane_mesh *out = dea_plane_mesh_create(ctx, mesh->order, 0, quads);
  int *edges = dea_alloc(ctx, mesh->edge_count * (size_t)w->line, sizeof *edges);
  bool are = false;
  dea_status status = out != NULL && edges != NULL ? DEA_OK : DEA_E_MEMORY;
  status = status == DEA_OK ? fill_well(ctx, w, out, edges, &are) : status;
  if (status == DEA_OK && are) {
    double *x = mesh->x;
    mesh->x = out->x;
    out->x = x;
    swap(&mesh->quads, &out->quads);
    swap(&mesh->region, &out->region);
    swap(&mesh->edges, &edges);
    mesh->node_count = out->node_count;
    mesh->quad_count = quads;
  }
  dea_free(ctx, edges);
  dea_plane_mesh_destroy(ctx, out);
  return status;
}

dea_status dea_edge_layers_add(struct dea_context *ctx, struct dea_plane_mesh *mesh,
                               const struct dea_edge_layers *layers)
{
  struct work w = {.mesh = mesh,
                   .layers = layers,
                   .memory = {.ctx = ctx},
                   .line = mesh->order + 1,
                   .per = (mesh->order + 1) * (mesh->order + 1),
                   .count = SIDES * mesh->quad_count};
  w.sorted = dea_arena_alloc(&w.memory, w.count, sizeof *w.sorted);
  w.width = dea_arena_alloc(&w.memory, w.count, sizeof *w.width);
  w.cut = dea_arena_alloc(&w.memory, w.count, sizeof *w.cut);
  w.guide = dea_arena_alloc(&w.memory, w.count, sizeof *w.guide);
  w.parent = dea_arena_alloc(&w.memory, w.count, sizeof *w.parent);
  w.scale = dea_arena_alloc(&w.memory, w.count, sizeof *w.scale);
  w.classes = dea_arena_alloc(&w.memory, w.count, sizeof *w.classes);
  dea_status status = dea_arena_status(&w.memory);
  if (status == DEA_OK && layers->rows > 0) {
    sort_sides(&w);
    mark_sides(&w);
    build_classes(&w);
    for (size_t k = 0; k < w.count; k++) {
      w.scale[k] = 1;
    }
    status = read_rows(ctx, &w, mesh);
  }
  dea_arena_free(&w.memory);
  return status;
}

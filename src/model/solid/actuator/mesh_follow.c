#include "model/solid/actuator/mesh_follow.h"

#include "base/quadrature.h"

#include <math.h>
#include <string.h>

/* Outlines of the layout and of the other one have the same pieces, each with a place that goes
 * from 0 at its start to 1 at its end; what lies at a place moves by D. A node on an outline with
 * the normal n follows it with n . d = n . D, and is free to slide along it; one on two outlines is
 * where they cross. Where a support holds only the part of an edge that is within a shape, the last
 * node that it holds goes along with that shape's outline. All other motions d are those of the
 * least integral of |grad d|^2, over the quadrilaterals between the nodes of each element, of which
 * each has the four corners' basis. */

static const double parallel = 1e-2;              // sine between outlines that are one at a node
static const double apart_share = 0.1;            // of the largest motion: outlines that part
static const double sample[] = {0.25, 0.5, 0.75}; // places at which a symmetry is looked at

/* A piece of an outline and what it becomes. */
struct outline {
  struct dea_piece from, to;
  double box[4]; // of from
};

/* What a node is held by. */
struct rule {
  int count;
  double n[2][2], v[2];   // n . d = v
  struct dea_piece to[2]; // lines or circles that it ends on
};

struct work {
  const struct dea_layout_mesh *like;
  const struct dea_plane_mesh *plane;
  struct dea_arena memory;
  struct outline *outline; // [outline_count + end_count]: last those where supports end only
  size_t outline_count, end_count;
  double near_m, apart_m;    // lies on an outline; outlines move apart
  struct rule *rule;         // [nodes]
  size_t cell_count;         // quadrilaterals between nodes
  int (*corner)[4];          // [cell_count]
  double (*stiffness)[16];   // [cell_count]
  double *diagonal, *border; // [nodes], [nodes][2]: not 0 on the border of the mesh
  double *d;                 // [nodes][2]
};

static dea_status cannot(struct dea_context *ctx, const char *why)
{
  return dea_fail(ctx, DEA_E_ARGUMENT, "the mesh cannot follow a change of shapes: %s", why);
}

// Outlines ---------------------------------------------------------------------------------------

/* Where on a piece a place on it is, 0 to 1. */
static double place_on(const struct dea_piece *p, const double x[2])
{
  static const double turn = 6.283185307179586;
  if (!p->arc) {
    const double t[2] = {p->to[0] - p->from[0], p->to[1] - p->from[1]};
    return ((x[0] - p->from[0]) * t[0] + (x[1] - p->from[1]) * t[1]) / (p->length_m * p->length_m);
  }
  double angle = atan2(x[1] - p->centre[1], x[0] - p->centre[0]) - p->start;
  angle -= turn * floor(angle / turn);                      // 0 to a turn
  const double swept = p->sweep > 0 ? angle : turn - angle; // the same along a clockwise one
  const double past = 0.5 * (turn + fabs(p->sweep));        // beyond it, it is before the start
  return (swept > past ? swept - turn : swept) / fabs(p->sweep);
}

/* Unit normal of the whole line or circle at a place. */
static void normal_of(const struct dea_piece *p, const double x[2], double n[2])
{
  const double t[2] = {p->to[0] - p->from[0], p->to[1] - p->from[1]};
  n[0] = p->arc ? x[0] - p->centre[0] : t[1];
  n[1] = p->arc ? x[1] - p->centre[1] : -t[0];
  const double size = hypot(n[0], n[1]);
  n[0] /= size;
  n[1] /= size;
}

/* Distance from the whole line or circle, with the sign of the normal. */
static double off(const struct dea_piece *p, const double x[2], double n[2])
{
  normal_of(p, x, n);
  return p->arc ? hypot(x[0] - p->centre[0], x[1] - p->centre[1]) - p->radius_m
                : (x[0] - p->from[0]) * n[0] + (x[1] - p->from[1]) * n[1];
}

/* How far the outline goes along its normal at a place of it. */
static double speed(const struct outline *o, const double x[2], double n[2])
{
  const double at = place_on(&o->from, x);
  double before[2], after[2];
  dea_piece_point(&o->from, at, before);
  dea_piece_point(&o->to, at, after);
  normal_of(&o->from, x, n);
  return n[0] * (after[0] - before[0]) + n[1] * (after[1] - before[1]);
}

/* By how many vertices the other contour begins later: the way in which they are nearest. */
static size_t shift_between(const struct dea_contour *a, const struct dea_contour *b)
{
  double least = INFINITY;
  size_t best = 0;
  for (size_t shift = 0; shift < a->count; shift++) {
    double sum = 0;
    for (size_t i = 0; i < a->count && sum < least; i++) {
      const struct dea_vertex *v = &a->vertex[i], *w = &b->vertex[(i + shift) % a->count];
      sum += pow(v->x_m - w->x_m, 2) + pow(v->y_m - w->y_m, 2);
    }
    if (sum < least) {
      least = sum;
      best = shift;
    }
  }
  return best;
}

/* Pieces of one region's outlines, added to outline [*count]. */
static dea_status add_region(struct dea_context *ctx, struct work *w, const struct dea_region *a,
                             const struct dea_region *b, struct outline *outline, size_t *count)
{
  bool same = a->contour_count == b->contour_count;
  for (size_t k = 0; same && k < a->contour_count; k++) {
    const struct dea_contour from = dea_region_contour(a, k), to = dea_region_contour(b, k);
    same = from.count == to.count;
    const size_t shift = same ? shift_between(&from, &to) : 0;
    for (size_t i = 0; same && i < from.count; i++) {
      struct outline *o = &outline[(*count)++];
      *o = (struct outline){.from = dea_contour_piece(&from, i),
                            .to = dea_contour_piece(&to, (i + shift) % from.count),
                            .box = {INFINITY, INFINITY, -INFINITY, -INFINITY}};
      same = o->from.arc == o->to.arc;
      dea_piece_grow_box(&o->from, o->box);
      for (int c = 0; c < 5; c++) {
        double before[2], after[2];
        dea_piece_point(&o->from, 0.25 * c, before);
        dea_piece_point(&o->to, 0.25 * c, after);
        const double moved_m = hypot(after[0] - before[0], after[1] - before[1]);
        w->apart_m = fmax(w->apart_m, apart_share * moved_m);
      }
    }
  }
  return same ? DEA_OK : cannot(ctx, "an outline has other pieces than before");
}

static dea_status find_outlines(struct dea_context *ctx, struct work *w,
                                const struct dea_layout *layout)
{
  const struct dea_layout *own = w->like->layout;
  size_t pieces = 0;
  unsigned *roles = dea_arena_alloc(&w->memory, own->region_count, sizeof *roles);
  bool *ends = dea_arena_alloc(&w->memory, own->region_count, sizeof *ends);
  for (size_t i = 0; i < own->region_count; i++) {
    pieces += own->regions[i].region.vertex_count;
  }
  w->outline = dea_arena_alloc(&w->memory, pieces, sizeof *w->outline);
  DEA_TRY(ctx, dea_arena_status(&w->memory));
  dea_layout_mesh_roles(own, roles);
  for (size_t i = 0; i < own->region_count; i++) {
    if (roles[i] != 0) {
      DEA_TRY(ctx, add_region(ctx, w, &own->regions[i].region, &layout->regions[i].region,
                              w->outline, &w->outline_count));
    }
  }
  for (size_t i = 0; i < own->support_count; i++) {
    const size_t end = own->supports[i].within;
    if (end != DEA_LAYOUT_NONE && roles[end] == 0 && !ends[end]) {
      ends[end] = true;
      DEA_TRY(ctx, add_region(ctx, w, &own->regions[end].region, &layout->regions[end].region,
                              w->outline + w->outline_count, &w->end_count));
    }
  }
  return DEA_OK;
}

static bool is_on(const struct outline *o, const double x[2], double near_m)
{
  return x[0] > o->box[0] - near_m && x[0] < o->box[2] + near_m && x[1] > o->box[1] - near_m &&
         x[1] < o->box[3] + near_m && dea_piece_distance_m(&o->from, x) <= near_m;
}

/* Whether some outline goes through a place of that normal with that speed. */
static bool goes_along(const struct work *w, const double x[2], const double n[2], double v)
{
  for (size_t i = 0; i < w->outline_count; i++) {
    double own[2];
    if (is_on(&w->outline[i], x, 4 * w->near_m)) {
      const double here = speed(&w->outline[i], x, own);
      const double along = own[0] * n[0] + own[1] * n[1];
      if (fabs(along) > 1 - parallel && fabs(here - along * v) <= w->apart_m) {
        return true;
      }
    }
  }
  return false;
}

/* Whether outlines move in all copies of the sector as they do in it. */
static bool is_symmetric(const struct work *w)
{
  for (size_t k = 1; k < dea_layout_sector_copies(&w->like->sector); k++) {
    const struct dea_motion copy = dea_layout_sector_copy(&w->like->sector, k);
    for (size_t i = 0; i < w->outline_count; i++) {
      for (size_t c = 0; c < sizeof sample / sizeof sample[0]; c++) {
        double x[2], n[2], there[2];
        dea_piece_point(&w->outline[i].from, sample[c], x);
        const double v = speed(&w->outline[i], x, n);
        dea_motion_apply(&copy, x, there);
        dea_layout_sector_turn(&copy, n, n);
        if (!goes_along(w, there, n, v)) {
          return false;
        }
      }
    }
  }
  return true;
}

// Rules ------------------------------------------------------------------------------------------

/* The motion that two rules leave. */
static void meet(const struct rule *r, double d[2])
{
  const double det = r->n[0][0] * r->n[1][1] - r->n[0][1] * r->n[1][0];
  d[0] = (r->v[0] * r->n[1][1] - r->v[1] * r->n[0][1]) / det;
  d[1] = (r->v[1] * r->n[0][0] - r->v[0] * r->n[1][0]) / det;
}

/* One outline more through a node; false: it moves otherwise than those that it lies on. */
static bool add_rule(struct rule *r, const double n[2], double v, const struct dea_piece *to,
                     double apart_m)
{
  if (r->count == 2) {
    double d[2];
    meet(r, d);
    return fabs(n[0] * d[0] + n[1] * d[1] - v) <= apart_m;
  }
  if (r->count == 1 && fabs(r->n[0][0] * n[1] - r->n[0][1] * n[0]) < parallel) {
    const double along = r->n[0][0] * n[0] + r->n[0][1] * n[1];
    return fabs(v - along * r->v[0]) <= apart_m;
  }
  memcpy(r->n[r->count], n, sizeof r->n[0]);
  r->v[r->count] = v;
  r->to[r->count++] = *to;
  return true;
}

/* A node on the sides of a sector stays on them. */
static bool add_sides(const struct work *w, const double x[2], struct rule *r)
{
  double Q[9];
  const int held = dea_layout_sector_holds(&w->like->sector, x, w->near_m, Q);
  bool good = true;
  for (int k = 0; k < 2; k++) {
    const double n[2] = {Q[3 * k], Q[3 * k + 1]};
    const struct dea_piece side = {
        .from = {x[0], x[1]}, .to = {x[0] - n[1], x[1] + n[0]}, .length_m = 1};
    good = good && ((held >> k & 1) == 0 || add_rule(r, n, 0, &side, w->apart_m));
  }
  return good;
}

/* A node follows those of outlines [begin, end) that it lies on; false: they move apart. */
static bool add_outlines(struct work *w, size_t node, size_t begin, size_t end)
{
  const double *x = w->plane->x + 2 * node;
  bool good = true;
  for (size_t i = begin; i < end; i++) {
    double normal[2];
    if (is_on(&w->outline[i], x, w->near_m)) {
      const double v = speed(&w->outline[i], x, normal);
      good = add_rule(&w->rule[node], normal, v, &w->outline[i].to, w->apart_m) && good;
    }
  }
  return good;
}

static dea_status find_rules(struct dea_context *ctx, struct work *w)
{
  w->rule = dea_arena_alloc(&w->memory, w->plane->node_count, sizeof *w->rule);
  DEA_TRY(ctx, dea_arena_status(&w->memory));
  for (size_t n = 0; n < w->plane->node_count; n++) {
    if (!add_sides(w, w->plane->x + 2 * n, &w->rule[n]) ||
        !add_outlines(w, n, 0, w->outline_count)) {
      return cannot(ctx, "outlines that lie on each other or touch come apart");
    }
    // the mesh has nodes where a support ends; where that end lies on an outline of a part and
    // moves otherwise, the part has them
    (void)add_outlines(w, n, w->outline_count, w->outline_count + w->end_count);
  }
  return DEA_OK;
}

/* The rule of a node that is the last one held within an outline: it goes along with the piece that
 * is nearest to it. */
static void add_limit(struct work *w, const struct outline *limit, size_t count, int node)
{
  const double *x = w->plane->x + 2 * node;
  double least = INFINITY, at[2], n[2];
  size_t nearest = 0;
  for (size_t i = 0; i < count; i++) {
    const double far_m = dea_piece_distance_m(&limit[i].from, x);
    nearest = far_m < least ? i : nearest;
    least = fmin(least, far_m);
  }
  dea_piece_nearest(&limit[nearest].from, x, at);
  const double v = speed(&limit[nearest], at, n);
  const struct dea_piece to = {.from = {x[0] + v * n[0], x[1] + v * n[1]},
                               .to = {x[0] + v * n[0] - n[1], x[1] + v * n[1] + n[0]},
                               .length_m = 1};
  if (w->rule[node].count < 2) { // a corner stays one
    add_rule(&w->rule[node], n, v, &to, w->apart_m);
  }
}

/* Those of a support: each held node beside one of its region that is not held. */
static dea_status add_limits(struct dea_context *ctx, struct work *w,
                             const struct dea_layout *layout,
                             const struct dea_layout_support *support)
{
  const struct dea_plane_mesh *p = w->plane;
  const struct dea_region *within = &w->like->layout->regions[support->within].region;
  const size_t line = (size_t)p->order + 1;
  size_t count = 0;
  bool *all = dea_arena_alloc(&w->memory, p->node_count, sizeof *all);
  bool *held = dea_arena_alloc(&w->memory, p->node_count, sizeof *held);
  struct outline *limit = dea_arena_alloc(&w->memory, within->vertex_count, sizeof *limit);
  DEA_TRY(ctx, dea_arena_status(&w->memory));
  DEA_TRY(ctx, add_region(ctx, w, within, &layout->regions[support->within].region, limit, &count));
  dea_layout_mesh_mark(w->like, support->region, support->edge, DEA_LAYOUT_NONE, all);
  dea_layout_mesh_mark(w->like, support->region, support->edge, support->within, held);
  for (size_t i = 0; i < p->quad_count * line * line; i++) {
    const size_t next[2] = {i % line + 1 < line ? i + 1 : i,
                            i / line % line + 1 < line ? i + line : i};
    for (int k = 0; k < 2; k++) {
      const int a = p->quads[i], b = p->quads[next[k]];
      if (all[a] && all[b] && held[a] != held[b]) {
        add_limit(w, limit, count, held[a] ? a : b);
      }
    }
  }
  return DEA_OK;
}

static dea_status find_limits(struct dea_context *ctx, struct work *w,
                              const struct dea_layout *layout)
{
  const struct dea_layout *own = w->like->layout;
  for (size_t i = 0; i < own->support_count; i++) {
    if (own->supports[i].within != DEA_LAYOUT_NONE) {
      DEA_TRY(ctx, add_limits(ctx, w, layout, &own->supports[i]));
    }
  }
  return DEA_OK;
}

// What lies between ------------------------------------------------------------------------------

/* Stiffness of a quadrilateral by two times two points, and what it adds to the border. */
static void fill_cell(struct work *w, size_t cell)
{
  static const double at[2] = {-0.57735026918962576, 0.57735026918962576};
  static const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const int *nodes = w->corner[cell];
  for (int q = 0; q < 4; q++) {
    double slope[4][2], J[2][2] = {{0, 0}, {0, 0}};
    for (int a = 0; a < 4; a++) {
      slope[a][0] = 0.25 * corner[a][0] * (1 + corner[a][1] * at[q / 2]);
      slope[a][1] = 0.25 * corner[a][1] * (1 + corner[a][0] * at[q % 2]);
      for (int i = 0; i < 4; i++) {
        J[i / 2][i % 2] += slope[a][i / 2] * w->plane->x[2 * nodes[a] + i % 2];
      }
    }
    const double det = J[0][0] * J[1][1] - J[0][1] * J[1][0];
    for (int a = 0; a < 4; a++) {
      const double s = slope[a][0], t = slope[a][1];
      slope[a][0] = (J[1][1] * s - J[0][1] * t) / det;
      slope[a][1] = (J[0][0] * t - J[1][0] * s) / det;
      w->border[2 * nodes[a]] += det * slope[a][0];
      w->border[2 * nodes[a] + 1] += det * slope[a][1];
    }
    for (int ab = 0; ab < 16; ab++) {
      const double *a = slope[ab / 4], *b = slope[ab % 4];
      w->stiffness[cell][ab] += fabs(det) * (a[0] * b[0] + a[1] * b[1]);
    }
  }
  for (int a = 0; a < 4; a++) {
    w->diagonal[nodes[a]] += w->stiffness[cell][5 * a];
  }
}

static dea_status find_cells(struct dea_context *ctx, struct work *w)
{
  const struct dea_plane_mesh *p = w->plane;
  const size_t line = (size_t)p->order + 1, along = (size_t)p->order;
  w->cell_count = p->quad_count * along * along;
  w->corner = dea_arena_alloc(&w->memory, w->cell_count, sizeof *w->corner);
  w->stiffness = dea_arena_alloc(&w->memory, w->cell_count, sizeof *w->stiffness);
  w->diagonal = dea_arena_alloc(&w->memory, p->node_count, sizeof *w->diagonal);
  w->border = dea_arena_alloc(&w->memory, 2 * p->node_count, sizeof *w->border);
  w->d = dea_arena_alloc(&w->memory, 2 * p->node_count, sizeof *w->d);
  DEA_TRY(ctx, dea_arena_status(&w->memory));
  for (size_t c = 0; c < w->cell_count; c++) {
    const size_t e = c / (along * along), i = c % along, j = c / along % along;
    const int *nodes = p->quads + e * line * line + j * line + i;
    w->corner[c][0] = nodes[0];
    w->corner[c][1] = nodes[1];
    w->corner[c][2] = nodes[line + 1];
    w->corner[c][3] = nodes[line];
    fill_cell(w, c);
  }
  return DEA_OK;
}

/* Whether every node between two regions, and on the border, is on an outline. */
static dea_status check_borders(struct dea_context *ctx, struct work *w)
{
  static const double rounding = 1e-3; // of near_m
  const struct dea_plane_mesh *p = w->plane;
  const size_t per = (size_t)((p->order + 1) * (p->order + 1));
  int *region = dea_arena_alloc(&w->memory, p->node_count, sizeof *region);
  bool good = region != NULL;
  for (size_t i = 0; i < p->quad_count * per && region != NULL; i++) {
    const int node = p->quads[i], here = p->region[i / per] + 1;
    good = good && (region[node] == 0 || region[node] == here || w->rule[node].count > 0);
    region[node] = here;
  }
  for (size_t n = 0; n < p->node_count && region != NULL; n++) {
    const double *b = w->border + 2 * n;
    good = good && (w->rule[n].count > 0 || hypot(b[0], b[1]) <= rounding * w->near_m);
  }
  DEA_TRY(ctx, dea_arena_status(&w->memory));
  return good ? DEA_OK : cannot(ctx, "a node on an outline is not found on it");
}

/* Takes away what the rules do not leave free. */
static void release(const struct work *w, double *v)
{
  for (size_t n = 0; n < w->plane->node_count; n++) {
    const struct rule *r = &w->rule[n];
    const double along = r->n[0][0] * v[2 * n] + r->n[0][1] * v[2 * n + 1];
    for (int k = 0; k < 2; k++) {
      v[2 * n + (size_t)k] -= r->count == 1   ? along * r->n[0][k]
                              : r->count == 2 ? v[2 * n + (size_t)k]
                                              : 0;
    }
  }
}

/* out = K v of what is free. */
static void stretch(const struct work *w, const double *v, double *out)
{
  memset(out, 0, 2 * w->plane->node_count * sizeof *out);
  for (size_t c = 0; c < w->cell_count; c++) {
    const int *nodes = w->corner[c];
    for (int ab = 0; ab < 16; ab++) {
      const double k = w->stiffness[c][ab];
      out[2 * nodes[ab / 4]] += k * v[2 * nodes[ab % 4]];
      out[2 * nodes[ab / 4] + 1] += k * v[2 * nodes[ab % 4] + 1];
    }
  }
  release(w, out);
}

static double dot(const struct work *w, const double *a, const double *b)
{
  double sum = 0;
  for (size_t i = 0; i < 2 * w->plane->node_count; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

/* By conjugate gradients, from what the rules say on. */
static dea_status solve(struct dea_context *ctx, struct work *w)
{
  static const double settled = 1e-20; // of the square of what is left
  enum { STEPS = 20000 };
  const size_t count = 2 * w->plane->node_count;
  double *left = dea_arena_alloc(&w->memory, count, sizeof *left);
  double *towards = dea_arena_alloc(&w->memory, count, sizeof *towards);
  double *pull = dea_arena_alloc(&w->memory, count, sizeof *pull);
  DEA_TRY(ctx, dea_arena_status(&w->memory));
  for (size_t n = 0; n < w->plane->node_count; n++) {
    const struct rule *r = &w->rule[n];
    for (int k = 0; k < 2 && r->count == 1; k++) {
      w->d[2 * n + (size_t)k] = r->v[0] * r->n[0][k];
    }
    if (r->count == 2) {
      meet(r, w->d + 2 * n);
    }
  }
  stretch(w, w->d, left);
  double first = 0, before = 0;
  for (int i = 0; i < STEPS; i++) {
    for (size_t k = 0; k < count; k++) {
      pull[k] = left[k] / w->diagonal[k / 2];
    }
    const double size = dot(w, left, pull);
    first = i == 0 ? size : first;
    if (size <= settled * first) {
      return DEA_OK;
    }
    for (size_t k = 0; k < count; k++) {
      towards[k] = pull[k] + (i > 0 ? size / before * towards[k] : 0);
    }
    before = size;
    stretch(w, towards, pull);
    const double length = size / dot(w, towards, pull);
    for (size_t k = 0; k < count; k++) {
      w->d[k] -= length * towards[k];
      left[k] -= length * pull[k];
    }
  }
  return cannot(ctx, "its nodes do not settle");
}

/* Onto the outlines themselves, from where the rules have brought it: beside them by the square of
 * the motion. */
static void land(const struct rule *r, double x[2])
{
  enum { STEPS = 20 };
  for (int i = 0; i < STEPS && r->count > 0; i++) {
    struct rule now = *r;
    double d[2];
    for (int k = 0; k < r->count; k++) {
      now.v[k] = -off(&r->to[k], x, now.n[k]);
    }
    if (r->count == 1) {
      d[0] = now.v[0] * now.n[0][0];
      d[1] = now.v[0] * now.n[0][1];
    } else {
      meet(&now, d);
    }
    x[0] += d[0];
    x[1] += d[1];
  }
}

static dea_status follow(struct dea_context *ctx, struct work *w, const struct dea_layout *layout,
                         double *x)
{
  DEA_TRY(ctx, find_outlines(ctx, w, layout));
  if (!is_symmetric(w)) {
    return cannot(ctx, "it breaks the symmetry that the sector has (compute.solid.domain: whole)");
  }
  DEA_TRY(ctx, find_rules(ctx, w));
  DEA_TRY(ctx, find_limits(ctx, w, layout));
  DEA_TRY(ctx, find_cells(ctx, w));
  DEA_TRY(ctx, check_borders(ctx, w));
  DEA_TRY(ctx, solve(ctx, w));
  for (size_t n = 0; n < w->plane->node_count; n++) {
    x[2 * n] = w->plane->x[2 * n] + w->d[2 * n];
    x[2 * n + 1] = w->plane->x[2 * n + 1] + w->d[2 * n + 1];
    land(&w->rule[n], x + 2 * n);
  }
  return DEA_OK;
}

/* The plane mesh of `like` as shapes of another layout take it, in `memory`; the rest of it is
 * lent. */
static dea_status move_plane(struct dea_context *ctx, const struct dea_layout_mesh *like,
                             const struct dea_layout *layout, struct dea_arena *memory,
                             struct dea_plane_mesh **out)
{
  struct work w = {
      .like = like, .plane = like->plane, .memory = {.ctx = ctx}, .near_m = like->near_m};
  struct dea_plane_mesh *moved = dea_arena_alloc(memory, 1, sizeof *moved);
  double *x = dea_arena_alloc(memory, 2 * like->plane->node_count, sizeof *x);
  *out = moved;
  dea_status status = dea_arena_status(memory);
  if (status == DEA_OK) {
    *moved = *like->plane;
    moved->x = x;
    status = follow(ctx, &w, layout, x);
  }
  dea_arena_free(&w.memory);
  if (status == DEA_OK && !(dea_plane_mesh_smallest_jacobian(moved, NULL) > 0)) {
    status = cannot(ctx, "an element folds");
  }
  return status;
}

/* Whether all shapes are where they were. */
static bool same_regions(const struct dea_layout *a, const struct dea_layout *b)
{
  bool same = true;
  for (size_t i = 0; i < a->region_count && same; i++) {
    same = dea_region_same(&a->regions[i].region, &b->regions[i].region);
  }
  return same;
}

dea_status dea_mesh_follow(struct dea_context *ctx, const struct dea_layout *layout,
                           const struct dea_model_settings *settings,
                           const struct dea_layout_mesh *like, struct dea_layout_mesh *out)
{
  *out = (struct dea_layout_mesh){0};
  if (layout->region_count != like->layout->region_count ||
      layout->ply_count != like->layout->ply_count) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the mesh cannot follow: there are other parts");
  }
  *out = (struct dea_layout_mesh){.memory = {.ctx = ctx},
                                  .layout = layout,
                                  .membrane = like->membrane,
                                  .sector = like->sector,
                                  .plane = like->plane,
                                  .like = true,
                                  .group = like->group};
  if (!same_regions(layout, like->layout)) {
    DEA_TRY_ELSE(ctx, move_plane(ctx, like, layout, &out->memory, &out->plane),
                 dea_layout_mesh_free(ctx, out));
  }
  return DEA_CHAIN(ctx, dea_layout_mesh_fill(ctx, settings, like, out));
}

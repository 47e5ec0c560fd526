/* Symmetry of regions (docs/theory/geometry.md, "Symmetry"). */
#include "geometry/symmetry.h"

#include "geometry/contour_pieces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum kind { LINE, ARC, ROUND };

/* A line, an arc or a whole circle, as long as it goes, so that nothing depends on where the
 * vertices on it are. */
struct feature {
  int label;
  enum kind kind;
  double from[2], to[2]; // not of a circle
  double middle[2];      // of a circle its centre
  double radius;         // signed as the sense of the arc; 0: a line
  double distance;       // of the middle from the centre of all
  size_t number;
};

struct finder {
  struct dea_context *ctx;
  struct dea_arena arena;
  struct feature *feature; // [count], sorted
  size_t count;
  struct dea_box_tree tree; // of the middles
  double tolerance, snap;
  double centre[2];
};

/* ---- features ---- */

/* Whether a piece goes on as the one before it. */
static bool goes_on(const struct finder *f, const struct dea_piece *a, const struct dea_piece *b)
{
  if (a->arc != b->arc) {
    return false;
  }
  if (a->arc) {
    return a->sweep * b->sweep > 0 && dea_apart_m(a->centre, b->centre) <= f->tolerance &&
           fabs(a->radius_m - b->radius_m) <= f->tolerance;
  }
  double cross = (a->to[0] - a->from[0]) * (b->to[1] - b->from[1]) -
                 (a->to[1] - a->from[1]) * (b->to[0] - b->from[0]);
  double dot = (a->to[0] - a->from[0]) * (b->to[0] - b->from[0]) +
               (a->to[1] - a->from[1]) * (b->to[1] - b->from[1]);
  return dot > 0 && fabs(cross) <= f->snap * (a->length_m + b->length_m);
}

static void add_run(struct finder *f, const struct dea_contour *contour, size_t first, size_t count,
                    int label)
{
  const struct dea_piece a = dea_contour_piece(contour, first % contour->count);
  const struct dea_piece b = dea_contour_piece(contour, (first + count - 1) % contour->count);
  struct feature *out = &f->feature[f->count];
  *out = (struct feature){
      label,   a.arc ? ARC : LINE, {a.from[0], a.from[1]}, {b.to[0], b.to[1]}, {0, 0}, 0, 0,
      f->count};
  f->count++;
  if (!a.arc) {
    out->middle[0] = 0.5 * (a.from[0] + b.to[0]);
    out->middle[1] = 0.5 * (a.from[1] + b.to[1]);
    return;
  }
  double sweep = 0;
  for (size_t k = 0; k < count; k++) {
    sweep += dea_contour_piece(contour, (first + k) % contour->count).sweep;
  }
  out->radius = copysign(a.radius_m, a.sweep);
  out->middle[0] = a.centre[0] + a.radius_m * cos(a.start + 0.5 * sweep);
  out->middle[1] = a.centre[1] + a.radius_m * sin(a.start + 0.5 * sweep);
}

static void add_features(struct finder *f, const struct dea_contour *contour, int label)
{
  size_t n = contour->count, start = 0;
  struct dea_piece before = dea_contour_piece(contour, n - 1);
  for (; start < n; start++) {
    const struct dea_piece piece = dea_contour_piece(contour, start);
    if (!goes_on(f, &before, &piece)) {
      break;
    }
    before = piece;
  }
  if (start == n) {
    f->feature[f->count] = (struct feature){.label = label, .kind = ROUND, .number = f->count};
    memcpy(f->feature[f->count].middle, before.centre, sizeof before.centre);
    f->feature[f->count++].radius = copysign(before.radius_m, before.sweep);
    return;
  }
  for (size_t i = start, run = 0; i < start + n; i++) {
    const struct dea_piece piece = dea_contour_piece(contour, i % n);
    const struct dea_piece after = dea_contour_piece(contour, (i + 1) % n);
    run++;
    if (i + 1 == start + n || !goes_on(f, &piece, &after)) {
      add_run(f, contour, i + 1 - run, run, label);
      run = 0;
    }
  }
}

static int by_distance(const void *one, const void *two)
{
  const struct feature *a = one, *b = two;
  int order = (a->label > b->label) - (a->label < b->label);
  order = order != 0 ? order : (a->kind > b->kind) - (a->kind < b->kind);
  order = order != 0 ? order : (a->distance > b->distance) - (a->distance < b->distance);
  return order != 0 ? order : (a->number > b->number) - (a->number < b->number);
}

/* ---- trying ---- */

/* Whether b is the image of a, whose ends the motion maps to `from` and `to` of the image. */
static bool is_image(const struct finder *f, const struct feature *a, const struct feature *b,
                     const double middle[2], const double from[2], const double to[2])
{
  bool same = a->label == b->label && a->kind == b->kind &&
              dea_apart_m(middle, b->middle) <= f->tolerance &&
              fabs(a->radius - b->radius) <= f->tolerance;
  return same && (a->kind == ROUND || (dea_apart_m(from, b->from) <= f->tolerance &&
                                       dea_apart_m(to, b->to) <= f->tolerance));
}

/* Whether a motion maps every feature onto one. A reflection turns the sense of contours, which is
 * turned back so that the inside is on the left: ends change places, arcs keep their sense. */
static bool is_symmetry(const struct finder *f, const struct dea_motion *motion)
{
  for (size_t i = 0; i < f->count; i++) {
    const struct feature *a = &f->feature[i];
    double middle[2], from[2], to[2];
    dea_motion_apply(motion, a->middle, middle);
    dea_motion_apply(motion, motion->mirrored ? a->to : a->from, from);
    dea_motion_apply(motion, motion->mirrored ? a->from : a->to, to);
    double d = f->tolerance;
    const double box[4] = {middle[0] - d, middle[1] - d, middle[0] + d, middle[1] + d};
    size_t cursor = 0, other;
    bool found = false;
    while (!found && dea_box_tree_next(&f->tree, box, &cursor, &other)) {
      found = is_image(f, a, &f->feature[other], middle, from, to);
    }
    if (!found) {
      return false;
    }
  }
  return true;
}

static double direction(const struct finder *f, size_t i)
{
  const double *x = f->feature[i].middle;
  return atan2(x[1] - f->centre[1], x[0] - f->centre[0]);
}

/* The smallest set of features, [*first, *first + returned), that a symmetry can only map onto each
 * other: of one label and kind, at one distance from the centre. 0: all are circles about it. */
static size_t find_orbit(const struct finder *f, size_t *first)
{
  size_t best = 0;
  for (size_t i = 0, next; i < f->count; i = next) {
    const struct feature *a = &f->feature[i];
    for (next = i + 1; next < f->count; next++) {
      const struct feature *b = &f->feature[next];
      if (b->label != a->label || b->kind != a->kind ||
          b->distance - f->feature[next - 1].distance > 2 * f->tolerance) {
        break;
      }
    }
    if (a->distance > 4 * f->tolerance && (best == 0 || next - i < best)) {
      best = next - i;
      *first = i;
    }
  }
  return best;
}

static size_t find_order(const struct finder *f, size_t first, size_t count)
{
  size_t order = 1;
  double start = direction(f, first);
  for (size_t k = 1; k < count; k++) {
    double angle = direction(f, first + k) - start;
    angle += angle < 0 ? 2 * DEA_PI : 0;
    double turns = floor(2 * DEA_PI / angle + 0.5);
    // the least rotation is a whole part of a turn, and reaches no more places than there are
    if (turns > (double)order && turns <= (double)count &&
        fabs(turns * angle - 2 * DEA_PI) * f->feature[first].distance <= 4 * turns * f->tolerance) {
      const struct dea_motion motion = dea_motion_rotation(f->centre, 2 * DEA_PI / turns);
      order = is_symmetry(f, &motion) ? (size_t)turns : order;
    }
  }
  return order;
}

static void find_mirrors(const struct finder *f, size_t first, size_t count,
                         struct dea_symmetry *out)
{
  double start = direction(f, first);
  out->step_rad = DEA_PI / (double)out->order;
  for (size_t k = 0; k < count && out->mirrors == 0; k++) {
    double angle = 0.5 * (start + direction(f, first + k));
    const struct dea_motion motion = dea_motion_mirror(f->centre, angle);
    if (is_symmetry(f, &motion)) {
      angle -= out->step_rad * floor(angle / out->step_rad + 1e-9); // -0 and the step itself: 0
      out->mirror_rad = fmax(0, angle);
      out->mirrors = out->order;
    }
  }
}

/* ---- all ---- */

static dea_status prepare(struct finder *f, const struct dea_region *const regions[],
                          const int labels[], size_t count)
{
  size_t pieces = 0;
  for (size_t r = 0; r < count; r++) {
    pieces += regions[r]->vertex_count;
  }
  f->feature = dea_arena_alloc(&f->arena, pieces, sizeof *f->feature);
  struct dea_box *boxes = dea_arena_alloc(&f->arena, pieces, sizeof *boxes);
  DEA_TRY_MEMORY(boxes != NULL);
  for (size_t r = 0; r < count; r++) {
    for (size_t c = 0; c < regions[r]->contour_count; c++) {
      const struct dea_contour contour = dea_region_contour(regions[r], c);
      add_features(f, &contour, labels[r]);
    }
  }
  for (size_t i = 0; i < f->count; i++) {
    f->feature[i].distance = dea_apart_m(f->feature[i].middle, f->centre);
  }
  if (f->count > 0) {
    qsort(f->feature, f->count, sizeof *f->feature, by_distance);
  }
  for (size_t i = 0; i < f->count; i++) {
    const double *x = f->feature[i].middle;
    boxes[i] = (struct dea_box){{x[0], x[1], x[0], x[1]}, i};
  }
  return dea_box_tree_build(f->ctx, boxes, f->count, &f->tree);
}

dea_status dea_symmetry_find(struct dea_context *ctx, const struct dea_region *const regions[],
                             const int labels[], size_t count, double tolerance_m,
                             struct dea_symmetry *out)
{
  struct finder f = {.ctx = ctx, .arena = {.ctx = ctx}};
  double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY}, area = 0;
  *out = (struct dea_symmetry){.order = 1};
  for (size_t r = 0; r < count; r++) {
    double own[4], centre[2], its = dea_region_area_m2(regions[r]);
    dea_region_box_m(regions[r], own);
    for (int k = 0; k < 2; k++) {
      box[k] = fmin(box[k], own[k]);
      box[k + 2] = fmax(box[k + 2], own[k + 2]);
    }
    if (its != 0) { // mean of what was seen so far and this one
      dea_region_centroid_m(regions[r], centre);
      area += its;
      f.centre[0] += (centre[0] - f.centre[0]) * its / area;
      f.centre[1] += (centre[1] - f.centre[1]) * its / area;
    }
  }
  double size = area > 0 ? hypot(box[2] - box[0], box[3] - box[1]) : 0;
  f.snap = DEA_GEOMETRY_SNAP * size;
  f.tolerance = tolerance_m > 0 ? tolerance_m : 1e-6 * size;
  memcpy(out->centre_m, f.centre, sizeof f.centre);
  dea_status status = prepare(&f, regions, labels, count);
  if (status == DEA_OK) {
    size_t first = 0, orbit = find_orbit(&f, &first);
    out->order = orbit > 0 ? find_order(&f, first, orbit) : 0;
    if (orbit > 0) {
      find_mirrors(&f, first, orbit, out);
    }
  }
  dea_box_tree_free(ctx, &f.tree);
  dea_arena_free(&f.arena);
  return status;
}

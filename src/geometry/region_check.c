/* What is wrong with contours, and where. */
#include "base/rounded.h"
#include "geometry/contour_pieces.h"

#include <math.h>
#include <stdio.h>

static const char crosses_itself[] = "the contour crosses or touches itself";

dea_status dea_region_fault(struct dea_context *ctx, struct dea_location location, double x_m,
                            double y_m, const char *what)
{
  char place[80] = "";
  if (isfinite(x_m) && isfinite(y_m)) {
    snprintf(place, sizeof place, " at (%.6g, %.6g) mm", dea_rounded(1e3 * x_m),
             dea_rounded(1e3 * y_m));
  }
  if (location.file == NULL) {
    location.file = "";
  }
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location, "%s%s", what, place));
  return dea_fail(ctx, DEA_E_DESIGN, "%s%s", what, place);
}

/* Two pieces that are looked at together, and what is found. */
struct pair {
  const struct dea_pieces *all;
  size_t i, j;
  const struct dea_piece *a, *b;
  double snap;
  double meet[6][2]; // points where they meet, apart from each other
  bool inner[6];     // at neither's end, and across
  int count;
};

static bool is_end(const struct dea_piece *p, const double x[2], double snap)
{
  return dea_apart_m(p->from, x) <= snap || dea_apart_m(p->to, x) <= snap;
}

static void add_meeting(struct pair *p, const double x[2], bool across)
{
  for (int k = 0; k < p->count; k++) {
    if (dea_apart_m(p->meet[k], x) <= 2 * p->snap) {
      return;
    }
  }
  p->meet[p->count][0] = x[0];
  p->meet[p->count][1] = x[1];
  p->inner[p->count++] = across && !is_end(p->a, x, p->snap) && !is_end(p->b, x, p->snap);
}

/* All points where two pieces meet: their ends on the other one, and crossings. */
static void find_meetings(struct pair *p)
{
  const double *ends[4] = {p->a->from, p->a->to, p->b->from, p->b->to};
  for (int k = 0; k < 4; k++) {
    if (dea_piece_distance_m(k < 2 ? p->b : p->a, ends[k]) <= p->snap) {
      add_meeting(p, ends[k], false);
    }
  }
  double at[2][2];
  int count = dea_piece_crossings(p->a, p->b, p->snap, at);
  bool tangent = count == 1 && (p->a->arc || p->b->arc);
  for (int k = 0; k < count; k++) {
    if (dea_piece_distance_m(p->a, at[k]) <= p->snap &&
        dea_piece_distance_m(p->b, at[k]) <= p->snap) {
      add_meeting(p, at[k], !tangent);
    }
  }
}

/* The first place where two pieces of one contour meet but for where one follows the other. */
static const double *find_own_crossing(const struct pair *p)
{
  for (int k = 0; k < p->count; k++) {
    bool joint = (p->all->next[p->i] == p->j && dea_apart_m(p->meet[k], p->a->to) <= p->snap) ||
                 (p->all->next[p->j] == p->i && dea_apart_m(p->meet[k], p->b->to) <= p->snap);
    if (!joint) {
      return p->meet[k];
    }
  }
  return NULL;
}

/* How far along a piece a point of it lies, as dea_piece_point counts. */
static double fraction_of(const struct dea_piece *p, const double x[2], double snap)
{
  if (dea_apart_m(p->from, x) <= snap || dea_apart_m(p->to, x) <= snap) {
    return dea_apart_m(p->from, x) <= snap ? 0 : 1;
  }
  if (!p->arc) {
    return dea_apart_m(p->from, x) / p->length_m;
  }
  double along =
      (atan2(x[1] - p->centre[1], x[0] - p->centre[0]) - p->start) * (p->sweep > 0 ? 1 : -1);
  return (along - 2 * DEA_PI * floor(along / (2 * DEA_PI))) / fabs(p->sweep);
}

/* Whether pieces that meet more than once lie on each other in between. */
static bool share_an_edge(const struct pair *p)
{
  for (int k = 0; k < p->count; k++) {
    for (int other = 0; other < k; other++) {
      double middle[2], part = fraction_of(p->a, p->meet[k], p->snap);
      part = 0.5 * (part + fraction_of(p->a, p->meet[other], p->snap));
      dea_piece_point(p->a, part, middle);
      if (dea_piece_distance_m(p->b, middle) <= p->snap) {
        return true;
      }
    }
  }
  return false;
}

static struct dea_contour contour_of(const struct dea_pieces *all, size_t piece)
{
  size_t first = piece, last = piece;
  while (first > 0 && all->contour[first - 1] == all->contour[piece]) {
    first--;
  }
  while (last + 1 < all->count && all->contour[last + 1] == all->contour[piece]) {
    last++;
  }
  return (struct dea_contour){all->start + first, last - first + 1, true};
}

/* Whether the contour of a goes through the other one where they touch at x: what comes a little
 * before and what comes after lie on different sides. */
static bool goes_through(const struct pair *p, const double x[2])
{
  size_t before = p->i, after = p->i;
  if (dea_apart_m(p->a->to, x) <= p->snap) {
    after = p->all->next[p->i];
  } else if (dea_apart_m(p->a->from, x) <= p->snap) {
    while (p->all->next[before] != p->i) {
      before = p->all->next[before];
    }
  }
  double sides[2][2];
  for (int k = 0; k < 2; k++) {
    const struct dea_piece *piece = &p->all->piece[k == 0 ? before : after];
    double part =
        dea_apart_m(piece->from, x) / (dea_apart_m(piece->from, x) + dea_apart_m(piece->to, x));
    part += k == 0 ? -1e-3 : 1e-3; // along from its start, near enough
    dea_piece_point(piece, part < 0 ? 0 : part > 1 ? 1 : part, sides[k]);
    if (dea_piece_distance_m(p->b, sides[k]) <= p->snap) {
      return false;
    }
  }
  const struct dea_contour other = contour_of(p->all, p->j);
  return dea_contour_inside(&other, sides[0][0], sides[0][1]) !=
         dea_contour_inside(&other, sides[1][0], sides[1][1]);
}

/* What is looked at: all pieces, those of one contour with each other, or only where these cross
 * and not at an end of either. */
enum check { ALL, EACH_ALONE, CROSSINGS };

/* What is wrong with two pieces; NULL when nothing is. */
static const char *check_pair(struct pair *p, enum check check, const double **where)
{
  find_meetings(p);
  for (int k = 0; k < p->count && check == CROSSINGS; k++) {
    if (p->inner[k]) {
      *where = p->meet[k];
      return crosses_itself;
    }
  }
  if (p->count == 0 || check == CROSSINGS) {
    return NULL;
  }
  if (p->all->contour[p->i] == p->all->contour[p->j]) {
    *where = find_own_crossing(p);
    return *where != NULL ? crosses_itself : NULL;
  }
  *where = p->meet[0];
  if (share_an_edge(p)) {
    return "two contours have an edge in common";
  }
  for (int k = 0; k < p->count; k++) {
    *where = p->meet[k];
    if (p->inner[k] || goes_through(p, p->meet[k])) {
      return "two contours cross";
    }
  }
  return NULL;
}

static dea_status check_pairs(struct dea_context *ctx, const struct dea_pieces *all,
                              enum check check)
{
  for (size_t i = 0; i < all->count; i++) {
    double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    dea_piece_grow_box(&all->piece[i], box);
    size_t cursor = 0, j;
    while (dea_pieces_next(all, box, &cursor, &j)) {
      if (j <= i || (check == EACH_ALONE && all->contour[i] != all->contour[j])) {
        continue;
      }
      struct pair pair = {.all = all, .i = i, .j = j, .a = &all->piece[i], .b = &all->piece[j]};
      pair.snap = all->snap_m;
      const double *at = NULL;
      const char *what = check_pair(&pair, check, &at);
      if (what != NULL) {
        return dea_region_fault(ctx, all->start[i].location, at[0], at[1], what);
      }
    }
    if ((i & 1023) == 0 && dea_interrupted(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted while contours were checked");
    }
  }
  return DEA_OK;
}

/* What to say of a contour without an area: one that goes as far around one side of its crossing as
 * around the other has none either. */
static dea_status report_no_area(struct dea_context *ctx, const struct dea_contour *contour)
{
  const struct dea_vertex *first = &contour->vertex[0];
  struct dea_region alone = {.ctx = ctx};
  const struct dea_region *of = &alone;
  struct dea_pieces all;
  dea_region_add(&alone, contour->vertex, contour->count);
  dea_status status = dea_region_status(&alone);
  status = status == DEA_OK ? dea_pieces_build(ctx, &of, 1, &all) : status;
  dea_region_free(&alone);
  DEA_TRY(ctx, status);
  status = check_pairs(ctx, &all, CROSSINGS);
  dea_pieces_free(&all);
  DEA_TRY(ctx, status);
  return dea_region_fault(ctx, first->location, first->x_m, first->y_m,
                          "a contour encloses no area");
}

dea_status dea_region_check(struct dea_context *ctx, const struct dea_region *region,
                            bool apart_too)
{
  double size = dea_region_size_m(region), snap = DEA_GEOMETRY_SNAP * size;
  for (size_t c = 0; c < region->contour_count; c++) {
    const struct dea_contour contour = dea_region_contour(region, c);
    const struct dea_vertex *v = contour.vertex;
    for (size_t i = 0; i < contour.count; i++) {
      const struct dea_piece piece = dea_contour_piece(&contour, i);
      if (!isfinite(piece.length_m)) {
        return dea_region_fault(ctx, v[i].location, NAN, NAN, "a vertex of a contour is no number");
      }
      if (piece.length_m <= snap) {
        return dea_region_fault(ctx, v[i].location, v[i].x_m, v[i].y_m,
                                "two vertices of a contour lie on each other");
      }
    }
    if (contour.count < 2 ||
        fabs(dea_contour_area_m2(&contour)) <= snap * dea_contour_length_m(&contour)) {
      return report_no_area(ctx, &contour);
    }
  }
  struct dea_pieces all;
  DEA_TRY(ctx, dea_pieces_build(ctx, &region, 1, &all));
  dea_status status = check_pairs(ctx, &all, apart_too ? ALL : EACH_ALONE);
  dea_pieces_free(&all);
  return status;
}

dea_status dea_region_add_checked(struct dea_region *region, const struct dea_region *from)
{
  DEA_TRY(region->ctx, dea_region_status(from));
  DEA_TRY(region->ctx, dea_region_check(region->ctx, from, true));
  for (size_t i = 0; i < from->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(from, i);
    dea_region_add(region, contour.vertex, contour.count);
  }
  return dea_region_status(region);
}

#include "fabricate/layout_parts.h"

#include "geometry/boolean.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// Names ------------------------------------------------------------------------------------------

/* Letters and digits of a name, and dashes for the rest. */
static void write_slug(const char *name, char out[32])
{
  size_t n = 0;
  for (; *name != '\0' && n < 31; name++) {
    char c = *name;
    bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                 c == '_' || c == '-';
    if (plain || (n > 0 && out[n - 1] != '-')) {
      out[n++] = plain ? c : '-';
    }
  }
  while (n > 1 && out[n - 1] == '-') {
    n--;
  }
  out[n] = '\0';
}

size_t dea_part_pieces(const struct dea_part *part)
{
  size_t pieces = 0;
  for (size_t i = 0; i < part->contour_count; i++) {
    pieces += part->contour[i].layer == DEA_LAYER_CUT_OUTER ? 1 : 0;
  }
  return pieces;
}

// From the layout to a part ----------------------------------------------------------------------

/* A part that is being made, and where points of the layout come to lie on it. */
struct sheet {
  struct dea_workshop *w;
  const struct dea_layout *layout;
  struct dea_part *part;
  double map[2][2]; // of a distance from the plan's origin, in the flat film
};

/* "KIND-NAME", with the number of the ply or body where the name of another one would give the
 * same; a ply may bring its own. */
static void write_name(const struct dea_layout *l, enum dea_part_kind kind, size_t of,
                       char out[DEA_PART_NAME_SIZE])
{
  static const char *const words[] = {"blank", "stencil", "stencil", "ply",
                                      "body",  "frame",   "template"};
  static const char *const sides[] = {[DEA_PART_BOTTOM] = "-bottom", [DEA_PART_TOP] = "-top"};
  const char *word = words[kind], *side = kind <= DEA_PART_TOP && sides[kind] ? sides[kind] : "";
  const bool body = kind == DEA_PART_BODY;
  char slug[32], other[32], number[24] = "";
  bool alone = true;
  const bool single = kind >= DEA_PART_FRAME;
  if (single || (!body && l->plies[of].part != NULL)) {
    snprintf(out, DEA_PART_NAME_SIZE, "%s%s", single || side[0] != '\0' ? word : l->plies[of].part,
             side);
    return;
  }
  write_slug(body ? l->bodies[of].name : l->plies[of].name, slug);
  for (size_t i = 0; i < (body ? l->body_count : l->ply_count); i++) {
    write_slug(body ? l->bodies[i].name : l->plies[i].name, other);
    alone &= i == of || strcmp(slug, other) != 0;
  }
  if (!alone) {
    snprintf(number, sizeof number, "-%zu", of + 1);
  }
  snprintf(out, DEA_PART_NAME_SIZE, "%s-%s%.9s%s", word, slug, number, side);
}

/* Starts the next part: of the flat film, or a blank or stencil of the unstretched one of its ply,
 * which is seen from below where that face is printed. */
DEA_PRINTF(4, 5)
static struct sheet start(struct dea_workshop *w, enum dea_part_kind kind, size_t of,
                          const char *title, ...)
{
  struct sheet s = {.w = w, .layout = w->plan.layout, .map = {{1, 0}, {0, 1}}};
  const bool below = kind == DEA_PART_BOTTOM;
  s.part = &w->part[w->count++];
  *s.part = (struct dea_part){.memory = &w->memory,
                              .kind = kind,
                              .of = of,
                              .state = DEA_STRETCHED,
                              .flat = !w->plan.stretched,
                              .quantity = 1,
                              .mirrored = below};
  write_name(s.layout, kind, of, s.part->name);
  va_list args;
  va_start(args, title);
  vsnprintf(s.part->title, sizeof s.part->title, title, args);
  va_end(args);
  if (kind <= DEA_PART_TOP && dea_ply_is_stretched(&s.layout->plies[of])) {
    double(*F)[2] = s.part->stretch;
    dea_ply_stretch(&s.layout->plies[of], F);
    double det = F[0][0] * F[1][1] - F[0][1] * F[1][0];
    s.part->state = DEA_UNSTRETCHED;
    s.map[0][0] = F[0][1] == 0 ? 1 / F[0][0] : F[1][1] / det;
    s.map[1][1] = F[0][1] == 0 ? 1 / F[1][1] : F[0][0] / det;
    s.map[0][1] = -F[0][1] / det;
    s.map[1][0] = -F[1][0] / det;
  }
  for (int k = 0; k < 2 && below; k++) {
    s.map[0][k] = -s.map[0][k];
  }
  if (below) { // along both axes the film has then the other angle
    s.part->stretch[0][1] = -s.part->stretch[0][1];
    s.part->stretch[1][0] = -s.part->stretch[1][0];
  }
  return s;
}

static void place(const struct sheet *s, const double x_m[2], double out[2])
{
  double x = x_m[0] - s->w->plan.centre_m[0], y = x_m[1] - s->w->plan.centre_m[1];
  out[0] = s->map[0][0] * x + s->map[0][1] * y;
  out[1] = s->map[1][0] * x + s->map[1][1] * y;
}

/* Whether circles stay circles. */
static bool keeps_circles(const struct sheet *s)
{
  double shear = fabs(s->map[0][0]) - fabs(s->map[1][1]);
  return fabs(shear) < 1e-15 && s->map[0][1] == 0;
}

/* A piece of a contour into vertices of another one, without its end: arcs but those of a circle
 * into quarters, which files of few digits keep. Arcs that do not stay arcs become short ones
 * through points of the true curve, less than 0.1 um from it. */
static void add_piece(const struct sheet *s, const struct dea_piece *piece,
                      const struct dea_vertex *from, bool circle, struct dea_vertex *out,
                      size_t *count)
{
  static const double degree = DEA_PI / 180;
  const bool turned = s->map[0][0] * s->map[1][1] < s->map[0][1] * s->map[1][0];
  const double step = (keeps_circles(s) ? circle ? 180 : 90 : 5) * degree;
  const int parts = piece->arc ? (int)fmax(1, ceil(fabs(piece->sweep) / step - 1e-9)) : 1;
  for (int i = 0; i < parts; i++) {
    double at[3][2]; // start, middle, end of it
    for (int k = 0; k < 3; k++) {
      double x[2];
      dea_piece_point(piece, (i + 0.5 * k) / parts, x);
      place(s, x, at[k]);
    }
    double bulge = turned ? -from->bulge : from->bulge;
    if (parts > 1) { // half of the arc's angle is that by which its two chords turn
      double a[2] = {at[1][0] - at[0][0], at[1][1] - at[0][1]};
      double b[2] = {at[2][0] - at[1][0], at[2][1] - at[1][1]};
      bulge = tan(0.5 * atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]));
    }
    out[(*count)++] = (struct dea_vertex){at[0][0], at[0][1], bulge, from->location};
  }
}

/* Vertices that a contour can become at most. */
static size_t room_for(const struct dea_contour *contour)
{
  return contour->count * 74;
}

/* A contour in the coordinates of the part, counter-clockwise. */
static void add_contour(const struct sheet *s, const struct dea_contour *contour,
                        enum dea_layer layer)
{
  struct dea_arena *memory = s->part->memory;
  struct dea_region mapped = {.ctx = memory->ctx};
  struct dea_vertex *v = dea_alloc(memory->ctx, room_for(contour), sizeof *v);
  size_t count = 0;
  for (size_t i = 0; v != NULL && i < contour->count; i++) {
    const struct dea_piece piece = dea_contour_piece(contour, i);
    add_piece(s, &piece, &contour->vertex[i], contour->count == 2, v, &count);
  }
  if (v != NULL) {
    const struct dea_contour made = {v, count, true};
    (dea_contour_area_m2(&made) > 0 ? dea_region_add : dea_region_add_reversed)(&mapped, v, count);
  }
  if (v == NULL || mapped.failed) {
    memory->failed = true;
  } else {
    const struct dea_contour made = dea_region_contour(&mapped, 0);
    dea_part_add(s->part, layer, &made);
  }
  dea_region_free(&mapped);
  dea_free(memory->ctx, v);
}

/* Outlines on one layer, holes on another. */
static void add_region(const struct sheet *s, const struct dea_region *region,
                       enum dea_layer outlines, enum dea_layer holes)
{
  for (size_t i = 0; i < region->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(region, i);
    add_contour(s, &contour, dea_contour_area_m2(&contour) > 0 ? outlines : holes);
  }
}

/* Whether a cross of the grid at a place of the flat film would lie on something else. */
static bool is_taken(const struct dea_workshop *w, double x, double y)
{
  const struct dea_fab_plan *plan = &w->plan;
  double clear = 1.5 * plan->cross_m + w->plan.feature_m;
  bool inside = true, beyond = false;
  for (int k = 0; k < 2; k++) {
    const double at = plan->round ? hypot(x, y) : fabs(k == 0 ? x : y);
    inside &= at < plan->opening_m[k] + clear;
    beyond |= at > plan->blank_m[k] - clear;
  }
  bool taken = inside || beyond;
  for (size_t i = 0; i < plan->pad_count; i++) {
    taken |= hypot(x - plan->pad[i].at_m[0], y - plan->pad[i].at_m[1]) < plan->pad_m + clear;
  }
  for (int k = 0; k < DEA_FAB_MARKS; k++) {
    taken |= hypot(x - plan->mark_at_m[k][0], y - plan->mark_at_m[k][1]) < plan->mark_m + clear;
  }
  return taken;
}

static void add_line(const struct sheet *s, double x0, double y0, double x1, double y1)
{
  const double *c = s->w->plan.centre_m;
  const double from[2] = {c[0] + x0, c[1] + y0}, to[2] = {c[0] + x1, c[1] + y1};
  double a[2], b[2];
  place(s, from, a);
  place(s, to, b);
  const struct dea_location at = s->w->plan.design->fabrication.grid_spacing.length.location;
  const struct dea_vertex ends[2] = {{a[0], a[1], 0, at}, {b[0], b[1], 0, at}};
  const struct dea_contour line = {ends, 2, false};
  dea_part_add(s->part, DEA_LAYER_MARK, &line);
}

/* Crosses of a grid, on the film beyond the opening. */
static void add_grid(const struct sheet *s)
{
  const struct dea_fab_plan *plan = &s->w->plan;
  int n[2];
  for (int k = 0; k < 2; k++) {
    n[k] = (int)(plan->blank_m[k] / plan->grid_m);
  }
  for (int j = -n[1]; j <= n[1]; j++) {
    for (int i = -n[0]; i <= n[0]; i++) {
      double x = i * plan->grid_m, y = j * plan->grid_m, arm = plan->cross_m;
      if (!is_taken(s->w, x, y)) {
        add_line(s, x - arm, y, x + arm, y);
        add_line(s, x, y - arm, x, y + arm);
      }
    }
  }
}

// Dimensions -------------------------------------------------------------------------------------

/* Two sides of a box. */
static void measure_sides(struct dea_part *part, const double box[4], const char *what)
{
  dea_part_measure(part, DEA_MEASURE_LENGTH, box[0], box[1], box[2], box[1], what);
  dea_part_measure(part, DEA_MEASURE_LENGTH, box[0], box[1], box[0], box[3], what);
}

/* Dimensions of contours from `first` on: diameters of circles, two sides of the boxes around
 * others; of several alike the first one. */
static void measure(struct dea_part *part, size_t first, enum dea_layer layer, const char *what)
{
  double seen[6][2];
  size_t count = 0;
  for (size_t i = first; i < part->contour_count && count < 6; i++) {
    double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    dea_contour_grow_box(&part->contour[i].path, box);
    const double side[2] = {box[2] - box[0], box[3] - box[1]};
    bool known = part->contour[i].layer != layer || !part->contour[i].path.closed;
    for (size_t k = 0; k < count && !known; k++) {
      known = fabs(seen[k][0] - side[0]) < 1e-7 && fabs(seen[k][1] - side[1]) < 1e-7;
    }
    if (known) {
      continue;
    }
    memcpy(seen[count++], side, sizeof side);
    double y = 0.5 * (box[1] + box[3]);
    if (part->contour[i].circle) {
      dea_part_measure(part, DEA_MEASURE_DIAMETER, box[0], y, box[2], y, what);
    } else {
      measure_sides(part, box, what);
    }
  }
}

/* Dimensions of contours from `first` on that are none of the part, and go again. */
static void measure_and_drop(struct dea_part *part, size_t first, const char *what)
{
  measure(part, first, DEA_LAYER_NOTE, what);
  part->contour_count = first;
}

/* A length in the flat film, from the plan's origin. */
static void measure_length(const struct sheet *s, double x0, double y0, double x1, double y1,
                           const char *what)
{
  const double *c = s->w->plan.centre_m;
  const double from[2] = {c[0] + x0, c[1] + y0}, to[2] = {c[0] + x1, c[1] + y1};
  double a[2], b[2];
  place(s, from, a);
  place(s, to, b);
  dea_part_measure(s->part, DEA_MEASURE_LENGTH, a[0], a[1], b[0], b[1], what);
}

static void measure_grid(const struct sheet *s, double share)
{
  const struct dea_fab_plan *plan = &s->w->plan;
  const double y = -share * plan->blank_m[1];
  measure_length(s, -plan->grid_m, y, 0, y, "grid");
}

/* Sides of the box around all that is cut. */
static void measure_box(struct dea_part *part, const char *what)
{
  double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (size_t i = 0; i < part->contour_count; i++) {
    if (part->contour[i].layer == DEA_LAYER_CUT_OUTER) {
      dea_contour_grow_box(&part->contour[i].path, box);
    }
  }
  measure_sides(part, box, what);
}

// Parts ------------------------------------------------------------------------------------------

static void add_blank(struct dea_workshop *w, size_t ply)
{
  const struct dea_layout *l = w->plan.layout;
  struct sheet s = start(w, DEA_PART_BLANK, ply, "Film '%.60s'%s", l->plies[ply].name,
                         dea_ply_is_stretched(&l->plies[ply]) ? " before it is stretched" : "");
  s.part->quantity = dea_ply_count_like(l, ply);
  add_grid(&s);
  add_region(&s, &w->plan.marks, DEA_LAYER_MARK, DEA_LAYER_MARK);
  add_region(&s, &w->plan.film, DEA_LAYER_CUT_OUTER, DEA_LAYER_CUT_INNER);
  measure(s.part, 0, DEA_LAYER_CUT_OUTER, "film");
  measure_grid(&s, 0.86);
}

static bool lies_on(const struct dea_layout_electrode *e, size_t ply, bool top)
{
  return e->ply == ply && e->top == top;
}

/* All electrodes of a face, with their leads and pads, as one region. */
static dea_status gather(struct dea_context *ctx, const struct dea_fab_plan *plan, size_t ply,
                         bool top, struct dea_region *out)
{
  const struct dea_motion still = dea_motion_translation(0, 0);
  struct dea_region all = {.ctx = ctx};
  for (size_t i = 0; i < plan->layout->electrode_count; i++) {
    if (lies_on(&plan->layout->electrodes[i], ply, top)) {
      dea_region_add_moved(&all, &plan->inked[i], &still);
    }
  }
  return dea_fab_unite(ctx, &all, out);
}

/* Sizes of the electrodes of a face, of a lead, and of a pad. */
static void measure_ink(const struct sheet *s, size_t ply, bool top)
{
  const struct dea_fab_plan *plan = &s->w->plan;
  const size_t first = s->part->contour_count;
  for (size_t i = 0; i < s->layout->electrode_count; i++) {
    const struct dea_layout_electrode *e = &s->layout->electrodes[i];
    if (lies_on(e, ply, top)) {
      add_region(s, &s->layout->regions[e->region].region, DEA_LAYER_NOTE, DEA_LAYER_CUT_OUTER);
    }
  }
  measure_and_drop(s->part, first, "electrode");
  for (size_t i = 0; i < plan->pad_count; i++) {
    const struct dea_layout_electrode *e = &s->layout->electrodes[plan->pad[i].electrode];
    const double *at = plan->pad[i].at_m, u = 0.5 * plan->lead_width_m * cos(e->lead_rad);
    const double v = 0.5 * plan->lead_width_m * sin(e->lead_rad), back = 1.2 * plan->pad_m;
    const double x = at[0] - back * cos(e->lead_rad), y = at[1] - back * sin(e->lead_rad);
    if (!lies_on(e, ply, top)) {
      continue;
    }
    measure_length(s, x + v, y - u, x - v, y + u, "lead");
    const struct dea_contour circle = dea_region_contour(&plan->pads, i);
    add_contour(s, &circle, DEA_LAYER_NOTE);
    measure_and_drop(s->part, first, "pad");
    return;
  }
}

static dea_status add_stencil(struct dea_workshop *w, size_t ply, bool top)
{
  const struct dea_layout *l = w->plan.layout;
  struct dea_context *ctx = w->memory.ctx;
  struct dea_region openings = {.ctx = ctx};
  DEA_TRY_ELSE(ctx, gather(ctx, &w->plan, ply, top, &openings), dea_region_free(&openings));
  struct sheet s = start(w, top ? DEA_PART_TOP : DEA_PART_BOTTOM, ply,
                         "Stencil of the electrodes on the %s of '%.60s'", top ? "top" : "bottom",
                         l->plies[ply].name);
  add_region(&s, &openings, DEA_LAYER_CUT_INNER, DEA_LAYER_CUT_OUTER);
  size_t pieces = dea_part_pieces(s.part);
  measure_ink(&s, ply, top);
  measure(s.part, 0, DEA_LAYER_CUT_OUTER, "loose piece");
  add_region(&s, &w->plan.marks, DEA_LAYER_CUT_INNER, DEA_LAYER_CUT_OUTER);
  add_region(&s, &w->plan.sheet, DEA_LAYER_CUT_OUTER, DEA_LAYER_CUT_INNER);
  measure_box(s.part, "stencil");
  double box[4];
  dea_part_box(s.part, box);
  s.part->word = top ? "TOP" : "BOTTOM";
  s.part->word_y_m = 0.94 * box[1];
  s.part->word_height_m = fmin(2e-3, 0.06 * fmin(box[2], box[3]));
  dea_region_free(&openings);
  if (pieces > 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, l->plies[ply].location,
                                 "%s: %zu piece%s within an electrode %s loose; cut the stencil "
                                 "from adhesive foil on a carrier, which keeps places",
                                 s.part->name, pieces, pieces > 1 ? "s" : "",
                                 pieces > 1 ? "are" : "is"));
  }
  return DEA_OK;
}

static void add_template(struct dea_workshop *w)
{
  struct sheet s = start(w, DEA_PART_TEMPLATE, 0, "Template of the flat device, for paper");
  const struct dea_layout *l = s.layout;
  const enum dea_layer mark = DEA_LAYER_MARK;
  s.part->paper = true;
  add_grid(&s);
  add_region(&s, &w->plan.marks, mark, mark);
  for (size_t i = l->electrode_count; i-- > 0;) {
    if (dea_face_like(l, l->electrodes[i].ply, l->electrodes[i].top) == l->electrodes[i].ply) {
      add_region(&s, &w->plan.inked[i], mark, mark);
    }
  }
  for (size_t i = 0; i < l->ply_count; i++) {
    if (dea_ply_is_cut(&l->plies[i]) && dea_ply_like(l, i) == i) {
      add_region(&s, &l->regions[l->plies[i].region].region, mark, mark);
    }
  }
  for (size_t i = 0; i < l->body_count; i++) {
    add_region(&s, &l->regions[l->bodies[i].region].region, mark, mark);
  }
  const struct dea_layout_ply *film = dea_layout_film(l);
  if (film != NULL && film->pre_stretch[0] == film->pre_stretch[1]) {
    dea_ply_stretch(film, s.part->stretch);
  }
  if (w->plan.held || w->plan.stretched) {
    add_region(&s, &w->plan.frame, mark, mark);
    const size_t first = s.part->contour_count;
    add_region(&s, &w->plan.film, mark, mark);
    measure(s.part, first, mark, "film");
    measure_grid(&s, 0.9);
  }
}

static void add_frame(struct dea_workshop *w)
{
  const enum dea_layer inner = DEA_LAYER_CUT_INNER, outer = DEA_LAYER_CUT_OUTER;
  struct sheet s = start(w, DEA_PART_FRAME, 0, "%s",
                         w->plan.held ? "Frame, to which the edge of the film is bonded"
                                      : "Frame that holds the film until it is cut");
  add_region(&s, &w->plan.hole, inner, outer);
  measure(s.part, 0, inner, "opening");
  size_t first = s.part->contour_count;
  add_region(&s, &w->plan.marks, inner, outer);
  measure(s.part, first, inner, "mark");
  first = s.part->contour_count;
  add_region(&s, &w->plan.windows, inner, outer);
  measure(s.part, first, inner, "contact");
  first = s.part->contour_count;
  add_region(&s, &w->plan.frame, outer, inner);
  measure(s.part, first, outer, "frame");
}

/* Pieces in a holder that is as large as the frame. */
static dea_status add_holder(struct dea_workshop *w, size_t ply)
{
  const struct dea_fab_plan *plan = &w->plan;
  const struct dea_fabrication *f = &plan->design->fabrication;
  const struct dea_device *d = plan->device;
  struct dea_context *ctx = w->memory.ctx;
  struct dea_region pieces = {.ctx = ctx}, inside = {.ctx = ctx}, opening = {.ctx = ctx};
  dea_region_add_circle(&inside, plan->centre_m[0], plan->centre_m[1], plan->holder_m, false,
                        f->holder.tab_length_m.location);
  dea_fab_add_pieces(plan, true, &pieces);
  dea_status status = inside.failed ? DEA_E_MEMORY : dea_region_status(&pieces);
  status = status == DEA_OK ? dea_region_combine(ctx, DEA_DIFFERENCE, &inside, &pieces, &opening)
                            : status;
  if (status == DEA_OK) {
    struct sheet s =
        start(w, DEA_PART_OUTLINE, ply, "Ply '%.60s' in its holder", plan->layout->plies[ply].name);
    const double outer = plan->piece_outer_m, half = 0.5 * d->fibre_width_m;
    add_region(&s, &opening, DEA_LAYER_CUT_INNER, DEA_LAYER_CUT_OUTER);
    add_region(&s, &plan->marks, DEA_LAYER_CUT_INNER, DEA_LAYER_CUT_OUTER);
    const size_t first = s.part->contour_count;
    add_region(&s, &plan->frame, DEA_LAYER_CUT_OUTER, DEA_LAYER_CUT_INNER);
    measure(s.part, first, DEA_LAYER_CUT_OUTER, "holder");
    measure_length(&s, d->fibre_tip_radius_m, 0, outer, 0, "fibre");
    if (plan->piece_end_m > outer) {
      measure_length(&s, outer, 0, plan->piece_end_m, 0, "anchor");
    }
    measure_length(&s, outer, -half, outer, half, "width");
  }
  dea_region_free(&pieces);
  dea_region_free(&inside);
  dea_region_free(&opening);
  return status;
}

/* Pieces on a carrier, which has the marks. */
static void add_outline(struct dea_workshop *w, enum dea_part_kind kind, size_t of,
                        const char *what, const char *name, const char *more, size_t region)
{
  struct sheet s = start(w, kind, of, "%s '%.60s'%s", what, name, more);
  s.part->quantity = kind == DEA_PART_BODY ? 1 : dea_ply_count_like(s.layout, of);
  add_region(&s, &s.layout->regions[region].region, DEA_LAYER_CUT_OUTER, DEA_LAYER_CUT_INNER);
  if (dea_part_pieces(s.part) > 1) {
    measure_box(s.part, "in all");
  }
  measure(s.part, 0, DEA_LAYER_CUT_OUTER, "piece");
  measure(s.part, 0, DEA_LAYER_CUT_INNER, "hole");
  add_region(&s, &w->plan.marks, DEA_LAYER_MARK, DEA_LAYER_MARK);
}

static dea_status add_plies_and_bodies(struct dea_workshop *w)
{
  const struct dea_layout *l = w->plan.layout;
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_layout_ply *ply = &l->plies[i];
    if (i == w->plan.on_tabs) {
      DEA_TRY(w->memory.ctx, add_holder(w, i));
    } else if (dea_ply_like(l, i) == i && dea_ply_is_cut(ply) && !dea_ply_is_held(l, i)) {
      const bool film = dea_ply_is_stretched(ply);
      add_outline(w, DEA_PART_OUTLINE, i, film ? "Outline of the film" : "Ply", ply->name,
                  film ? ", cut once it is stretched and bonded" : "", ply->region);
    }
  }
  for (size_t i = 0; i < l->body_count; i++) {
    add_outline(w, DEA_PART_BODY, i, "Rigid body", l->bodies[i].name, "", l->bodies[i].region);
  }
  return DEA_OK;
}

dea_status dea_parts_build(struct dea_context *ctx, struct dea_workshop *w)
{
  const struct dea_layout *l = w->plan.layout;
  size_t most = 2 + 4 * l->ply_count + l->body_count;
  w->part = dea_arena_alloc(&w->memory, most, sizeof *w->part);
  DEA_TRY(ctx, dea_arena_status(&w->memory));
  for (size_t i = 0; i < l->ply_count; i++) {
    if (dea_ply_is_blank(l, i) && dea_ply_like(l, i) == i) {
      add_blank(w, i);
    }
    for (int top = 0; top < 2; top++) {
      DEA_TRY(ctx, dea_face_like(l, i, top == 1) == i ? add_stencil(w, i, top == 1) : DEA_OK);
    }
  }
  add_template(w);
  if (w->plan.held || w->plan.stretched) {
    add_frame(w);
  }
  DEA_TRY(ctx, add_plies_and_bodies(w));
  return dea_arena_status(&w->memory);
}

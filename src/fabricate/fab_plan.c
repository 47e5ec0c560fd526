#include "fabricate/fab_plan.h"

#include "device/geometry.h"
#include "device/layout_check.h"
#include "geometry/boolean.h"

#include <math.h>
#include <string.h>

/* Parts that touch exactly do not overlap; the file's decimals leave a rounding error. */
static const double touching = 1e-9;

// Plies and faces --------------------------------------------------------------------------------

bool dea_ply_is_cut(const struct dea_layout_ply *ply)
{
  return ply->part == NULL || ply->part[0] != '\0';
}

bool dea_ply_is_stretched(const struct dea_layout_ply *ply)
{
  return fabs(ply->pre_stretch[0] - 1) > 1e-12 || fabs(ply->pre_stretch[1] - 1) > 1e-12;
}

bool dea_ply_is_held(const struct dea_layout *layout, size_t ply)
{
  for (size_t i = 0; i < layout->support_count; i++) {
    if (dea_support_is_frame(&layout->supports[i]) &&
        layout->supports[i].region == layout->plies[ply].region) {
      return true;
    }
  }
  return false;
}

bool dea_ply_is_blank(const struct dea_layout *layout, size_t ply)
{
  const struct dea_layout_ply *own = &layout->plies[ply];
  return dea_ply_is_cut(own) && (dea_ply_is_stretched(own) || dea_ply_is_held(layout, ply));
}

static bool same_stretch(const struct dea_layout_ply *a, const struct dea_layout_ply *b)
{
  return a->pre_stretch[0] == b->pre_stretch[0] && a->pre_stretch[1] == b->pre_stretch[1] &&
         a->angle_rad == b->angle_rad;
}

size_t dea_ply_like(const struct dea_layout *layout, size_t ply)
{
  const struct dea_layout_ply *p = layout->plies, *own = &p[ply];
  size_t i = 0;
  while (i < ply && !(p[i].region == own->region && p[i].thickness_m == own->thickness_m &&
                      dea_ply_layers(&p[i]) == dea_ply_layers(own) && same_stretch(&p[i], own) &&
                      strcmp(p[i].material.name, own->material.name) == 0)) {
    i++;
  }
  return i;
}

size_t dea_ply_count_like(const struct dea_layout *layout, size_t ply)
{
  size_t count = 0;
  for (size_t i = 0; i < layout->ply_count; i++) {
    count += dea_ply_like(layout, i) == ply ? dea_ply_layers(&layout->plies[i]) : 0;
  }
  return count;
}

/* Whether two faces have electrodes of the same regions with the same leads, in one order; none:
 * false. */
static bool same_face(const struct dea_layout *layout, size_t a, size_t b, bool top)
{
  const struct dea_layout_electrode *e = layout->electrodes;
  size_t j = 0, count = 0;
  for (size_t i = 0; i <= layout->electrode_count; i++) {
    if (i < layout->electrode_count && (e[i].ply != a || e[i].top != top)) {
      continue;
    }
    while (j < layout->electrode_count && (e[j].ply != b || e[j].top != top)) {
      j++;
    }
    if (i == layout->electrode_count || j == layout->electrode_count) {
      return i == j && count > 0;
    }
    if (e[i].region != e[j].region || e[i].lead != e[j].lead || e[i].lead_rad != e[j].lead_rad) {
      return false;
    }
    j++;
    count++;
  }
  return false;
}

size_t dea_face_like(const struct dea_layout *layout, size_t ply, bool top)
{
  const struct dea_layout_ply *p = layout->plies;
  for (size_t i = 0; i <= ply; i++) {
    if (same_stretch(&p[i], &p[ply]) && same_face(layout, i, ply, top)) {
      return i;
    }
  }
  return DEA_LAYOUT_NONE;
}

void dea_ply_stretch(const struct dea_layout_ply *ply, double out[2][2])
{
  double c = cos(ply->angle_rad), s = sin(ply->angle_rad);
  double a = ply->pre_stretch[0], b = ply->pre_stretch[1];
  out[0][0] = a == b ? a : c * c * a + s * s * b; // without rounding where the angle says nothing
  out[1][1] = a == b ? a : s * s * a + c * c * b;
  out[0][1] = out[1][0] = a == b ? 0 : c * s * (a - b);
}

// Frame and marks --------------------------------------------------------------------------------

/* The largest of the plies' pre-stretches, of two axes their mean: that of lengths which the design
 * gives unstretched. */
static double largest_stretch(const struct dea_layout *layout)
{
  double largest = 1;
  for (size_t i = 0; i < layout->ply_count; i++) {
    const double *l = layout->plies[i].pre_stretch;
    largest = fmax(largest, sqrt(l[0] * l[1]));
  }
  return largest;
}

/* The opening of a frame that stays: all that it holds the edge of. */
static dea_status build_hole(struct dea_context *ctx, struct dea_fab_plan *plan)
{
  const struct dea_motion still = dea_motion_translation(0, 0);
  const struct dea_layout *layout = plan->layout;
  struct dea_region all = {.ctx = ctx};
  size_t last = DEA_LAYOUT_NONE;
  for (size_t i = 0; i < layout->support_count; i++) {
    const size_t region = layout->supports[i].region;
    if (dea_support_is_frame(&layout->supports[i]) && region != last) {
      dea_region_add_moved(&all, &layout->regions[region].region, &still);
      last = region;
      plan->held = true;
    }
  }
  return dea_fab_unite(ctx, &all, &plan->hole);
}

/* Half way between an edge and the outer edge of the frame, from a place in a direction. */
static void place_on_frame(const struct dea_fab_plan *plan, const double edge_m[2],
                           const double from[2], double angle_rad, double out[2])
{
  const double u[2] = {cos(angle_rad), sin(angle_rad)};
  const double along = from[0] * u[0] + from[1] * u[1];
  double t = INFINITY;
  for (int k = 0; k < 2; k++) {
    const double half = 0.5 * (edge_m[k] + plan->frame_m[k]);
    if (plan->round) {
      t = sqrt(along * along + half * half - from[0] * from[0] - from[1] * from[1]) - along;
    } else if (u[k] != 0) {
      t = fmin(t, (copysign(half, u[k]) - from[k]) / u[k]);
    }
  }
  for (int k = 0; k < 2; k++) {
    out[k] = from[k] + t * u[k];
  }
}

/* Three marks on the frame: two on the wider way from the last lead to the first, one on the other
 * way. All three distances between them differ, so that a sheet that is turned over or around does
 * not fit: two equal ones would let it be turned over. */
static void place_marks(struct dea_fab_plan *plan)
{
  const double *last = plan->pad_count > 0 ? plan->pad[plan->pad_count - 1].at_m : NULL;
  const double from = last != NULL ? atan2(last[1], last[0]) : 0;
  const double *first = plan->pad_count > 1 ? plan->pad[0].at_m : NULL;
  double turn = first != NULL ? atan2(first[1], first[0]) - from : DEA_PI;
  turn -= 2 * DEA_PI * floor(turn / (2 * DEA_PI));
  const bool wider = turn >= DEA_PI * (1 - 1e-9);
  const double two = wider ? turn : turn - 2 * DEA_PI, one = wider ? turn - 2 * DEA_PI : turn;
  const double angle[DEA_FAB_MARKS] = {from + two / 3, from + 2 * two / 3, from + 0.4 * one};
  const double centre[2] = {0, 0}, holder[2] = {plan->holder_m, plan->holder_m};
  for (int m = 0; m < DEA_FAB_MARKS; m++) {
    place_on_frame(plan, plan->round ? holder : plan->opening_m, centre, angle[m],
                   plan->mark_at_m[m]);
  }
}

static dea_status fill(struct dea_context *ctx, struct dea_fab_plan *plan)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const struct dea_layout *layout = plan->layout;
  const double l = plan->stretch = largest_stretch(layout);
  double box[4], centre[2], radius;
  plan->kerf_m = f->kerf_m.si;
  plan->feature_m = f->minimum_feature_m.si;
  plan->copies = (int)f->copies.si;
  for (size_t i = 0; i < layout->ply_count; i++) {
    plan->stretched |= dea_ply_is_stretched(&layout->plies[i]);
  }
  DEA_TRY(ctx, build_hole(ctx, plan));
  if (plan->held && plan->hole.contour_count == 1) {
    const struct dea_contour edge = dea_region_contour(&plan->hole, 0);
    plan->round = dea_contour_is_circle(&edge, centre, &radius);
  }
  dea_layout_box_m(layout, box);
  for (size_t i = 0; i < layout->body_count; i++) {
    dea_region_grow_box(&layout->regions[layout->bodies[i].region].region, box);
  }
  dea_region_grow_box(&plan->hole, box);
  for (int k = 0; k < 2; k++) {
    plan->centre_m[k] = 0.5 * (box[k] + box[2 + k]);
    plan->opening_m[k] = 0.5 * (box[2 + k] - box[k]) + (plan->held ? 0 : f->frame_gap_m.si);
    plan->frame_m[k] = plan->opening_m[k] + f->ring.width_m.si;
    plan->blank_m[k] = plan->frame_m[k] + dea_length_stretched_m(&f->blank.margin, l);
  }
  plan->lead_width_m = dea_length_stretched_m(&f->leads.width, l);
  plan->pad_m = 0.5 * dea_length_stretched_m(&f->leads.pad_diameter, l);
  plan->window_m = 0.5 * f->ring.contact_window_m.si;
  plan->mark_m = 0.5 * dea_length_stretched_m(&f->mark_diameter, l);
  plan->grid_m = dea_length_stretched_m(&f->grid_spacing, l);
  plan->cross_m = fmin(0.1 * plan->grid_m, 0.5e-3 * l);
  return DEA_OK;
}

static void add_box(const struct dea_fab_plan *plan, const double half_m[2],
                    struct dea_location location, struct dea_region *out)
{
  const double *c = plan->centre_m;
  struct dea_vertex v[4];
  for (int k = 0; k < 4; k++) {
    v[k] = (struct dea_vertex){c[0] + (k == 0 || k == 3 ? half_m[0] : -half_m[0]),
                               c[1] + (k < 2 ? half_m[1] : -half_m[1]), 0, location};
  }
  dea_region_add(out, v, 4);
}

/* Round as the opening, or a rectangle. */
static void add_edge(const struct dea_fab_plan *plan, const double half_m[2],
                     struct dea_location location, struct dea_region *out)
{
  if (plan->round) {
    dea_region_add_circle(out, plan->centre_m[0], plan->centre_m[1], half_m[0], false, location);
  } else {
    add_box(plan, half_m, location, out);
  }
}

/* What is cut and marked in addition to the layout's own shapes. */
static dea_status build_edges(struct dea_context *ctx, struct dea_fab_plan *plan)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const struct dea_location edge = f->blank.margin.length.location;
  const double *c = plan->centre_m;
  struct dea_region *const all[] = {&plan->hole,  &plan->frame, &plan->film,   &plan->sheet,
                                    &plan->marks, &plan->pads,  &plan->windows};
  add_edge(plan, plan->frame_m, f->ring.width_m.location, &plan->frame);
  add_edge(plan, plan->blank_m, edge, &plan->film);
  add_box(plan, plan->blank_m, edge, &plan->sheet);
  if (!plan->held) {
    add_box(plan, plan->opening_m, f->frame_gap_m.location, &plan->hole);
  }
  for (int m = 0; m < DEA_FAB_MARKS; m++) {
    dea_region_add_circle(&plan->marks, c[0] + plan->mark_at_m[m][0], c[1] + plan->mark_at_m[m][1],
                          plan->mark_m, false, f->mark_diameter.length.location);
  }
  for (size_t i = 0; i < plan->pad_count; i++) {
    const double x = c[0] + plan->pad[i].at_m[0], y = c[1] + plan->pad[i].at_m[1];
    dea_region_add_circle(&plan->pads, x, y, plan->pad_m, false,
                          f->leads.pad_diameter.length.location);
    if (plan->window_m > 0 && !plan->layout->electrodes[plan->pad[i].electrode].top) {
      dea_region_add_circle(&plan->windows, x, y, plan->window_m, false,
                            f->ring.contact_window_m.location);
    }
  }
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
    DEA_TRY(ctx, dea_region_status(all[i]));
  }
  return DEA_OK;
}

// Leads ------------------------------------------------------------------------------------------

/* Distance along a ray at which it leaves a region for good; 0: it does not meet it. */
static double leaves_at(const struct dea_region *region, const double from[2], double angle_rad)
{
  const double u[2] = {cos(angle_rad), sin(angle_rad)};
  const double length = 10 * (dea_region_size_m(region) + hypot(from[0], from[1]));
  const struct dea_piece ray = {
      .from = {from[0], from[1]},
      .to = {from[0] + length * u[0], from[1] + length * u[1]},
      .length_m = length,
  };
  double last = 0;
  for (size_t i = 0; i < region->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(region, i);
    for (size_t k = 0; k < dea_contour_pieces(&contour); k++) {
      const struct dea_piece piece = dea_contour_piece(&contour, k);
      double at[2][2];
      const int count = dea_piece_crossings(&ray, &piece, 0, at);
      for (int c = 0; c < count; c++) {
        const double t = (at[c][0] - from[0]) * u[0] + (at[c][1] - from[1]) * u[1];
        const bool on = dea_piece_distance_m(&piece, at[c]) < 1e-9 * length;
        last = on ? fmax(last, t) : last;
      }
    }
  }
  return last;
}

/* The lead and the pad of an electrode, which overlap, in the layout's coordinates. */
static void add_lead(const struct dea_fab_plan *plan, const struct dea_fab_pad *pad,
                     struct dea_region *out)
{
  const struct dea_layout_electrode *e = &plan->layout->electrodes[pad->electrode];
  const struct dea_fabrication *f = &plan->design->fabrication;
  const struct dea_region *region = &plan->layout->regions[e->region].region;
  const double c = cos(e->lead_rad), s = sin(e->lead_rad), half = 0.5 * plan->lead_width_m;
  const double end[2] = {plan->centre_m[0] + pad->at_m[0], plan->centre_m[1] + pad->at_m[1]};
  double from[2];
  dea_region_centroid_m(region, from);
  const double start = fmax(0, leaves_at(region, from, e->lead_rad) - 2 * half);
  const double length = hypot(end[0] - from[0], end[1] - from[1]);
  const double corner[4][2] = {{start, -half}, {length, -half}, {length, half}, {start, half}};
  struct dea_vertex v[4];
  for (int k = 0; k < 4; k++) {
    v[k] = (struct dea_vertex){from[0] + c * corner[k][0] - s * corner[k][1],
                               from[1] + s * corner[k][0] + c * corner[k][1], 0,
                               f->leads.width.length.location};
  }
  dea_region_add(out, v, 4);
  dea_region_add_circle(out, end[0], end[1], plan->pad_m, false,
                        f->leads.pad_diameter.length.location);
}

/* Where pads are; of a lead without a frame that stays it is said. */
static dea_status place_pads(struct dea_context *ctx, struct dea_fab_plan *plan)
{
  const struct dea_layout *l = plan->layout;
  plan->pad = dea_arena_alloc(&plan->memory, l->electrode_count, sizeof *plan->pad);
  plan->inked = dea_arena_alloc(&plan->memory, l->electrode_count, sizeof *plan->inked);
  DEA_TRY(ctx, dea_arena_status(&plan->memory));
  for (size_t i = 0; i < l->electrode_count; i++) {
    const struct dea_layout_electrode *e = &l->electrodes[i];
    double from[2];
    if (e->lead && !plan->held) {
      return dea_finding_add(ctx, DEA_ERROR, e->location,
                             "the lead of the electrode '%.60s' ends at a pad on the frame, but no "
                             "frame stays: hold the edge of the film (supports), or draw the lead "
                             "as part of the electrode's shape",
                             e->name);
    }
    if (e->lead) {
      struct dea_fab_pad *pad = &plan->pad[plan->pad_count++];
      pad->electrode = i;
      dea_region_centroid_m(&l->regions[e->region].region, from);
      from[0] -= plan->centre_m[0];
      from[1] -= plan->centre_m[1];
      place_on_frame(plan, plan->opening_m, from, e->lead_rad, pad->at_m);
    }
  }
  return DEA_OK;
}

dea_status dea_fab_unite(struct dea_context *ctx, struct dea_region *parts, struct dea_region *out)
{
  dea_status status = dea_region_status(parts);
  status = status == DEA_OK ? dea_region_combine(ctx, DEA_UNION, parts, NULL, out) : status;
  dea_region_free(parts);
  return status;
}

/* Electrodes with their leads, which are made only of lengths that fit. */
static dea_status ink(struct dea_context *ctx, struct dea_fab_plan *plan)
{
  const struct dea_motion still = dea_motion_translation(0, 0);
  const struct dea_layout *l = plan->layout;
  const struct dea_fab_pad *pad = plan->pad;
  for (size_t i = 0; i < l->electrode_count; i++) {
    const struct dea_region *own = &l->regions[l->electrodes[i].region].region;
    plan->inked[i] = (struct dea_region){.ctx = ctx};
    if (!l->electrodes[i].lead) {
      dea_region_add_moved(&plan->inked[i], own, &still);
      DEA_TRY(ctx, dea_region_status(&plan->inked[i]));
      continue;
    }
    struct dea_region parts = {.ctx = ctx};
    dea_region_add_moved(&parts, own, &still);
    add_lead(plan, pad++, &parts);
    DEA_TRY(ctx, dea_fab_unite(ctx, &parts, &plan->inked[i]));
  }
  return DEA_OK;
}

// Pieces on tabs ---------------------------------------------------------------------------------

/* What joins a piece from the circle `at` on, of half a width there, to the circle `to` or beyond,
 * and begins within it, on its axis. */
static void add_strip(const struct dea_fab_plan *plan, int number, double at, double half,
                      double to, bool round, struct dea_location location, struct dea_region *out)
{
  const struct dea_device *d = plan->device;
  const double angle = d->angle_rad + 2 * DEA_PI * number / d->fibre_count;
  const double c = cos(angle), s = sin(angle);
  const double near = sqrt(at * at - half * half), far = sqrt(to * to - half * half);
  const double corner[5][2] = {{0.5 * (d->fibre_tip_radius_m + plan->piece_outer_m), 0},
                               {near, -half},
                               {far, -half},
                               {far, half},
                               {near, half}};
  struct dea_vertex v[5];
  for (int k = 0; k < 5; k++) {
    v[k] = (struct dea_vertex){d->centre_m[0] + c * corner[k][0] - s * corner[k][1],
                               d->centre_m[1] + s * corner[k][0] + c * corner[k][1],
                               round && k == 2 ? tan(0.5 * asin(half / to)) : 0, location};
  }
  dea_region_add(out, v, 5);
}

void dea_fab_add_pieces(const struct dea_fab_plan *plan, bool tabs, struct dea_region *out)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const struct dea_motion still = dea_motion_translation(0, 0);
  const struct dea_device *d = plan->device;
  const size_t region = plan->layout->plies[plan->on_tabs].region;
  dea_region_add_moved(out, &plan->layout->regions[region].region, &still);
  for (int k = 0; k < d->fibre_count; k++) {
    if (plan->piece_end_m > plan->piece_outer_m) {
      add_strip(plan, k, plan->piece_outer_m, 0.5 * d->fibre_width_m, plan->piece_end_m, true,
                f->holder.anchor_m.location, out);
    }
    if (tabs) {
      add_strip(plan, k, plan->piece_end_m, 0.5 * plan->tab_width_m, 1.1 * plan->holder_m, false,
                f->holder.tab_width_m.location, out);
    }
  }
}

static void fill_tabs(struct dea_fab_plan *plan)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const struct dea_device *d = plan->device;
  plan->on_tabs = 0;
  while (plan->on_tabs < plan->layout->ply_count && !plan->layout->plies[plan->on_tabs].on_tabs) {
    plan->on_tabs++;
  }
  plan->holder_m = plan->opening_m[0];
  if (plan->on_tabs == plan->layout->ply_count) {
    plan->on_tabs = DEA_LAYOUT_NONE;
    return;
  }
  const bool held = d->outer_end != DEA_END_FREE;
  plan->piece_outer_m = d->frame_radius_m - d->fibre_outer_gap_m;
  plan->piece_end_m = held ? d->frame_radius_m + f->holder.anchor_m.si : plan->piece_outer_m;
  plan->holder_m = fmax(plan->piece_end_m, d->frame_radius_m) + f->holder.tab_length_m.si;
  plan->tab_width_m = f->holder.tab_width_m.si;
}

// Checks -----------------------------------------------------------------------------------------

/* What the film is marked with has to be countable. */
static dea_status check_cutter(struct dea_context *ctx, const struct dea_fab_plan *plan)
{
  enum { CROSSES_MAX = 10000 };
  const struct dea_fabrication *f = &plan->design->fabrication;
  if (plan->kerf_m > plan->feature_m) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, f->kerf_m.location,
                                 "kerf: a cut of %.4g mm width makes no features of %.4g mm "
                                 "(minimum_feature)",
                                 1e3 * plan->kerf_m, 1e3 * plan->feature_m));
  }
  const double crosses = 4 * plan->blank_m[0] * plan->blank_m[1] / (plan->grid_m * plan->grid_m);
  if (!(crosses <= CROSSES_MAX)) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, f->grid_spacing.length.location,
                                 "a grid of %.4g mm (stretched) has more than %d crosses on a film "
                                 "of %.4g mm x %.4g mm",
                                 1e3 * plan->grid_m, (int)CROSSES_MAX, 2e3 * plan->blank_m[0],
                                 2e3 * plan->blank_m[1]));
  }
  return DEA_OK;
}

/* Widths of leads, pads and windows. */
static dea_status check_pads(struct dea_context *ctx, const struct dea_fab_plan *plan)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const double w = plan->lead_width_m, ring = f->ring.width_m.si;
  double narrowest = 2 * plan->pad_m;
  for (size_t i = 0; i < plan->pad_count; i++) {
    double box[4];
    const size_t region = plan->layout->electrodes[plan->pad[i].electrode].region;
    dea_region_box_m(&plan->layout->regions[region].region, box);
    narrowest = fmin(narrowest, fmin(box[2] - box[0], box[3] - box[1]));
  }
  if (plan->pad_count > 0 && w >= narrowest) {
    return dea_finding_add(ctx, DEA_ERROR, f->leads.width.length.location,
                           "leads of %.4g mm width are wider than the %s of %.4g mm (stretched)",
                           1e3 * w, narrowest < 2 * plan->pad_m ? "electrode" : "pad",
                           1e3 * narrowest);
  }
  if (plan->pad_count > 0 && 2 * plan->pad_m > ring * (1 + touching)) {
    return dea_finding_add(ctx, DEA_ERROR, f->leads.pad_diameter.length.location,
                           "a pad of %.4g mm diameter (%.4g mm unstretched) does not fit on the "
                           "ring of %.4g mm width (ring.width)",
                           2e3 * plan->pad_m, 2e3 * plan->pad_m / plan->stretch, 1e3 * ring);
  }
  if (plan->pad_count > 0 && plan->window_m > plan->pad_m * (1 + touching)) {
    return dea_finding_add(ctx, DEA_ERROR, f->ring.contact_window_m.location,
                           "a contact window of %.4g mm diameter is larger than the pad of %.4g mm "
                           "(stretched)",
                           2e3 * plan->window_m, 2e3 * plan->pad_m);
  }
  return DEA_OK;
}

/* Area that two regions have in common. */
static dea_status find_common(struct dea_context *ctx, const struct dea_region *a,
                              const struct dea_region *b, double *area_m2)
{
  struct dea_region both = {.ctx = ctx};
  const dea_status status = dea_region_combine(ctx, DEA_INTERSECTION, a, b, &both);
  *area_m2 = status == DEA_OK ? dea_region_area_m2(&both) : NAN;
  dea_region_free(&both);
  return status;
}

/* Leads of two channels touch on no face, and lie on each other across no film. */
static dea_status check_pair(struct dea_context *ctx, const struct dea_fab_plan *plan, size_t i,
                             size_t j)
{
  const struct dea_layout_electrode *a = &plan->layout->electrodes[i];
  const struct dea_layout_electrode *b = &plan->layout->electrodes[j];
  double common;
  if (a->ply != b->ply || a->channel == b->channel || !(a->lead || b->lead)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, find_common(ctx, &plan->inked[i], &plan->inked[j], &common));
  const double designed =
      a->top == b->top ? 0 : dea_layout_overlap_m2(plan->layout, a->region, b->region);
  if (common > designed + 1e-6 * dea_region_area_m2(&plan->inked[i])) {
    return dea_finding_add(
        ctx, DEA_ERROR, plan->design->fabrication.leads.width.length.location, "%s",
        a->top == b->top ? "leads of two channels touch on one face"
                         : "the leads of the two electrodes overlap outside of the electrodes, "
                           "which would make active film that is not in the design");
  }
  return DEA_OK;
}

/* A lead beyond its electrode goes under a ply: that can be built but not simulated. */
static dea_status check_under(struct dea_context *ctx, const struct dea_fab_plan *plan,
                              const struct dea_fab_pad *pad, size_t ply)
{
  const struct dea_layout_electrode *e = &plan->layout->electrodes[pad->electrode];
  const struct dea_region *region = &plan->layout->regions[plan->layout->plies[ply].region].region;
  struct dea_region lead = {.ctx = ctx}, beyond = {.ctx = ctx};
  double common = 0;
  if (!dea_ply_is_cut(&plan->layout->plies[ply]) || (e->top ? ply <= e->ply : ply >= e->ply)) {
    return DEA_OK;
  }
  add_lead(plan, pad, &lead);
  dea_status status = dea_region_status(&lead);
  status = status == DEA_OK ? dea_region_combine(ctx, DEA_DIFFERENCE, &lead,
                                                 &plan->layout->regions[e->region].region, &beyond)
                            : status;
  status = status == DEA_OK ? find_common(ctx, &beyond, region, &common) : status;
  if (status == DEA_OK && common > 1e-9 * dea_region_area_m2(&beyond)) {
    status =
        dea_finding_add(ctx, DEA_WARNING, plan->design->fabrication.leads.width.length.location,
                        "the lead of the %s electrode '%.60s', %.4g mm wide (stretched), runs "
                        "under '%.60s'; what that does to the bond and the motion is not "
                        "simulated",
                        e->top ? "top" : "bottom", e->name, 1e3 * plan->lead_width_m,
                        plan->layout->plies[ply].name);
  }
  dea_region_free(&lead);
  dea_region_free(&beyond);
  return status;
}

/* Marks lie on the frame, and apart from the pads. */
static dea_status check_marks(struct dea_context *ctx, const struct dea_fab_plan *plan)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const bool tabs = plan->on_tabs != DEA_LAYOUT_NONE;
  const double capacity = tabs ? plan->frame_m[0] - plan->holder_m : f->ring.width_m.si;
  if (2 * (plan->mark_m + plan->feature_m) > capacity * (1 + touching)) {
    return dea_finding_add(ctx, DEA_ERROR, f->mark_diameter.length.location,
                           "alignment marks of %.4g mm diameter (stretched) do not fit on the %s, "
                           "%.4g mm wide, with %.4g mm (minimum_feature) around them",
                           2e3 * plan->mark_m, tabs ? "fibres' holder" : "frame", 1e3 * capacity,
                           1e3 * plan->feature_m);
  }
  for (int m = 0; m < DEA_FAB_MARKS; m++) {
    for (size_t i = 0; i < plan->pad_count; i++) {
      // in the unstretched film, where both are cut from one stencil
      if (dea_apart_m(plan->mark_at_m[m], plan->pad[i].at_m) <
          plan->mark_m + plan->pad_m + plan->feature_m * plan->stretch) {
        return dea_finding_add(ctx, DEA_ERROR, f->leads.pad_diameter.length.location,
                               "parts overlap: a pad of %.4g mm diameter (stretched) reaches to an "
                               "alignment mark of %.4g mm",
                               2e3 * plan->pad_m, 2e3 * plan->mark_m);
      }
    }
  }
  return DEA_OK;
}

static dea_status check_tabs(struct dea_context *ctx, const struct dea_fab_plan *plan)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const double width = plan->device->fibre_width_m;
  if (plan->on_tabs == DEA_LAYOUT_NONE) {
    return DEA_OK;
  }
  if (plan->tab_width_m > width * (1 + touching)) {
    return dea_finding_add(ctx, DEA_ERROR, f->holder.tab_width_m.location,
                           "a tab of %.4g mm width is wider than a fibre of %.4g mm",
                           1e3 * plan->tab_width_m, 1e3 * width);
  }
  if (plan->holder_m >= plan->frame_m[0] * (1 - touching)) {
    return dea_finding_add(ctx, DEA_ERROR, f->holder.anchor_m.location,
                           "a fibre is longer than the frame: with its anchor and its tab it "
                           "reaches %.4g mm from the centre, and the ring ends at %.4g mm",
                           1e3 * plan->holder_m, 1e3 * plan->frame_m[0]);
  }
  return DEA_OK;
}

static dea_status check_leads(struct dea_context *ctx, const struct dea_fab_plan *plan)
{
  const struct dea_layout *l = plan->layout;
  for (size_t i = 0; i < l->electrode_count; i++) {
    for (size_t j = 0; j < i; j++) {
      DEA_TRY(ctx, check_pair(ctx, plan, i, j));
    }
  }
  for (size_t i = 0; i < plan->pad_count * l->ply_count; i++) {
    DEA_TRY(ctx, check_under(ctx, plan, &plan->pad[i / l->ply_count], i % l->ply_count));
  }
  for (size_t i = 0; i < l->electrode_count; i++) {
    if (!l->electrodes[i].lead) {
      return dea_finding_add(ctx, DEA_NOTE, l->electrodes[i].location,
                             "the electrode '%.60s' has no lead: give it the direction of one "
                             "(`lead`), or draw it as part of its shape",
                             l->electrodes[i].name);
    }
  }
  return DEA_OK;
}

dea_status dea_fab_plan_build(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_device *device, struct dea_fab_plan *out)
{
  const size_t before = dea_finding_count(ctx, DEA_ERROR);
  *out = (struct dea_fab_plan){.design = design,
                               .device = device,
                               .layout = device->layout,
                               .memory = {.ctx = ctx},
                               .hole = {.ctx = ctx},
                               .frame = {.ctx = ctx},
                               .film = {.ctx = ctx},
                               .sheet = {.ctx = ctx},
                               .marks = {.ctx = ctx},
                               .pads = {.ctx = ctx},
                               .windows = {.ctx = ctx},
                               .bonded = {.ctx = ctx}};
  DEA_TRY(ctx, fill(ctx, out));
  fill_tabs(out);
  DEA_TRY(ctx, place_pads(ctx, out));
  place_marks(out);
  DEA_TRY(ctx, build_edges(ctx, out));
  DEA_TRY(ctx, check_cutter(ctx, out));
  DEA_TRY(ctx, check_pads(ctx, out));
  DEA_TRY(ctx, check_tabs(ctx, out));
  if (dea_finding_count(ctx, DEA_ERROR) > before) { // else leads have no form
    return DEA_OK;
  }
  DEA_TRY(ctx, check_marks(ctx, out));
  DEA_TRY(ctx, ink(ctx, out));
  if (out->on_tabs != DEA_LAYOUT_NONE) {
    struct dea_region parts = {.ctx = ctx};
    dea_fab_add_pieces(out, false, &parts);
    DEA_TRY(ctx, dea_fab_unite(ctx, &parts, &out->bonded));
  }
  return check_leads(ctx, out);
}

void dea_fab_plan_free(struct dea_fab_plan *plan)
{
  for (size_t i = 0; plan->inked != NULL && i < plan->layout->electrode_count; i++) {
    if (plan->inked[i].ctx != NULL) {
      dea_region_free(&plan->inked[i]);
    }
  }
  struct dea_region *const all[] = {&plan->hole,  &plan->frame, &plan->film,    &plan->sheet,
                                    &plan->marks, &plan->pads,  &plan->windows, &plan->bonded};
  for (size_t i = 0; i < sizeof all / sizeof all[0] && plan->hole.ctx != NULL; i++) {
    dea_region_free(all[i]);
  }
  dea_arena_free(&plan->memory);
}

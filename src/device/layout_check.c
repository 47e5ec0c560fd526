#include "device/layout_check.h"

#include "base/rounded.h"
#include "geometry/boolean.h"

#include <math.h>

/* Parts of an area that rounding may leave. */
static const double rounding = 1e-6;
enum { SAMPLES = 16 }; // of a piece of a contour

static const struct dea_region *region_of(const struct dea_layout *l, size_t number)
{
  return &l->regions[number].region;
}

/* What two regions have in common; false where it cannot be told. out: to be freed. */
static bool common_of(const struct dea_region *a, const struct dea_region *b,
                      struct dea_region *out)
{
  struct dea_context *ctx = a->ctx;
  double one[4], two[4];
  *out = (struct dea_region){.ctx = ctx};
  dea_region_box_m(a, one);
  dea_region_box_m(b, two);
  if (one[0] >= two[2] || two[0] >= one[2] || one[1] >= two[3] || two[1] >= one[3]) {
    return true;
  }
  size_t errors = dea_finding_trial_begin(ctx);
  dea_status status = dea_region_combine(ctx, DEA_INTERSECTION, a, b, out);
  dea_finding_trial_end(ctx, errors);
  if (status != DEA_OK && status != DEA_E_MEMORY) {
    dea_context_clear(ctx);
  }
  return status == DEA_OK;
}

double dea_layout_overlap_m2(const struct dea_layout *l, size_t a, size_t b)
{
  struct dea_region common;
  if (a == b) {
    return dea_region_area_m2(region_of(l, a));
  }
  bool known = common_of(region_of(l, a), region_of(l, b), &common);
  double area = known ? dea_region_area_m2(&common) : NAN;
  dea_region_free(&common);
  return area;
}

double dea_layout_active_area_m2(const struct dea_layout *l, size_t ply)
{
  const struct dea_layout_electrode *pair[2];
  double area = 0;
  for (size_t at = 0; dea_layout_next_pair(l, ply, &at, pair);) {
    const double common = dea_layout_overlap_m2(l, pair[0]->region, pair[1]->region);
    area += !isnan(common) ? common
                           : fmin(dea_region_area_m2(region_of(l, pair[0]->region)),
                                  dea_region_area_m2(region_of(l, pair[1]->region)));
  }
  return area;
}

bool dea_layout_holds(const struct dea_layout *l, size_t region, const double x_m[2])
{
  const struct dea_region *r = region_of(l, region);
  return dea_region_inside(r, x_m[0], x_m[1]) ||
         dea_region_distance_m(r, x_m) <= 10 * DEA_GEOMETRY_SNAP * dea_region_size_m(r);
}

/* Whether some ply holds a point. */
static bool on_device(const struct dea_layout *l, const double x_m[2])
{
  for (size_t i = 0; i < l->ply_count; i++) {
    if (dea_layout_holds(l, l->plies[i].region, x_m)) {
      return true;
    }
  }
  return false;
}

/* Whether some sample of a region's boundary is what `is` looks for; its self: as given. */
static bool any_sample(const struct dea_region *r, bool (*is)(void *self, const double at[2]),
                       void *self)
{
  for (size_t c = 0; c < r->contour_count; c++) {
    const struct dea_contour contour = dea_region_contour(r, c);
    for (size_t i = 0; i < SAMPLES * dea_contour_pieces(&contour); i++) {
      const struct dea_piece piece = dea_contour_piece(&contour, i / SAMPLES);
      double at[2];
      dea_piece_point(&piece, (double)(i % SAMPLES) / SAMPLES, at);
      if (is(self, at)) {
        return true;
      }
    }
  }
  return false;
}

/* Where an edge is looked for: within a region, unless that is none, and on a part of the device,
 * NULL: on any ply. */
struct edge_place {
  const struct dea_layout *layout;
  size_t within;
  const struct dea_region *part;
  double near_m; // of the part
};

static bool is_at_place(void *self, const double at[2])
{
  const struct edge_place *e = self;
  if (e->within != DEA_LAYOUT_NONE && !dea_layout_holds(e->layout, e->within, at)) {
    return false;
  }
  return e->part != NULL ? dea_region_inside(e->part, at[0], at[1]) ||
                               dea_region_distance_m(e->part, at) <= e->near_m
                         : on_device(e->layout, at);
}

/* Whether some of a support's edge lies on a part of the device, NULL: on any ply. */
static bool edge_is_there(const struct dea_layout *l, const struct dea_layout_support *support,
                          const struct dea_region *part)
{
  const struct dea_region *r = region_of(l, support->region);
  struct edge_place place = {l, support->within, part,
                             10 * DEA_GEOMETRY_SNAP * dea_region_size_m(r)};
  return any_sample(r, is_at_place, &place);
}

struct held_by {
  const struct dea_layout *layout;
  size_t region;
};

static bool is_held(void *self, const double at[2])
{
  const struct held_by *h = self;
  return dea_layout_holds(h->layout, h->region, at);
}

/* Whether two regions have an area or a part of a boundary in common. */
static bool touch(const struct dea_layout *l, size_t a, size_t b)
{
  struct held_by by_a = {l, a}, by_b = {l, b};
  double area = dea_layout_overlap_m2(l, a, b);
  return isnan(area) || area > 0 || any_sample(region_of(l, a), is_held, &by_b) ||
         any_sample(region_of(l, b), is_held, &by_a);
}

static bool on_some_ply(const struct dea_layout *l, size_t region)
{
  for (size_t i = 0; i < l->ply_count; i++) {
    if (touch(l, region, l->plies[i].region)) {
      return true;
    }
  }
  return false;
}

/* Width [m] of a gap in dry air of 1 bar that breaks down at a voltage: of V = 24.36 d + 6.72
 * sqrt(d), kV and cm (E. Kuffel, W. S. Zaengl, J. Kuffel, High Voltage Engineering, 2nd ed.,
 * section 5.5). Along a surface, with dust or moisture, it breaks down earlier. */
static double air_gap_m(double voltage_V)
{
  const double linear = 24.36, by_root = 6.72, kV = 1e-3 * voltage_V;
  const double root = (sqrt(by_root * by_root + 4 * linear * kV) - by_root) / (2 * linear);
  return 1e-2 * root * root;
}

// Electrodes -------------------------------------------------------------------------------------

/* Number of the face that an electrode lies on, counted from below: a top is the next one's bottom.
 */
static size_t interface_of(const struct dea_layout_electrode *e)
{
  return e->ply + (e->top ? 1 : 0);
}

static dea_status check_electrode(struct dea_context *ctx, const struct dea_layout *l,
                                  const struct dea_layout_electrode *e)
{
  const struct dea_layout_ply *ply = &l->plies[e->ply];
  double area = dea_region_area_m2(region_of(l, e->region));
  double on = dea_layout_overlap_m2(l, e->region, ply->region);
  if (area - on > rounding * area) {
    return dea_finding_add(ctx, DEA_ERROR, e->location,
                           on > 0 ? "the electrode '%s' reaches beyond its ply '%s': %.4g mm2 of "
                                    "its %.4g mm2 lie outside"
                                  : "the electrode '%s' does not lie on its ply '%s' at all: %.4g "
                                    "mm2 of its %.4g mm2 lie outside",
                           e->name, ply->name, 1e6 * (area - on), 1e6 * area);
  }
  return DEA_OK;
}

/* Boundaries of two regions, for the smallest distance of the samples of one from the other. */
struct nearest {
  const struct dea_region *to;
  double distance_m, at_m[2];
};

static bool is_nearest(void *self, const double at[2])
{
  struct nearest *n = self;
  const double distance_m = dea_region_distance_m(n->to, at);
  if (distance_m < n->distance_m) {
    n->distance_m = distance_m;
    n->at_m[0] = at[0];
    n->at_m[1] = at[1];
  }
  return false;
}

/* Largest voltage between two channels while the voltage of the sweep goes up to `highest_V`. */
static double voltage_between(const struct dea_layout_channel *a,
                              const struct dea_layout_channel *b, double highest_V)
{
  const double own_V = a->own_V - b->own_V;
  return fmax(fabs(own_V), fabs(own_V + (a->ratio - b->ratio) * highest_V));
}

/* Electrodes beside each other: they may not touch, and air between them may not break down. */
static dea_status check_gap(struct dea_context *ctx, const struct dea_layout *l,
                            const struct dea_layout_electrode *a,
                            const struct dea_layout_electrode *b, double highest_V)
{
  const struct dea_layout_channel *first = &l->channels[a->channel];
  const struct dea_layout_channel *second = &l->channels[b->channel];
  const double voltage_V = voltage_between(first, second, highest_V);
  struct nearest n = {.to = region_of(l, b->region), .distance_m = INFINITY};
  any_sample(region_of(l, a->region), is_nearest, &n);
  n.to = region_of(l, a->region);
  any_sample(region_of(l, b->region), is_nearest, &n);
  const double x_mm = dea_rounded(1e3 * n.at_m[0]), y_mm = dea_rounded(1e3 * n.at_m[1]);
  if (n.distance_m <= 10 * DEA_GEOMETRY_SNAP * dea_region_size_m(n.to)) {
    return dea_finding_add(ctx, DEA_ERROR, b->location,
                           "electrodes of the channels '%s' and '%s' touch on one face of '%s', "
                           "about (%.4g, %.4g) mm: leave a gap (the other one is in line %zu)",
                           first->name, second->name, l->plies[b->ply].name, x_mm, y_mm,
                           a->location.line);
  }
  return !(air_gap_m(voltage_V) > n.distance_m)
             ? DEA_OK
             : dea_finding_add(
                   ctx, DEA_WARNING, b->location,
                   "electrodes of the channels '%s' and '%s' on one face of '%s' are %.3g mm apart "
                   "about (%.4g, %.4g) mm, with up to %.4g kV between them, at which even dry air "
                   "breaks down below %.3g mm, and along a surface earlier: widen the gap",
                   first->name, second->name, l->plies[b->ply].name, 1e3 * n.distance_m, x_mm, y_mm,
                   1e-3 * voltage_V, 1e3 * air_gap_m(voltage_V));
}

static dea_status check_pair(struct dea_context *ctx, const struct dea_layout *l,
                             const struct dea_layout_electrode *a,
                             const struct dea_layout_electrode *b, double highest_V)
{
  struct dea_region common;
  dea_status status = DEA_OK;
  if (a->channel == b->channel || interface_of(a) != interface_of(b)) {
    return DEA_OK;
  }
  double least = fmin(dea_region_area_m2(region_of(l, a->region)),
                      dea_region_area_m2(region_of(l, b->region)));
  if (common_of(region_of(l, a->region), region_of(l, b->region), &common) &&
      dea_region_area_m2(&common) > rounding * least) {
    double at[2];
    dea_region_centroid_m(&common, at);
    status = dea_finding_add(
        ctx, DEA_ERROR, b->location,
        "electrodes of the channels '%s' and '%s' lie on each other on one face of '%s', about "
        "(%.4g, %.4g) mm: %.4g mm2 (the other one is in line %zu)",
        l->channels[a->channel].name, l->channels[b->channel].name, l->plies[b->ply].name,
        dea_rounded(1e3 * at[0]), dea_rounded(1e3 * at[1]), 1e6 * dea_region_area_m2(&common),
        a->location.line);
  } else {
    status = check_gap(ctx, l, a, b, highest_V);
  }
  dea_region_free(&common);
  return status;
}

static dea_status check_electrodes(struct dea_context *ctx, const struct dea_layout *l,
                                   double highest_V)
{
  for (size_t i = 0; i < l->electrode_count; i++) {
    DEA_TRY(ctx, check_electrode(ctx, l, &l->electrodes[i]));
    for (size_t j = 0; j < i; j++) {
      DEA_TRY(ctx, check_pair(ctx, l, &l->electrodes[j], &l->electrodes[i], highest_V));
    }
  }
  return DEA_OK;
}

// All else ---------------------------------------------------------------------------------------

/* Every ply lies on or beside others up to the lowest one. */
static dea_status check_plies(struct dea_context *ctx, const struct dea_layout *l)
{
  bool *reached = dea_alloc(ctx, l->ply_count, sizeof *reached);
  dea_status status = reached != NULL ? DEA_OK : DEA_E_MEMORY;
  if (status == DEA_OK) {
    reached[0] = true;
  }
  for (bool more = status == DEA_OK; more;) {
    more = false;
    for (size_t k = 0; k < l->ply_count * l->ply_count; k++) {
      size_t from = k / l->ply_count, to = k % l->ply_count;
      if (reached[from] && !reached[to] && touch(l, l->plies[from].region, l->plies[to].region)) {
        more = reached[to] = true;
      }
    }
  }
  for (size_t i = 0; i < l->ply_count && status == DEA_OK; i++) {
    if (!reached[i]) {
      status = dea_finding_add(ctx, DEA_ERROR, l->plies[i].location,
                               "the ply '%s' lies nowhere on the device: not on '%s', nor on what "
                               "lies there",
                               l->plies[i].name, l->plies[0].name);
    }
  }
  dea_free(ctx, reached);
  return status;
}

static dea_status check_supports(struct dea_context *ctx, const struct dea_layout *l)
{
  for (size_t i = 0; i < l->support_count; i++) {
    const struct dea_layout_support *s = &l->supports[i];
    bool there = s->edge ? edge_is_there(l, s, NULL)
                         : on_some_ply(l, s->region) &&
                               (s->within == DEA_LAYOUT_NONE || touch(l, s->region, s->within));
    if (!there) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, s->location,
                                   "the support by '%s'%s%s%s holds nothing: no ply lies there",
                                   l->regions[s->region].name,
                                   s->within != DEA_LAYOUT_NONE ? " within '" : "",
                                   s->within != DEA_LAYOUT_NONE ? l->regions[s->within].name : "",
                                   s->within != DEA_LAYOUT_NONE ? "'" : ""));
    }
  }
  return DEA_OK;
}

/* All plies as one region; empty where that cannot be told. */
static dea_status unite_plies(struct dea_context *ctx, const struct dea_layout *l,
                              struct dea_region *out)
{
  struct dea_region copies = {.ctx = ctx};
  const struct dea_motion none = dea_motion_translation(0, 0);
  for (size_t i = 0; i < l->ply_count; i++) {
    bool again = false;
    for (size_t k = 0; k < i; k++) {
      again = again || l->plies[k].region == l->plies[i].region;
    }
    if (!again) {
      dea_region_add_moved(&copies, region_of(l, l->plies[i].region), &none);
    }
  }
  dea_status status = dea_region_status(&copies);
  if (status == DEA_OK) {
    size_t errors = dea_finding_trial_begin(ctx);
    status = dea_region_combine(ctx, DEA_UNION, &copies, NULL, out);
    dea_finding_trial_end(ctx, errors);
    if (status != DEA_OK && status != DEA_E_MEMORY) {
      dea_context_clear(ctx);
      status = DEA_OK;
    }
  }
  dea_region_free(&copies);
  return status;
}

/* Whether a region and a part of the device have an area in common, or it cannot be told. */
static bool region_meets(const struct dea_layout *l, size_t region, const struct dea_region *part)
{
  struct dea_region common;
  bool meets = !common_of(region_of(l, region), part, &common) || common.contour_count > 0;
  dea_region_free(&common);
  return meets;
}

/* Whether a part of the device has a support, or a body: that body may be tied to another part, or
 * have a spring. Whether they hold every motion of it, the model says. */
static bool part_is_held(const struct dea_layout *l, const struct dea_region *part)
{
  bool held = false;
  for (size_t i = 0; i < l->support_count && !held; i++) {
    const struct dea_layout_support *s = &l->supports[i];
    held = s->components != 0 &&
           (s->edge ? edge_is_there(l, s, part) : region_meets(l, s->region, part));
  }
  for (size_t i = 0; i < l->body_count && !held; i++) {
    held = region_meets(l, l->bodies[i].region, part);
  }
  return held;
}

/* Directions, as bits 1, 2, 4, in which something is held: by a support, a body that may not go
 * there, or a spring. */
static int held_directions(const struct dea_layout *l)
{
  int held = 0;
  for (size_t i = 0; i < l->support_count; i++) {
    held |= l->supports[i].components;
  }
  for (size_t i = 0; i < l->body_count; i++) {
    held |= ~l->bodies[i].free;
  }
  for (size_t i = 0; i < l->spring_count; i++) {
    held |= 1 << l->springs[i].component;
  }
  return held & 7;
}

/* What may go away as a whole can still be made. */
static dea_status check_directions(struct dea_context *ctx, const struct dea_layout *l)
{
  static const char *const axes[] = {"x", "y", "z"};
  int held = held_directions(l);
  if (held == 0) {
    return dea_finding_add(ctx, DEA_WARNING, l->plies[0].location,
                           "nothing holds the device: it has neither a support nor a body that "
                           "may not do everything");
  }
  for (int i = 0; i < 3; i++) {
    if ((held & 1 << i) == 0) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, l->plies[0].location,
                                   "nothing holds the device along %s: it has no support, no body "
                                   "that may not go there and no spring",
                                   axes[i]));
    }
  }
  return DEA_OK;
}

/* Each part of the device that hangs together is held somewhere; of a device without errors that
 * something holds. */
static dea_status check_held(struct dea_context *ctx, const struct dea_layout *l)
{
  struct dea_region all = {.ctx = ctx};
  dea_status status = DEA_OK;
  if (held_directions(l) != 0 && dea_finding_count(ctx, DEA_ERROR) == 0) {
    status = unite_plies(ctx, l, &all);
  }
  for (size_t c = 0; c < all.contour_count && status == DEA_OK; c++) {
    const struct dea_contour outline = dea_region_contour(&all, c);
    struct dea_region part = {.ctx = ctx};
    dea_region_add(&part, outline.vertex, outline.count);
    status = dea_region_status(&part);
    if (status == DEA_OK && dea_contour_area_m2(&outline) > 0 && !part_is_held(l, &part)) {
      status = dea_finding_add(ctx, DEA_ERROR, l->plies[0].location,
                               "nothing holds the part of the device at (%.4g, %.4g) mm: it has "
                               "neither a support nor a body",
                               dea_rounded(1e3 * outline.vertex[0].x_m),
                               dea_rounded(1e3 * outline.vertex[0].y_m));
      c = all.contour_count - 1; // one is enough
    }
    dea_region_free(&part);
  }
  dea_region_free(&all);
  return status;
}

static dea_status check_bodies(struct dea_context *ctx, const struct dea_layout *l)
{
  for (size_t i = 0; i < l->body_count; i++) {
    const struct dea_layout_body *b = &l->bodies[i];
    if (!on_some_ply(l, b->region)) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, b->location,
                                   "nothing holds the body '%s': no ply lies in its shape '%s'",
                                   b->name, l->regions[b->region].name));
    }
    for (size_t j = 0; j < i; j++) {
      if (dea_layout_overlap_m2(l, b->region, l->bodies[j].region) > 0) {
        DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, b->location,
                                     "the bodies '%s' and '%s' lie on each other: what moves as "
                                     "one is one body",
                                     b->name, l->bodies[j].name));
      }
    }
  }
  return DEA_OK;
}

static dea_status check_pressures(struct dea_context *ctx, const struct dea_layout *l)
{
  for (size_t i = 0; i < l->pressure_count; i++) {
    const struct dea_layout_pressure *p = &l->pressures[i];
    const struct dea_layout_ply *ply = &l->plies[p->ply];
    if (dea_layout_overlap_m2(l, p->region, ply->region) <= 0) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, p->location,
                                   "the pressure in '%s' does not lie on its ply '%s'",
                                   l->regions[p->region].name, ply->name));
    }
  }
  return DEA_OK;
}

/* On the ply, and beyond a gap of the other one where it touches that. */
static dea_status check_contacts(struct dea_context *ctx, const struct dea_layout *l)
{
  for (size_t i = 0; i < l->contact_count; i++) {
    const struct dea_layout_contact *c = &l->contacts[i];
    const char *region = l->regions[c->region].name;
    if (dea_layout_overlap_m2(l, c->region, l->plies[c->ply].region) <= 0) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, c->location,
                                   "the contact in '%s' does not lie on its ply '%s'", region,
                                   l->plies[c->ply].name));
      continue;
    }
    if (c->with == DEA_LAYOUT_NONE) {
      continue;
    }
    bool open = c->top ? c->with > c->ply : c->with < c->ply;
    const size_t low = c->with < c->ply ? c->with : c->ply, high = c->with + c->ply - low;
    bool apart = false;
    for (size_t p = low + 1; p < high; p++) {
      open = open && !(dea_layout_overlap_m2(l, c->region, l->plies[p].region) > 0);
      apart = true;
    }
    if (!open || !apart || dea_layout_overlap_m2(l, c->region, l->plies[c->with].region) <= 0) {
      DEA_TRY(ctx, dea_finding_add(
                       ctx, DEA_ERROR, c->location,
                       "in '%s' the %s of ply '%s' has no gap to ply '%s': one as thick as a ply "
                       "between them that is open there",
                       region, c->top ? "top" : "bottom", l->plies[c->ply].name,
                       l->plies[c->with].name));
    }
  }
  return DEA_OK;
}

static dea_status check_monitors(struct dea_context *ctx, const struct dea_layout *l)
{
  for (size_t i = 0; i < l->monitor_count; i++) {
    const struct dea_layout_monitor *m = &l->monitors[i];
    if (m->kind >= DEA_MONITOR_BODY) {
      continue;
    }
    const struct dea_layout_ply *ply = &l->plies[m->ply];
    bool there = true;
    for (int k = 0; k < (m->kind == DEA_MONITOR_LINE ? 2 : 1); k++) {
      there &= m->kind == DEA_MONITOR_REGION || dea_layout_holds(l, ply->region, m->at_m[k]);
    }
    if (m->kind == DEA_MONITOR_REGION) {
      there = !(dea_layout_overlap_m2(l, m->region, ply->region) <= 0);
    }
    if (!there) {
      DEA_TRY(ctx,
              dea_finding_add(ctx, DEA_ERROR, m->location,
                              "the monitor '%s' does not lie on the ply '%s'", m->name, ply->name));
    }
  }
  return DEA_OK;
}

dea_status dea_layout_check(struct dea_context *ctx, const struct dea_layout *layout,
                            double highest_V)
{
  typedef dea_status (*check_fn)(struct dea_context *, const struct dea_layout *);
  static const check_fn checks[] = {check_plies, check_supports,  check_bodies,   check_directions,
                                    check_held,  check_pressures, check_contacts, check_monitors};
  DEA_TRY(ctx, check_electrodes(ctx, layout, highest_V));
  for (size_t i = 0; i < sizeof checks / sizeof checks[0]; i++) {
    DEA_TRY(ctx, checks[i](ctx, layout));
  }
  // what regions have in common was not told for want of memory
  return dea_context_status(ctx) == DEA_E_MEMORY ? DEA_E_MEMORY : DEA_OK;
}

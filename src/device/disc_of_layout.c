/* The numbers of a disc in a round frame, of a layout that is one. */
#include "base/text.h"
#include "device/device.h"
#include "device/disc_layout.h"
#include "device/identity.h"

#include <math.h>
#include <string.h>

/* Fails where something is not as in a disc: "ply 'hub'", "is no part of one". */
static dea_status require(struct dea_context *ctx, bool good, const char *what, const char *name,
                          const char *how)
{
  return good ? DEA_OK
              : dea_fail(ctx, DEA_E_DESIGN,
                         "this needs a disc in a round frame, and %s '%.60s' %s; the model 3d "
                         "takes any device",
                         what, name, how);
}

/* A length of a contour without what is left of rounding: to a femtometre. */
static double tidy(double length_m)
{
  return round(1e15 * length_m) / 1e15;
}

struct circle {
  double centre[2], radius_m; // 0: there is none
};

static struct circle circle_of(const struct dea_layout *l, size_t region)
{
  const struct dea_region *r = &l->regions[region].region;
  struct circle out = {.radius_m = 0};
  if (r->contour_count != 1) {
    return out;
  }
  const struct dea_contour contour = dea_region_contour(r, 0);
  const double near = DEA_GEOMETRY_SNAP * dea_region_size_m(r);
  for (size_t i = 0; i < dea_contour_pieces(&contour); i++) {
    const struct dea_piece piece = dea_contour_piece(&contour, i);
    const double *c = i == 0 ? piece.centre : out.centre;
    if (!piece.arc || hypot(piece.centre[0] - c[0], piece.centre[1] - c[1]) > near ||
        (i > 0 && fabs(piece.radius_m - out.radius_m) > near)) {
      return (struct circle){.radius_m = 0};
    }
    out = i == 0 ? (struct circle){{tidy(c[0]), tidy(c[1])}, tidy(piece.radius_m)} : out;
  }
  return out;
}

static bool is_same(const struct circle *a, const struct circle *b)
{
  const double near = DEA_GEOMETRY_SNAP * a->radius_m;
  return fabs(a->radius_m - b->radius_m) <= near &&
         hypot(a->centre[0] - b->centre[0], a->centre[1] - b->centre[1]) <= near;
}

/* The ply between the two electrodes, and their circle. */
static dea_status find_electrodes(struct dea_context *ctx, const struct dea_layout *l, size_t *film,
                                  struct circle *out)
{
  const struct dea_layout_electrode *e = l->electrodes;
  const struct dea_layout_channel *drive = &l->channels[1];
  DEA_TRY(ctx, require(ctx, l->electrode_count > 0, "ply", l->plies[0].name, "has no electrodes"));
  DEA_TRY(ctx, require(ctx, l->electrode_count > 1, "electrode", e[0].name, "has no other one"));
  DEA_TRY(ctx,
          require(ctx, l->channel_count > 1, "channel", l->channels[0].name, "is the only one"));
  DEA_TRY(ctx,
          require(ctx, l->channel_count == 2, "channel", l->channels[l->channel_count - 1].name,
                  "is one more than ground and a driven one"));
  DEA_TRY(ctx, require(ctx, drive->ratio == 1 && drive->own_V == 0 && drive->waveform == NULL,
                       "channel", drive->name, "has a voltage of its own"));
  DEA_TRY(ctx, require(ctx, l->electrode_count == 2, "electrode", e[l->electrode_count - 1].name,
                       "is one more than two"));
  DEA_TRY(ctx,
          require(ctx, e[0].ply == e[1].ply && e[0].top != e[1].top && e[0].channel != e[1].channel,
                  "electrode", e[1].name, "is not across the film from the other one"));
  *film = e[0].ply;
  *out = circle_of(l, e[0].region);
  DEA_TRY(ctx, require(ctx, out->radius_m > 0, "electrode", e[0].name, "is not round"));
  const struct circle other = circle_of(l, e[1].region);
  return DEA_CHAIN(
      ctx, require(ctx, is_same(out, &other), "electrode", e[1].name, "is not as the other one"));
}

static dea_status read_film(struct dea_context *ctx, const struct dea_layout *l, size_t film,
                            const struct circle *electrode, struct dea_device *out)
{
  const struct dea_layout_ply *ply = &l->plies[film];
  const struct circle frame = circle_of(l, ply->region);
  const double off =
      hypot(frame.centre[0] - electrode->centre[0], frame.centre[1] - electrode->centre[1]);
  const bool centred = off <= DEA_GEOMETRY_SNAP * frame.radius_m;
  DEA_TRY(ctx, require(ctx, frame.radius_m > 0, "ply", ply->name, "is not round"));
  DEA_TRY(ctx, require(ctx, centred, "electrode", l->electrodes[0].name,
                       "is not in the middle of the film"));
  DEA_TRY(ctx,
          require(ctx, electrode->radius_m < frame.radius_m * (1 - DEA_GEOMETRY_SNAP), "electrode",
                  l->electrodes[0].name, "does not end before the edge of the film"));
  DEA_TRY(ctx, require(ctx, dea_ply_layers(ply) == 1, "ply", ply->name, "has several layers"));
  DEA_TRY(ctx, require(ctx, ply->pre_stretch[0] == ply->pre_stretch[1], "ply", ply->name,
                       "has two pre-stretches"));
  DEA_TRY(ctx, require(ctx, ply->material.law == NULL || !ply->material.law->anisotropic, "ply",
                       ply->name, "has a direction of its own"));
  for (size_t i = 0; i < l->support_count; i++) {
    const struct dea_layout_support *s = &l->supports[i];
    const struct circle held = circle_of(l, s->region);
    const double *move = s->move_m;
    DEA_TRY(ctx, require(ctx,
                         dea_support_is_frame(s) && !s->hinged && s->plies == 0 &&
                             is_same(&frame, &held) && move[0] == 0 && move[1] == 0 && move[2] == 0,
                         "the support of", l->regions[s->region].name,
                         "does not clamp the edge of the film"));
  }
  DEA_TRY(ctx, require(ctx, l->support_count > 0, "ply", ply->name, "has no clamped edge"));
  out->centre_m[0] = frame.centre[0];
  out->centre_m[1] = frame.centre[1];
  out->film = ply->material;
  out->film_thickness_m = ply->thickness_m;
  out->film_thickness_unstretched_m = ply->thickness_unstretched_m;
  out->pre_stretch = ply->pre_stretch[0];
  out->frame_radius_m = frame.radius_m;
  out->electrode_radius_m = electrode->radius_m;
  for (size_t i = 0; i < 2; i++) {
    out->sheet_resistance_ohm[l->electrodes[i].top ? 1 : 0] = l->electrodes[i].sheet_resistance_ohm;
  }
  out->coverage = electrode->radius_m / frame.radius_m;
  return DEA_OK;
}

/* Whether two materials have the same numbers, into *same. */
static dea_status compare(struct dea_context *ctx, const struct dea_material *a,
                          const struct dea_material *b, bool *same)
{
  struct dea_text text[2] = {{.ctx = ctx}, {.ctx = ctx}};
  dea_material_identity(a, &text[0]);
  dea_material_identity(b, &text[1]);
  const dea_status status = text[0].failed || text[1].failed ? DEA_E_MEMORY : DEA_OK;
  *same = status == DEA_OK && strcmp(dea_text_get(&text[0]), dea_text_get(&text[1])) == 0;
  dea_text_free(&text[0]);
  dea_text_free(&text[1]);
  return status;
}

/* Electrodes with stiffness: a ply like them below the film, and the same one above. *next: the
 * first ply above these and the film. */
static dea_status read_stiffness(struct dea_context *ctx, const struct dea_layout *l, size_t film,
                                 const struct circle *electrode, size_t *next,
                                 struct dea_device *out)
{
  const bool stiff = film == 1;
  *next = stiff ? 3 : 1;
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_layout_ply *ply = &l->plies[i];
    const struct circle own = circle_of(l, ply->region);
    const bool like = own.radius_m > 0 && is_same(electrode, &own);
    DEA_TRY(ctx, require(ctx, i == film || i >= *next || like, "ply", ply->name,
                         "is neither the film nor of its electrodes' shape"));
    DEA_TRY(ctx, require(ctx, i < *next ? i == film || stiff : !like, "ply", ply->name,
                         "is not one of two electrodes, below and above the film"));
    DEA_TRY(ctx, require(ctx,
                         i == film || !like ||
                             (ply->pre_stretch[0] == out->pre_stretch &&
                              ply->pre_stretch[1] == out->pre_stretch),
                         "ply", ply->name, "is not stretched with the film"));
  }
  DEA_TRY(ctx, require(ctx, film <= 1 && l->ply_count >= *next, "ply", l->plies[0].name,
                       "is not one of two electrodes, below and above the film"));
  if (!stiff) {
    return DEA_OK;
  }
  const struct dea_layout_ply *below = &l->plies[0], *above = &l->plies[2];
  bool same;
  DEA_TRY(ctx, compare(ctx, &below->material, &above->material, &same));
  DEA_TRY(ctx, require(ctx, same && below->thickness_m == above->thickness_m, "ply", above->name,
                       "is not as that below the film"));
  out->electrode = below->material;
  out->electrode_thickness_m = below->thickness_unstretched_m;
  return DEA_OK;
}

// Fibres -----------------------------------------------------------------------------------------

/* Lengths of fibres that differ by less than this part of the frame's radius are equal: drawings
 * have so many digits. */
static const double alike = 1e-6;

/* The numbers of a fibre, which ends outside at its only arc, and its direction. */
static bool measure_fibre(const struct dea_contour *fibre, struct dea_device *out)
{
  enum { PIECES = 4 };
  struct dea_piece outer = {.arc = false}, tip = {.arc = false};
  for (size_t i = 0; i < PIECES && fibre->count == PIECES; i++) {
    const struct dea_piece piece = dea_contour_piece(fibre, i);
    if (piece.arc) {
      outer = piece;
      tip = dea_contour_piece(fibre, (i + PIECES / 2) % PIECES);
    }
  }
  if (!outer.arc) {
    return false;
  }
  const double at[2] = {0.5 * (tip.from[0] + tip.to[0]) - out->centre_m[0],
                        0.5 * (tip.from[1] + tip.to[1]) - out->centre_m[1]};
  const double near = alike * out->frame_radius_m, gap_m = out->frame_radius_m - outer.radius_m;
  out->fibre_width_m = tidy(hypot(outer.to[0] - outer.from[0], outer.to[1] - outer.from[1]));
  out->fibre_tip_width_m = tidy(hypot(tip.to[0] - tip.from[0], tip.to[1] - tip.from[1]));
  out->fibre_tip_radius_m = tidy(hypot(at[0], at[1]));
  out->fibre_length_m = out->frame_radius_m - out->fibre_tip_radius_m;
  out->fibre_overlap_m = out->electrode_radius_m - out->fibre_tip_radius_m;
  out->outer_end = gap_m > near ? DEA_END_FREE : DEA_END_CLAMPED;
  out->fibre_outer_gap_m = gap_m > near ? tidy(gap_m) : 0;
  out->angle_rad = atan2(at[1], at[0]);
  return true;
}

/* Whether a contour about the disc's centre is that one about the origin. */
static bool is_moved(const struct dea_contour *a, const struct dea_contour *b,
                     const struct dea_device *disc)
{
  const double near = alike * disc->frame_radius_m;
  bool same = false;
  for (size_t first = 0; first < b->count && a->count == b->count && !same; first++) {
    same = true;
    for (size_t i = 0; i < a->count && same; i++) {
      const struct dea_vertex *v = &a->vertex[i], *w = &b->vertex[(first + i) % b->count];
      const double x = v->x_m - disc->centre_m[0], y = v->y_m - disc->centre_m[1];
      same = hypot(x - w->x_m, y - w->y_m) <= near && fabs(v->bulge - w->bulge) <= alike;
    }
  }
  return same;
}

/* Whether each contour of a region is one of the other's. */
static bool is_like(const struct dea_region *a, const struct dea_region *b,
                    const struct dea_device *disc)
{
  bool same = a->contour_count == b->contour_count;
  for (size_t i = 0; i < a->contour_count && same; i++) {
    const struct dea_contour own = dea_region_contour(a, i);
    same = false;
    for (size_t k = 0; k < b->contour_count && !same; k++) {
      const struct dea_contour other = dea_region_contour(b, k);
      same = is_moved(&own, &other, disc);
    }
  }
  return same;
}

/* Whether a material is that of a glue or fibre of a disc, which are linear. */
static bool is_linear(const struct dea_material *m)
{
  return m->law == NULL && m->branch_count == 0 && m->young_modulus_Pa > 0;
}

/* Plies from `first` on against those that a disc with these fibres has. */
static dea_status compare_fibres(struct dea_context *ctx, const struct dea_layout *l, size_t first,
                                 const struct dea_layout *wanted, const struct dea_device *disc)
{
  const char *name = l->plies[l->ply_count - 1].name;
  DEA_TRY(ctx, require(ctx, l->ply_count == wanted->ply_count, "under ply", name,
                       "the plies are not those of fibres on a film"));
  for (size_t i = first; i < l->ply_count; i++) {
    const struct dea_layout_ply *a = &l->plies[i], *b = &wanted->plies[i];
    const bool glue = b->kind == DEA_PLY_GLUE;
    DEA_TRY(ctx, require(ctx,
                         is_like(&l->regions[a->region].region, &wanted->regions[b->region].region,
                                 disc),
                         "ply", a->name, "has not the shape that it has below radial fibres"));
    DEA_TRY(ctx, require(ctx, fabs(a->thickness_m - b->thickness_m) <= alike * b->thickness_m,
                         "ply", a->name, "is not as thick as the electrodes that it lies beside"));
    DEA_TRY(ctx, require(ctx, a->pre_stretch[0] == 1 && a->pre_stretch[1] == 1, "ply", a->name,
                         "is stretched"));
    DEA_TRY(ctx, require(ctx, is_linear(&a->material), "ply", a->name, "is not linear elastic"));
    DEA_TRY(ctx, require(ctx,
                         a->material.young_modulus_Pa == b->material.young_modulus_Pa &&
                             (!glue || a->material.poisson_ratio == b->material.poisson_ratio),
                         "ply", a->name, "is of another material than a disc has there"));
    DEA_TRY(ctx, require(ctx,
                         a->material.density_kg_per_m3 == b->material.density_kg_per_m3 ||
                             (glue && !(a->material.density_kg_per_m3 > 0)),
                         "ply", a->name, "is not as dense as the film, which a disc's glue is"));
  }
  return DEA_OK;
}

/* Fibres, from the ply `first` on: alike, radial, evenly spread. Below them may be their glue, and
 * beside electrodes of a thickness what continues these. */
static dea_status read_fibres(struct dea_context *ctx, const struct dea_layout *l, size_t first,
                              struct dea_device *out)
{
  static const double turn = 6.28318530717958647692;
  const struct dea_layout_ply *top = &l->plies[l->ply_count - 1], *below = top - 1;
  const struct dea_region *region = &l->regions[top->region].region;
  struct dea_layout *wanted;
  const struct dea_contour fibre = dea_region_contour(region, 0);
  DEA_TRY(ctx, require(ctx, measure_fibre(&fibre, out), "ply", top->name,
                       "is neither the film nor of its electrodes' shape, nor are its parts radial "
                       "fibres that end at a circle"));
  out->fibre_count = (int)region->contour_count;
  const double step = turn / out->fibre_count, angle = fmod(out->angle_rad + turn, step);
  out->angle_rad = angle > alike && step - angle > alike ? angle : 0;
  out->fibre = top->material;
  out->fibre_thickness_m = top->thickness_m;
  if (l->ply_count > first + 1 &&
      is_like(&l->regions[below->region].region, region,
              &(struct dea_device){.frame_radius_m = out->frame_radius_m})) {
    out->bond_thickness_m = below->thickness_m;
    out->bond_modulus_Pa = below->material.young_modulus_Pa;
  }
  DEA_TRY(ctx, dea_disc_layout_create(ctx, out, false, &wanted));
  const dea_status status = compare_fibres(ctx, l, first, wanted, out);
  dea_layout_destroy(ctx, wanted);
  return status;
}

// The layout that stands for it -------------------------------------------------------------------

/* The ply of one of a disc's layouts that ply i of another is: electrodes may be one. */
static size_t ply_of(const struct dea_layout *l, size_t i, const struct dea_layout *to)
{
  const size_t below = l->electrodes[0].ply > 0 ? 3 : 1; // the film and its electrodes
  return i >= below                  ? to->ply_count - (l->ply_count - i)
         : i == l->electrodes[0].ply ? to->electrodes[0].ply
                                     : 0;
}

dea_status dea_disc_layout_add_monitors(struct dea_context *ctx, const struct dea_device *device,
                                        struct dea_layout *to, bool *fit)
{
  const struct dea_layout *l = device->layout;
  *fit = true;
  if (l == NULL) {
    return DEA_OK;
  }
  for (size_t i = 0; i < l->ply_count; i++) {
    struct dea_layout_ply *ply = &to->plies[ply_of(l, i, to)];
    ply->elements = l->plies[i].elements > 0 ? l->plies[i].elements : ply->elements;
  }
  to->monitors = dea_arena_alloc(&to->memory, l->monitor_count, sizeof *to->monitors);
  DEA_TRY(ctx, dea_arena_status(&to->memory));
  to->monitor_count = l->monitor_count;
  DEA_TRY(ctx, dea_disc_layout_own_monitors(ctx, device, to->electrodes[0].ply, to));
  for (size_t i = 0; i < l->monitor_count; i++) {
    struct dea_layout_monitor *monitor = &to->monitors[i];
    *monitor = l->monitors[i];
    monitor->ply = ply_of(l, monitor->ply, to);
    for (monitor->region = 0; monitor->kind == DEA_MONITOR_REGION; monitor->region++) {
      if (monitor->region == to->region_count) {
        *fit = false;
        return DEA_OK;
      }
      if (is_like(&l->regions[l->monitors[i].region].region, &to->regions[monitor->region].region,
                  device)) {
        break;
      }
    }
  }
  return DEA_OK;
}

// All --------------------------------------------------------------------------------------------

static dea_status find(struct dea_context *ctx, const struct dea_layout *l, struct dea_device *out)
{
  struct circle electrode = {.radius_m = 0};
  size_t film = 0, next;
  DEA_TRY(ctx, require(ctx, l->body_count == 0, "body", l->body_count > 0 ? l->bodies[0].name : "",
                       "is no part of one"));
  DEA_TRY(ctx, require(ctx, l->pressure_count == 0, "the pressure on ply",
                       l->pressure_count > 0 ? l->plies[l->pressures[0].ply].name : "",
                       "is no load of one"));
  DEA_TRY(ctx,
          require(ctx, l->contact_count == 0, "the contact of ply",
                  l->contact_count > 0 ? l->plies[l->contacts[0].ply].name : "", "is none of one"));
  for (size_t i = 0; i < l->ply_count; i++) {
    DEA_TRY(ctx, require(ctx, dea_ply_layers(&l->plies[i]) == 1, "ply", l->plies[i].name,
                         "is of several layers"));
  }
  DEA_TRY(ctx, find_electrodes(ctx, l, &film, &electrode));
  DEA_TRY(ctx, read_film(ctx, l, film, &electrode, out));
  DEA_TRY(ctx, read_stiffness(ctx, l, film, &electrode, &next, out));
  DEA_TRY(ctx, next < l->ply_count ? read_fibres(ctx, l, next, out) : DEA_OK);
  out->disc = true;
  return DEA_OK;
}

dea_status dea_device_find_disc(struct dea_context *ctx, struct dea_device *device)
{
  struct dea_device disc = {.layout = device->layout, .gravity = device->gravity};
  const dea_status status = find(ctx, device->layout, &disc);
  if (status == DEA_E_DESIGN) {
    dea_context_clear(ctx);
    disc = (struct dea_device){.layout = device->layout, .gravity = device->gravity};
  }
  *device = disc;
  device->layout->disc_monitor_count = 0;
  return status == DEA_OK ? dea_disc_layout_own_monitors(
                                ctx, device, device->layout->electrodes[0].ply, device->layout)
         : status == DEA_E_DESIGN ? DEA_OK
                                  : status;
}

dea_status dea_device_require_disc(struct dea_context *ctx, const struct dea_device *device)
{
  struct dea_device disc = {.gravity = device->gravity};
  return DEA_CHAIN(ctx, device->disc ? DEA_OK : find(ctx, device->layout, &disc));
}

double dea_device_pre_stretch(const struct dea_device *device)
{
  const struct dea_layout_ply *film = device->disc ? NULL : dea_layout_film(device->layout);
  return device->disc ? device->pre_stretch : film != NULL ? film->pre_stretch[0] : 1;
}

double dea_device_path_end(const struct dea_device *device, const struct dea_design *design)
{
  const double given = design->compute.path_max_stretch.si;
  return isinf(given) ? 1.5 * dea_device_pre_stretch(device) : given; // of plies: not given
}

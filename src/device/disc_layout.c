#include "device/disc_layout.h"

#include <math.h>
#include <stdio.h>

enum { FILM, ELECTRODE, FIBRES, FILLER, SEAT, REGIONS }; // seat: of fibres on electrodes
enum { PLIES = 7 };

static struct dea_region *add_region(struct dea_layout *l, const char *name)
{
  struct dea_layout_region *region = &l->regions[l->region_count++];
  *region = (struct dea_layout_region){.name = name, .region = {.ctx = l->ctx}};
  return &region->region;
}

/* Whether fibres lie on electrodes, from their tips on. */
static bool on_electrodes(const struct dea_device *d)
{
  static const double same = 1e-9; // of the frame's radius
  return d->fibre_count > 0 && d->electrode_thickness_m > 0 &&
         d->fibre_tip_radius_m < d->electrode_radius_m - same * d->frame_radius_m;
}

/* A fibre along x: corners, and bulges of the sides that begin there. */
struct outline {
  double corner[4][2], bulge[4];
};

/* Where a fibre's long side, y > 0, comes to a circle about the centre. */
static void cross(const struct outline *fibre, double radius_m, double out[2])
{
  const double *from = fibre->corner[3], *to = fibre->corner[2];
  double dx = to[0] - from[0], dy = to[1] - from[1], a = dx * dx + dy * dy;
  double b = from[0] * dx + from[1] * dy;
  double c = from[0] * from[0] + from[1] * from[1] - radius_m * radius_m;
  double t = (sqrt(b * b - a * c) - b) / a;
  out[0] = from[0] + t * dx;
  out[1] = from[1] + t * dy;
}

/* A fibre ends at its tip and at the frame, or before it. A corner at the frame lies on it, so that
 * a fibre is not wider than the film there. Of it all, or the part that is beyond the electrode, or
 * not beyond it. */
static struct outline outline_of(const struct dea_device *d, int region)
{
  double half = 0.5 * d->fibre_width_m, at[2];
  double tip = d->fibre_tip_width_m > 0 ? 0.5 * d->fibre_tip_width_m : half;
  double r = d->frame_radius_m - d->fibre_outer_gap_m, end = sqrt(r * r - half * half);
  double inner = d->fibre_tip_radius_m;
  struct outline out = {{{inner, -tip}, {end, -half}, {end, half}, {inner, tip}},
                        {[1] = tan(0.5 * asin(half / r))}};
  if (region != FIBRES) {
    bool beyond = region == FILLER;
    cross(&out, d->electrode_radius_m, at);
    double *low = out.corner[beyond ? 0 : 1], *high = out.corner[beyond ? 3 : 2];
    low[0] = high[0] = at[0];
    low[1] = -at[1];
    high[1] = at[1];
    out.bulge[beyond ? 3 : 1] = (beyond ? -1 : 1) * tan(0.5 * atan2(at[1], at[0]));
  }
  return out;
}

static void add_fibres(const struct dea_device *d, int region, struct dea_region *out)
{
  const struct outline fibre = outline_of(d, region);
  for (int i = 0; i < d->fibre_count; i++) {
    double angle = d->angle_rad + 2 * DEA_PI * i / d->fibre_count, c = cos(angle), s = sin(angle);
    struct dea_vertex v[4] = {0};
    for (int k = 0; k < 4; k++) {
      v[k].x_m = c * fibre.corner[k][0] - s * fibre.corner[k][1];
      v[k].y_m = s * fibre.corner[k][0] + c * fibre.corner[k][1];
      v[k].bulge = fibre.bulge[k];
    }
    dea_region_add(out, v, 4);
  }
}

/* The next ply up; a material without data of its own has a name alone. */
static struct dea_layout_ply *add_ply(struct dea_layout *l, const char *name, size_t region,
                                      double thickness_m, const struct dea_material *material)
{
  struct dea_layout_ply *ply = &l->plies[l->ply_count++];
  *ply = (struct dea_layout_ply){.name = name,
                                 .region = region,
                                 .thickness_m = thickness_m,
                                 .thickness_unstretched_m = thickness_m,
                                 .pre_stretch = {1, 1},
                                 .elements = 1};
  if (material != NULL) {
    ply->material = *material;
  } else {
    snprintf(ply->material.name, sizeof ply->material.name, "%s", name);
  }
  return ply;
}

/* Electrodes are stretched with the film; of an unknown density they are as heavy as it. */
static void add_electrode(const struct dea_device *d, struct dea_layout *l, const char *name,
                          int sheets)
{
  double area = d->pre_stretch * d->pre_stretch, thickness_m = sheets * d->electrode_thickness_m;
  struct dea_layout_ply *ply = add_ply(l, name, ELECTRODE, thickness_m / area, &d->electrode);
  ply->thickness_unstretched_m = thickness_m;
  ply->pre_stretch[0] = ply->pre_stretch[1] = d->pre_stretch;
  ply->kind = DEA_PLY_ELECTRODE;
  ply->part = "";
  if (!(ply->material.density_kg_per_m3 > 0)) {
    ply->material.density_kg_per_m3 = d->film.density_kg_per_m3;
  }
}

static void add_film(const struct dea_device *d, struct dea_layout *l)
{
  struct dea_layout_ply *ply = add_ply(l, "film", FILM, d->film_thickness_m, &d->film);
  ply->thickness_unstretched_m = d->film_thickness_unstretched_m;
  ply->pre_stretch[0] = ply->pre_stretch[1] = d->pre_stretch;
  ply->elements = 0;
  ply->part = "film";
}

/* A bond of no mass: all of that is in the surface. */
static void add_bond(struct dea_layout *l, const char *name, size_t region, double thickness_m,
                     size_t joins)
{
  struct dea_layout_ply *ply = add_ply(l, name, region, thickness_m, NULL);
  ply->kind = DEA_PLY_JOINT;
  ply->joins = joins;
}

/* A glue is taken as incompressible and as heavy as the film: a design says no more of it. */
static void add_glue(const struct dea_device *d, struct dea_layout *l, const char *name,
                     size_t region, double thickness_m)
{
  struct dea_layout_ply *ply = add_ply(l, name, region, thickness_m, NULL);
  ply->kind = DEA_PLY_GLUE;
  ply->part = "";
  ply->material.young_modulus_Pa = d->bond_modulus_Pa;
  ply->material.poisson_ratio = 0.5;
  ply->material.density_kg_per_m3 = d->film.density_kg_per_m3;
}

/* Fibres are linear, whatever else is known of their material. */
static void add_fibre_ply(const struct dea_device *d, struct dea_layout *l, const char *name,
                          size_t region, double thickness_m)
{
  struct dea_layout_ply *ply = add_ply(l, name, region, thickness_m, &d->fibre);
  ply->material.law = NULL;
  ply->material.branch_count = 0;
  ply->on_tabs = region == FIBRES;
  ply->part = ply->on_tabs ? name : "";
}

/* From the film or its electrodes up. */
static void add_fibre_plies(const struct dea_device *d, bool membrane, struct dea_layout *l)
{
  double electrode_m = d->electrode_thickness_m / (d->pre_stretch * d->pre_stretch);
  if (on_electrodes(d)) {
    if (membrane) {
      add_bond(l, "bond of electrodes", SEAT, electrode_m, 0);
    }
    (d->bond_thickness_m > 0 ? add_glue : add_fibre_ply)(d, l, "filler", FILLER, electrode_m);
  }
  if (d->bond_thickness_m > 0) {
    add_glue(d, l, "bond", FIBRES, d->bond_thickness_m);
  }
  add_fibre_ply(d, l, "fibres", FIBRES, d->fibre_thickness_m);
}

static void add_plies(const struct dea_device *d, bool membrane, struct dea_layout *l)
{
  bool stiff = d->electrode_thickness_m > 0;
  if (stiff) {
    add_electrode(d, l, membrane ? "electrodes" : "lower electrode", membrane ? 2 : 1);
  }
  size_t film = l->ply_count;
  add_film(d, l);
  if (membrane && d->fibre_count > 0) {
    add_bond(l, "bond of the film", FIBRES, 0.5 * d->film_thickness_m, film);
  }
  size_t held = l->ply_count;
  if (stiff && !membrane) {
    add_electrode(d, l, "upper electrode", 1);
  }
  if (d->fibre_count > 0) {
    add_fibre_plies(d, membrane, l);
  }
  l->electrodes[0] =
      (struct dea_layout_electrode){.name = "ground",
                                    .region = ELECTRODE,
                                    .ply = film,
                                    .channel = 0,
                                    .sheet_resistance_ohm = d->sheet_resistance_ohm[0]};
  l->electrodes[1] =
      (struct dea_layout_electrode){.name = "drive",
                                    .region = ELECTRODE,
                                    .ply = film,
                                    .top = true,
                                    .channel = 1,
                                    .sheet_resistance_ohm = d->sheet_resistance_ohm[1]};
  l->electrode_count = 2;
  l->supports[0] = (struct dea_layout_support){.region = FILM,
                                               .edge = true,
                                               .within = DEA_LAYOUT_NONE,
                                               .components = 7,
                                               .plies = d->outer_end == DEA_END_HINGED ? held : 0};
  l->support_count = 1;
}

/* Whether fibres are bonded to a film that is a surface: they begin at the bond's upper face. */
static size_t ply_below_fibres(const struct dea_layout *l, size_t film)
{
  const bool bond = film + 1 < l->ply_count && l->plies[film + 1].kind == DEA_PLY_JOINT;
  return bond ? film + 1 : film;
}

dea_status dea_disc_layout_own_monitors(struct dea_context *ctx, const struct dea_device *d,
                                        size_t film, struct dea_layout *l)
{
  enum { OWN_MAX = 4 };
  const double c = cos(d->angle_rad), s = sin(d->angle_rad), *centre = d->centre_m;
  const double half = d->angle_rad + DEA_PI / (d->fibre_count > 0 ? d->fibre_count : 4);
  const double a = d->electrode_radius_m, tip = d->fibre_tip_radius_m;
  const double edge[2] = {centre[0] + a * cos(half), centre[1] + a * sin(half)};
  const struct dea_layout_monitor all[OWN_MAX] = {
      {.name = "centre", .at_m = {{centre[0], centre[1]}}, .level = DEA_LEVEL_MIDDLE},
      {.name = "electrode edge",
       .kind = DEA_MONITOR_RADIUS,
       .at_m = {{edge[0], edge[1]}, {centre[0], centre[1]}},
       .level = DEA_LEVEL_MIDDLE},
      {.name = "electrode",
       .kind = DEA_MONITOR_RADIUS,
       .at_m = {{edge[0], edge[1]}, {centre[0], centre[1]}},
       .level = DEA_LEVEL_MIDDLE},
      {.name = "fibre tip",
       .at_m = {{centre[0] + tip * c, centre[1] + tip * s}},
       .level = DEA_LEVEL_TOP}};
  struct dea_layout_monitor *monitors =
      dea_arena_alloc(&l->memory, l->monitor_count + OWN_MAX, sizeof *monitors);
  DEA_TRY(ctx, dea_arena_status(&l->memory));
  for (size_t i = 0; i < l->monitor_count; i++) {
    monitors[i] = l->monitors[i];
  }
  l->disc_monitor_count = d->fibre_count > 0 ? OWN_MAX : OWN_MAX - 1;
  for (size_t i = 0; i < l->disc_monitor_count; i++) {
    monitors[l->monitor_count + i] = all[i];
    monitors[l->monitor_count + i].ply =
        all[i].level == DEA_LEVEL_TOP ? ply_below_fibres(l, film) : film;
  }
  l->monitors = monitors;
  return DEA_OK;
}

static dea_status fill(struct dea_context *ctx, const struct dea_device *d, bool membrane,
                       struct dea_layout *l)
{
  l->polar = true;
  static const char *const fibre_regions[REGIONS] = {
      [FIBRES] = "fibres", [FILLER] = "filler", [SEAT] = "seat"};
  l->regions = dea_arena_alloc(&l->memory, REGIONS, sizeof *l->regions);
  l->plies = dea_arena_alloc(&l->memory, PLIES, sizeof *l->plies);
  l->electrodes = dea_arena_alloc(&l->memory, 2, sizeof *l->electrodes);
  l->supports = dea_arena_alloc(&l->memory, 1, sizeof *l->supports);
  struct dea_layout_channel *channels = dea_arena_alloc(&l->memory, 2, sizeof *channels);
  DEA_TRY(ctx, dea_arena_status(&l->memory));
  channels[0] = l->channels[0];
  channels[1] = (struct dea_layout_channel){.name = "drive", .ratio = 1};
  l->channels = channels;
  l->channel_count = 2;
  const struct dea_location nowhere = {.file = ""};
  dea_region_add_circle(add_region(l, "film"), 0, 0, d->frame_radius_m, false, nowhere);
  dea_region_add_circle(add_region(l, "electrode"), 0, 0, d->electrode_radius_m, false, nowhere);
  int last = on_electrodes(d) ? membrane ? SEAT : FILLER : d->fibre_count > 0 ? FIBRES : ELECTRODE;
  for (int i = FIBRES; i <= last; i++) {
    add_fibres(d, i, add_region(l, fibre_regions[i]));
  }
  for (size_t i = 0; i < l->region_count; i++) {
    DEA_TRY(ctx, dea_region_status(&l->regions[i].region));
  }
  add_plies(d, membrane, l);
  if (d->gravity != DEA_GRAVITY_OFF) {
    l->gravity_m_per_s2[2] =
        (d->gravity == DEA_GRAVITY_FIBRES_UP ? -1 : 1) * DEA_STANDARD_GRAVITY_M_PER_S2;
  }
  return dea_disc_layout_own_monitors(ctx, d, l->electrodes[0].ply, l);
}

dea_status dea_disc_layout_create(struct dea_context *ctx, const struct dea_device *d,
                                  bool membrane, struct dea_layout **out)
{
  struct dea_layout *layout;
  *out = NULL;
  DEA_TRY(ctx, dea_layout_create(ctx, &layout));
  DEA_TRY_ELSE(ctx, fill(ctx, d, membrane, layout), dea_layout_destroy(ctx, layout));
  *out = layout;
  return DEA_OK;
}

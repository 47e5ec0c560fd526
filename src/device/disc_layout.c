#include "device/disc_layout.h"

#include <math.h>
#include <stdio.h>

static const double pi = 3.14159265358979323846;

enum { REGIONS = 3, PLIES = 5 };

static struct dea_region *add_region(struct dea_layout *l, const char *name)
{
  struct dea_layout_region *region = &l->regions[l->region_count++];
  *region = (struct dea_layout_region){.name = name, .region = {.ctx = l->ctx}};
  return &region->region;
}

/* All fibres, which end at their tips and at the frame, or before it. A corner at the frame lies on
 * it, so that a fibre is not wider than the film there. */
static void add_fibres(const struct dea_device *d, struct dea_region *out)
{
  double half = 0.5 * d->fibre_width_m, tip = 0.5 * d->fibre_tip_width_m;
  double r = d->frame_radius_m - d->fibre_outer_gap_m;
  double end = sqrt(r * r - half * half), bulge = tan(0.5 * asin(half / r));
  for (int i = 0; i < d->fibre_count; i++) {
    double angle = 2 * pi * i / d->fibre_count, c = cos(angle), s = sin(angle);
    const double corner[4][2] = {
        {d->fibre_tip_radius_m, -tip}, {end, -half}, {end, half}, {d->fibre_tip_radius_m, tip}};
    struct dea_vertex v[4] = {0};
    for (int k = 0; k < 4; k++) {
      v[k].x_m = c * corner[k][0] - s * corner[k][1];
      v[k].y_m = s * corner[k][0] + c * corner[k][1];
      v[k].bulge = k == 1 ? bulge : 0;
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
                                 .pre_stretch = {1, 1}};
  if (material != NULL) {
    ply->material = *material;
  } else {
    snprintf(ply->material.name, sizeof ply->material.name, "%s", name);
  }
  return ply;
}

static void add_plies(const struct dea_device *d, struct dea_layout *l)
{
  bool stiff = d->electrode_thickness_m > 0;
  if (stiff) {
    add_ply(l, "lower electrode", 1, d->electrode_thickness_m, &d->electrode);
  }
  size_t film = l->ply_count;
  struct dea_layout_ply *ply = add_ply(l, "film", 0, d->film_thickness_m, &d->film);
  ply->thickness_unstretched_m = d->film_thickness_unstretched_m;
  ply->pre_stretch[0] = ply->pre_stretch[1] = d->pre_stretch;
  if (stiff) {
    add_ply(l, "upper electrode", 1, d->electrode_thickness_m, &d->electrode);
  }
  if (d->fibre_count > 0 && d->bond_thickness_m > 0) {
    ply = add_ply(l, "bond", 2, d->bond_thickness_m, NULL);
    ply->material.young_modulus_Pa = d->bond_modulus_Pa;
  }
  if (d->fibre_count > 0) {
    add_ply(l, "fibres", 2, d->fibre_thickness_m, &d->fibre);
  }
  l->electrodes[0] =
      (struct dea_layout_electrode){.name = "ground", .region = 1, .ply = film, .channel = 0};
  l->electrodes[1] = (struct dea_layout_electrode){
      .name = "drive", .region = 1, .ply = film, .top = true, .channel = 1};
  l->electrode_count = 2;
}

dea_status dea_disc_layout_make(struct dea_context *ctx, struct dea_device *d)
{
  DEA_TRY(ctx, dea_layout_create(ctx, &d->layout));
  struct dea_layout *l = d->layout;
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
  if (d->fibre_count > 0) {
    add_fibres(d, add_region(l, "fibres"));
  }
  for (size_t i = 0; i < l->region_count; i++) {
    DEA_TRY(ctx, dea_region_status(&l->regions[i].region));
  }
  add_plies(d, l);
  l->supports[0] = (struct dea_layout_support){
      .region = 0, .edge = true, .within = DEA_LAYOUT_NONE, .components = 7};
  l->support_count = 1;
  return dea_layout_find_symmetry(ctx, l);
}

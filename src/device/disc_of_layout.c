/* The numbers of a disc in a round frame, of a layout that is one. */
#include "base/text.h"
#include "device/device.h"
#include "material/identity.h"

#include <math.h>
#include <string.h>

/* Fails where something is not as in a disc: "ply 'hub'", "is no part of one". */
static dea_status ask(struct dea_context *ctx, bool good, const char *what, const char *name,
                      const char *how)
{
  return good ? DEA_OK
              : dea_fail(ctx, DEA_E_DESIGN,
                         "this needs a disc in a round frame, and %s '%.60s' %s; the model 3d "
                         "takes any device",
                         what, name, how);
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
    out = i == 0 ? (struct circle){{c[0], c[1]}, piece.radius_m} : out;
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
  DEA_TRY(ctx, ask(ctx, l->electrode_count > 0, "ply", l->plies[0].name, "has no electrodes"));
  DEA_TRY(ctx, ask(ctx, l->electrode_count > 1, "electrode", e[0].name, "has no other one"));
  DEA_TRY(ctx, ask(ctx, l->channel_count > 1, "channel", l->channels[0].name, "is the only one"));
  DEA_TRY(ctx, ask(ctx, l->channel_count == 2, "channel", l->channels[l->channel_count - 1].name,
                   "is one more than ground and a driven one"));
  DEA_TRY(ctx, ask(ctx, drive->ratio == 1 && drive->own_V == 0 && drive->waveform == NULL,
                   "channel", drive->name, "has a voltage of its own"));
  DEA_TRY(ctx, ask(ctx, l->electrode_count == 2, "electrode", e[l->electrode_count - 1].name,
                   "is one more than two"));
  DEA_TRY(ctx,
          ask(ctx, e[0].ply == e[1].ply && e[0].top != e[1].top && e[0].channel != e[1].channel,
              "electrode", e[1].name, "is not across the film from the other one"));
  *film = e[0].ply;
  *out = circle_of(l, e[0].region);
  DEA_TRY(ctx, ask(ctx, out->radius_m > 0, "electrode", e[0].name, "is not round"));
  const struct circle other = circle_of(l, e[1].region);
  DEA_TRY(ctx, ask(ctx, is_same(out, &other), "electrode", e[1].name, "is not as the other one"));
  return DEA_OK;
}

static dea_status take_film(struct dea_context *ctx, const struct dea_layout *l, size_t film,
                            const struct circle *electrode, struct dea_device *out)
{
  const struct dea_layout_ply *ply = &l->plies[film];
  const struct circle frame = circle_of(l, ply->region);
  const double off =
      hypot(frame.centre[0] - electrode->centre[0], frame.centre[1] - electrode->centre[1]);
  const bool centred = off <= DEA_GEOMETRY_SNAP * frame.radius_m;
  DEA_TRY(ctx, ask(ctx, frame.radius_m > 0, "ply", ply->name, "is not round"));
  DEA_TRY(ctx, ask(ctx, centred, "electrode", l->electrodes[0].name,
                   "is not in the middle of the film"));
  DEA_TRY(ctx, ask(ctx, electrode->radius_m < frame.radius_m * (1 - DEA_GEOMETRY_SNAP), "electrode",
                   l->electrodes[0].name, "does not end before the edge of the film"));
  DEA_TRY(ctx, ask(ctx, dea_ply_layers(ply) == 1, "ply", ply->name, "has several layers"));
  DEA_TRY(ctx, ask(ctx, ply->pre_stretch[0] == ply->pre_stretch[1], "ply", ply->name,
                   "has two pre-stretches"));
  DEA_TRY(ctx, ask(ctx, ply->material.law == NULL || !ply->material.law->anisotropic, "ply",
                   ply->name, "has a direction of its own"));
  for (size_t i = 0; i < l->support_count; i++) {
    const struct dea_layout_support *s = &l->supports[i];
    const struct circle held = circle_of(l, s->region);
    const double *move = s->move_m;
    DEA_TRY(ctx, ask(ctx,
                     dea_support_is_frame(s) && !s->hinged && s->plies == 0 &&
                         is_same(&frame, &held) && move[0] == 0 && move[1] == 0 && move[2] == 0,
                     "the support of", l->regions[s->region].name,
                     "does not clamp the edge of the film"));
  }
  DEA_TRY(ctx, ask(ctx, l->support_count > 0, "ply", ply->name, "has no clamped edge"));
  out->film = ply->material;
  out->film_thickness_m = ply->thickness_m;
  out->film_thickness_unstretched_m = ply->thickness_unstretched_m;
  out->pre_stretch = ply->pre_stretch[0];
  out->frame_radius_m = frame.radius_m;
  out->electrode_radius_m = electrode->radius_m;
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

/* Electrodes with stiffness: a ply like them below the film, and the same one above. */
static dea_status take_stiffness(struct dea_context *ctx, const struct dea_layout *l, size_t film,
                                 const struct circle *electrode, struct dea_device *out)
{
  const bool stiff = l->ply_count == 3 && film == 1;
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_layout_ply *ply = &l->plies[i];
    const struct circle own = circle_of(l, ply->region);
    const bool like = is_same(electrode, &own);
    DEA_TRY(ctx, ask(ctx, i == film || like, "ply", ply->name,
                     "is neither the film nor of its electrodes' shape"));
    DEA_TRY(ctx, ask(ctx, i == film || stiff, "ply", ply->name,
                     "is not one of two electrodes, below and above the film"));
    DEA_TRY(ctx, ask(ctx,
                     i == film || (ply->pre_stretch[0] == out->pre_stretch &&
                                   ply->pre_stretch[1] == out->pre_stretch),
                     "ply", ply->name, "is not stretched with the film"));
  }
  if (!stiff) {
    return DEA_OK;
  }
  const struct dea_layout_ply *below = &l->plies[0], *above = &l->plies[2];
  bool same;
  DEA_TRY(ctx, compare(ctx, &below->material, &above->material, &same));
  DEA_TRY(ctx, ask(ctx, same && below->thickness_m == above->thickness_m, "ply", above->name,
                   "is not as that below the film"));
  out->electrode = below->material;
  out->electrode_thickness_m = below->thickness_unstretched_m;
  return DEA_OK;
}

dea_status dea_device_disc(struct dea_context *ctx, const struct dea_device *device,
                           struct dea_device *out)
{
  struct dea_device disc = *device;
  const struct dea_layout *l = device->layout;
  struct circle electrode = {.radius_m = 0};
  size_t film = 0;
  if (device->general) {
    disc.general = false;
    DEA_TRY(ctx, ask(ctx, l->body_count == 0, "body", l->body_count > 0 ? l->bodies[0].name : "",
                     "is no part of one"));
    DEA_TRY(ctx, ask(ctx, l->pressure_count == 0, "the pressure on ply",
                     l->pressure_count > 0 ? l->plies[l->pressures[0].ply].name : "",
                     "is no load of one"));
    DEA_TRY(ctx, find_electrodes(ctx, l, &film, &electrode));
    DEA_TRY(ctx, take_film(ctx, l, film, &electrode, &disc));
    DEA_TRY(ctx, take_stiffness(ctx, l, film, &electrode, &disc));
  }
  *out = disc;
  return DEA_OK;
}

double dea_device_pre_stretch(const struct dea_device *device)
{
  const struct dea_layout_ply *film = device->general ? dea_layout_film(device->layout) : NULL;
  return !device->general ? device->pre_stretch : film != NULL ? film->pre_stretch[0] : 1;
}

double dea_device_path_end(const struct dea_device *device, const struct dea_design *design)
{
  const double given = design->compute.path_max_stretch.si;
  return isinf(given) ? 1.5 * dea_device_pre_stretch(device) : given; // of plies: not given
}

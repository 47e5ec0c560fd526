#include "model/solid/actuator/disc_mesh.h"

#include "device/disc_layout.h"
#include "model/solid/actuator/mesh_follow.h"
#include "model/solid/mesh/cuts.h"

#include <math.h>
#include <string.h>

/* Sizes of elements over the electrode radius at refinement 1, which each refinement more halves
 * (docs/theory/mesh.md has the study that they come from). The fine edge is for the ends of fibres:
 * without them it is four times as large. */
static const double size_share = 0.26, beside_share = 0.13, edge_share = 0.0125;

/* The plate of a disc, on the domain and with the mesh that the settings name. */
static void find_plate(const struct dea_device *d, const struct dea_model_settings *settings,
                       struct dea_fibre_disc *out)
{
  double finer = exp2(1 - fmax(1, settings->refinement)), a = d->electrode_radius_m;
  double l = d->pre_stretch;
  *out = (struct dea_fibre_disc){
      .order = dea_mesh_order(settings->order),
      .order_z = dea_mesh_order(settings->order_z),
      .through = settings->elements_z > 0 ? settings->elements_z : 1,
      .membrane = settings->film == DEA_FILM_MEMBRANE,
      .fibres = d->fibre_count,
      .sectors = 1,
      .electrode_radius = a,
      .frame_radius = d->frame_radius_m,
      .tip_radius = d->fibre_tip_radius_m,
      .outer_radius = d->frame_radius_m - d->fibre_outer_gap_m,
      .tip_width = d->fibre_tip_width_m > 0 ? d->fibre_tip_width_m : d->fibre_width_m,
      .outer_width = d->fibre_width_m,
      .film_thickness = d->film_thickness_m,
      .electrode_thickness = d->electrode_thickness_m / (l * l), // they are stretched with the film
      .glue_thickness = d->bond_thickness_m,
      .fibre_thickness = d->fibre_thickness_m,
      .end = d->outer_end == DEA_END_HINGED ? DEA_FIBRE_DISC_HINGED : DEA_FIBRE_DISC_CLAMPED,
      .size = size_share * a * finer,
      .edge = (d->fibre_count > 0 ? 1 : 4) * edge_share * a * finer,
      .beside = beside_share * a * finer,
      .finer_at_tips = exp2(settings->tip_refinement - fmax(1, settings->refinement)),
  };
  if (settings->field == DEA_FIELD_COUPLED && out->through > 1 &&
      out->through <= DEA_FIBRE_DISC_THROUGH_MAX) { // elements at the edge as wide as thick
    double cuts[DEA_FIBRE_DISC_THROUGH_MAX + 1];
    dea_cuts_through((size_t)out->through, cuts);
    out->fringe = d->film_thickness_m * cuts[1] * finer;
  }
  if (settings->domain == DEA_DOMAIN_DISC) {
    out->sectors = dea_fibre_disc_sectors(out);
  }
}

/* Regions of the layout as groups: what of them lies where, by the bits of the blocks' regions. */
static dea_status name_groups(struct dea_context *ctx, struct dea_layout_mesh *mesh)
{
  enum { GROUPS = 5, BITS = 4 }; // film, electrode, fibres, filler, seat
  const struct dea_layout *l = mesh->layout;
  mesh->group = dea_arena_alloc(&mesh->memory, l->region_count, sizeof *mesh->group);
  DEA_TRY(ctx, dea_arena_status(&mesh->memory));
  for (size_t i = 0; i < l->region_count; i++) {
    mesh->group[i] = i;
    DEA_TRY(ctx, dea_plane_mesh_add_group(ctx, mesh->plane, l->regions[i].name));
  }
  for (int bits = 0; bits < BITS; bits++) {
    const bool electrode = bits & DEA_FIBRE_DISC_ELECTRODE, fibre = bits & DEA_FIBRE_DISC_FIBRE;
    bool any = false;
    for (size_t q = 0; q < mesh->plane->quad_count; q++) {
      any = any || mesh->plane->region[q] == bits;
    }
    const unsigned char within[GROUPS] = {any, any && electrode, any && fibre,
                                          any && fibre && !electrode, any && fibre && electrode};
    int region;
    DEA_TRY(ctx, dea_plane_mesh_region(ctx, mesh->plane, within, &region)); // 0, 1, ...
  }
  return DEA_OK;
}

/* The numbers of plies and channels that a disc cannot have, such as one electrode that is thicker
 * than the other, into its layout. */
static void copy_numbers(const struct dea_layout *from, struct dea_layout *to)
{
  for (size_t i = 0; i < to->ply_count; i++) {
    const struct dea_layout_ply *a = &from->plies[i];
    struct dea_layout_ply *b = &to->plies[i];
    const double density = b->material.density_kg_per_m3;
    b->material = a->material;
    b->material.density_kg_per_m3 =
        a->material.density_kg_per_m3 > 0 ? a->material.density_kg_per_m3 : density;
    b->thickness_m = a->thickness_m;
    b->thickness_unstretched_m = a->thickness_unstretched_m;
    memcpy(b->pre_stretch, a->pre_stretch, sizeof a->pre_stretch);
  }
  to->channels[1].ratio = from->channels[1].ratio;
  to->channels[1].own_V = from->channels[1].own_V;
}

/* *fit: whether blocks have all that the layout names, else there is no mesh. */
static dea_status build_plane(struct dea_context *ctx, const struct dea_device *device,
                              struct dea_layout_mesh *mesh, bool *fit)
{
  struct dea_device disc = *device;
  disc.angle_rad = mesh->sector.angle_rad;
  DEA_TRY(ctx, dea_disc_layout_create(ctx, &disc, mesh->membrane, &mesh->own));
  DEA_TRY(ctx, dea_disc_layout_add_monitors(ctx, device, mesh->own, fit));
  if (!*fit) {
    return DEA_OK;
  }
  if (!device->disc && device->layout != NULL) {
    copy_numbers(device->layout, mesh->own);
  }
  mesh->layout = mesh->own;
  DEA_TRY(ctx, dea_fibre_disc_plane(ctx, &mesh->plate, &mesh->cuts, &mesh->plane));
  const struct dea_motion turn = dea_motion_rotation((double[2]){0, 0}, disc.angle_rad);
  for (size_t i = 0; i < mesh->plane->node_count && disc.angle_rad != 0; i++) {
    dea_motion_apply(&turn, mesh->plane->x + 2 * i, mesh->plane->x + 2 * i);
  }
  return DEA_CHAIN(ctx, name_groups(ctx, mesh));
}

dea_status dea_disc_mesh_create(struct dea_context *ctx, const struct dea_device *device,
                                const struct dea_model_settings *settings,
                                const struct dea_fibre_disc *plate,
                                const struct dea_layout_mesh *like, struct dea_layout_mesh *out,
                                bool *fit)
{
  const bool whole = plate->sectors == dea_fibre_disc_sectors(plate);
  *out = (struct dea_layout_mesh){
      .memory = {.ctx = ctx},
      .plate = *plate,
      .disc = device,
      .cuts = like != NULL ? like->cuts : *plate,
      .membrane = plate->membrane,
      .sector = {.angle_rad = like != NULL ? like->sector.angle_rad : device->angle_rad,
                 .fold = whole ? 0 : dea_fibre_disc_sectors(plate) / 2},
      .bottom_m = plate->membrane ? 0 : -0.5 * plate->film_thickness - plate->electrode_thickness};
  DEA_TRY_ELSE(ctx, build_plane(ctx, device, out, fit), dea_layout_mesh_free(ctx, out));
  if (!*fit) {
    dea_layout_mesh_free(ctx, out);
    return DEA_OK;
  }
  return DEA_CHAIN(ctx, dea_layout_mesh_fill(ctx, settings, like, out));
}

/* Blocks are the mesh of a disc about the origin, of which nothing else is asked for. */
dea_status dea_device_mesh_create(struct dea_context *ctx, const struct dea_device *device,
                                  const struct dea_model_settings *settings,
                                  struct dea_layout_mesh *out)
{
  bool blocks = device->disc && device->centre_m[0] == 0 && device->centre_m[1] == 0 &&
                settings->adapt.monitor == NULL && settings->size_count == 0;
  struct dea_fibre_disc plate;
  *out = (struct dea_layout_mesh){0};
  if (blocks) {
    find_plate(device, settings, &plate);
    DEA_TRY(ctx, dea_disc_mesh_create(ctx, device, settings, &plate, NULL, out, &blocks));
  }
  return DEA_CHAIN(ctx,
                   blocks ? DEA_OK : dea_layout_mesh_create(ctx, device->layout, settings, out));
}

/* The disc that a mesh is of with the layout of what is no disc any more: of the same shapes. */
static dea_status find_near(struct dea_context *ctx, const struct dea_device *device,
                            const struct dea_layout_mesh *like, struct dea_device *out)
{
  const struct dea_layout *a = device->layout, *b = like->disc->layout;
  bool same = !like->membrane && b != NULL && a->region_count == b->region_count &&
              a->ply_count == b->ply_count && a->channel_count == b->channel_count;
  for (size_t i = 0; same && i < a->region_count; i++) {
    same = dea_region_same(&a->regions[i].region, &b->regions[i].region);
  }
  *out = *like->disc;
  out->layout = device->layout;
  out->disc = false;
  return same ? DEA_OK
              : dea_fail(ctx, DEA_E_ARGUMENT,
                         "the mesh cannot follow: it is of a disc, which this is not");
}

dea_status dea_device_mesh_follow(struct dea_context *ctx, const struct dea_device *device,
                                  const struct dea_model_settings *settings,
                                  const struct dea_layout_mesh *like, struct dea_layout_mesh *out)
{
  struct dea_fibre_disc plate;
  struct dea_device near;
  bool fit;
  *out = (struct dea_layout_mesh){0};
  if (like->plate.order == 0) {
    return DEA_CHAIN(ctx, dea_mesh_follow(ctx, device->layout, settings, like, out));
  }
  DEA_TRY(ctx, !device->disc ? find_near(ctx, device, like, &near) : DEA_OK);
  const struct dea_device *disc = device->disc ? device : &near;
  find_plate(disc, settings, &plate);
  DEA_TRY(ctx, dea_disc_mesh_create(ctx, disc, settings, &plate, like, out, &fit));
  if (!fit) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the mesh cannot follow a monitor's region");
  }
  out->disc = device;
  return DEA_OK;
}

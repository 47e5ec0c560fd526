/* From a device to the solid of the model "3d", at rest. */
#include "model/film.h"
#include "model/solid/actuator/disc_mesh.h"
#include "model/solid/model3d/solid_model.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { resolved = 6 }; // elements through the film from which a coupled field is (coupled.md)

/* Elements through the film, the least of several. */
static int least_through(const struct dea_model *model)
{
  const int usual = model->settings.elements_z > 1 ? model->settings.elements_z : 1;
  int least = model->disc ? usual : INT_MAX;
  for (size_t i = 0; i < model->layout->ply_count && !model->disc; i++) {
    const int own = (int)model->layout->plies[i].elements;
    least = model->mesh.dielectric[i] && (own > 0 ? own : usual) < least ? (own > 0 ? own : usual)
                                                                         : least;
  }
  return least;
}

/* What of a coupled field the mesh does not resolve. */
static dea_status report_coupled(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_device *d = model->device;
  const int through = least_through(model);
  if (through < resolved) {
    return dea_finding_add(
        ctx, DEA_WARNING, (struct dea_location){0},
        "model 3d: %d element%s through the film do%s not resolve the coupled field at "
        "the electrode's edge: capacitance comes out too large (by 0.8 %% with one), "
        "and what a fibre tip there loses against V/h is not to be trusted, not even "
        "in its sign; compute.solid.elements_z: %d resolves it "
        "(docs/theory/coupled.md)",
        through, through > 1 ? "s" : "", through > 1 ? "" : "es", resolved);
  }
  if (d->fibre_count > 0 &&
      fabs(d->electrode_radius_m - d->fibre_tip_radius_m) < d->film_thickness_m) {
    return dea_finding_add(
        ctx, DEA_WARNING, (struct dea_location){0},
        "model 3d: the fibres begin where the electrode ends: there the coupled field's part in "
        "their lift converges with the root of the element's size only, so that %d elements "
        "through the film show about half of it at small voltage, and at larger ones no limit is "
        "known; capacitance and what is not at that edge are resolved (docs/theory/coupled.md)",
        through);
  }
  return DEA_OK;
}

/* What a film without bending leaves out. */
static dea_status report_membrane(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_device *d = model->device;
  DEA_TRY(ctx, dea_finding_add(
                   ctx, DEA_NOTE, (struct dea_location){0},
                   "model 3d with a membrane film is a preview: %s"
                   "it has no bending of the film and no shape of its wrinkles "
                   "(compute.solid.film: solid)",
                   d->fibre_count > 0 ? "10 to 20 % off the solid film at the fibre tip; " : ""));
  if (model->disc && d->pre_stretch <= 1) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                                 "a membrane film without pre-stretch is slack under any voltage: "
                                 "nothing will move, where a solid film buckles "
                                 "(compute.solid.film: solid)"));
  }
  return DEA_OK;
}

/* What is about to be solved, and what it cannot show. */
static dea_status report_mesh(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_grid *grid = model->mesh.grid;
  const bool whole = model->mesh.sector.fold == 0;
  char what[200];
  snprintf(what, sizeof what, "%sthe whole %s", model->disc ? "" : "a free mesh of ",
           model->disc ? "disc" : "device");
  if (!whole && model->disc) {
    snprintf(what, sizeof what,
             "one sector of the actuator; it is blind to motions that break its symmetry "
             "(compute.solid.domain: disc)");
  } else if (!whole) {
    snprintf(what, sizeof what,
             "a free mesh of one of %g mirrored sectors of the device; it is blind to motions that "
             "break this symmetry (compute.solid.domain: whole)",
             model->copies);
  }
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                               "model 3d: %zu elements, %zu unknowns, %s", grid->element_count,
                               3 * grid->node_count, what));
  if (model->settings.order > grid->order) {
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                            "model 3d: compute.solid.order: %d is not there for devices made "
                            "of `plies`: their free mesh has elements of order %d in the plane "
                            "(compute.solid.refinement makes it finer)",
                            model->settings.order, grid->order));
  }
  DEA_TRY(ctx, model->settings.field == DEA_FIELD_COUPLED ? report_coupled(ctx, model) : DEA_OK);
  return DEA_CHAIN(ctx, model->mesh.membrane ? report_membrane(ctx, model) : DEA_OK);
}

/* Where the weight alone brings the film of a disc. */
static dea_status report_sag(struct dea_context *ctx, const struct dea_model *model)
{
  const double centre_z_m = dea_solid_model_centre_z(model, dea_solid_displacement(model->solid));
  if (!isnan(centre_z_m) && dea_solid_has_weight(model->layout)) {
    DEA_TRY(ctx,
            dea_finding_add(
                ctx, DEA_NOTE, (struct dea_location){0},
                "model 3d: with its weight the centre is at z = %.4g um without voltage, "
                "where the sweep starts (gravity: fibres_%s)",
                1e6 * centre_z_m, model->device->gravity == DEA_GRAVITY_FIBRES_UP ? "up" : "down"));
  }
  return DEA_OK;
}

static struct dea_film_band find_band(const struct dea_model *model)
{
  const size_t film = model->plies.film;
  const double *face_m = model->mesh.face_m[film];
  return (struct dea_film_band){0.5 * (face_m[0] + face_m[1]),
                                model->layout->plies[film].thickness_m};
}

dea_status dea_solid_model_assemble(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_layout *l = model->layout;
  const bool coupled = model->settings.field == DEA_FIELD_COUPLED;
  DEA_TRY(ctx, dea_plies_create(ctx, &model->mesh, &model->memory, &model->plies));
  model->band = find_band(model);
  double *point_mass, *share = dea_arena_alloc(&model->memory, l->channel_count, sizeof *share);
  model->bodies = dea_arena_alloc(&model->memory, l->body_count, sizeof *model->bodies);
  model->push = dea_arena_alloc(&model->memory, l->body_count, sizeof *model->push);
  model->controls = dea_arena_alloc(&model->memory, l->body_count, sizeof *model->controls);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  model->mesh_node_count = model->mesh.grid->node_count;
  DEA_TRY(ctx, dea_solid_bodies_add(ctx, model, &point_mass));
  model->on_side = dea_arena_alloc(&model->memory, model->mesh_node_count, sizeof *model->on_side);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    model->on_side[n] = dea_plies_held(&model->mesh, model->mesh.grid->X + 3 * n);
  }
  for (size_t k = 1; k < l->channel_count; k++) {
    share[k - 1] = l->channels[k].ratio;
  }
  struct dea_solid_load *contacts;
  size_t contact_count;
  DEA_TRY(ctx, dea_solid_contacts_create(ctx, model, &contacts, &contact_count));
  const struct dea_solid_options options = {
      .loads = contacts,
      .load_count = contact_count,
      .order_z = dea_mesh_order(model->settings.order_z),
      .part_material_count = l->ply_count,
      .part_materials = model->plies.part_materials,
      .part_material_of = dea_plies_part_material,
      .active = dea_plies_active,
      .field = coupled ? DEA_SOLID_FIELD_COUPLED : DEA_SOLID_FIELD_THIN,
      .electrode = dea_plies_electrode,
      .channels = coupled ? NULL : dea_plies_channels,
      .channel_count = l->channel_count > 1 ? l->channel_count - 1 : 1,
      .share = share,
      .held = dea_plies_held,
      .frame = dea_plies_frame,
      .body_count = l->body_count,
      .bodies = model->bodies,
      .body_of = l->body_count > 0 ? model->follows : NULL,
      .point_mass_kg = l->body_count > 0 ? point_mass : NULL,
      .self = &model->mesh,
  };
  DEA_TRY(ctx, dea_solid_create(ctx, model->mesh.grid, &options, &model->solid));
  DEA_TRY(ctx, dea_solid_loads_add(ctx, model));
  return DEA_CHAIN(ctx, dea_observer_create(ctx, &model->mesh, model->pressures, model->contacts,
                                            &model->memory, &model->observer));
}

static dea_status keep_rest(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_solid *s = model->solid;
  size_t values = s->problem.dofs, pressures = dea_solid_pressure_count(s);
  model->at.rest_energy_J = model->at.report.energy_J;
  model->at.as_made = !model->at.report.snapped;
  model->rest_is_one_of = model->at.left_a_state;
  model->rest = dea_arena_alloc(&model->memory, values + pressures, sizeof *model->rest);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  memcpy(model->rest, s->state.u, values * sizeof *model->rest);
  memcpy(model->rest + values, s->state.multiplier, pressures * sizeof *model->rest);
  return DEA_OK;
}

dea_status dea_solid_model_mesh(struct dea_context *ctx, struct dea_model *model,
                                const struct dea_layout_mesh *like)
{
  DEA_TRY(ctx,
          like == NULL
              ? dea_device_mesh_create(ctx, model->device, &model->settings, &model->mesh)
              : dea_device_mesh_follow(ctx, model->device, &model->settings, like, &model->mesh));
  model->layout = model->mesh.layout;
  model->disc = model->mesh.plate.order > 0;
  return DEA_OK;
}

/* A mesh of its own, or that of another model. */
static dea_status build_mesh(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_model *from = model->settings.mesh_from;
  if (model->device->disc) {
    struct dea_film film;
    DEA_TRY(ctx, dea_film_create(ctx, model->device, &film)); // laws and permittivity are there
  }
  if (model->settings.film == DEA_FILM_MEMBRANE && model->settings.field == DEA_FIELD_COUPLED) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "compute.solid.field: coupled needs a film with a thickness; take "
                    "compute.solid.film: solid");
  }
  return DEA_CHAIN(ctx, dea_solid_model_mesh(ctx, model, from != NULL ? &from->mesh : NULL));
}

dea_status dea_solid_model_prepare(struct dea_context *ctx, const struct dea_device *device,
                                   const struct dea_model_settings *settings,
                                   struct dea_model *model)
{
  model->device = device;
  model->settings = *settings;
  model->at.outcome.model = model;
  model->memory.ctx = ctx;
  model->pressure_factor = 1;
  DEA_TRY(ctx, dea_solid_start(ctx));
  DEA_TRY(ctx,
          dea_solid_allreduce(ctx, build_mesh(ctx, model))); // gmsh may be ended on one rank alone
  model->copies = (double)dea_layout_sector_copies(&model->mesh.sector);
  DEA_TRY(ctx, report_mesh(ctx, model));
  DEA_TRY(ctx, dea_solid_model_assemble(ctx, model));
  DEA_TRY(ctx, dea_solid_loads_release(ctx, model));
  DEA_TRY(ctx, keep_rest(ctx, model));
  return DEA_CHAIN(ctx, report_sag(ctx, model));
}

void dea_solid_model_destroy(struct dea_context *ctx, struct dea_model *model)
{
  if (model == NULL) {
    return;
  }
  dea_circuit_step_destroy(ctx, model->at.driven);
  dea_step_outcome_free(&model->at.outcome);
  dea_free(ctx, model->at.soft);
  dea_free(ctx, model->answers);
  dea_free(ctx, model->passes);
  dea_solid_destroy(ctx, model->solid);
  dea_indent_destroy(ctx, model->indent);
  dea_free(ctx, model->profile);
  dea_layout_mesh_free(ctx, &model->mesh);
  dea_arena_free(&model->memory);
  dea_free(ctx, model);
}

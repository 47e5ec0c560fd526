/* Model "3d" behind the common interface: a device as a solid, on a sector or as a whole. It is the
 * whole of the loadable module that model/solid_module.c opens. */
#include "model/solid/model3d/solid_model.h"
#include "base/module.h"
#include "model/make.h"
#include "model/solid/model3d/motions.h"
#include "model/solid/model3d/solid_fields.h"
#include "model/solid/recovery/line_profile.h"
#include "result/columns.h"
#include "result/field_mesh.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double field_step_V_per_m = 10e6; // a longer way is gone in such steps of V/H0

// In time ----------------------------------------------------------------------------------------

static dea_status begin(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_time_options *time, struct dea_load_point *out)
{
  const struct dea_driven_solid driven = {
      .solid = model->solid,
      .branches = model->plies.branches,
      .leakage_per_s = model->plies.leakage_per_s,
      .mesh = &model->mesh,
      .channels = !model->disc || dea_layout_has_sheet_resistance(model->layout),
      .copies = model->copies,
      .thickness_m = model->layout->plies[model->plies.film].thickness_m};
  DEA_TRY(ctx, time->inertia ? dea_solid_check_densities(ctx, model) : DEA_OK);
  return DEA_CHAIN(ctx, dea_solver_state_begin(ctx, &model->at, &driven, time, out));
}

// Saved states -----------------------------------------------------------------------------------

static void mark(struct dea_model_marks *marks, const double *values, size_t count)
{
  if (marks->out != NULL && count > 0) {
    memcpy(marks->out + marks->count, values, count * sizeof *values);
  }
  marks->count += count;
}

/* All numbers of the layout that electrodes, supports, and loads depend on. */
static void mark_layout(const struct dea_layout *l, struct dea_model_marks *marks)
{
  mark(marks, l->gravity_m_per_s2, 3);
  for (size_t i = 0; i < l->channel_count; i++) {
    const double own[] = {l->channels[i].ratio, l->channels[i].own_V};
    mark(marks, own, 2);
  }
  for (size_t i = 0; i < l->electrode_count; i++) {
    const struct dea_layout_electrode *e = &l->electrodes[i];
    const double own[] = {(double)e->ply, e->top, (double)e->region, (double)e->channel};
    mark(marks, own, 4); // a sheet resistance is of no equilibrium
  }
  for (size_t i = 0; i < l->support_count; i++) {
    mark(marks, l->supports[i].move_m, 3);
    mark(marks, l->supports[i].force_N, 3);
  }
  for (size_t i = 0; i < l->body_count; i++) {
    const struct dea_layout_body *b = &l->bodies[i];
    mark(marks, &b->mass_kg, 1);
    mark(marks, b->shift_m, 3);
    mark(marks, b->turn_rad, 3);
    mark(marks, b->force_N, 3);
    mark(marks, b->moment_N_m, 3);
  }
  for (size_t i = 0; i < l->spring_count; i++) {
    const struct dea_layout_spring *s = &l->springs[i];
    const double own[] = {(double)s->body, s->component, s->free_at, s->stiffness};
    mark(marks, own, 4);
    mark(marks, s->at, s->count);
    mark(marks, s->force, s->count);
  }
  for (size_t i = 0; i < l->pressure_count; i++) {
    const struct dea_layout_pressure *p = &l->pressures[i];
    const double own[] = {(double)p->region, (double)p->ply, p->top, p->pressure_Pa};
    mark(marks, own, 4);
  }
  for (size_t i = 0; i < l->contact_count; i++) {
    const struct dea_layout_contact *c = &l->contacts[i];
    const double own[] = {(double)c->region, (double)c->ply, c->top, c->gap_m, (double)c->with};
    mark(marks, own, 5);
  }
}

static dea_status save(struct dea_context *ctx, struct dea_model *model, struct dea_state *out)
{
  DEA_TRY(ctx, dea_solver_state_save(ctx, &model->at, out));
  if (model->marks.out == NULL) {
    struct dea_model_marks counted = {.out = NULL};
    mark_layout(model->layout, &counted);
    model->marks.out = dea_arena_alloc(&model->memory, counted.count, sizeof *model->marks.out);
    DEA_TRY(ctx, dea_arena_status(&model->memory));
    mark_layout(model->layout, &model->marks);
  }
  return DEA_CHAIN(ctx, dea_state_add_mark(ctx, out, "loads", model->marks.out,
                                           model->marks.count * sizeof *model->marks.out));
}

static dea_status observe(struct dea_context *ctx, struct dea_model *model,
                          struct dea_observation *out)
{
  DEA_TRY(ctx, dea_observer_read(ctx, model->observer, model->solid, out));
  if (model->at.driven != NULL) {
    dea_observer_set_currents(model->observer, dea_circuit_step_currents_A(model->at.driven));
  }
  return DEA_OK;
}

/* What small motions are of. */
static dea_status find_motions(struct dea_context *ctx, const struct dea_model *model,
                               struct dea_motions *out)
{
  *out = (struct dea_motions){.solid = model->solid,
                              .grid = model->mesh.grid,
                              .observer = model->observer,
                              .branches = model->plies.branches,
                              .part_material_count = model->layout->ply_count};
  DEA_TRY(ctx, dea_solid_check_densities(ctx, model));
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                         "model 3d: frequencies are those in vacuo; the air that moves with a film "
                         "makes it slower, a thin one by about a fifth (model reduced has it: "
                         "compute.reduced.air)%s%s",
                         model->mesh.sector.fold == 0
                             ? ""
                             : ". A sector has only those modes that have its symmetry "
                               "(compute.solid.domain: ",
                         model->mesh.sector.fold == 0 ? ""
                         : model->disc                ? "disc has all)"
                                                      : "whole has all)");
}

/* Monitors of the answer at one frequency, per volt. */
static dea_status get_answer(struct dea_context *ctx, void *user, size_t i, const double *real,
                             const double *imaginary)
{
  const struct dea_model *model = user;
  size_t width = model->layout->monitor_count * DEA_OBSERVED_MOTIONS;
  const double *parts[2] = {real, imaginary};
  for (int p = 0; p < 2; p++) {
    DEA_TRY(ctx, dea_observer_differentiate(ctx, model->observer, model->solid, parts[p],
                                            model->answer));
    for (size_t k = 0; k < width; k++) {
      model->answers[2 * (i * width + k) + (size_t)p] = model->answer[k];
    }
  }
  return DEA_OK;
}

static dea_status respond(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_load_point *at,
                          const struct dea_ac_excitation *excitation, const double *frequency_Hz,
                          size_t count, struct dea_load_point *points)
{
  struct dea_motions motions;
  size_t width = model->layout->monitor_count * DEA_OBSERVED_MOTIONS;
  double *answers = dea_resize(ctx, model->answers, 2 * count * width + 1, sizeof *answers);
  model->answers = answers != NULL ? answers : model->answers;
  DEA_TRY_MEMORY(!dea_solid_allreduce_any(answers == NULL));
  if (dea_layout_has_sheet_resistance(model->layout)) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "an excitation by electrodes with a sheet resistance is known in "
                    "time only (compute.transient with a sine); without sheet_resistance: that of "
                    "ideal electrodes");
  }
  DEA_TRY(ctx, find_motions(ctx, model, &motions));
  motions.take = width > 0 ? get_answer : NULL;
  motions.user = model;
  dea_solid_liquids_stiffen(model, true);
  const dea_status status =
      dea_motions_respond(ctx, &motions, at, excitation, frequency_Hz, count, points);
  dea_solid_liquids_stiffen(model, false);
  DEA_TRY(ctx, status);
  for (size_t i = 0; i < 2 * count * width; i++) {
    model->answers[i] *= excitation->amplitude_V;
  }
  return DEA_OK;
}

static const double *answers(const struct dea_model *model)
{
  return model->answers;
}

/* All copies of the sector in the place of *mesh; that of a disc says how it is to be unfolded. */
static dea_status build_whole(struct dea_context *ctx, const struct dea_model *model,
                              struct dea_field_mesh **mesh)
{
  const struct dea_layout_sector *sector = &model->mesh.sector;
  struct dea_field_mesh *part = *mesh, *whole = NULL;
  if (model->disc) {
    part->fold = sector->fold;
    part->symmetry_angle = sector->angle_rad;
    part->fibres = model->device->fibre_count;
  }
  if (sector->fold == 0 || model->disc) {
    return DEA_OK;
  }
  part->fold = sector->fold; // about the z axis, where the centre is for a moment
  part->symmetry_angle = sector->angle_rad;
  for (size_t i = 0; i < 2 * part->point_count; i++) {
    part->X[3 * (i / 2) + i % 2] -= sector->centre_m[i % 2];
  }
  dea_status status = dea_field_mesh_whole(ctx, part, &whole);
  dea_field_mesh_destroy(ctx, part);
  *mesh = whole;
  DEA_TRY(ctx, status);
  for (size_t i = 0; i < 2 * whole->point_count; i++) {
    whole->X[3 * (i / 2) + i % 2] += sector->centre_m[i % 2];
  }
  return DEA_OK;
}

static dea_status modes(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_load_point *at, size_t count,
                        struct dea_load_point *points, struct dea_field_mesh **shapes)
{
  struct dea_motions motions;
  *shapes = NULL;
  DEA_TRY(ctx, find_motions(ctx, model, &motions));
  dea_solid_liquids_stiffen(model, true);
  const dea_status status =
      dea_motions_modes(ctx, &motions, (int)model->plies.film, at, count, points, shapes);
  dea_solid_liquids_stiffen(model, false);
  DEA_TRY(ctx, status);
  return DEA_CHAIN(ctx, build_whole(ctx, model, shapes));
}

static dea_status fields(struct dea_context *ctx, struct dea_model *model,
                         enum dea_fields_part part, struct dea_field_mesh **out)
{
  DEA_TRY(ctx, part == DEA_FIELDS_VOLUME
                   ? dea_solid_volume(ctx, model->solid, out)
                   : dea_solid_surface(ctx, model->solid, (int)model->plies.film, out));
  return DEA_CHAIN(ctx, build_whole(ctx, model, out));
}

/* Of a disc: along the first fibre's axis and halfway between it and the next. Of others: none. */
static dea_status profile(struct dea_context *ctx, struct dea_model *model, struct dea_profile *out)
{
  const struct dea_fibre_disc *p = &model->mesh.plate;
  struct dea_field_mesh *surface;
  *out = (struct dea_profile){0};
  if (!model->disc) {
    return DEA_OK;
  }
  dea_free(ctx, model->profile);
  model->profile = NULL;
  DEA_TRY(ctx, dea_solid_surface(ctx, model->solid, (int)model->plies.film, &surface));
  dea_status status = dea_line_profile(ctx, surface, 0, dea_fibre_disc_angle(p) / p->sectors,
                                       model->device->pre_stretch, &model->profile, out);
  dea_field_mesh_destroy(ctx, surface);
  return DEA_CHAIN(ctx, status);
}

// Other ways to a state ---------------------------------------------------------------------------

static dea_status indent(struct dea_context *ctx, struct dea_model *model,
                         const struct dea_probe *probe, double depth_m, struct dea_load_point *out)
{
  dea_solver_state_end_history(ctx, &model->at);
  if (model->indent == NULL) {
    DEA_TRY(ctx, dea_indent_create(ctx, &model->mesh, model->solid, probe, &model->indent));
  }
  dea_status status = dea_indent_move(ctx, model->indent, model->solid, model->at.voltage_V,
                                      depth_m, &model->at.report);
  if (status != DEA_OK) {
    char why[200];
    snprintf(why, sizeof why, "%s", dea_context_message(ctx));
    return dea_fail(ctx, status,
                    "the probe stopped at a depth of %.4g mm on its way to %.4g mm (%s)",
                    1e3 * model->indent->depth_m, 1e3 * depth_m, why);
  }
  return DEA_CHAIN(ctx, dea_solid_model_report(ctx, model, model->at.voltage_V, out));
}

/* Of a disc to a stretch of its electrode too. */
static dea_status long_path(struct dea_context *ctx, struct dea_model *model,
                            const struct dea_path_options *options, dea_point_sink points,
                            dea_event_sink events, void *user)
{
  struct dea_solver_state_end end = {0};
  double *weight = NULL;
  if (model->disc) {
    weight = dea_solid_alloc(ctx, model->solid->problem.dofs, sizeof *weight);
    DEA_TRY_MEMORY(weight != NULL);
    dea_observer_column_gradient(model->observer, model->solid,
                                 dea_point_column_find("electrode_edge_u_m"), weight);
    end.weight = weight;
    end.value =
        (options->max_stretch / model->device->pre_stretch - 1) * model->device->electrode_radius_m;
  }
  dea_status status = dea_solver_state_path(ctx, &model->at, options, &end, points, events, user);
  dea_free(ctx, weight);
  return DEA_CHAIN(ctx, status);
}

static dea_status push(struct dea_context *ctx, struct dea_model *model,
                       const struct dea_push *perturbation, struct dea_load_point *out, bool *found)
{
  double *fold = dea_solid_alloc(ctx, 3 * model->mesh.grid->node_count, sizeof *fold);
  DEA_TRY_MEMORY(fold != NULL);
  dea_buckling_branch_fold(model->solid, model->mesh.grid, &model->band, perturbation->side, fold);
  dea_status status = dea_solver_state_push(ctx, &model->at, perturbation, fold, out, found);
  dea_free(ctx, fold);
  return DEA_CHAIN(ctx, status);
}

static void size(const struct dea_model *model, struct dea_model_size *out)
{
  *out = (struct dea_model_size){.elements = model->mesh.grid->element_count,
                                 .nodes = model->mesh.grid->node_count,
                                 .unknowns = 3 * model->mesh.grid->node_count};
}

static const struct dea_adapt_pass *passes(const struct dea_model *model, size_t *count)
{
  *count = model->pass_count;
  return model->passes;
}

// Estimated errors -------------------------------------------------------------------------------

/* Whether the mesh is all that a point's error is of; a membrane has one too. */
static bool has_error(const struct dea_load_point *point)
{
  struct dea_load_point solid = *point;
  solid.own_flags &= ~(1u << DEA_FLAG_PREVIEW);
  return dea_load_point_trusted(&solid);
}

/* Of the main motion of a monitor at a point without a doubt; otherwise, and of a body that is held
 * along it, NAN. part: of each element, may be NULL. */
static dea_status find_error(struct dea_context *ctx, struct dea_model *model, size_t monitor,
                             const double *values, double *weight, double *error, double *part)
{
  const struct dea_layout_monitor *m = &model->layout->monitors[monitor];
  enum dea_observed motion = dea_observed_main(values);
  *error = NAN;
  if (m->kind == DEA_MONITOR_BODY) {
    size_t node = model->bodies[m->body].node;
    if ((model->solid->problem.held[3 * node + (size_t)motion]) != 0) {
      return DEA_OK;
    }
  }
  dea_observer_gradient(model->observer, model->solid, monitor, motion, weight);
  struct dea_solid_quantity one = {.weight = weight};
  one.probe_count = dea_observer_probes(model->observer, model->solid, monitor, motion, one.probes);
  dea_status status = dea_solid_errors(ctx, model->solid, &one, 1, error, part);
  return status == DEA_E_DOMAIN ? DEA_OK : status; // at the end of a law none is known
}

static dea_status errors(struct dea_context *ctx, struct dea_model *model, double *error)
{
  struct dea_load_point point;
  struct dea_observation seen;
  DEA_TRY(ctx, dea_solid_model_report(ctx, model, model->at.voltage_V, &point));
  DEA_TRY(ctx, dea_observer_read(ctx, model->observer, model->solid, &seen));
  for (size_t i = 0; i < seen.monitor_count; i++) {
    error[i] = NAN;
  }
  if (!has_error(&point)) {
    return DEA_OK;
  }
  double *weight = dea_solid_alloc(ctx, 3 * model->mesh.grid->node_count, sizeof *weight);
  dea_status status = weight == NULL ? DEA_E_MEMORY : DEA_OK;
  for (size_t i = 0; i < seen.monitor_count && status == DEA_OK; i++) {
    status = find_error(ctx, model, i, seen.monitor[i], weight, &error[i], NULL);
  }
  dea_free(ctx, weight);
  return status;
}

// Adaptive refinement ----------------------------------------------------------------------------

/* One mesh after the other, each finer where the error of the last one came from. */
struct adaptation {
  const struct dea_device *device;
  struct dea_model_settings settings; // with the sizes of the present mesh
  size_t monitor;                     // of the layout
  struct dea_adapt_pass *pass;        // [settings.adapt.passes], owned
  size_t count;
  double (*now)[3], (*next)[3]; // sizes of this mesh and the next one, owned
  size_t next_count;
};

static dea_status build(struct dea_context *ctx, const struct dea_device *device,
                        const struct dea_model_settings *settings, struct dea_model **out)
{
  DEA_TRY(ctx, dea_model_build(ctx, sizeof **out, device, settings, dea_solid_model_prepare,
                               dea_solid_model_destroy, out));
  struct dea_model *model = *out;
  const struct dea_layout_ply *film = &model->layout->plies[model->plies.film];
  model->at.outcome.owner = (struct dea_step_outcome_owner){
      .solid = model->solid,
      .films = model->plies.films,
      .model = model,
      .point = dea_solid_model_report,
      .arrived = dea_solid_model_arrived,
      .step_V = field_step_V_per_m * model->plies.thinnest_m,
      .tension_scale_N_per_m =
          dea_part_material_modulus(&model->plies.part_materials[model->plies.film]) *
          film->thickness_m,
      .refinement = model->settings.refinement,
      .membrane = model->mesh.membrane};
  return DEA_OK;
}

/* The error on a mesh at the voltage, and the sizes of the next one. */
static dea_status estimate_mesh_error(struct dea_context *ctx, struct adaptation *a,
                                      struct dea_model *model, struct dea_adapt_pass *pass)
{
  struct dea_load_point point;
  struct dea_observation seen;
  const struct dea_grid *grid = model->mesh.grid;
  DEA_TRY(ctx, dea_solver_state_solve(ctx, model, a->settings.adapt.voltage_V, &point));
  DEA_TRY(ctx, dea_observer_read(ctx, model->observer, model->solid, &seen));
  const double *values = seen.monitor[a->monitor];
  enum dea_observed motion = dea_observed_main(values);
  bool ratio = motion == DEA_OBSERVED_STRETCH || motion == DEA_OBSERVED_AREA_STRETCH;
  *pass = (struct dea_adapt_pass){.elements = grid->element_count,
                                  .unknowns = 3 * grid->node_count,
                                  .value = values[motion],
                                  .error = NAN};
  double *weight = dea_alloc(ctx, 3 * grid->node_count, sizeof *weight);
  double *part = dea_alloc(ctx, grid->element_count, sizeof *part);
  double(*at)[3] = dea_resize(ctx, a->next, model->mesh.plane->quad_count, sizeof *at);
  a->next = at != NULL ? at : a->next;
  dea_status status =
      dea_solid_allreduce_any(weight == NULL || part == NULL || at == NULL) ? DEA_E_MEMORY : DEA_OK;
  if (status == DEA_OK && has_error(&point)) {
    status = find_error(ctx, model, a->monitor, values, weight, &pass->error, part);
  }
  double wanted = a->settings.adapt.tolerance * fabs(pass->value - (ratio ? 1 : 0));
  if (status == DEA_OK && wanted > 0 && !isnan(pass->error)) {
    pass->within = pass->error <= wanted;
    a->next_count = model->mesh.plane->quad_count;
    status = dea_adapt_sizes(ctx, &model->mesh, part, wanted, a->next);
  } else if (status == DEA_OK) {
    pass->error = NAN; // of what does not move, too
  }
  dea_free(ctx, part);
  dea_free(ctx, weight);
  return status;
}

static dea_status find_monitor(struct dea_context *ctx, struct adaptation *a)
{
  const struct dea_layout *l = a->device->layout;
  const char *name = a->settings.adapt.monitor;
  while (a->monitor < l->monitor_count && strcmp(l->monitors[a->monitor].name, name) != 0) {
    a->monitor++;
  }
  return a->monitor < l->monitor_count
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DESIGN, "compute.solid.adapt: there is no monitor '%s'", name);
}

/* Where the error of a mesh is not known the last one is as good as any. */
static dea_status report_end(struct dea_context *ctx, const struct adaptation *a)
{
  const struct dea_adapt_pass *last = &a->pass[a->count - 1];
  if (!isnan(last->error) && last->within) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                         isnan(last->error)
                             ? "model 3d: no error of the monitor '%s' is known at %.4g kV: its "
                               "mesh stays as it is"
                             : "model 3d: the error of the monitor '%s' at %.4g kV is not yet that "
                               "of compute.solid.adapt.tolerance (compute.solid.adapt.passes)",
                         a->settings.adapt.monitor, 1e-3 * a->settings.adapt.voltage_V);
}

/* Another model, on a mesh of the present sizes, in the place of *model. */
static dea_status build_anew(struct dea_context *ctx, const struct adaptation *a,
                             struct dea_model **model)
{
  dea_solid_model_destroy(ctx, *model);
  *model = NULL;
  return DEA_CHAIN(ctx, build(ctx, a->device, &a->settings, model));
}

/* To the mesh that is exact enough; *model: on it, at rest. */
static dea_status adapt(struct dea_context *ctx, struct adaptation *a, struct dea_model **model)
{
  size_t most = (size_t)a->settings.adapt.passes;
  a->pass = dea_solid_alloc(ctx, most, sizeof *a->pass);
  DEA_TRY_MEMORY(a->pass != NULL);
  for (bool on = true; on;) {
    struct dea_adapt_pass *pass = &a->pass[a->count];
    DEA_TRY(ctx, estimate_mesh_error(ctx, a, *model, pass));
    a->count++;
    on = a->count < most && !pass->within && !isnan(pass->error);
    if (on) {
      double(*sizes)[3] = a->now;
      a->now = a->next;
      a->next = sizes;
      a->settings.sizes = (const double(*)[3])a->now;
      a->settings.size_count = a->next_count;
    }
    DEA_TRY(ctx, build_anew(ctx, a, model)); // the last one too: to be at rest
  }
  return DEA_CHAIN(ctx, report_end(ctx, a));
}

static dea_status create(struct dea_context *ctx, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  static const struct dea_model_settings usual = {0};
  struct adaptation a = {.device = device, .settings = settings != NULL ? *settings : usual};
  bool asked = a.settings.adapt.monitor != NULL;
  *out = NULL;
  dea_status status = asked ? find_monitor(ctx, &a) : DEA_OK;
  status = status == DEA_OK ? build(ctx, device, &a.settings, out) : status;
  if (asked && status == DEA_OK) {
    status = adapt(ctx, &a, out);
  }
  if (status == DEA_OK) {
    (*out)->passes = a.pass;
    (*out)->pass_count = a.count;
    a.pass = NULL;
  } else if (*out != NULL) {
    dea_solid_model_destroy(ctx, *out);
    *out = NULL;
  }
  dea_free(ctx, a.pass);
  dea_free(ctx, a.now);
  dea_free(ctx, a.next);
  return DEA_CHAIN(ctx, status);
}

extern DEA_MODULE_SYMBOL const struct dea_model_type dea_solid_module;

const struct dea_model_type dea_solid_module = {
    .name = "3d",
    .long_name = "3D solid",
    .any_layout = true,
    .libraries = dea_solid_libraries,
    .create = create,
    .destroy = dea_solid_model_destroy,
    .solve = dea_solver_state_solve,
    .gradient = dea_solid_model_gradient,
    .limit = dea_solver_state_limit,
    .passed = dea_solver_state_passed,
    .observe = observe,
    .errors = errors,
    .passes = passes,
    .indent = indent,
    .move = dea_solid_model_move,
    .compliance = dea_solid_model_compliance,
    .long_path = long_path,
    .soften = dea_solver_state_soften,
    .push = push,
    .modes = modes,
    .respond = respond,
    .answers = answers,
    .profile = profile,
    .fields = fields,
    .save = save,
    .load = dea_solver_state_load,
    .begin = begin,
    .advance = dea_solid_model_advance,
    .accept = dea_solver_state_accept,
    .size = size,
};

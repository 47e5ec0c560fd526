/* Model "3d" behind the common interface: a device as a solid, on a sector or as a whole. It is the
 * whole of the loadable module that model/solid_module.c opens. */
#include "model/solid/model3d/solid_model.h"
#include "base/module.h"
#include "model/make.h"
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/model3d/solid_fields.h"
#include "model/solid/model3d/solid_state.h"
#include "model/solid/recovery/line_profile.h"
#include "result/columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double path_step = 0.05; // of the square of the voltage, or of path_unit
static const double path_step_most = 0.5;
static const double path_unit = 2; // of the solid's length: displacement that counts as much as
                                   // all of the voltage

// Equilibria -------------------------------------------------------------------------------------

static const struct dea_event *limit(const struct dea_model *model)
{
  return model->at.outcome.limited ? &model->at.outcome.limit : NULL;
}

static const struct dea_event *passed(const struct dea_model *model)
{
  return model->at.outcome.has_passed ? &model->at.outcome.passed : NULL;
}

static dea_status observe(struct dea_context *ctx, struct dea_model *model,
                          struct dea_observation *out)
{
  DEA_TRY(ctx, dea_observer_read(ctx, model->observer, model->solid, out));
  if (model->at.driven != NULL && dea_circuit_step_currents_A(model->at.driven) != NULL) {
    dea_observer_set_currents(model->observer, dea_circuit_step_currents_A(model->at.driven));
  }
  return DEA_OK;
}

static dea_status indent(struct dea_context *ctx, struct dea_model *model,
                         const struct dea_probe *probe, double depth_m, struct dea_load_point *out)
{
  dea_solid_model_end_history(ctx, model);
  if (model->indent == NULL) {
    const struct dea_pressed out_of_touch = {*probe, -1e-3 * probe->radius_m};
    DEA_TRY(ctx, dea_indent_create(ctx, &model->mesh, model->solid, &out_of_touch, NULL,
                                   &model->indent));
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

// Path -------------------------------------------------------------------------------------------

/* A path by arc length, and where its points go. */
struct path {
  struct dea_model *model;
  const struct dea_path_options *options;
  struct dea_solid_continuation *steps;
  double *weight, value; // [dofs] of a disc: it ends where weight . u comes to that from below
  dea_point_sink points;
  dea_event_sink events; // NULL: not wanted
  void *user;
};

/* What the model says of a point of a path. */
static dea_status path_point(struct dea_context *ctx, const struct path *path,
                             const struct dea_continuation_point *at, struct dea_load_point *out)
{
  path->model->at.report.energy_J = at->energy_J;
  path->model->at.report.unstable_modes = at->unstable_modes;
  return DEA_CHAIN(ctx, dea_solid_model_report(ctx, path->model, at->voltage_V, out));
}

/* How far the solid is beyond the end, in its unit. */
static double beyond(const struct path *path)
{
  const struct dea_solid *solid = path->model->solid;
  return path->weight != NULL ? dea_solid_dot(solid, path->weight, solid->state.u) - path->value
                              : -1;
}

/* The limit point or bifurcation that the last step has passed, if it is not beyond the end; where
 * it cannot be closed in on there is none. */
static dea_status path_event(struct dea_context *ctx, const struct path *path,
                             const struct dea_continuation_point *after)
{
  struct dea_continuation_point at = {0};
  struct dea_event event;
  dea_status status = dea_solid_continuation_locate(ctx, path->steps, &at);
  if (dea_solid_may_shorten(status) || status == DEA_E_ARGUMENT) {
    dea_context_clear(ctx);
    return DEA_OK;
  }
  DEA_TRY(ctx, status);
  if (beyond(path) > 0) {
    return DEA_OK;
  }
  if (after->passed == DEA_CONTINUATION_BIFURCATION) {
    return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                           "model 3d: another branch crosses the path at %.4g kV; the path goes "
                           "on with %d unstable modes",
                           1e-3 * at.voltage_V, after->unstable_modes);
  }
  event.kind = after->slope < 0 ? DEA_EVENT_PULL_IN : DEA_EVENT_SNAP_BACK;
  DEA_TRY(ctx, path_point(ctx, path, &at, &event.point));
  return path->events != NULL ? path->events(path->user, &event) : DEA_OK;
}

/* A point of a path into its sink. */
static dea_status add_point(struct dea_context *ctx, const struct path *path,
                            const struct dea_continuation_point *at)
{
  struct dea_load_point point;
  DEA_TRY(ctx, path_point(ctx, path, at, &point));
  return DEA_CHAIN(ctx, path->points(path->user, &point));
}

/* The point where the step ends, or the path within it. */
static dea_status solve_step(struct dea_context *ctx, const struct path *path,
                             struct dea_continuation_point *at, bool *ended)
{
  const struct dea_continuation_point step = *at;
  *ended = beyond(path) >= 0;
  DEA_TRY(ctx, !*ended ? add_point(ctx, path, at) : DEA_OK);
  if (step.passed != DEA_CONTINUATION_NOTHING) {
    DEA_TRY(ctx, path_event(ctx, path, &step));
  }
  if (*ended) {
    DEA_TRY(ctx, dea_solid_continuation_across(ctx, path->steps, path->weight, path->value, at));
    DEA_TRY(ctx, add_point(ctx, path, at));
  }
  path->model->at.voltage_V = at->voltage_V;
  *ended = *ended || at->voltage_V >= path->options->max_voltage_V;
  return DEA_OK;
}

/* Step by step to one of the ends. */
static dea_status follow_path(struct dea_context *ctx, const struct path *path)
{
  bool ended = false;
  for (size_t i = 1; i < path->options->max_points && !ended; i++) {
    struct dea_continuation_point at;
    if (dea_interrupted_anywhere(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted on the path");
    }
    dea_status status = dea_solid_continuation_step(ctx, path->steps, &at);
    if (status == DEA_E_DOMAIN) { // 0 V, or the end of a law
      dea_context_clear(ctx);
      return DEA_OK;
    }
    DEA_TRY(ctx, status);
    DEA_TRY(ctx, solve_step(ctx, path, &at, &ended));
  }
  return DEA_OK;
}

/* From where the solid is; it is then back there unless it stays at the end. */
static dea_status go_along(struct dea_context *ctx, struct path *path)
{
  struct dea_model *model = path->model;
  const struct dea_path_options *options = path->options;
  const struct dea_continuation_options steps = {path_step, path_step_most,
                                                 path_unit * model->solid->problem.length_m, false};
  const struct dea_solid_report report = model->at.report;
  const double voltage_V = model->at.voltage_V;
  struct dea_load_point point;
  struct dea_solid_saved_state from;
  DEA_TRY(ctx, dea_solid_model_report(ctx, model, voltage_V, &point));
  DEA_TRY(ctx, path->points(path->user, &point));
  dea_status status = dea_solid_save_state(ctx, model->solid, &from);
  if (status == DEA_OK) {
    const double scale_V = isfinite(options->max_voltage_V)
                               ? options->max_voltage_V
                               : dea_step_outcome_longest_V(&model->at.outcome);
    status = dea_solid_continuation_create(ctx, model->solid, scale_V, &steps, &path->steps);
  }
  status = status == DEA_OK ? follow_path(ctx, path) : status;
  if (path->steps != NULL && !(status == DEA_OK && options->stays)) {
    dea_solid_restore_state(model->solid, &from);
    model->at.report = report;
    model->at.voltage_V = voltage_V;
  }
  dea_solid_continuation_destroy(ctx, path->steps);
  dea_solid_saved_state_free(&from);
  return status;
}

/* Of a disc to a stretch of its electrode too. */
static dea_status long_path(struct dea_context *ctx, struct dea_model *model,
                            const struct dea_path_options *options, dea_point_sink points,
                            dea_event_sink events, void *user)
{
  struct path path = {
      .model = model, .options = options, .points = points, .events = events, .user = user};
  dea_solid_model_end_history(ctx, model);
  if (model->disc) {
    path.weight = dea_solid_alloc(ctx, model->solid->problem.dofs, sizeof *path.weight);
    DEA_TRY_MEMORY(path.weight != NULL);
    dea_observer_column_gradient(model->observer, model->solid,
                                 dea_point_column_find("electrode_edge_u_m"), path.weight);
    path.value =
        (options->max_stretch / model->device->pre_stretch - 1) * model->device->electrode_radius_m;
  }
  const dea_status status = go_along(ctx, &path);
  dea_free(ctx, path.weight);
  return DEA_CHAIN(ctx, status);
}

// Other states -----------------------------------------------------------------------------------

static dea_status soften(struct dea_context *ctx, struct dea_model *model, size_t count,
                         double *stiffness_N_per_m4)
{
  dea_solid_model_end_history(ctx, model);
  dea_step_outcome_free(&model->at.outcome);
  dea_free(ctx, model->at.soft);
  model->at.soft = NULL;
  model->at.soft_count = 0;
  if (count == 0 || count > DEA_SOFT_MODES_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "1 to %d soft modes can be asked for", DEA_SOFT_MODES_MAX);
  }
  model->at.soft =
      dea_solid_alloc(ctx, count * 3 * model->mesh.grid->node_count, sizeof *model->at.soft);
  DEA_TRY_MEMORY(model->at.soft != NULL);
  DEA_TRY(ctx, dea_solid_modes_lowest(ctx, model->solid, DEA_MODES_BY_VOLUME, count,
                                      stiffness_N_per_m4, model->at.soft));
  model->at.soft_count = count;
  return DEA_OK;
}

/* Share of a mode that a push keeps at a place: 1 in the middle of a sector, 1/2 on its border
 * where the next one is left out. */
static double kept_share(const struct dea_push *push, const double X[3])
{
  double fraction = 0;
  if (push->parts < 2) {
    return 1;
  }
  double at = atan2(X[1], X[0]) / (2 * DEA_PI) * push->parts;
  for (int k = 0; k < push->parts; k++) {
    double away = at - k - push->parts * round((at - k) / push->parts);
    if ((push->in >> k & 1) != 0 && fabs(away) < 1) {
      fraction += pow(cos(0.5 * DEA_PI * away), 2);
    }
  }
  return fraction;
}

/* The push as displacements [node_count][3] in the place of the mode or fold. */
static void set_push(const struct dea_grid *grid, const struct dea_push *push, double *out)
{
  double most = 0;
  for (size_t n = 0; n < grid->node_count; n++) {
    double fraction = kept_share(push, grid->X + 3 * n);
    for (size_t i = 3 * n; i < 3 * n + 3; i++) {
      out[i] = fraction * out[i];
      most = fmax(most, fabs(out[i]));
    }
  }
  double scale =
      push->kind == DEA_PUSH_MODE && most > 0 ? push->side * push->amplitude_m / most : 1;
  for (size_t i = 0; i < 3 * grid->node_count; i++) {
    out[i] *= scale;
  }
}

static dea_status push(struct dea_context *ctx, struct dea_model *model,
                       const struct dea_push *perturbation, struct dea_load_point *out, bool *found)
{
  const struct dea_grid *grid = model->mesh.grid;
  const bool folds = perturbation->kind == DEA_PUSH_FOLD;
  const size_t moves = 3 * grid->node_count;
  *found = model->at.as_made = false;
  if ((!folds && perturbation->mode >= model->at.soft_count) ||
      perturbation->parts > DEA_PUSH_PARTS_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a push along mode %zu of %zu soft ones, in %d parts",
                    perturbation->mode + 1, model->at.soft_count, perturbation->parts);
  }
  double *displacement = dea_solid_alloc(ctx, moves, sizeof *displacement);
  DEA_TRY_MEMORY(displacement != NULL);
  if (folds) {
    dea_buckling_branch_fold(model->solid, grid, &model->band, perturbation->side, displacement);
  } else {
    memcpy(displacement, model->at.soft + perturbation->mode * moves, moves * sizeof *displacement);
  }
  set_push(grid, perturbation, displacement);
  dea_status status =
      dea_solid_perturb(ctx, model->solid, displacement, NULL, NULL, &model->at.report, found);
  dea_free(ctx, displacement);
  DEA_TRY(ctx, status);
  return DEA_CHAIN(ctx,
                   *found ? dea_solid_model_report(ctx, model, model->at.voltage_V, out) : DEA_OK);
}

// In time ----------------------------------------------------------------------------------------

static dea_status report_time(struct dea_context *ctx, struct dea_model *model,
                              struct dea_load_point *out)
{
  model->at.voltage_V = dea_solid_voltage(model->solid);
  DEA_TRY(ctx, dea_solid_model_report(ctx, model, model->at.voltage_V, out));
  dea_circuit_step_point(model->at.driven, out);
  out->stored_energy_J += model->at.stored_J;
  out->energy_J = out->stored_energy_J - dea_circuit_step_charged_J(model->at.driven);
  return DEA_OK;
}

static dea_status begin(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_time_options *time, struct dea_load_point *out)
{
  DEA_TRY(ctx, time->inertia ? dea_solid_check_densities(ctx, model) : DEA_OK);
  dea_solid_model_end_history(ctx, model);
  DEA_TRY(ctx, dea_solid_model_report(ctx, model, model->at.voltage_V, out));
  DEA_TRY(ctx, dea_circuit_step_create(ctx, model, time, &model->at.driven));
  model->at.stored_J = out->energy_J + dea_circuit_step_charged_J(model->at.driven);
  return DEA_CHAIN(ctx, report_time(ctx, model, out));
}

/* A control may move in a step. */
static dea_status advance(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_time_step *step, struct dea_load_point *out,
                          double *error)
{
  DEA_TRY(ctx, step->control != NULL
                   ? dea_solid_model_set_control(ctx, model, step->control, step->value)
                   : DEA_OK);
  if (model->at.driven == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a history in time has to begin first");
  }
  if (dea_interrupted_anywhere(ctx)) {
    return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted in a step in time");
  }
  DEA_TRY(ctx, dea_circuit_step_advance(ctx, model->at.driven, step, &model->at.report, error));
  return DEA_CHAIN(ctx, report_time(ctx, model, out));
}

static void accept(struct dea_model *model)
{
  dea_circuit_step_accept(model->at.driven);
}

// Saved states -----------------------------------------------------------------------------------

enum { VOLTAGE, LEFT_A_STATE, NUMBERS };
static const char own_name[] = "model";

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
  const double own[NUMBERS] = {
      [VOLTAGE] = model->at.voltage_V, [LEFT_A_STATE] = model->at.left_a_state ? 1 : 0};
  *out = (struct dea_state){0};
  DEA_TRY(ctx, dea_solid_save(ctx, model->solid, out));
  DEA_TRY(ctx, dea_state_add_numbers(ctx, out, own_name, own, NUMBERS));
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

static dea_status load(struct dea_context *ctx, struct dea_model *model,
                       const struct dea_state *state)
{
  const double *own = dea_state_find(state, own_name, NUMBERS);
  if (own == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the state is not one of model 3d");
  }
  model->at.as_made = false;
  DEA_TRY(ctx, dea_solid_load(ctx, model->solid, state));
  model->at.voltage_V = own[VOLTAGE];
  model->at.left_a_state = own[LEFT_A_STATE] != 0;
  return DEA_OK;
}

// Fields -----------------------------------------------------------------------------------------

static dea_status fields(struct dea_context *ctx, struct dea_model *model,
                         enum dea_fields_part part, struct dea_field_mesh **out)
{
  const int ply = part == DEA_FIELDS_VOLUME ? DEA_ALL_PLIES : (int)model->plies.film;
  DEA_TRY(ctx, dea_solid_fields(ctx, model->solid, ply, out));
  return DEA_CHAIN(ctx, dea_solid_model_whole(ctx, model, out));
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
  DEA_TRY(ctx, dea_solid_fields(ctx, model->solid, (int)model->plies.film, &surface));
  dea_status status = dea_line_profile(ctx, surface, 0, dea_fibre_disc_angle(p) / p->sectors,
                                       model->device->pre_stretch, &model->profile, out);
  dea_field_mesh_destroy(ctx, surface);
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

static const double *answers(const struct dea_model *model)
{
  return model->answers != NULL ? *model->answers : NULL;
}

extern DEA_MODULE_SYMBOL const struct dea_model_type dea_solid_module;

const struct dea_model_type dea_solid_module = {
    .name = "3d",
    .long_name = "3D solid",
    .any_layout = true,
    .libraries = dea_solid_libraries,
    .create = dea_solid_model_create,
    .destroy = dea_solid_model_destroy,
    .solve = dea_solid_model_solve,
    .gradient = dea_solid_model_gradient,
    .limit = limit,
    .passed = passed,
    .observe = observe,
    .errors = dea_solid_model_errors,
    .passes = passes,
    .indent = indent,
    .move = dea_solid_model_move,
    .compliance = dea_solid_model_compliance,
    .long_path = long_path,
    .soften = soften,
    .push = push,
    .modes = dea_solid_model_modes,
    .respond = dea_solid_model_respond,
    .answers = answers,
    .profile = profile,
    .fields = fields,
    .save = save,
    .load = load,
    .begin = begin,
    .advance = advance,
    .accept = accept,
    .size = size,
};

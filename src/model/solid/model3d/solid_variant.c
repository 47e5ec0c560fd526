/* Slopes of the model "3d" by changed devices (docs/theory/gradients.md). */
#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/model3d/solid_model.h"
#include "result/columns.h"

#include <math.h>
#include <string.h>

// The film ----------------------------------------------------------------------------------------

static const char *const extremes[DEA_FILM_EXTREMES] = {
    [DEA_FILM_FIELD] = "true_field_V_per_m",
    [DEA_FILM_MARGIN] = "breakdown_margin",
    [DEA_FILM_TENSION] = "min_tension_N_per_m",
};

static void find_places(const struct dea_model *model, struct dea_gradient_places *out)
{
  for (int i = 0; i < DEA_FILM_EXTREMES; i++) {
    out->known[i] = dea_solid_extreme_find(model->solid, model->plies.films,
                                           (enum dea_film_extreme)i, &out->at[i]);
  }
}

/* dea_variant_slope for extremes of the film, capacitance, energy and nominal field, and the
 * voltage, which is no unknown; *known false for every other column. */
static dea_status film_slope(struct dea_context *ctx, const struct dea_model *model, int column,
                             double *out, double *pressures, bool *known)
{
  const struct dea_gradient_places *places = &model->variant->places;
  const char *key = dea_point_columns[column].key;
  int extreme = 0;
  while (extreme < DEA_FILM_EXTREMES && strcmp(key, extremes[extreme]) != 0) {
    extreme++;
  }
  if (extreme < DEA_FILM_EXTREMES) {
    *known = places->known[extreme];
    if (*known) {
      dea_solid_extreme_slope(model->solid, model->plies.films, (enum dea_film_extreme)extreme,
                              &places->at[extreme], out, pressures);
    }
  } else if (strcmp(key, "capacitance_F") == 0) {
    DEA_TRY(ctx, dea_solid_capacitance_slope(ctx, model->solid, out, known));
    for (size_t i = 0; i < model->solid->problem.dofs; i++) {
      out[i] *= model->copies;
    }
  } else { // forces of the energy are 0
    *known = strcmp(key, "energy_J") == 0 || strcmp(key, "nominal_field_V_per_m") == 0 ||
             strcmp(key, "voltage_V") == 0;
  }
  return DEA_OK;
}

static bool asks(const struct dea_gradient_request *ask, const char *key)
{
  for (size_t i = 0; i < ask->column_count; i++) {
    if (strcmp(dea_point_columns[ask->columns[i]].key, key) == 0) {
      return true;
    }
  }
  return false;
}

/* Extremes and, where it is asked for, capacitance of the film as it is now. */
static dea_status film_at(struct dea_context *ctx, const struct dea_model *model, double voltage_V,
                          struct dea_load_point *out)
{
  const struct dea_gradient_places *places = &model->variant->places;
  double *const values[DEA_FILM_EXTREMES] = {
      [DEA_FILM_FIELD] = &out->true_field_V_per_m,
      [DEA_FILM_MARGIN] = &out->breakdown_margin,
      [DEA_FILM_TENSION] = &out->min_tension_N_per_m,
  };
  for (int i = 0; i < DEA_FILM_EXTREMES; i++) {
    if (places->known[i]) {
      *values[i] = dea_solid_extreme_at(model->solid, model->plies.films, (enum dea_film_extreme)i,
                                        &places->at[i], voltage_V);
    }
  }
  if (asks(model->variant->ask, "capacitance_F")) {
    DEA_TRY(ctx, dea_solid_capacitance(ctx, model->solid, true, &out->capacitance_F));
    out->capacitance_F *= model->copies;
  }
  return DEA_OK;
}

/* Energy without voltage at the unknowns of rest, u [dofs], followers of bodies are moved. Left as
 * it is where no energy is asked for. */
static dea_status find_rest_energy(struct dea_model *model, double *u)
{
  struct dea_solid *s = model->solid;
  double *own = s->state.multiplier;
  if (!asks(model->variant->ask, "energy_J")) {
    return DEA_OK;
  }
  s->state.multiplier = model->rest + s->problem.dofs;
  dea_status status = dea_solid_energy(s, u, 0, &model->at.rest_energy_J);
  s->state.multiplier = own;
  return status;
}

// Devices -----------------------------------------------------------------------------------------

static bool same_hold(const struct dea_layout_support *a, const struct dea_layout_support *b)
{
  return a->region == b->region && a->edge == b->edge && a->within == b->within &&
         a->components == b->components && a->hinged == b->hinged;
}

static bool same_place(const struct dea_layout_body *a, const struct dea_layout_body *b)
{
  return a->region == b->region && a->free == b->free && a->moved == b->moved;
}

/* What is held where, but not how far it is moved. */
static bool same_supports(const struct dea_layout *a, const struct dea_layout *b)
{
  bool same = a->support_count == b->support_count && a->body_count == b->body_count &&
              a->channel_count == b->channel_count;
  for (size_t i = 0; same && i < a->support_count; i++) {
    same = same_hold(&a->supports[i], &b->supports[i]);
  }
  for (size_t i = 0; same && i < a->body_count; i++) {
    same = same_place(&a->bodies[i], &b->bodies[i]);
  }
  return same;
}

/* Whether nodes are held and follow bodies as before: unknowns at which slopes are taken stay. */
static dea_status check_held(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_model *own = &model->variant->own;
  const struct dea_solid_problem *a = &own->solid->problem, *b = &model->solid->problem;
  const bool same =
      a->dofs == b->dofs && memcmp(a->held, b->held, a->dofs) == 0 &&
      memcmp(own->follows, model->follows, model->mesh_node_count * sizeof *model->follows) == 0;
  return same ? DEA_OK
              : dea_fail(ctx, DEA_E_ARGUMENT,
                         "the mesh cannot follow: supports and bodies would hold other nodes");
}

/* Loads stand where a solve would bring them. */
static void place_loads(const struct dea_solid_problem *p)
{
  for (size_t i = 0; i < p->load_count; i++) {
    if (p->loads[i].parameter_count > 0) {
      memcpy(p->loads[i].now, p->loads[i].goal, p->loads[i].parameter_count * sizeof(double));
    }
  }
}

/* What controls have moved has their values, whatever the changed device says of it. */
static void keep_controls(struct dea_model *model)
{
  const struct dea_model *own = &model->variant->own;
  const struct dea_solid *from = own->solid;
  struct dea_solid *to = model->solid;
  for (size_t i = 0; i < model->layout->body_count; i++) {
    for (size_t k = 0; k < 6; k++) {
      const size_t at = 3 * to->problem.bodies[i].node + k;
      if ((own->controls[i].place >> k) & 1) {
        to->problem.held[at] = from->problem.held[at];
        to->state.u_goal[at] = from->state.u_goal[at];
      }
      if ((own->controls[i].force >> k) & 1) {
        model->push[i][k] = own->push[i][k];
      }
    }
    dea_solid_body_load(model, i, model->push[i]);
  }
  for (size_t i = 0; i < to->problem.dofs && own->pull.slope != NULL; i++) {
    dea_solid_force(to)[i] += own->pull.force / own->copies * own->pull.slope[i];
  }
  dea_solid_pressures_set(model, own->pressure_factor);
  place_loads(&to->problem);
}

/* Mesh, part materials and loads of a changed device, with a solid that has them. */
static dea_status build_variant(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_model *own = &model->variant->own;
  DEA_TRY(ctx, dea_solid_model_mesh(ctx, model, &own->mesh));
  if (!same_supports(model->layout, own->layout)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the mesh cannot follow a change of what is held");
  }
  DEA_TRY(ctx, dea_solid_model_assemble(ctx, model));
  DEA_TRY(ctx, dea_solid_dead_loads_set(ctx, model));
  DEA_TRY(ctx, dea_solid_supports_hold(ctx, model, true));
  DEA_TRY(ctx, dea_solid_bodies_load(ctx, model));
  keep_controls(model);
  if (own->indent != NULL) { // in the place of the tip that stands for it
    const struct dea_solid_load tip = dea_contact_load(own->indent->contact);
    DEA_TRY(ctx, dea_solid_add_load(ctx, model->solid, &tip));
  }
  for (size_t i = 0; i < model->layout->pressure_count; i++) {
    if (model->pressures[i] != NULL && own->pressures[i] != NULL) {
      dea_pressure_hold(model->pressures[i], own->pressures[i]);
    }
  }
  for (size_t i = 0; i < model->layout->contact_count; i++) {
    if (model->contacts[i] != NULL && own->contacts[i] != NULL) {
      dea_contact_hold(model->contacts[i], own->contacts[i]);
    }
  }
  return DEA_CHAIN(ctx, check_held(ctx, model));
}

/* Supports and bodies to where the changed device has them: these are no unknowns, which stay. */
static void move_held(struct dea_model_variant *v)
{
  struct dea_solid *s = v->own.solid;
  const size_t dofs = s->problem.dofs;
  for (size_t i = 0; i < dofs; i++) {
    const bool moves = s->problem.held[i] == DEA_PRESCRIBED;
    v->shift[i] = moves ? v->solid->state.u_goal[i] - s->state.u_goal[i] : 0;
  }
  dea_solid_frame_vector(s, true, v->shift);
  memcpy(v->u, s->state.u, dofs * sizeof *v->u);
  dea_add(dofs, 1, v->shift, s->state.u);
  v->is_moved = true;
}

/* A tip that is pressed in holds what it touches, on the device that is there now. */
static dea_status enter_tip(struct dea_context *ctx, struct dea_model *model,
                            const struct dea_pressed *pressed)
{
  struct dea_model_variant *v = model->variant;
  const struct dea_pressed own = {model->indent->probe, model->indent->depth_m};
  DEA_TRY(ctx, dea_indent_create(ctx, &model->mesh, model->solid, pressed != NULL ? pressed : &own,
                                 v->own.indent, &v->indent));
  model->indent = v->indent;
  return DEA_OK;
}

/* Mesh, part materials, and loads of a changed device under the solid. */
static dea_status enter_device(struct dea_context *ctx, struct dea_model *model,
                               const struct dea_device *device)
{
  struct dea_model_variant *v = model->variant;
  struct dea_solid *s = v->own.solid;
  model->device = device;
  model->layout = NULL;
  model->memory = (struct dea_arena){.ctx = ctx};
  model->mesh = (struct dea_layout_mesh){.memory = {.ctx = ctx}};
  model->solid = NULL;
  model->pressures = NULL;
  model->contacts = NULL;
  dea_status status = build_variant(ctx, model);
  v->solid = model->solid;
  model->solid = s;
  DEA_TRY(ctx, status);
  s->problem.grid = v->solid->problem.grid;
  s->problem.part_materials = v->solid->problem.part_materials;
  s->problem.share = v->solid->problem.share;
  s->problem.point_mass = v->solid->problem.point_mass;
  s->problem.loads = v->solid->problem.loads;
  s->problem.load_count = v->solid->problem.load_count;
  memcpy(s->state.force, v->solid->state.force_goal, s->problem.dofs * sizeof *s->state.force);
  for (size_t k = 1; k < model->layout->channel_count; k++) {
    s->state.own_V[k] = model->layout->channels[k].own_V;
  }
  move_held(v);
  return DEA_OK;
}

dea_status dea_variant_enter(struct dea_context *ctx, struct dea_model *model,
                             const struct dea_design_change *change, int side)
{
  const struct dea_device *device = change->device[side];
  if (device == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "there is no device with a number a little beside it");
  }
  DEA_TRY(ctx, device != model->variant->own.device ? enter_device(ctx, model, device) : DEA_OK);
  return DEA_CHAIN(ctx,
                   model->indent != NULL ? enter_tip(ctx, model, change->pressed[side]) : DEA_OK);
}

dea_status dea_variant_hold_tip(struct dea_context *ctx, struct dea_model *model)
{
  return enter_tip(ctx, model, NULL);
}

void dea_variant_leave(struct dea_context *ctx, struct dea_model *model)
{
  struct dea_model_variant *v = model->variant;
  struct dea_solid *s = v->own.solid;
  dea_indent_end_variant(ctx, s, v->own.indent, v->indent);
  v->indent = NULL;
  if (model->device != v->own.device) {
    dea_solid_destroy(ctx, v->solid);
    v->solid = NULL;
    dea_layout_mesh_free(ctx, &model->mesh);
    dea_arena_free(&model->memory);
  }
  *model = v->own;
  s->problem = v->problem;
  if (v->is_moved) {
    memcpy(s->state.u, v->u, s->problem.dofs * sizeof *s->state.u);
    memset(v->shift, 0, s->problem.dofs * sizeof *v->shift);
  }
  v->is_moved = false;
  memcpy(s->state.force, v->force, s->problem.dofs * sizeof *s->state.force);
  memcpy(s->state.own_V, v->own_V, (s->problem.channel_count + 1) * sizeof *s->state.own_V);
}

dea_status dea_variant_slope(struct dea_context *ctx, struct dea_model *model, int column,
                             double *out, double *pressures, bool *known)
{
  const char *key = dea_point_columns[column].key;
  *known = true;
  if (strcmp(key, "highest_z_m") == 0 || strcmp(key, "lowest_z_m") == 0) {
    const struct dea_model_place place =
        dea_solid_model_height(model, strcmp(key, "highest_z_m") == 0 ? 1 : -1);
    out[3 * place.node[0] + 2] += 0.5;
    out[3 * place.node[1] + 2] += 0.5;
  } else if (strcmp(key, "force_N") == 0 && model->indent != NULL) { // the last load
    dea_indent_force_slope(model->indent, dea_solid_displacement(model->solid), out,
                           pressures + dea_solid_pressure_count(model->solid));
  } else if (strcmp(key, "tip_depth_m") == 0) { // of no unknown
    *known = model->indent != NULL;
  } else if (!dea_observer_column_gradient(model->observer, model->solid, column, out)) {
    DEA_TRY(ctx, film_slope(ctx, model, column, out, pressures, known));
  }
  return DEA_OK;
}

bool dea_variant_monitor_slope(const struct dea_model *model, size_t i, double *out,
                               double *direction)
{
  const struct dea_model_variant *v = model->variant;
  return dea_observer_gradient(model->observer, model->solid, v->ask->monitors[i], v->motion[i],
                               out) ||
         dea_observer_force_direction(model->observer, model->solid, v->ask->monitors[i],
                                      v->motion[i], direction);
}

dea_status dea_variant_monitors(struct dea_context *ctx, struct dea_model *model, double *out)
{
  const struct dea_model_variant *v = model->variant;
  struct dea_observation seen;
  DEA_TRY(ctx, dea_observer_read(ctx, model->observer, model->solid, &seen));
  for (size_t i = 0; i < v->ask->monitor_count; i++) {
    out[i] = seen.monitor[v->ask->monitors[i]][v->motion[i]];
  }
  return DEA_OK;
}

/* Pressures and forces that controls have moved as the design has them, which they were at rest, or
 * as they are again. */
static void load_as_at_rest(const struct dea_model *model, bool at_rest)
{
  struct dea_solid *s = model->solid;
  dea_solid_pressures_set(model, at_rest ? 1 : model->pressure_factor);
  place_loads(&s->problem);
  for (size_t i = 0; i < model->layout->body_count; i++) {
    const struct dea_layout_body *body = &model->layout->bodies[i];
    const size_t first = 3 * s->problem.bodies[i].node;
    double own[6];
    memcpy(own, body->force_N, sizeof body->force_N);
    memcpy(own + 3, body->moment_N_m, sizeof body->moment_N_m);
    dea_solid_body_load(model, i, at_rest ? own : model->push[i]);
    for (size_t k = 0; k < 6; k++) {
      if ((model->variant->own.controls[i].force >> k) & 1) {
        s->state.force[first + k] = s->state.force_goal[first + k];
      }
    }
  }
}

dea_status dea_variant_point(struct dea_context *ctx, struct dea_model *model, double voltage_V,
                             double energy_J, struct dea_load_point *out)
{
  const struct dea_model_variant *v = model->variant;
  double *rest = v->rest; // room: followers of bodies are moved
  for (size_t i = 0; i < model->solid->problem.dofs; i++) {
    rest[i] = model->rest[i] + v->shift[i];
  }
  model->at.report.energy_J = energy_J;
  load_as_at_rest(model, true);
  const size_t loads = model->solid->problem.load_count;
  model->solid->problem.load_count -= model->indent != NULL ? 1 : 0; // it is not there at rest
  dea_status status = find_rest_energy(model, rest);
  model->solid->problem.load_count = loads;
  load_as_at_rest(model, false);
  bool kept = model->layout->contact_count == 0; // pressures at rest
  for (size_t i = 0; i < model->layout->pressure_count; i++) {
    kept = kept && model->layout->pressures[i].encloses != DEA_LIQUID;
  }
  model->at.rest_energy_J = kept ? model->at.rest_energy_J : NAN;
  dea_solid_model_describe(model, voltage_V, out);
  status = status == DEA_OK ? film_at(ctx, model, voltage_V, out) : status;
  return status == DEA_OK
             ? DEA_OK
             : dea_fail(ctx, status, "a changed device cannot be evaluated at %g V", voltage_V);
}

/* The motion of each monitor that its slope is of. */
static dea_status find_asked_motions(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_model_variant *v = model->variant;
  struct dea_observation seen;
  if (v->ask->monitor_count > 0) {
    DEA_TRY(ctx, dea_observer_read(ctx, model->observer, model->solid, &seen));
    for (size_t i = 0; i < v->ask->monitor_count; i++) {
      v->motion[i] = v->ask->motions != NULL ? v->ask->motions[i]
                                             : dea_observed_main(seen.monitor[v->ask->monitors[i]]);
    }
  }
  return DEA_OK;
}

dea_status dea_variant_begin(struct dea_context *ctx, struct dea_model *model,
                             const struct dea_gradient_request *ask, struct dea_arena *memory)
{
  struct dea_solid *s = model->solid;
  const struct dea_solid_problem *p = &s->problem;
  struct dea_model_variant *v = model->variant = dea_arena_alloc(memory, 1, sizeof *v);
  double *values = dea_arena_alloc(memory, 4 * p->dofs, sizeof *values);
  double *own_V = dea_arena_alloc(memory, p->channel_count + 1, sizeof *own_V);
  enum dea_observed *motion = dea_arena_alloc(memory, ask->monitor_count + 1, sizeof *motion);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(memory)));
  *v = (struct dea_model_variant){.own = *model,
                                  .problem = *p,
                                  .force = values,
                                  .rest = values + p->dofs,
                                  .u = values + 2 * p->dofs,
                                  .shift = values + 3 * p->dofs,
                                  .own_V = own_V,
                                  .motion = motion,
                                  .ask = ask};
  memcpy(v->force, s->state.force, p->dofs * sizeof *v->force);
  memcpy(v->own_V, s->state.own_V, (p->channel_count + 1) * sizeof *v->own_V);
  find_places(model, &v->places);
  return DEA_CHAIN(ctx, find_asked_motions(ctx, model));
}

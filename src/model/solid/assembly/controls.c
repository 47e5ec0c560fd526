#include "model/solid/assembly/controls.h"

#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/matrix.h"

#include <math.h>
#include <string.h>

static const double rounding = 1e-12; // of a displacement, relative

/* Displacements, without the potentials of a coupled field. */
static size_t move_count(const struct dea_solid *s)
{
  return 3 * s->problem.grid->node_count;
}

static size_t control_count(const struct dea_solid *s)
{
  const struct dea_solid_problem *p = &s->problem;
  size_t count = 1 + p->dofs + move_count(s) + p->channel_count;
  for (size_t i = 0; i < p->load_count; i++) {
    count += p->loads[i].parameter_count;
  }
  return count + (s->state.drop_V != NULL ? p->grid->element_count : 0);
}

static void release(struct dea_load_steps *path)
{
  dea_arena_free(&path->memory);
  *path = (struct dea_load_steps){0};
}

dea_status dea_load_steps_prepare(struct dea_context *ctx, struct dea_solid *s)
{
  struct dea_load_steps *path = &s->work.load_steps;
  size_t states = s->problem.dofs + dea_solid_multiplier_count(s), controls = control_count(s);
  if (path->state_count == states && path->control_count == controls) {
    return DEA_OK;
  }
  release(path); // a load more: what was before is no guide
  path->memory.ctx = ctx;
  dea_solid_alloc_doubles(
      &path->memory, states,
      (double **[]){&path->keep, &path->factored, &path->before_last, &path->last, NULL});
  dea_solid_alloc_doubles(
      &path->memory, controls,
      (double **[]){&path->controls, &path->controls_from, &path->controls_goal, &path->at, NULL});
  if (path->memory.failed) {
    release(path);
    return DEA_E_MEMORY;
  }
  path->state_count = states;
  path->control_count = controls;
  return DEA_OK;
}

void dea_solid_state_get(const struct dea_solid *s, double *state)
{
  const struct dea_solid_problem *p = &s->problem;
  size_t pressures = dea_solid_pressure_count(s);
  memcpy(state, s->state.u, p->dofs * sizeof *state);
  memcpy(state += p->dofs, s->state.multiplier, pressures * sizeof *state);
  state += pressures;
  for (size_t i = 0; i < p->load_count; state += p->loads[i].multiplier_count, i++) {
    if (p->loads[i].multiplier_count > 0) {
      memcpy(state, p->loads[i].multiplier, p->loads[i].multiplier_count * sizeof *state);
    }
  }
}

void dea_solid_state_set(struct dea_solid *s, const double *state)
{
  const struct dea_solid_problem *p = &s->problem;
  size_t pressures = dea_solid_pressure_count(s);
  memcpy(s->state.u, state, p->dofs * sizeof *state);
  memcpy(s->state.multiplier, state += p->dofs, pressures * sizeof *state);
  state += pressures;
  for (size_t i = 0; i < p->load_count; state += p->loads[i].multiplier_count, i++) {
    if (p->loads[i].multiplier_count > 0) {
      memcpy(p->loads[i].multiplier, state, p->loads[i].multiplier_count * sizeof *state);
    }
  }
}

/* Controls from their parts; parameters as they stand, or those that are wanted. */
static void pack(const struct dea_solid *s, double voltage_V, const double *force,
                 const double *place, bool wanted, double *controls)
{
  const struct dea_solid_problem *p = &s->problem;
  *controls++ = voltage_V;
  memcpy(controls, force, p->dofs * sizeof *controls);
  controls += p->dofs;
  for (size_t i = 0; i < move_count(s); i++) {
    *controls++ = p->held[i] && p->held[i] != DEA_FOLLOWS ? place[i] : 0;
  }
  for (size_t k = 1; k <= p->channel_count; k++) {
    *controls++ = wanted ? s->state.own_goal_V[k] : s->state.own_V[k];
  }
  for (size_t i = 0; i < p->load_count; i++) {
    const struct dea_solid_load *load = &p->loads[i];
    for (size_t k = 0; k < load->parameter_count; k++) {
      *controls++ = wanted ? load->goal[k] : load->now[k];
    }
  }
  if (s->state.drop_V != NULL) {
    memcpy(controls, wanted ? s->state.drop_goal_V : s->state.drop_V,
           p->grid->element_count * sizeof *controls);
  }
}

void dea_solid_controls_get(struct dea_solid *s, double *controls)
{
  memcpy(s->work.trial, s->state.u, s->problem.dofs * sizeof(double));
  dea_solid_frame_vector(s, false, s->work.trial);
  pack(s, s->state.voltage_V, s->state.force, s->work.trial, false, controls);
}

void dea_solid_controls_goal(struct dea_solid *s, double voltage_V, double *controls)
{
  memcpy(s->work.trial, s->state.u, s->problem.dofs * sizeof(double));
  dea_solid_frame_vector(s, false, s->work.trial);
  for (size_t i = 0; i < move_count(s); i++) { // what is only held stays where it is
    s->work.trial[i] = s->problem.held[i] == DEA_PRESCRIBED ? s->state.u_goal[i] : s->work.trial[i];
  }
  pack(s, voltage_V, s->state.force_goal, s->work.trial, true, controls);
}

void dea_solid_controls_set(struct dea_solid *s, const double *controls)
{
  const struct dea_solid_problem *p = &s->problem;
  s->state.voltage_V = *controls++;
  memcpy(s->state.force, controls, p->dofs * sizeof *controls);
  controls += p->dofs + move_count(s);
  for (size_t k = 1; k <= p->channel_count; k++) {
    s->state.own_V[k] = *controls++;
  }
  for (size_t i = 0; i < p->load_count; i++) {
    for (size_t k = 0; k < p->loads[i].parameter_count; k++) {
      p->loads[i].now[k] = *controls++;
    }
  }
  if (s->state.drop_V != NULL) {
    memcpy(s->state.drop_V, controls, p->grid->element_count * sizeof *controls);
  }
}

/* How far the node of a component has moved: where its frame is turned, what the component is off
 * by rounding is of that. */
static double moved(const struct dea_solid *s, size_t component)
{
  const double *u = s->state.u + 3 * (component / 3);
  return hypot(hypot(u[0], u[1]), u[2]);
}

bool dea_solid_controls_increment(struct dea_solid *s, const double *controls)
{
  const struct dea_solid_problem *p = &s->problem;
  const double *place = controls + 1 + p->dofs;
  bool any = false;
  memcpy(s->work.increment, s->state.u, p->dofs * sizeof(double));
  dea_solid_frame_vector(s, false, s->work.increment);
  for (size_t i = 0; i < p->dofs; i++) {
    double moved_by = 0;
    if (i < move_count(s) && p->held[i] && p->held[i] != DEA_FOLLOWS) {
      moved_by = place[i] - s->work.increment[i];
      moved_by = fabs(moved_by) > rounding * fmax(fabs(place[i]), moved(s, i)) ? moved_by : 0;
    }
    s->work.increment[i] = moved_by;
    any = any || moved_by != 0;
  }
  dea_solid_frame_vector(s, true, s->work.increment);
  dea_solid_bodies_prepare(s);
  dea_solid_bodies_transfer(s, s->work.increment);
  return any;
}

dea_status dea_solid_save_state(struct dea_context *ctx, struct dea_solid *s,
                                struct dea_solid_saved_state *out)
{
  *out = (struct dea_solid_saved_state){.memory = {.ctx = ctx}};
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_load_steps_prepare(ctx, s)));
  const struct dea_load_steps *steps = &s->work.load_steps;
  out->state = dea_arena_alloc(&out->memory, steps->state_count, sizeof *out->state);
  out->controls = dea_arena_alloc(&out->memory, steps->control_count, sizeof *out->controls);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(&out->memory)));
  dea_solid_state_get(s, out->state);
  dea_solid_controls_get(s, out->controls);
  return DEA_OK;
}

void dea_solid_saved_state_free(struct dea_solid_saved_state *saved)
{
  dea_arena_free(&saved->memory);
}

void dea_solid_restore_state(struct dea_solid *s, const struct dea_solid_saved_state *at)
{
  dea_solid_state_set(s, at->state);
  dea_solid_controls_set(s, at->controls);
  dea_solid_forget(s);
}

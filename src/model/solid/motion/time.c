#include "model/solid/motion/time.h"

#include "model/alpha.h"
#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/channels.h"
#include "model/solid/assembly/controls.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/potential.h"
#include "model/solid/equilibrium/load_steps.h"

#include <math.h>
#include <string.h>

/* What lies between electrodes, by elements of this rank, and of all the sum of charges times
 * voltages. */
struct charged {
  double *voltage_V, *capacitance_F; // [own_count]
  double energy_J;
};

struct dea_solid_time {
  struct dea_arena memory; // of all arrays but those of the accepted state
  struct dea_solid *solid;
  struct dea_internal_variables *variables;
  struct dea_solid_inertia inertia;
  bool inertial, stay;    // stay: of the solid before
  bool open;              // a step has been tried, the solid is not at the accepted state
  bool start, start_next; // acceleration and pressures belong to other forces: after a jump
  struct dea_alpha alpha;
  size_t count;                     // 3 node_count
  double *v, *a, *F;                // at the accepted state; F: all forces but those of inertia
  double *v_next, *a_next, *F_next; // of the step that is tried
  double *first;                    // [count] displacements at the start
  double *u_before;                 // [count] of the state before the accepted one
  double *work;                     // [count]
  double step_s, step_before_s;     // of the step that is tried; of the accepted one, 0: a corner
  struct dea_solid_saved_state accepted;
  struct dea_solid_energies sums, sums_next;
  double first_J; // stored energy at the start
  double capacitance_F, capacitance_next_F;
  bool own, driven;            // channels have voltages of their own; own_first_V is filled
  double *own_V, *own_first_V; // [channels] that are gone to; goals at the start
  size_t channels;             // with ground
  struct charged charged, charged_next;
};

/* ---- forces and stored energy at a state ---- */

/* Forces of everything but inertia at the solid's displacements, supports included. */
static dea_status find_forces(struct dea_context *ctx, struct dea_solid_time *t, double *F)
{
  struct dea_solid *s = t->solid;
  double energy;
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_FORCE, &energy));
  for (size_t i = 0; i < t->count; i++) {
    F[i] = s->work.g[i] + s->found.reaction[i];
  }
  return DEA_OK;
}

/* Gives followers of rigid bodies the forces that hold them in their body, which are what their
 * inertia takes ([count], negative), and takes them from the bodies (docs/theory/bodies.md). */
static void constrain_forces(struct dea_solid_time *t, const double *taken, double *F)
{
  struct dea_solid *s = t->solid;
  if (s->problem.body_count == 0) {
    return;
  }
  for (size_t i = 0; i < t->count; i++) {
    t->work[i] = s->problem.held[i] == DEA_FOLLOWS ? taken[i] : 0;
    F[i] -= t->work[i];
  }
  dea_solid_bodies_prepare(s);
  dea_solid_bodies_collect(s, t->work);
  dea_add(t->count, 1, t->work, F);
}

/* The same at the end of a step that was tried. */
static dea_status constrain_at_end(struct dea_context *ctx, struct dea_solid_time *t)
{
  struct dea_solid_inertia *inertia = &t->inertia;
  if (t->solid->problem.body_count == 0 || !t->inertial || !(t->step_s > 0)) {
    return DEA_OK;
  }
  for (size_t i = 0; i < t->count; i++) {
    inertia->away[i] = t->solid->state.u[i] - inertia->around[i];
  }
  DEA_TRY(ctx, dea_solid_mass_apply(ctx, t->solid, inertia->away, inertia->force));
  for (size_t i = 0; i < t->count; i++) {
    inertia->force[i] = inertia->factor * inertia->force[i] + inertia->constant[i];
  }
  constrain_forces(t, inertia->force, t->F_next);
  return DEA_OK;
}

static dea_status find_charged(struct dea_context *ctx, struct dea_solid *s, struct charged *out)
{
  dea_status status = DEA_OK;
  out->energy_J = 0;
  for (size_t i = 0; i < s->problem.own_count && status == DEA_OK; i++) {
    const size_t e = s->problem.own[i];
    if (s->problem.active[e]) {
      status = dea_solid_element_capacitance(s, e, s->state.u, &out->capacitance_F[i]);
      out->voltage_V[i] = dea_solid_voltage_across(s, e, s->state.voltage_V);
      out->energy_J += out->capacitance_F[i] * out->voltage_V[i] * out->voltage_V[i];
    }
  }
  status = dea_solid_allreduce(ctx, status);
  dea_solid_sum(&out->energy_J, 1);
  return status;
}

/* Work of a source, the integral of V dQ, on a film whose voltage and capacitance go from [0] to
 * [1]: the integral of Q dV is half that of C by V^2, along which C is nearly straight. */
static double source_work(const double voltage_V[2], const double capacitance_F[2])
{
  const double square[2] = {voltage_V[0] * voltage_V[0], voltage_V[1] * voltage_V[1]};
  return capacitance_F[1] * square[1] - capacitance_F[0] * square[0] -
         0.25 * (capacitance_F[0] + capacitance_F[1]) * (square[1] - square[0]);
}

/* Work of the sources from one to the other. */
static double work_between(const struct dea_solid *s, const struct charged *from,
                           const struct charged *to)
{
  double sum = 0;
  for (size_t i = 0; i < s->problem.own_count; i++) {
    const double voltage_V[2] = {from->voltage_V[i], to->voltage_V[i]};
    const double capacitance_F[2] = {from->capacitance_F[i], to->capacitance_F[i]};
    sum += source_work(voltage_V, capacitance_F);
  }
  dea_solid_sum(&sum, 1);
  return sum;
}

/* Elastic and electric energy and that of loads, without what steps add, and capacitance or, with
 * own voltages, what is charged: of films as wide as they are with it, where they wrinkle. */
static dea_status find_stored(struct dea_context *ctx, struct dea_solid_time *t, double *stored,
                              double *capacitance_F, struct charged *charged)
{
  struct dea_solid *s = t->solid;
  double potential = 0, capacitance = 0;
  dea_status status = dea_solid_energy(s, s->state.u, s->state.voltage_V, &potential);
  if (status == DEA_OK) {
    status =
        t->own ? find_charged(ctx, s, charged) : dea_solid_capacitance(ctx, s, false, &capacitance);
  }
  potential -= t->variables != NULL ? dea_internal_variables_energy(t->variables) : 0;
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "the energy of the film cannot be evaluated");
  }
  if (t->own) {
    *stored = potential + charged->energy_J;
    return DEA_OK;
  }
  *capacitance_F = isnan(capacitance) ? 0 : capacitance; // NAN: no electrodes
  *stored = potential + *capacitance_F * s->state.voltage_V * s->state.voltage_V;
  return DEA_OK;
}

/* ---- creation ---- */

static dea_status allocate_time(struct dea_solid_time *t)
{
  dea_solid_alloc_doubles(&t->memory, t->count,
                          (double **[]){&t->v, &t->a, &t->F, &t->v_next, &t->F_next, &t->a_next,
                                        &t->work, &t->u_before, &t->first, &t->inertia.around,
                                        &t->inertia.constant, &t->inertia.away, &t->inertia.force,
                                        NULL});
  if (t->own) {
    t->channels = t->solid->problem.channel_count + 1;
    dea_solid_alloc_doubles(&t->memory, t->channels,
                            (double **[]){&t->own_V, &t->own_first_V, NULL});
    dea_solid_alloc_doubles(&t->memory, t->solid->problem.own_count,
                            (double **[]){&t->charged.voltage_V, &t->charged.capacitance_F,
                                          &t->charged_next.voltage_V,
                                          &t->charged_next.capacitance_F, NULL});
  }
  return dea_arena_status(&t->memory);
}

static dea_status start_time(struct dea_context *ctx, struct dea_solid_time *t,
                             const struct dea_solid_time_options *options)
{
  struct dea_solid *s = t->solid;
  DEA_TRY(ctx, dea_solid_allreduce(ctx, allocate_time(t)));
  if (t->own) {
    memcpy(t->own_V, s->state.own_goal_V, t->channels * sizeof *t->own_V);
    memcpy(t->own_first_V, s->state.own_goal_V, t->channels * sizeof *t->own_V);
    t->driven = true;
  }
  if (options->branches != NULL) {
    DEA_TRY(ctx,
            dea_internal_variables_create(ctx, s, options->branches, &t->memory, &t->variables));
    dea_internal_variables_begin(t->variables, s, 0);
    s->state.internal_variables = t->variables;
  }
  if (t->inertial) {
    DEA_TRY(ctx, dea_solid_mass_apply(ctx, s, s->state.u, t->work)); // from here on it cannot fail
  }
  memcpy(t->first, s->state.u, t->count * sizeof *t->first);
  DEA_TRY(ctx, find_forces(ctx, t, t->F));
  return DEA_CHAIN(ctx, find_stored(ctx, t, &t->first_J, &t->capacitance_F, &t->charged));
}

dea_status dea_solid_time_create(struct dea_context *ctx, struct dea_solid *solid,
                                 const struct dea_solid_time_options *options,
                                 struct dea_solid_time **out)
{
  *out = NULL;
  if (!(options->spectral_radius >= 0 && options->spectral_radius <= 1)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a spectral radius lies between 0 and 1");
  }
  struct dea_solid_time *t = dea_solid_alloc(ctx, 1, sizeof *t);
  DEA_TRY_MEMORY(t != NULL);
  t->memory.ctx = ctx;
  t->solid = solid;
  t->inertial = options->inertia;
  t->own = options->own_voltages;
  t->alpha = dea_alpha_of(options->spectral_radius);
  t->count = 3 * solid->problem.grid->node_count;
  t->stay = solid->settings.accept_unstable;
  solid->settings.accept_unstable = t->stay || t->inertial; // inertia decides where a film goes
  DEA_TRY_ELSE(ctx, start_time(ctx, t, options), dea_solid_time_destroy(ctx, t));
  *out = t;
  return DEA_OK;
}

/* Back to the accepted state. */
static void return_to_accepted(struct dea_solid_time *t)
{
  struct dea_solid *s = t->solid;
  t->open = false;
  s->state.inertia = NULL;
  dea_solid_state_set(s, t->accepted.state);
  dea_solid_controls_set(s, t->accepted.controls);
  s->found.factor_fits = false;
}

void dea_solid_time_destroy(struct dea_context *ctx, struct dea_solid_time *t)
{
  if (t == NULL) {
    return;
  }
  if (t->open) {
    return_to_accepted(t);
  }
  if (t->driven) {
    memcpy(t->solid->state.own_goal_V, t->own_first_V, t->channels * sizeof *t->own_V);
  }
  t->solid->state.internal_variables = NULL;
  t->solid->state.inertia = NULL;
  t->solid->settings.accept_unstable = t->stay;
  t->solid->state.bulk_factor = 1;
  dea_solid_forget(t->solid); // what it has is of the step
  dea_arena_free(&t->memory);
  dea_solid_saved_state_free(&t->accepted);
  dea_free(ctx, t);
}

double *dea_solid_velocity(struct dea_solid_time *time)
{
  return time->v;
}

void dea_solid_time_drive(struct dea_solid_time *time, const double *own_V)
{
  memcpy(time->own_V, own_V, time->channels * sizeof *own_V);
}

/* ---- steps ---- */

/* The accepted state, to come back to. */
static dea_status save_accepted(struct dea_context *ctx, struct dea_solid_time *t)
{
  if (t->open) {
    return_to_accepted(t);
  }
  dea_solid_saved_state_free(&t->accepted);
  DEA_TRY(ctx, dea_solid_save_state(ctx, t->solid, &t->accepted));
  t->open = true;
  return DEA_OK;
}

/* kappa in proportion to the shear modulus that the step has, to the next power of 2: the pressures
 * would follow slowly otherwise where branches are much stiffer than the law. */
static void follow_stiffness(struct dea_solid_time *t)
{
  struct dea_solid *s = t->solid;
  double most = 0;
  for (size_t l = 0; l < s->problem.part_material_count && t->variables != NULL; l++) {
    const struct dea_part_material *part_material = &s->problem.part_materials[l];
    if (part_material->kappa_Pa > 0) {
      most = fmax(most, t->variables->b_Pa[l] / dea_part_material_modulus(part_material));
    }
  }
  double factor = exp2(round(log2(1 + most)));
  if (factor != s->state.bulk_factor) {
    s->state.bulk_factor = factor;
    s->found.factor_fits = false;
  }
}

/* u* and d of generalised-alpha. */
static dea_status set_inertia(struct dea_context *ctx, struct dea_solid_time *t, double h)
{
  const struct dea_alpha *alpha = &t->alpha;
  struct dea_solid_inertia *inertia = &t->inertia;
  const double *u = t->solid->state.u;
  double fraction = alpha->f / (1 - alpha->f), mass = alpha->m / (1 - alpha->f);
  inertia->factor = (1 - alpha->m) / ((1 - alpha->f) * alpha->beta * h * h);
  DEA_TRY(ctx, dea_solid_mass_apply(ctx, t->solid, t->a, t->work));
  for (size_t i = 0; i < t->count; i++) {
    inertia->around[i] = u[i] + h * t->v[i] + h * h * (0.5 - alpha->beta) * t->a[i];
    inertia->constant[i] = mass * t->work[i] + fraction * t->F[i];
  }
  return DEA_OK;
}

/* The minimum of the potential that has been set up; the solid as it was when there is none. own_V:
 * of the channels, where they have voltages of their own. */
static dea_status solve_step(struct dea_context *ctx, struct dea_solid_time *t, double voltage_V,
                             const double *own_V, struct dea_solid_report *report)
{
  struct dea_solid *s = t->solid;
  follow_stiffness(t);
  if (t->own) {
    memcpy(s->state.own_goal_V, own_V, t->channels * sizeof *own_V);
  }
  s->state.inertia = t->inertial ? &t->inertia : NULL;
  dea_status status = dea_load_steps_solve(ctx, s, voltage_V, report);
  s->state.inertia = NULL;
  DEA_TRY_ELSE(ctx, status, return_to_accepted(t));
  return DEA_OK;
}

/* Acceleration and pressures that go with the forces at once: those of a small implicit step, which
 * is then taken back but for them. */
static dea_status find_acceleration(struct dea_context *ctx, struct dea_solid_time *t,
                                    double step_s, struct dea_solid_report *report)
{
  struct dea_solid *s = t->solid;
  struct dea_solid_inertia *inertia = &t->inertia;
  double h = 0.1 * step_s;
  memcpy(inertia->around, s->state.u, t->count * sizeof *s->state.u);
  inertia->factor = 1 / (h * h);
  for (size_t i = 0; i < t->count; i++) {
    inertia->around[i] += h * t->v[i];
    inertia->constant[i] = 0;
  }
  s->found.factor_fits = false;
  DEA_TRY(ctx, solve_step(ctx, t, s->state.voltage_V, s->state.own_V, report));
  for (size_t i = 0; i < t->count; i++) {
    t->a[i] = (s->state.u[i] - inertia->around[i]) / (h * h);
  }
  memcpy(s->state.u, t->accepted.state, s->problem.dofs * sizeof *s->state.u);
  s->found.factor_fits = false;
  DEA_TRY(ctx, dea_solid_solve_potential(ctx, s, s->state.voltage_V, s->state.u));
  DEA_TRY(ctx, find_forces(ctx, t, t->F));
  DEA_TRY(ctx, dea_solid_mass_apply(ctx, s, t->a, inertia->force));
  constrain_forces(t, inertia->force, t->F);
  dea_solid_state_get(s, t->accepted.state); // with its pressures
  return DEA_OK;
}

dea_status dea_solid_time_step(struct dea_context *ctx, struct dea_solid_time *t, double voltage_V,
                               double step_s, struct dea_solid_report *report)
{
  struct dea_solid *s = t->solid;
  double h = step_s;
  DEA_TRY(ctx, save_accepted(ctx, t));
  if (t->variables != NULL) {
    dea_internal_variables_begin(t->variables, s, h);
  }
  DEA_TRY(ctx, t->start ? find_acceleration(ctx, t, h, report) : DEA_OK);
  DEA_TRY(ctx, t->inertial ? set_inertia(ctx, t, h) : DEA_OK);
  t->start_next = false;
  s->found.factor_fits =
      s->found.factor_fits && fabs(log(h / t->step_s)) < 0.5; // at first t->step_s is 0
  t->step_s = h;
  return DEA_CHAIN(ctx, solve_step(ctx, t, voltage_V, t->own_V, report));
}

dea_status dea_solid_time_again(struct dea_context *ctx, struct dea_solid_time *t, double voltage_V,
                                struct dea_solid_report *report)
{
  if (t->inertial && !(t->step_s > 0)) {
    return dea_solid_time_jump(ctx, t, voltage_V, report);
  }
  return DEA_CHAIN(ctx, solve_step(ctx, t, voltage_V, t->own_V, report));
}

void dea_solid_time_reject(struct dea_solid_time *time)
{
  if (time->open) {
    return_to_accepted(time);
  }
}

/* ---- energies, works and error of a step ---- */

double dea_solid_time_charged_J(const struct dea_solid_time *time, bool tried)
{
  return tried ? time->charged_next.energy_J : time->charged.energy_J;
}

/* sums_next at the end of the step that was tried; needs F_next and v_next. */
static dea_status find_energies(struct dea_context *ctx, struct dea_solid_time *t)
{
  struct dea_solid *s = t->solid;
  struct dea_solid_branch_energies branches = {0};
  struct dea_solid_energies *sums = &t->sums_next;
  double stored = 0, work = 0, motion = 0;
  *sums = t->sums;
  if (t->variables != NULL) {
    DEA_TRY(ctx, dea_internal_variables_close(ctx, t->variables, s, &branches));
  }
  DEA_TRY(ctx, find_stored(ctx, t, &stored, &t->capacitance_next_F, &t->charged_next));
  const double voltage_V[2] = {t->accepted.controls[0], s->state.voltage_V};
  const double capacitance_F[2] = {t->capacitance_F, t->capacitance_next_F};
  sums->supply += t->own ? work_between(s, &t->charged, &t->charged_next)
                         : source_work(voltage_V, capacitance_F);
  sums->stored = stored - t->first_J;
  sums->branches = branches.stored;
  sums->dissipated += branches.dissipated;
  for (size_t i = 0; i < t->count; i++) { // of the forces, by the trapezoidal rule
    double part = 0.5 * (t->F[i] + t->F_next[i]) * (s->state.u[i] - t->accepted.state[i]);
    work -= part;
    motion += s->problem.held[i] == DEA_PRESCRIBED ? part : 0;
  }
  sums->motion += motion;
  if (t->inertial) {
    work += motion;
    DEA_TRY(ctx, dea_solid_mass_apply(ctx, s, t->v_next, t->work));
    sums->kinetic = 0;
    for (size_t i = 0; i < t->count; i++) {
      sums->kinetic += 0.5 * t->v_next[i] * t->work[i];
    }
    sums->damped += t->step_s > 0 ? work - (sums->kinetic - t->sums.kinetic) : 0;
  }
  return DEA_OK;
}

/* Share of the stiffness that relaxes within a step, of the part material with most of it. */
static double relaxing(const struct dea_solid_time *t)
{
  double most = 0;
  for (size_t l = 0; l < t->solid->problem.part_material_count && t->variables != NULL; l++) {
    const struct dea_branches *branches = &t->variables->branches[l];
    double sum = 0, all = dea_part_material_modulus(&t->solid->problem.part_materials[l]);
    for (size_t i = 0; i < branches->count; i++) {
      sum -= branches->branch[i].modulus_Pa * expm1(-t->step_s / branches->branch[i].time_s);
      all += branches->branch[i].modulus_Pa;
    }
    most = fmax(most, sum / all);
  }
  return most;
}

/* Estimate of the error of the step that was tried. With inertia that of the acceleration taken as
 * straight (Zienkiewicz, Xie 1991). Without it only the branches have a memory, and what counts is
 * that C^-1 is taken as straight over the step: of what relaxes in it, the difference to the step
 * before drawn on; after a corner, where there is none, to the way gone. */
static double step_error(const struct dea_solid_time *t)
{
  const double *u = t->solid->state.u, *from = t->accepted.state;
  double h = t->step_s, before = t->step_before_s, most = 0, fraction = relaxing(t);
  double weight = before > 0 ? 0.25 * h / (h + before) : 0.125;
  for (size_t i = 0; i < t->count; i++) {
    double way = before > 0 ? h / before * (from[i] - t->u_before[i]) : 0;
    double off = t->inertial ? h * h * (t->a_next[i] - t->a[i]) / 12
                             : fraction * weight * (u[i] - from[i] - way);
    most = fmax(most, fabs(off));
  }
  return most;
}

/* ---- the end of a step ---- */

dea_status dea_solid_time_close(struct dea_context *ctx, struct dea_solid_time *t, double *error_m)
{
  const struct dea_alpha *alpha = &t->alpha;
  double h = t->step_s;
  for (size_t i = 0; i < t->count && t->inertial && h > 0; i++) {
    t->a_next[i] = (t->solid->state.u[i] - t->inertia.around[i]) / (alpha->beta * h * h);
    t->v_next[i] = t->v[i] + h * ((1 - alpha->gamma) * t->a[i] + alpha->gamma * t->a_next[i]);
  }
  // what goes with the state that has been found, so that taking it cannot fail
  dea_status status = find_forces(ctx, t, t->F_next);
  status = status == DEA_OK ? constrain_at_end(ctx, t) : status;
  status = status == DEA_OK ? find_energies(ctx, t) : status;
  DEA_TRY_ELSE(ctx, status, return_to_accepted(t));
  if (error_m != NULL) {
    *error_m = h > 0 ? step_error(t) : 0;
  }
  return DEA_OK;
}

void dea_solid_time_accept(struct dea_solid_time *t)
{
  if (t->variables != NULL) {
    dea_internal_variables_accept(t->variables);
  }
  dea_swap(&t->F, &t->F_next);
  dea_swap(&t->v, &t->v_next);
  dea_swap(&t->a, &t->a_next);
  memcpy(t->u_before, t->accepted.state, t->count * sizeof *t->u_before);
  t->step_before_s = t->step_s;
  t->sums = t->sums_next;
  t->start = t->start_next;
  t->open = false;
  t->capacitance_F = t->capacitance_next_F;
  const struct charged charged = t->charged;
  t->charged = t->charged_next;
  t->charged_next = charged;
}

/* ---- jumps ---- */

/* With inertia the film stays where it is and is accelerated from then on. */
dea_status dea_solid_time_jump(struct dea_context *ctx, struct dea_solid_time *t, double voltage_V,
                               struct dea_solid_report *report)
{
  struct dea_solid *s = t->solid;
  DEA_TRY(ctx, save_accepted(ctx, t));
  t->step_s = 0;
  t->start_next = t->inertial;
  if (t->variables != NULL) {
    dea_internal_variables_begin(t->variables, s, 0);
  }
  if (t->inertial) {
    memcpy(t->v_next, t->v, t->count * sizeof *t->v);
    memcpy(t->a_next, t->a, t->count * sizeof *t->a);
    s->state.voltage_V = voltage_V;
    if (t->own) {
      memcpy(s->state.own_V, t->own_V, t->channels * sizeof *t->own_V);
    }
    DEA_TRY(ctx, dea_solid_solve_potential(ctx, s, voltage_V, s->state.u));
  } else {
    DEA_TRY(ctx, solve_step(ctx, t, voltage_V, t->own_V, report));
  }
  return DEA_OK;
}

struct dea_solid_energies dea_solid_time_energies(const struct dea_solid_time *time, bool tried)
{
  return tried ? time->sums_next : time->sums;
}

double dea_solid_time_motion(const struct dea_solid_time *t)
{
  double most = 0;
  for (size_t i = 0; i < t->count; i++) {
    most = fmax(most, fabs(t->solid->state.u[i] - t->first[i]));
  }
  return most;
}

#include "model/solid/equilibrium/load_steps.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/controls.h"
#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/assembly/potential.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/equilibrium/modified_newton.h"
#include "model/solid/equilibrium/newton.h"
#include "model/solid/equilibrium/presolve_check.h"

#include <math.h>
#include <string.h>

static const double aimed_rate = 0.5;  // of the first step: about ten steps to anderson_rtol
static const double equal_rtol = 1e-6; // of the fall: both sides of a pitchfork

/* ---- from an unstable equilibrium down to a stable one ---- */

/* trial = u + size v, and the energy there; INFINITY where there is none. */
static double energy_beside(struct dea_context *ctx, struct dea_solid *s, const double *u,
                            const double *mode, double size)
{
  double energy;
  memcpy(s->work.trial, u, s->problem.dofs * sizeof *s->work.trial);
  dea_add(3 * s->problem.grid->node_count, size, mode, s->work.trial);
  return dea_solid_solve_potential(ctx, s, s->state.voltage_V, s->work.trial) == DEA_OK &&
                 dea_solid_energy(s, s->work.trial, s->state.voltage_V, &energy) == DEA_OK
             ? energy
             : INFINITY;
}

/* A push along the mode, with its sign, whose largest displacement is `metres` or less where that
 * is needed to go down, and more as long as that goes down further; 0 when no side goes down. */
static double choose_push(struct dea_context *ctx, struct dea_solid *s, const double *u,
                          const double *mode, double metres, int side, double energy)
{
  const double most = dea_largest(3 * s->problem.grid->node_count, mode);
  double push = 0, lowest = energy;
  for (double size = metres / most; push == 0 && size > 1e-4 * metres / most; size /= 2) {
    double up = side >= 0 ? energy_beside(ctx, s, u, mode, size) : INFINITY;
    double down = side <= 0 ? energy_beside(ctx, s, u, mode, -size) : INFINITY;
    lowest = fmin(up, down);
    if (lowest < energy) {
      push = up <= down + equal_rtol * fabs(energy - down) ? size : -size;
    }
  }
  double next = push != 0 ? energy_beside(ctx, s, u, mode, 2 * push) : INFINITY;
  while (next < lowest) {
    lowest = next;
    push *= 2;
    next = energy_beside(ctx, s, u, mode, 2 * push);
  }
  return push;
}

/* Perturbs the solid along its lowest mode [3 node_count] and minimises from there, until no mode
 * is unstable; the energy falls. */
static dea_status descend(struct dea_context *ctx, struct dea_solid *s, int side, double *mode,
                          struct dea_solid_report *report)
{
  const double energy = report->energy_J,
               size_m = s->settings.descent_perturbation * s->problem.length_m;
  for (int k = 0; k < s->settings.descent_max_modes && report->unstable_modes > 0; k++) {
    double value;
    DEA_TRY(ctx, dea_solid_unstable_mode(ctx, s, &value, mode));
    double push =
        choose_push(ctx, s, s->state.u, mode, size_m, k == 0 ? side : 0, report->energy_J);
    if (push == 0) {
      return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the energy falls along no unstable mode");
    }
    energy_beside(ctx, s, s->state.u, mode, push);
    memcpy(s->state.u, s->work.trial, s->problem.dofs * sizeof *s->state.u);
    s->found.factor_fits = false;
    DEA_TRY(ctx, dea_solid_equilibrate(ctx, s, report));
  }
  return report->unstable_modes == 0 && report->energy_J <= energy
             ? DEA_OK
             : dea_fail(ctx, DEA_E_NOT_CONVERGED, "no stable equilibrium below an unstable one");
}

/* At an unstable equilibrium, which *report speaks of; the solid stays there where no stable one is
 * found. */
static dea_status descend_from(struct dea_context *ctx, struct dea_solid *s, int side,
                               struct dea_solid_report *report)
{
  const struct dea_solid_report before = *report;
  struct dea_solid_saved_state from;
  double *mode = dea_solid_alloc(ctx, 3 * s->problem.grid->node_count, sizeof *mode);
  DEA_TRY_MEMORY(mode != NULL);
  dea_status status = dea_solid_save_state(ctx, s, &from);
  if (status == DEA_OK) {
    status = descend(ctx, s, side, mode, report);
    report->snapped |= status == DEA_OK;
    if (status != DEA_OK) {
      dea_solid_restore_state(s, &from);
      *report = before;
    }
  }
  dea_solid_saved_state_free(&from);
  dea_free(ctx, mode);
  return status;
}

dea_status dea_solid_descend_unstable(struct dea_context *ctx, struct dea_solid *s, int side,
                                      struct dea_solid_report *report)
{
  *report = (struct dea_solid_report){.load_factor = 1};
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_load_steps_prepare(ctx, s)));
  DEA_TRY(ctx, dea_solid_equilibrate(ctx, s, report));
  return DEA_CHAIN(ctx, report->unstable_modes > 0 ? descend_from(ctx, s, side, report) : DEA_OK);
}

/* Leaves an unstable equilibrium; where no way down is found it is the answer, and says so by its
 * unstable modes. */
static dea_status descend_if_possible(struct dea_context *ctx, struct dea_solid *s,
                                      struct dea_solid_report *report)
{
  dea_status status = descend_from(ctx, s, 0, report);
  return dea_solid_excuse(ctx, status);
}

/* ---- from a stable equilibrium to another ---- */

/* Equilibrium from the solid's state displaced by push_m. */
static dea_status solve_pushed(struct dea_context *ctx, struct dea_solid *s, const double *push_m,
                               struct dea_solid_report *report)
{
  const struct dea_solid_problem *p = &s->problem;
  memset(s->work.step, 0, p->dofs * sizeof *s->work.step);
  memcpy(s->work.step, push_m, 3 * p->grid->node_count * sizeof *s->work.step);
  dea_solid_release_held(s, s->work.step);
  dea_add(p->dofs, 1, s->work.step, s->state.u);
  s->found.factor_fits = false;
  *report = (struct dea_solid_report){.load_factor = 1};
  return DEA_CHAIN(ctx, dea_solid_equilibrate(ctx, s, report));
}

dea_status dea_solid_perturb(struct dea_context *ctx, struct dea_solid *s, const double *push_m,
                             bool (*accept)(const void *self, const double *displacement_m),
                             const void *self, struct dea_solid_report *report, bool *found)
{
  const struct dea_solid_report before = *report;
  struct dea_solid_saved_state from;
  *found = false;
  DEA_TRY_ELSE(ctx, dea_solid_save_state(ctx, s, &from), dea_solid_saved_state_free(&from));
  dea_status status = solve_pushed(ctx, s, push_m, report);
  if (status == DEA_OK && report->unstable_modes > 0 && accept == NULL) {
    status = descend_if_possible(ctx, s, report);
  }
  *found = status == DEA_OK && report->unstable_modes == 0 &&
           (accept == NULL || accept(self, s->state.u));
  if (!*found) {
    dea_solid_restore_state(s, &from);
    *report = before;
  }
  dea_solid_saved_state_free(&from);
  return dea_solid_excuse(ctx, status);
}

/* ---- to the next voltage and loads ---- */

/* path->at: the controls at a load factor, from 0 at the start to 1 at the goal, to the solid. */
static void set_load_factor(struct dea_solid *s, double load_factor)
{
  struct dea_load_steps *path = &s->work.load_steps;
  const double *from = path->controls_from;
  for (size_t i = 0; i < path->control_count; i++) {
    path->at[i] = load_factor >= 1 ? path->controls_goal[i]
                                   : from[i] + load_factor * (path->controls_goal[i] - from[i]);
  }
  dea_solid_controls_set(s, path->at);
}

/* Whether something that touches the solid is about to move. */
static bool moves_contact(const struct dea_solid *s)
{
  bool moves = false;
  for (size_t k = 0; k < s->problem.load_count; k++) {
    const struct dea_solid_load *load = &s->problem.loads[k];
    for (size_t i = 0; i < load->parameter_count && load->predict != NULL; i++) {
      moves = moves || load->now[i] != load->goal[i];
    }
  }
  return moves;
}

/* The equilibrium at a load factor; the solid stays as it was when it fails. */
static dea_status solve_at_load_factor(struct dea_context *ctx, struct dea_solid *s,
                                       double load_factor, struct dea_solid_report *report)
{
  struct dea_load_steps *path = &s->work.load_steps;
  const double *next = path->at;
  dea_solid_state_get(s, path->keep);
  s->found.factor_fits = s->found.factor_fits && !moves_contact(s); // normals turn with the tip
  set_load_factor(s, load_factor);
  dea_status status = DEA_OK;
  if (dea_solid_controls_increment(s, next)) {
    status = dea_solid_prescribed_increment(ctx, s, report);
  }
  status = status == DEA_OK ? dea_solid_equilibrate(ctx, s, report) : status;
  if (status == DEA_OK && report->unstable_modes > 0 && !s->settings.accept_unstable) {
    status = descend_if_possible(ctx, s, report);
  }
  if (status != DEA_OK) {
    s->found.predicts_tangent = false; // of the whole increment only
    dea_solid_state_set(s, path->keep);
    dea_solid_controls_set(s, path->controls);
    return status;
  }
  memcpy(path->controls, next, path->control_count * sizeof(double));
  return DEA_OK;
}

/* The next part of the increment after one, whose iterations fell by `rate` at first (0: not
 * known), which goes with the part. */
static double next_part(double part, double rate, bool there)
{
  double fraction = rate > 0 ? aimed_rate / rate : there ? 2 : 0.5;
  return part * (there ? fmin(fmax(fraction, 0.5), 2) : fmin(fmax(fraction, 0.125), 0.5));
}

/* With the factor of each point reached, report->load_factor, in steps as long as their rate of
 * convergence allows, until shorter ones converge no faster: from the same point, or to the end.
 * *there: at the last of them is an equilibrium. */
static dea_status follow_on(struct dea_context *ctx, struct dea_solid *s,
                            struct dea_solid_report *report, bool *there)
{
  struct dea_load_steps *path = &s->work.load_steps;
  const double *from = path->controls_from, *goal = path->controls_goal;
  double part = 1, rate = 0, from_here = INFINITY, to_end = INFINITY; // rates over root of part
  bool factor_valid = true;
  path->last_V = path->before_last_V; // no bend of another solve: a state that is kept has none
  bool alone = memcmp(from + 1, goal + 1, (path->control_count - 1) * sizeof *from) == 0;
  while (report->load_factor < 1 && part >= s->settings.anderson_step_min && factor_valid) {
    double load_factor = report->load_factor + part >= 1 - 1e-9 ? 1 : report->load_factor + part;
    part = load_factor - report->load_factor;
    double here_V = alone ? from[0] + report->load_factor * (goal[0] - from[0]) : NAN;
    set_load_factor(s, load_factor);
    DEA_TRY(ctx, dea_solid_follow(ctx, s, here_V, load_factor < 1, report, &rate, there));
    factor_valid =
        (s->found.factor_fits || s->found.stiff_factor_fits) &&
        (*there || rate < sqrt(part) * (load_factor < 1 ? from_here : fmin(from_here, to_end)));
    from_here = *there ? INFINITY : rate / sqrt(part);
    to_end = load_factor < 1 ? to_end : rate / sqrt(part);
    report->load_factor = *there ? load_factor : report->load_factor;
    part = next_part(part, rate, *there);
  }
  set_load_factor(s, report->load_factor);
  *there = report->load_factor == 0 || report->load_factor >= 1;
  factor_valid = s->found.factor_fits || s->found.stiff_factor_fits;
  if (!*there && factor_valid) { // it is only near one
    double here_V = alone ? s->state.voltage_V : NAN;
    DEA_TRY(ctx, dea_solid_follow(ctx, s, here_V, false, report, NULL, there));
  }
  return DEA_OK;
}

/* As far as that goes, to an equilibrium at report->load_factor. */
static dea_status follow_in_steps(struct dea_context *ctx, struct dea_solid *s,
                                  struct dea_solid_report *report)
{
  struct dea_load_steps *path = &s->work.load_steps;
  bool there = false;
  dea_solid_state_get(s, path->keep);
  dea_status status = follow_on(ctx, s, report, &there);
  if (status != DEA_OK || !there) {
    report->load_factor = 0;
    set_load_factor(s, 0);
    dea_solid_state_set(s, path->keep);
    dea_solid_forget(s);
  }
  memcpy(path->controls, path->at, path->control_count * sizeof(double));
  return status;
}

/* In steps that are halved where one fails, down to `least` of the increment, and grow again after.
 */
static dea_status solve_in_steps(struct dea_context *ctx, struct dea_solid *s, double least,
                                 struct dea_solid_report *report)
{
  const struct dea_load_steps *path = &s->work.load_steps;
  bool moves = memcmp(path->controls_from, path->controls_goal,
                      path->control_count * sizeof *path->controls_from) != 0;
  double part = 1;
  if (moves && !dea_solid_controls_increment(s, path->controls_goal)) { // no support moves
    DEA_TRY(ctx, follow_in_steps(ctx, s, report));
    if (report->load_factor >= 1) {
      return DEA_OK;
    }
  }
  for (;;) {
    double load_factor = report->load_factor + part >= 1 - 1e-9 ? 1 : report->load_factor + part;
    dea_status status = solve_at_load_factor(ctx, s, load_factor, report);
    dea_context_counters(ctx)->load_steps += status == DEA_OK;
    dea_context_counters(ctx)->rejected_steps += status != DEA_OK;
    if (status == DEA_OK) {
      report->load_factor = load_factor;
      if (load_factor >= 1) {
        return DEA_OK;
      }
      part = fmin(2 * part, 1);
    } else {
      part /= 2;
      if (!dea_solid_may_shorten(status) || !moves || part < least) {
        return status;
      }
    }
  }
}

dea_status dea_load_steps_solve(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                                struct dea_solid_report *report)
{
  return dea_load_steps_solve_within(ctx, s, voltage_V, s->settings.load_step_min, report);
}

dea_status dea_load_steps_solve_within(struct dea_context *ctx, struct dea_solid *s,
                                       double voltage_V, double least,
                                       struct dea_solid_report *report)
{
  const struct dea_load_steps *path = &s->work.load_steps;
  *report = (struct dea_solid_report){0};
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_load_steps_prepare(ctx, s)));
  dea_solid_controls_goal(s, voltage_V, path->controls_goal);
  return dea_load_steps_solve_to(ctx, s, path->controls_goal, least, report);
}

/* ---- a film that wrinkles ---- */

/* Whether an element is of a film that has no tension somewhere. */
static bool wrinkles(const struct dea_solid *s, size_t e)
{
  static const double none = 1e-12; // of the modulus
  const struct dea_element *element = dea_solid_element(s, e);
  const struct dea_part_material *film = dea_solid_part_material(s, e);
  struct dea_solid_element_input at;
  struct dea_membrane_state state;
  if (!film->relaxed) {
    return false;
  }
  dea_solid_element_input(s, e, s->state.u, s->state.voltage_V, &at);
  bool any = element->type->membrane_state(element, &at.in, &state) != DEA_OK;
  for (int p = 0; !any && p < state.count; p++) {
    any = state.tension[p] <= none * dea_part_material_modulus(film) * film->thickness_m;
  }
  return any;
}

/* Nothing leaves its height: of a body neither shift nor turn. */
static void hold_heights(struct dea_solid *s)
{
  for (size_t n = 0; n < s->problem.grid->node_count; n++) {
    const bool turns = dea_solid_turns_body(s, n);
    for (size_t i = 0; i < 3; i++) {
      unsigned char *held = &s->problem.held[3 * n + i];
      *held = *held == DEA_FREE && (i == 2) != turns ? DEA_HELD : *held;
    }
  }
}

/* Whether forces of compression in the plane meet motions without stiffness: K has next to none of
 * them, and they lead further than the solid is wide. films: those that bear compression. */
static dea_status find_freedom(struct dea_context *ctx, struct dea_solid *s,
                               const struct dea_part_material *films, bool *free)
{
  struct dea_solid_problem *p = &s->problem;
  const struct dea_part_material *own = p->part_materials;
  const size_t nodes = p->grid->node_count;
  double energy;
  *free = true;
  if (!s->found.factor_fits) {
    return DEA_OK;
  }
  p->part_materials = films;
  dea_status status = dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_FORCE, &energy);
  p->part_materials = own;
  DEA_TRY(ctx, status);
  for (size_t k = 0; k < 3 * nodes; k++) {
    s->work.trial[k] = (k % 3 == 2) == dea_solid_turns_body(s, k / 3) ? -s->work.g[k] : 0;
  }
  DEA_TRY(ctx, dea_solid_solve_linear(ctx, s, s->work.trial, s->work.step));
  *free = dea_largest(3 * nodes, s->work.step) > dea_largest(3 * nodes, p->grid->X);
  return DEA_OK;
}

/* The equilibrium in the plane of films that bear compression, then that of the films as they are.
 */
static dea_status relax_width(struct dea_context *ctx, struct dea_solid *s, unsigned char *held,
                              struct dea_part_material *stiff, struct dea_solid_report *report)
{
  struct dea_solid_problem *p = &s->problem;
  const struct dea_part_material *own = p->part_materials;
  const size_t components = 3 * p->grid->node_count;
  struct dea_solid_report flat = {0};
  bool free;
  memcpy(held, p->held, components);
  memcpy(stiff, own, p->part_material_count * sizeof *stiff);
  for (size_t i = 0; i < p->part_material_count; i++) {
    stiff[i].relaxed = false;
  }
  DEA_TRY(ctx, find_freedom(ctx, s, stiff, &free));
  if (!free) {
    return DEA_OK;
  }
  p->part_materials = stiff;
  hold_heights(s);
  dea_solid_forget(s);
  dea_status status = dea_solid_equilibrate(ctx, s, &flat);
  p->part_materials = own;
  memcpy(p->held, held, components);
  dea_solid_forget(s);
  return status == DEA_OK ? dea_solid_equilibrate(ctx, s, report) : status;
}

/* Which of the equilibria of a film that wrinkles is taken (docs/theory/membrane.md, "Free edges"):
 * the one that it has after it has spread in its plane as if it could not wrinkle. Nothing to do
 * for one that is in tension all over, for a solid without relaxed films and with inertia; where
 * no such equilibrium is found the solid stays where it was. */
static dea_status spread_film(struct dea_context *ctx, struct dea_solid *s,
                              struct dea_solid_report *report)
{
  const struct dea_solid_problem *p = &s->problem;
  struct dea_load_steps *path = &s->work.load_steps;
  struct dea_solid_report after = *report;
  bool any = false;
  for (size_t k = 0; k < p->own_count && s->state.inertia == NULL && !any; k++) {
    any = wrinkles(s, p->own[k]);
  }
  if (!dea_solid_allreduce_any(any)) {
    return DEA_OK;
  }
  struct dea_part_material *stiff = dea_solid_alloc(ctx, p->part_material_count, sizeof *stiff);
  unsigned char *held = dea_solid_alloc(ctx, 3 * p->grid->node_count, sizeof *held);
  dea_status status = stiff != NULL && held != NULL ? DEA_OK : DEA_E_MEMORY;
  dea_solid_state_get(s, path->keep);
  status = status == DEA_OK ? relax_width(ctx, s, held, stiff, &after) : status;
  if (status == DEA_OK) {
    *report = after;
  } else if (dea_solid_may_shorten(status)) {
    dea_context_clear(ctx);
    dea_solid_state_set(s, path->keep);
    status = DEA_OK;
  }
  s->found.predicts_tangent = s->found.extrapolated = false;
  path->last_V = path->before_last_V; // the path has a bend of another kind
  dea_free(ctx, stiff);
  dea_free(ctx, held);
  return DEA_CHAIN(ctx, status);
}

dea_status dea_load_steps_solve_to(struct dea_context *ctx, struct dea_solid *s, const double *goal,
                                   double least, struct dea_solid_report *report)
{
  struct dea_load_steps *path = &s->work.load_steps;
  const size_t size = path->control_count * sizeof(double);
  *report = (struct dea_solid_report){0};
  DEA_TRY(ctx, dea_solid_check(ctx, s));
  dea_solid_controls_get(s, path->controls);
  memmove(path->controls_goal, goal, size);
  memcpy(path->controls_from, path->controls, size);
  DEA_TRY(ctx, solve_in_steps(ctx, s, least, report));
  return spread_film(ctx, s, report);
}

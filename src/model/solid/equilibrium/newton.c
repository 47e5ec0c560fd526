#include "model/solid/equilibrium/newton.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/assembly/potential.h"
#include "model/solid/equilibrium/shift.h"

#include <math.h>
#include <string.h>

static const double divergence_rtol = 0.3; // of the sum of element forces: none balances another
enum { MAX_STALLED = 3 };           // shifted steps in a row that are shorter than newton_stol
static const double lag_rate = 0.2; // of the residual before: an old factor is good enough
static const double max_rise = 20;  // of the slope: along a curved valley linear steps go up
static const double pair_residual = 0.03; // of the sum of element forces: back in the valley
enum { MAX_SHIFTS = 40 };                 // attempts to make the tangent positive definite
static const double min_shift = 3e-5;     // of the softest modulus; below there is none
static const double shift_growth = 4;     // after a step that was cut
static const double shift_decay = 10;     // after a good step, its square after a quadratic one
static const double shift_margin = 2;   // of the lowest eigenvalue: as far above 0 as it was below
static const double descent_end = 1e-3; // of theta and residual, where kappa is its own again

/* A shifted step that went up, out of the valley, and the next one, back into it. */
struct pair {
  int steps;       // of them taken in a row; 0: none
  double shift_Pa; // of the first
  double energy_J; // before it
  double fraction, rise;
};

struct newton {
  double voltage_V;
  double shift_Pa;
  double norm_before; // of g at the last iterate
  bool chord;         // the next step takes the factor that is there
  bool start;         // it is that of the last equilibrium: the tangent of the path
  bool strict;        // the energy falls at fixed pressures
  int chords;         // in a row
  int unresolved;     // steps in a row whose change of the energy rounding hides
  int lost;           // iterates in a row whose forces are far out of balance
  int stalled;        // shifted steps in a row that are too small to matter
  double softness;    // kappa over its own
  struct pair pair;
  struct dea_solid_report *report;
};

static double norm(const struct dea_solid *s, const double *v)
{
  return sqrt(dea_solid_dot(s, v, v));
}

/* ---- linear steps ---- */

enum { SOME = 5, MANY = 20 }; // negative pivots

/* The next shift after one with which K has `negative` pivots: so that the lowest eigenvalue by L
 * is as far above 0 as it is below, where it can be found; otherwise by how many there are. *L:
 * what K is shifted by, made when it is first needed. */
static dea_status raise_shift(struct dea_context *ctx, struct dea_solid *s, struct newton *d,
                              double there, int negative, Mat *L)
{
  const struct dea_solid_settings *o = &s->settings;
  double lowest_Pa = 0, more = shift_growth * (negative > MANY ? 16 : negative > SOME ? 4 : 1);
  d->shift_Pa = there > 0 ? more * there : o->shift_initial * s->problem.modulus_Pa;
  if (negative > o->shift_max_modes) {
    return DEA_OK;
  }
  DEA_TRY(ctx, *L == NULL ? dea_solid_create_laplace(ctx, s, L) : DEA_OK);
  DEA_TRY(ctx, dea_solid_lowest_by_laplace(ctx, s, *L, negative, &lowest_Pa));
  if (lowest_Pa < 0) {
    d->shift_Pa = there - shift_margin * lowest_Pa;
  }
  return DEA_OK;
}

/* factorise_definite with *L. */
static dea_status search_definite(struct dea_context *ctx, struct dea_solid *s, struct newton *d,
                                  double *there, Mat *L)
{
  const int most = s->settings.shift_max_modes > MANY ? s->settings.shift_max_modes : MANY;
  for (int i = 0; i < MAX_SHIFTS; i++) {
    int negative;
    double more_Pa = d->shift_Pa - *there;
    if (more_Pa != 0 && *L != NULL) {
      DEA_TRY(ctx, dea_solid_add_matrix(ctx, s->work.K, more_Pa, *L));
    } else if (more_Pa != 0) {
      DEA_TRY(ctx, dea_solid_add_laplace(ctx, s, s->work.K, more_Pa));
    }
    *there = d->shift_Pa;
    DEA_TRY(ctx, dea_solid_factorise(ctx, s, most, &negative));
    d->report->factorisations++;
    d->report->shifted += *there > 0;
    if (*there == 0) {
      d->report->unstable_modes = negative;
    }
    if (negative <= 0) {
      return DEA_OK;
    }
    DEA_TRY(ctx, raise_shift(ctx, s, d, *there, negative, L));
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no shift makes the tangent positive definite");
}

/* Factor of K, shifted by d->shift_Pa or as much more as makes it positive definite. *there: the
 * shift that K has; the count of unstable modes is set when that is none. */
static dea_status factorise_definite(struct dea_context *ctx, struct dea_solid *s, struct newton *d,
                                     double *there)
{
  Mat L = NULL;
  dea_status status = search_definite(ctx, s, d, there, &L);
  MatDestroy(&L);
  return DEA_CHAIN(ctx, status);
}

dea_status dea_solid_linear_step(struct dea_context *ctx, struct dea_solid *s)
{
  for (size_t k = 0; k < s->problem.dofs; k++) {
    s->work.trial[k] = -s->work.g[k];
  }
  return DEA_CHAIN(ctx, dea_solid_solve_linear(ctx, s, s->work.trial, s->work.step));
}

/* A force over the sum of element forces, where that is known. */
static double over_scale(const struct dea_solid *s, double force_N)
{
  return force_N / (s->found.force_scale_N > 0 ? s->found.force_scale_N : 1);
}

double dea_solid_residual(const struct dea_solid *s)
{
  return over_scale(s, norm(s, s->work.g));
}

void dea_solid_predict_tangent(struct dea_solid *s, const double *step)
{
  if (s->found.predicts_tangent && step != NULL) {
    memcpy(s->work.extrapolated, step, s->problem.dofs * sizeof *step);
    s->found.extrapolated = true;
  }
  s->found.predicts_tangent = false;
}

/* ---- line search ---- */

bool dea_solid_resolved(const struct dea_solid *s, double change)
{
  return fabs(change) >
         s->settings.energy_rtol * s->found.energy_scale_J + s->problem.energy_floor_J;
}

/* The longest fraction of the step that the energy lets pass, into work.trial. *rise: of the energy
 * over the slope's size there, -1/2 where the energy is quadratic. false: none. */
static bool search_line(struct dea_context *ctx, struct dea_solid *s, const struct newton *d,
                        double slope, double *fraction, double *rise)
{
  const struct dea_solid_settings *o = &s->settings;
  double energy = d->report->energy_J, allowed = d->strict ? -o->linesearch_alpha : max_rise, at;
  *rise = -0.5;
  *fraction = 1;
  for (int i = 0; i < o->linesearch_max_iterations; i++, *fraction /= 2) {
    for (size_t k = 0; k < s->problem.dofs; k++) {
      s->work.trial[k] = s->state.u[k] + *fraction * s->work.step[k];
    }
    if (dea_solid_solve_potential(ctx, s, d->voltage_V, s->work.trial) == DEA_OK &&
        dea_solid_energy(s, s->work.trial, d->voltage_V, &at) == DEA_OK) {
      if (!dea_solid_resolved(s, slope)) {
        return true;
      }
      *rise = (at - energy) / (*fraction * fabs(slope));
      if (*rise <= allowed) {
        return true;
      }
    }
  }
  return false;
}

/* None where it is too small to matter. */
static void set_shift(const struct dea_solid *s, struct newton *d, double shift_Pa)
{
  d->shift_Pa = shift_Pa < min_shift * s->problem.modulus_Pa ? 0 : shift_Pa;
}

/* The shift of the next step from how this one went. A whole step up by less than its slope leaves
 * the floor of the valley, to which the next one returns: its shift was more than enough. */
static void adapt_shift(const struct dea_solid *s, struct newton *d, double fraction, double rise)
{
  double shift_Pa = d->shift_Pa;
  const struct dea_solid_settings *o = &s->settings;
  if (fraction < 1 || rise > 0) {
    shift_Pa = shift_Pa > 0
                   ? shift_Pa * (fraction < 0.2 ? shift_growth * shift_growth : shift_growth)
                   : o->shift_initial * s->problem.modulus_Pa;
  } else if (rise < -0.25) {
    shift_Pa /= fabs(rise + 0.5) < 0.05 ? shift_decay * shift_decay : shift_decay;
  }
  set_shift(s, d, shift_Pa);
}

/* Whether a step from there, with that shift, is one of a pair. */
static void begin_pair(struct newton *d, double shift_Pa, double fraction, double rise)
{
  if (rise > 0 && shift_Pa > 0 && !d->strict) {
    d->pair = (struct pair){1, shift_Pa, d->report->energy_J, fraction, rise};
  } else {
    d->pair.steps = d->pair.steps == 1 ? 2 : 0;
  }
}

/* The shift after both steps of a pair that have come back into the valley, from that of the first:
 * the second, quadratic as it may be, says nothing of the valley. */
static void end_pair(const struct dea_solid *s, struct newton *d)
{
  const struct pair *p = &d->pair;
  d->pair.steps = 0;
  if (d->report->residual <= pair_residual) {
    const double down = p->fraction < 1 || p->rise > 5 ? 1 : p->rise < 1 ? 8 : 2;
    set_shift(s, d,
              d->report->energy_J > p->energy_J ? shift_growth * p->shift_Pa : p->shift_Pa / down);
  }
}

/* ---- stresses and pressures at the end of a step ---- */

/* One element: predicted stresses into their place, pressures into theta, which is free here. */
static dea_status predict_element(struct dea_solid *s, size_t k, double voltage_V,
                                  const double *step, double fraction, bool stresses)
{
  const struct dea_solid_problem *p = &s->problem;
  size_t e = p->own[k], pressures = (size_t)p->elements.pressures;
  const struct dea_element *element = dea_solid_element(s, e);
  struct dea_solid_element_input at;
  double element_step[DEA_HEX_DOFS_MAX], *out = s->work.predicted + k * p->elements.predicted_count;
  dea_solid_element_input(s, e, s->state.u, voltage_V, &at);
  dea_solid_gather(s, e, step, element_step);
  dea_status status =
      element->type->predict(element, &at.in, element_step, fraction, stresses, out);
  memcpy(s->state.theta + e * pressures, out, (size_t)element->pressures * sizeof *out);
  return status;
}

dea_status dea_solid_predict(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                             const double *step, double fraction, bool stresses, bool pressures)
{
  const struct dea_solid_problem *p = &s->problem;
  size_t count = dea_solid_pressure_count(s);
  dea_status status = DEA_OK;
  stresses = stresses && p->field == NULL;
  memset(s->state.theta, 0, count * sizeof *s->state.theta);
  for (size_t k = 0; k < p->own_count && status == DEA_OK; k++) {
    if (dea_solid_element(s, p->own[k])->type->predict != NULL) {
      status = predict_element(s, k, voltage_V, step, fraction, stresses);
    }
  }
  s->found.predicted_fits = false;
  status = dea_solid_allreduce(ctx, status);
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "the stresses at the end of a step cannot be had");
  }
  s->found.predicted_fits = stresses;
  if (pressures) {
    dea_solid_sum(s->state.theta, count);
    memcpy(s->state.multiplier, s->state.theta, count * sizeof *s->state.multiplier);
  }
  return DEA_OK;
}

/* ---- one minimum ---- */

/* kappa over its own from now on. Another one has steps of its own before rounding hides them. */
static void soften(struct dea_solid *s, struct newton *d, double softness)
{
  d->unresolved = softness == d->softness ? d->unresolved : 0;
  s->state.bulk_factor *= softness / d->softness;
  d->softness = softness;
}

/* On the way down kappa is soft, and the valley wide (docs/theory/branches.md); where an unshifted
 * step has left little of the volume and of the forces it is its own again. */
static void choose_softness(struct dea_solid *s, struct newton *d, bool soft)
{
  const struct dea_solid_settings *o = &s->settings;
  bool near =
      d->shift_Pa == 0 && d->report->theta_max < descent_end && d->report->residual < descent_end;
  if (!d->chord && s->problem.elements.pressures > 0) {
    soften(s, d,
           soft && !near && d->shift_Pa <= s->problem.modulus_Pa ? o->descent_bulk_factor : 1);
  }
}

/* Takes the fraction of the step, with the stresses and the pressures that go with it. */
static dea_status apply_step(struct dea_context *ctx, struct dea_solid *s, const struct newton *d,
                             double fraction, bool stresses)
{
  bool pressures = d->shift_Pa <= s->problem.modulus_Pa;
  if (!d->strict) {
    DEA_TRY(ctx,
            dea_solid_predict(ctx, s, d->voltage_V, s->work.step, fraction, stresses, pressures));
  }
  for (size_t k = 0; k < s->problem.load_count && pressures && !d->strict; k++) {
    const struct dea_solid_load *load = &s->problem.loads[k];
    if (load->predict != NULL) {
      load->predict(load->self, s->state.u, s->work.step, fraction);
    }
  }
  memcpy(s->state.u, s->work.trial, s->problem.dofs * sizeof *s->state.u);
  return DEA_OK;
}

/* A step with the factor that is there, close to the equilibrium. */
static dea_status chord_step(struct dea_context *ctx, struct dea_solid *s, struct newton *d)
{
  DEA_TRY(ctx, dea_solid_linear_step(ctx, s));
  for (size_t k = 0; k < s->problem.dofs; k++) {
    s->work.trial[k] = s->state.u[k] + s->work.step[k];
  }
  dea_status status = dea_solid_solve_potential(ctx, s, d->voltage_V, s->work.trial);
  double energy;
  status = status == DEA_OK ? dea_solid_energy(s, s->work.trial, d->voltage_V, &energy) : status;
  if (status != DEA_OK) { // too far: the next step has a tangent of its own
    d->chord = false;
    return DEA_OK;
  }
  d->chords++;
  dea_context_counters(ctx)->newton_iterations++;
  return apply_step(ctx, s, d, 1, false);
}

/* A step with the tangent at hand, or from the last equilibrium along the tangent of its path.
 * *done: the step is too small to matter. */
static dea_status newton_step(struct dea_context *ctx, struct dea_solid *s, struct newton *d,
                              bool *done)
{
  const struct dea_solid_settings *o = &s->settings;
  double there = 0, fraction, rise;
  bool start = d->start;
  d->start = d->chord = *done = false;
  for (int i = 0; i < MAX_SHIFTS; i++) {
    if (!start) {
      DEA_TRY(ctx, factorise_definite(ctx, s, d, &there));
      d->report->iterations++;
    }
    DEA_TRY(ctx, dea_solid_linear_step(ctx, s));
    dea_solid_predict_tangent(s, there == 0 ? s->work.step : NULL);
    double slope = dea_solid_dot(s, s->work.g, s->work.step);
    bool found = search_line(ctx, s, d, slope, &fraction, &rise);
    dea_context_counters(ctx)->line_searches += !found || fraction < 1;
    if (found) {
      dea_context_counters(ctx)->newton_iterations++;
      bool quadratic = fabs(rise + 0.5) < 0.05 && fraction == 1;
      const double moved_m = dea_largest(s->problem.dofs, s->work.step),
                   least_m = o->newton_stol * s->problem.length_m;
      *done = !start && there == 0 && moved_m < least_m;
      d->stalled = there > 0 && fraction * moved_m < least_m ? d->stalled + 1 : 0;
      d->unresolved = there == 0 && !start && !dea_solid_resolved(s, slope) ? d->unresolved + 1 : 0;
      DEA_TRY(ctx, apply_step(ctx, s, d, fraction, !*done));
      if (start) {
        return DEA_OK;
      }
      begin_pair(d, there, fraction, rise);
      adapt_shift(s, d, fraction, rise);
      d->chords = 0;
      d->chord = quadratic && there == 0 && d->softness == 1;
      return DEA_OK;
    }
    if (start) {
      return DEA_OK; // the next step has a tangent of its own
    }
    d->shift_Pa = d->shift_Pa > 0 ? 16 * d->shift_Pa : o->shift_initial * s->problem.modulus_Pa;
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the line search found no lower energy");
}

/* Energy, forces and, where the next step needs one, the tangent at u. */
static dea_status evaluate(struct dea_context *ctx, struct dea_solid *s, struct newton *d)
{
  const struct dea_solid_settings *o = &s->settings;
  struct dea_solid_report *report = d->report;
  bool chord = d->chord || d->start;
  bool plain = d->strict || s->problem.field != NULL; // as predicted stresses
  enum dea_eval_order tangent = plain ? DEA_TANGENT : DEA_TANGENT_PREDICTED;
  DEA_TRY(ctx,
          dea_solid_assemble(ctx, s, d->voltage_V, chord ? DEA_FORCE : tangent, &report->energy_J));
  double size = norm(s, s->work.g);
  report->residual = over_scale(s, size);
  report->theta_max = dea_solid_theta_max(s);
  if (d->chord && (d->chords == o->lag_jacobian || !(size < lag_rate * d->norm_before)) &&
      !(report->residual < o->newton_rtol)) {
    d->chord = false;
    DEA_TRY(ctx, dea_solid_assemble(ctx, s, d->voltage_V, tangent, &report->energy_J));
  }
  d->norm_before = size;
  if (d->pair.steps == 2) {
    end_pair(s, d);
  }
  return DEA_OK;
}

dea_status dea_solid_count_unstable(struct dea_context *ctx, struct dea_solid *s, bool tangent,
                                    struct dea_solid_report *report)
{
  s->found.factor_fits = s->found.predicted_fits = s->found.factor_before = false;
  if (!tangent) {
    DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_TANGENT, &report->energy_J));
  }
  dea_solid_keep_scales(s);
  DEA_TRY(ctx, dea_solid_factorise(ctx, s, 0, &report->unstable_modes));
  report->factorisations++;
  s->found.factor_fits = report->unstable_modes == 0;
  if (!s->found.factor_fits) { // of a solid that kappa leaves a little compressible
    DEA_TRY(ctx, dea_solid_factor_stiff(ctx, s, &report->unstable_modes));
    report->factorisations++;
    s->found.stiff_factor_fits = report->unstable_modes == 0;
  }
  return DEA_OK;
}

/* Whether iterations lead to no equilibrium any more (docs/theory/branches.md): the forces stay as
 * large as those of the elements, of which none holds another one's balance, or the energy falls
 * along no step that is longer than rounding. */
static dea_status check_divergence(struct dea_context *ctx, const struct dea_solid *s,
                                   struct newton *d)
{
  const int most = s->settings.max_divergent;
  d->lost = d->report->residual > divergence_rtol ? d->lost + 1 : 0;
  if (most > 0 && d->lost >= most) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED,
                    "no equilibrium is near: %d iterations in a row are out of balance (residual "
                    "%.1e)",
                    d->lost, d->report->residual);
  }
  return d->stalled < MAX_STALLED
             ? DEA_OK
             : dea_fail(ctx, DEA_E_NOT_CONVERGED, "no step lowers the energy (residual %.1e)",
                        d->report->residual);
}

/* At the equilibrium, with kappa's own value. tangent: K is there, but for that. */
static dea_status count_there(struct dea_context *ctx, struct dea_solid *s, struct newton *d,
                              bool tangent)
{
  tangent = tangent && d->softness == 1;
  soften(s, d, 1);
  return dea_solid_count_unstable(ctx, s, tangent, d->report);
}

static dea_status descend(struct dea_context *ctx, struct dea_solid *s, struct newton *d, bool soft)
{
  const struct dea_solid_settings *o = &s->settings;
  struct dea_solid_report *report = d->report;
  for (int i = 0; i < o->newton_max_iterations; i++) {
    bool done = false;
    DEA_TRY(ctx, dea_solid_check_interruption(ctx));
    if (i == o->newton_max_nonmonotone) {
      d->strict = true;
      d->chord = s->found.predicted_fits = false;
    }
    if (i > 0) {
      choose_softness(s, d, soft && 2 * i < o->newton_max_nonmonotone);
    }
    DEA_TRY(ctx, evaluate(ctx, s, d));
    bool settled_volume = d->strict || report->theta_max < o->volume_tol;
    if (i > 0 && settled_volume && (report->residual < o->newton_rtol || d->unresolved > 2)) {
      return count_there(ctx, s, d, !d->chord && d->shift_Pa == 0 && !s->found.predicted_fits);
    }
    DEA_TRY(ctx, check_divergence(ctx, s, d));
    if (d->chord) {
      DEA_TRY(ctx, chord_step(ctx, s, d));
    } else {
      DEA_TRY(ctx, newton_step(ctx, s, d, &done));
    }
    if (done && settled_volume) {
      return count_there(ctx, s, d, false);
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no equilibrium after %d iterations (residual %.1e)",
                  o->newton_max_iterations, report->residual);
}

dea_status dea_solid_minimise(struct dea_context *ctx, struct dea_solid *s, bool soft,
                              struct dea_solid_report *report)
{
  double voltage_V = s->state.voltage_V;
  struct newton d = {
      .voltage_V = voltage_V, .start = s->found.factor_fits, .softness = 1, .report = report};
  s->found.factor_fits = false;
  dea_status status = dea_solid_solve_potential(ctx, s, voltage_V, s->state.u);
  status = status == DEA_OK ? descend(ctx, s, &d, soft) : status;
  soften(s, &d, 1);
  return status;
}

/* ---- held components that move ---- */

dea_status dea_solid_prescribed_increment(struct dea_context *ctx, struct dea_solid *s,
                                          struct dea_solid_report *report)
{
  struct newton d = {.voltage_V = s->state.voltage_V, .report = report};
  double energy, there = 0;
  s->found.factor_fits = s->found.predicted_fits = false;
  DEA_TRY(ctx, dea_solid_solve_potential(ctx, s, s->state.voltage_V, s->state.u));
  s->work.takes_increment = true;
  dea_status status = dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_TANGENT, &energy);
  s->work.takes_increment = false;
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, factorise_definite(ctx, s, &d, &there));
  DEA_TRY(ctx, dea_solid_linear_step(ctx, s));
  // where the whole of the linear step leads too far the held components go their way all the same
  for (double length = 1; length > 0.1; length /= 2) {
    for (size_t i = 0; i < s->problem.dofs; i++) {
      s->work.trial[i] = s->state.u[i] + s->work.increment[i] + length * s->work.step[i];
    }
    if (dea_solid_energy(s, s->work.trial, s->state.voltage_V, &energy) == DEA_OK) {
      for (size_t i = 0; i < s->problem.dofs; i++) {
        s->work.step[i] = s->work.trial[i] - s->state.u[i];
      }
      dea_solid_predict_tangent(s, length == 1 ? s->work.step : NULL);
      return apply_step(ctx, s, &d, 1, true);
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the prescribed displacements invert an element");
}

/* ---- multipliers ---- */

double dea_solid_update_loads(struct dea_solid *s)
{
  const struct dea_solid_problem *p = &s->problem;
  double error = 0;
  for (size_t k = 0; k < p->load_count; k++) {
    if (p->loads[k].update != NULL) {
      error = fmax(error, p->loads[k].update(p->loads[k].self, s->state.u));
    }
  }
  return error;
}

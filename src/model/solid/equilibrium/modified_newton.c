#include "model/solid/equilibrium/modified_newton.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/constraints.h"
#include "model/solid/assembly/controls.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/equilibrium/newton.h"

#include <lapacke.h>
#include <math.h>
#include <string.h>

static const double max_rate = 0.6;           // of the first step: slower ones do not pay
static const double intermediate_rtol = 1e-3; // of the first step: enough for one further on
static const double max_curvature = 0.1;      // of the first step
static const double max_extrapolation = 3;    // of the step before

/* Newton's method on displacements u and pressures q = p + kappa theta with the tangent of the
 * start kept:
 *
 *   A0 du + B0 dq = -r(u, q),   B0^T du - dq / kappa = -theta(u)
 *
 * in which dq is eliminated, so that K0 = A0 + kappa B0 B0^T is the factor that is there:
 *
 *   K0 du = -(r + kappa B0 theta),   dq = kappa (theta + B0^T du).
 *
 * B0 is that of the start on both sides: with that of where the solid is, kappa (B - B0) theta
 * would be a force on what only shears, kappa/mu times too large. Steps f = (du, dq) are mixed by
 * Anderson's rule. Multipliers of loads (a contact's pressures) are brought up to date between
 * steps. */

enum { DEPTH = 6 };                   // steps that are remembered
static const double compliance = 100; // of a pressure, in 1/kappa

struct follow {
  struct dea_arena memory; // of the arrays
  struct dea_solid *s;
  struct dea_solid_report *report;
  size_t dofs, pressures, count;      // of u, of q, of both
  double *keep, *first;               // [states] state, [count] u and q at the start
  struct dea_constraints constraints; // there
  double *weight;                     // [pressures] dq weight dq is an energy
  double *theta, *nu;                 // [pressures] of this iteration; work
  double *x, *f, *h;                  // [count], [count], [dofs] of this iteration; h = -K0 du
  double *x_old, *f_old, *h_old;      // of the one before
  double *dx[DEPTH], *df[DEPTH];      // [count] differences between iterations, newest first
  double *dh[DEPTH];                  // [dofs]
  double gram[DEPTH][DEPTH];          // products of df[i] and df[j] by K0
  int depth;                          // of them that there are
  double rate;                        // size of the second f over that of the first
  double size_first, size;            // of f, at first and now
  double size_renewed;                // when the loads were last brought up to date; or at first
  int renewed;                        // iteration of that
  double accuracy;                    // of the last f over the first
  double load_error;                  // of the loads' multipliers, at most 1: they have followed
  bool equilibrium;                   // forces and theta are to be those of one
  double from_V;                      // voltage at the start; NAN: not only that has changed
  double stiff;                       // kappa of the factor over that of the solid
};

static dea_status allocate(struct follow *w)
{
  dea_solid_alloc_doubles(&w->memory, w->s->work.load_steps.state_count,
                          (double **[]){&w->keep, NULL});
  dea_solid_alloc_doubles(&w->memory, w->count,
                          (double **[]){&w->first, &w->x, &w->f, &w->x_old, &w->f_old, NULL});
  dea_solid_alloc_doubles(&w->memory, w->dofs, (double **[]){&w->h, &w->h_old, NULL});
  dea_solid_alloc_doubles(&w->memory, w->pressures,
                          (double **[]){&w->theta, &w->nu, &w->weight, NULL});
  for (int i = 0; i < DEPTH; i++) {
    dea_solid_alloc_doubles(&w->memory, w->count, (double **[]){&w->dx[i], &w->df[i], NULL});
    dea_solid_alloc_doubles(&w->memory, w->dofs, (double **[]){&w->dh[i], NULL});
  }
  return dea_solid_allreduce(w->memory.ctx, dea_arena_status(&w->memory));
}

/* u and multipliers from one vector. */
static void set(const struct follow *w, const double *x)
{
  memcpy(w->s->state.u, x, w->dofs * sizeof *x);
  memcpy(w->s->state.multiplier, x + w->dofs, w->pressures * sizeof *x);
}

static double kappa_of(const struct follow *w, size_t pressure)
{
  return w->stiff *
         dea_solid_bulk_modulus(w->s, pressure / (size_t)w->s->problem.elements.pressures);
}

/* ---- the mixing of steps ---- */

static double product(const struct follow *w, const double *a, const double *b_h, const double *b)
{
  double sum = -dea_solid_dot(w->s, a, b_h);
  for (size_t i = 0; i < w->pressures; i++) {
    sum += w->weight[i] * a[w->dofs + i] * b[w->dofs + i];
  }
  return sum;
}

/* Puts what changed since the iteration before among what is remembered. */
static void remember(struct follow *w)
{
  int last = w->depth < DEPTH ? w->depth++ : DEPTH - 1;
  double *dx = w->dx[last], *df = w->df[last], *dh = w->dh[last];
  for (int i = last; i > 0; i--) {
    w->dx[i] = w->dx[i - 1];
    w->df[i] = w->df[i - 1];
    w->dh[i] = w->dh[i - 1];
  }
  w->dx[0] = dx;
  w->df[0] = df;
  w->dh[0] = dh;
  for (size_t i = 0; i < w->count; i++) {
    dx[i] = w->x[i] - w->x_old[i];
    df[i] = w->f[i] - w->f_old[i];
  }
  for (size_t i = 0; i < w->dofs; i++) {
    dh[i] = w->h[i] - w->h_old[i];
  }
  for (int i = w->depth - 1; i > 0; i--) {
    for (int j = w->depth - 1; j > 0; j--) {
      w->gram[i][j] = w->gram[i - 1][j - 1];
    }
  }
  for (int i = 0; i < w->depth; i++) {
    w->gram[i][0] = product(w, w->df[i], dh, df);
    w->gram[0][i] = product(w, df, w->dh[i], w->df[i]);
  }
}

/* coefficient [depth] that makes the size of f - sum of coefficient df least; how many of the
 * differences, the newest ones, say enough for that. */
static int mix(const struct follow *w, double *coefficient)
{
  double scale[DEPTH], A[DEPTH * DEPTH];
  for (int n = w->depth; n > 0; n--) {
    bool fine = true;
    for (int i = 0; i < n; i++) {
      scale[i] = sqrt(fmax(w->gram[i][i], 0));
      fine = fine && scale[i] > 0;
    }
    for (int i = 0; i < n && fine; i++) {
      coefficient[i] = product(w, w->df[i], w->h, w->f) / scale[i];
      for (int j = 0; j < n; j++) {
        A[i * n + j] = 0.5 * (w->gram[i][j] + w->gram[j][i]) / (scale[i] * scale[j]);
      }
      A[i * n + i] += 1e-10;
    }
    if (fine && LAPACKE_dposv(LAPACK_ROW_MAJOR, 'U', n, 1, A, n, coefficient, 1) == 0) {
      for (int i = 0; i < n; i++) {
        coefficient[i] /= scale[i];
      }
      return n;
    }
  }
  return 0;
}

/* The next x from x, f and what is remembered. */
static void advance(struct follow *w)
{
  double coefficient[DEPTH];
  int n = mix(w, coefficient);
  memcpy(w->x_old, w->x, w->count * sizeof *w->x);
  memcpy(w->f_old, w->f, w->count * sizeof *w->f);
  memcpy(w->h_old, w->h, w->dofs * sizeof *w->h);
  for (size_t i = 0; i < w->count; i++) {
    w->x[i] += w->f[i];
    for (int k = 0; k < n; k++) {
      w->x[i] -= coefficient[k] * (w->dx[k][i] + w->df[k][i]);
    }
  }
}

/* ---- the bend of the way ---- */

static bool knows_before(const struct follow *w)
{
  const struct dea_load_steps *path = &w->s->work.load_steps;
  return !isnan(w->from_V) && path->last_V != path->before_last_V &&
         memcmp(w->first, path->last, w->dofs * sizeof *w->first) == 0;
}

/* Adds to x, which the first step f has led to along the tangent at the start, how far the parabola
 * in V^2 with that tangent and the equilibrium before lies beside it there:
 *
 *   r f - r^2 (x_last - x_before_last),   r = what V^2 changes by over what it changed by before.
 */
static void bend(struct follow *w)
{
  const struct dea_load_steps *path = &w->s->work.load_steps;
  double V = w->s->state.voltage_V, last = path->last_V, before = path->before_last_V;
  double r = (V * V - last * last) / (last * last - before * before), beside = 0, along = 0;
  for (size_t i = 0; i < w->dofs; i++) {
    double d = r * w->f[i] - r * r * (w->first[i] - path->before_last[i]);
    beside += d * d;
    along += w->f[i] * w->f[i];
  }
  if (r > 0 && r <= max_extrapolation && sqrt(beside) < max_curvature * sqrt(along)) {
    for (size_t i = 0; i < w->count; i++) {
      w->x[i] += r * w->f[i] - r * r * (w->first[i] - path->before_last[i]);
    }
  }
}

/* For the next one, that the solid has come from the start to where it is. */
static void save_step(struct follow *w)
{
  struct dea_load_steps *path = &w->s->work.load_steps;
  double V = w->s->state.voltage_V;
  if (!isnan(w->from_V) && V != w->from_V) {
    memcpy(path->before_last, w->first, w->count * sizeof *w->first);
    path->before_last_V = w->from_V;
  } else if (!knows_before(w)) {
    path->before_last_V = V;
  }
  memcpy(path->last, w->s->state.u, w->dofs * sizeof *path->last);
  path->last_V = V;
}

/* ---- the slope of theta at the start ---- */

/* With the weights of pressures. */
static dea_status find_constraints(struct dea_context *ctx, struct follow *w)
{
  DEA_TRY(ctx, dea_constraints_find(ctx, &w->memory, w->s, &w->constraints));
  for (size_t k = 0; k < w->s->problem.own_count; k++) {
    const struct dea_element_constraint at = dea_constraints_at(&w->constraints, k);
    for (size_t m = 0; m < at.count; m++) {
      const double *L = at.L + m * at.count, kappa_Pa = kappa_of(w, at.first);
      for (size_t c = 0; c <= m && kappa_Pa > 0; c++) {
        w->weight[at.first + m] += L[c] * L[c] * compliance / kappa_Pa;
      }
    }
  }
  dea_solid_sum(w->weight, w->pressures);
  return DEA_OK;
}

/* h += kappa B0 theta. */
static void add_pressures(struct follow *w)
{
  struct dea_solid *s = w->s;
  double *sum = s->work.trial;
  for (size_t k = 0; k < s->problem.own_count; k++) {
    const struct dea_element_constraint at = dea_constraints_at(&w->constraints, k);
    for (size_t m = 0; m < at.count; m++) {
      double *nu = &w->nu[at.first + m];
      *nu = 0;
      for (size_t c = m; c < at.count; c++) {
        *nu += kappa_of(w, at.first) * at.L[c * at.count + m] * w->theta[at.first + c];
      }
    }
  }
  dea_constraints_push(&w->constraints, w->nu, sum);
  dea_solid_bodies_collect(s, sum);
  dea_solid_release_held(s, sum);
  dea_add(w->dofs, 1, sum, w->h);
}

/* dq = kappa (theta + L^-T b du) into f. */
static void find_pressures(struct follow *w)
{
  double *dq = w->f + w->dofs;
  dea_constraints_grow(&w->constraints, w->f, dq);
  dea_constraints_solve(&w->constraints, true, dq);
  for (size_t k = 0; k < w->s->problem.own_count; k++) {
    const struct dea_element_constraint at = dea_constraints_at(&w->constraints, k);
    for (size_t i = at.first; i < at.first + at.count; i++) {
      dq[i] = at.L[0] > 0 ? kappa_of(w, i) * (w->theta[i] + dq[i]) : 0;
    }
  }
  dea_solid_sum(dq, w->pressures);
}

/* ---- one step ---- */

/* r at u and q, both x; theta. */
static dea_status find_forces(struct dea_context *ctx, struct follow *w)
{
  struct dea_solid *s = w->s;
  set(w, w->x);
  DEA_TRY(ctx, dea_solid_assemble_forces(ctx, s, s->state.voltage_V, &w->report->energy_J));
  memcpy(w->h, s->work.g, w->dofs * sizeof *w->h);
  memcpy(w->theta, s->state.theta, w->pressures * sizeof *w->theta);
  return DEA_OK;
}

/* f at x, where h is r and theta is known. */
static dea_status find_step(struct dea_context *ctx, struct follow *w)
{
  struct dea_solid *s = w->s;
  memcpy(s->state.u, w->first, w->dofs * sizeof *w->first); // where bodies turned to at the start
  dea_solid_bodies_prepare(s);
  add_pressures(w);
  for (size_t i = 0; i < w->dofs; i++) {
    s->work.trial[i] = -w->h[i];
  }
  DEA_TRY(ctx, dea_solid_solve_linear(ctx, s, s->work.trial, w->f));
  find_pressures(w);
  w->size = sqrt(fmax(product(w, w->f, w->h, w->f), 0));
  return DEA_OK;
}

/* Whether iteration k and those that it promises are worth their while. */
static bool pays(const struct follow *w, int k)
{
  const struct dea_solid_settings *o = &w->s->settings;
  double size = w->size / w->size_renewed; // after k steps
  double goal = w->accuracy * w->size_first / w->size_renewed;
  k -= w->renewed;
  return k == 0 ||
         (size < max_rate && (k < 2 || k * log(goal) / log(size) < o->anderson_max_iterations));
}

/* Brings the loads' multipliers up to date at x, once that is near enough. What is remembered is of
 * other forces then. */
static bool renew_loads(struct follow *w, int k)
{
  if (w->load_error <= 1 || !(w->size < intermediate_rtol * w->size_first)) {
    return false;
  }
  set(w, w->x);
  w->load_error = dea_solid_update_loads(w->s);
  w->depth = 0;
  w->renewed = k;
  return true;
}

/* One iteration: a step, which is the last one where *there, or none where they do not pay (*ends).
 */
static dea_status iterate(struct dea_context *ctx, struct follow *w, int k, bool *there, bool *ends)
{
  struct dea_solid *s = w->s;
  const struct dea_solid_settings *o = &s->settings;
  DEA_TRY(ctx, dea_solid_check_interruption(ctx));
  bool renewed = k == 0 || renew_loads(w, k);
  DEA_TRY(ctx, find_forces(ctx, w));
  w->report->residual = dea_solid_residual(s);
  w->report->theta_max = dea_solid_theta_max(s);
  DEA_TRY(ctx, find_step(ctx, w));
  dea_solid_predict_tangent(s, w->f);
  w->size_first = k == 0 ? w->size : w->size_first;
  w->size_renewed = renewed ? w->size : w->size_renewed;
  bool small = k > 0 && w->size < w->accuracy * w->size_first;
  w->rate = k == 1 ? w->size / w->size_first : w->rate;
  *there =
      small && (!w->equilibrium || (w->report->theta_max < o->volume_tol &&
                                    w->report->residual < o->newton_rtol && w->load_error <= 1));
  *ends = !*there && !pays(w, k);
  if (!*ends) {
    if (!renewed) {
      remember(w);
    }
    advance(w);
    if (k == 0 && knows_before(w)) {
      bend(w);
    }
    dea_context_counters(ctx)->newton_iterations++;
  }
  return DEA_OK;
}

/* Multipliers with which the pressures at x are q. */
static void restore_state(struct follow *w)
{
  set(w, w->x);
  for (size_t i = 0; i < w->pressures; i++) {
    w->s->state.multiplier[i] -= kappa_of(w, i) / w->stiff * w->theta[i];
  }
}

/* u, pressures and theta at the start. */
static dea_status begin(struct dea_context *ctx, struct follow *w)
{
  struct dea_solid *s = w->s;
  double energy;
  DEA_TRY(ctx, allocate(w));
  dea_solid_state_get(s, w->keep);
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_FORCE, &energy));
  memcpy(w->first, w->keep, w->count * sizeof *w->first);
  for (size_t i = 0; i < w->pressures; i++) {
    w->first[w->dofs + i] += kappa_of(w, i) / w->stiff * s->state.theta[i];
  }
  memcpy(w->x, w->first, w->count * sizeof *w->x);
  return find_constraints(ctx, w);
}

/* Iterations until *there; otherwise the solid is as it was. Fails only where no shorter step would
 * help. */
static dea_status iterate_all(struct dea_context *ctx, struct follow *w, bool *there)
{
  bool ends = false;
  dea_status status = begin(ctx, w);
  DEA_TRY_STATUS(status);
  for (size_t i = 0; i < w->s->problem.load_count; i++) {
    w->load_error = w->s->problem.loads[i].update != NULL ? INFINITY : w->load_error;
  }
  for (int k = 0; k - w->renewed <= w->s->settings.anderson_max_iterations && status == DEA_OK &&
                  !*there && !ends;
       k++) {
    status = iterate(ctx, w, k, there, &ends);
  }
  if (*there) {
    restore_state(w);
  } else {
    dea_solid_state_set(w->s, w->keep);
  }
  return dea_solid_excuse(ctx, status);
}

/* A step with the new factor and the force that was found along with it: Newton's own. */
static dea_status solve_last_step(struct dea_context *ctx, struct follow *w)
{
  struct dea_solid *s = w->s;
  bool stiff = s->found.stiff_factor_fits;
  dea_solid_state_get(s, s->work.load_steps.factored);
  s->found.factor_before = true;
  DEA_TRY(ctx, dea_solid_linear_step(ctx, s));
  if (stiff) {
    dea_solid_change_bulk_modulus(s, DEA_SOLID_STIFF);
  }
  dea_status status = dea_solid_predict(ctx, s, s->state.voltage_V, s->work.step, 1, false, true);
  s->state.bulk_factor /= stiff ? DEA_SOLID_STIFF : 1; // multipliers are those of the step's end
  for (size_t i = 0; i < w->dofs && status == DEA_OK; i++) {
    s->state.u[i] += s->work.step[i];
  }
  return status;
}

/* Unstable modes where the solid has come to, and the loads' multipliers for it; it goes back where
 * there are some, or where these do not follow. */
static dea_status count(struct dea_context *ctx, struct follow *w, bool *there)
{
  struct dea_solid *s = w->s;
  dea_status status = dea_solid_count_unstable(ctx, s, false, w->report);
  status = status == DEA_OK && w->report->unstable_modes == 0 ? solve_last_step(ctx, w) : status;
  *there = status == DEA_OK && w->report->unstable_modes == 0;
  if (*there) {
    w->report->load_error = dea_solid_update_loads(s);
    *there = w->report->load_error <= 1 || !w->equilibrium;
  }
  if (!*there) {
    dea_solid_state_set(s, w->keep);
    s->found.factor_fits = s->found.stiff_factor_fits = false;
  }
  return dea_solid_excuse(ctx, status);
}

dea_status dea_solid_follow(struct dea_context *ctx, struct dea_solid *s, double from_V,
                            bool intermediate, struct dea_solid_report *report, double *rate,
                            bool *there)
{
  struct follow w = {.memory = {.ctx = ctx},
                     .s = s,
                     .accuracy = intermediate ? intermediate_rtol : s->settings.anderson_rtol,
                     .equilibrium = !intermediate,
                     .from_V = from_V,
                     .report = report,
                     .dofs = s->problem.dofs,
                     .pressures = dea_solid_pressure_count(s),
                     .count = s->problem.dofs + dea_solid_pressure_count(s),
                     .stiff = s->found.factor_fits ? 1 : DEA_SOLID_STIFF};
  *there = false;
  if (rate != NULL) {
    *rate = 0;
  }
  if (s->problem.field != NULL || !(s->found.factor_fits || s->found.stiff_factor_fits)) {
    return DEA_OK;
  }
  s->found.predicted_fits = false;
  dea_status status = iterate_all(ctx, &w, there);
  status = status == DEA_OK && *there ? count(ctx, &w, there) : status;
  dea_context_counters(ctx)->load_steps += status == DEA_OK && *there;
  dea_context_counters(ctx)->rejected_steps += !*there;
  if (status == DEA_OK && *there) {
    save_step(&w);
  }
  if (rate != NULL) {
    *rate = w.rate;
  }
  dea_arena_free(&w.memory);
  return status;
}

// Multipliers -------------------------------------------------------------------------------------

enum { MAX_WORSE = 4 }; // updates in a row that violate the constraints more

/* Minima at multipliers that follow, until the constraints hold. Where there is no equilibrium any
 * more minima at given multipliers may go on, but violate the constraints more and more. */
dea_status dea_solid_equilibrate(struct dea_context *ctx, struct dea_solid *s,
                                 struct dea_solid_report *report)
{
  const struct dea_solid_settings *o = &s->settings;
  double best = INFINITY;
  for (int i = 0, worse = 0; i < o->multiplier_max_iterations && worse < MAX_WORSE; i++) {
    DEA_TRY(ctx, dea_solid_minimise(ctx, s, i == 0 && !o->accept_unstable, report));
    report->load_error = dea_solid_update_loads(s);
    double error = fmax(report->theta_max / o->volume_tol, report->load_error);
    bool there = report->theta_max < o->volume_tol && report->load_error <= 1;
    if (!there && report->theta_max < o->volume_tol) {
      DEA_TRY(ctx, dea_solid_follow(ctx, s, NAN, false, report, NULL, &there));
    }
    if (there) {
      return DEA_OK;
    }
    if (report->theta_max >= o->volume_tol) {
      dea_solid_update_multipliers(s);
    }
    worse = error < best ? 0 : worse + 1;
    best = fmin(best, error);
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED,
                  "the constraints do not settle (J - 1: %.1e; loads: %.2g of what is allowed)",
                  report->theta_max, report->load_error);
}

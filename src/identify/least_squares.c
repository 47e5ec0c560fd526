#include "identify/least_squares.h"

#include <cminpack.h>
#include <math.h>
#include <string.h>

enum { ROUNDS_MAX = 30, EVALUATIONS_PER_PARAM = 400 };

static const double step_share = 1e-3, short_share = 1e-6;
static const double beyond = 1e100; // residual where the model has no answer: the step is refused

/* ---- derivatives ---- */

/* r at p with p_j moved by h. */
static dea_status shifted(const struct dea_lsq_problem *problem, double *p, size_t j, double h,
                          double *r)
{
  const double kept = p[j];
  p[j] = kept + h;
  dea_status status = problem->residual(problem->user, p, r);
  p[j] = kept;
  return status;
}

/* dr/dp_j by one central difference; work: [2 x rows]. */
static dea_status difference(const struct dea_lsq_problem *problem, double *p, size_t j, double h,
                             double *work, double *column)
{
  const size_t m = problem->rows;
  DEA_TRY_STATUS(shifted(problem, p, j, h, work));
  DEA_TRY_STATUS(shifted(problem, p, j, -h, work + m));
  for (size_t i = 0; i < m; i++) {
    column[i] = (work[i] - work[m + i]) / (2 * h);
  }
  return DEA_OK;
}

/* The same by two of them, of fourth order. */
static dea_status difference_twice(const struct dea_lsq_problem *problem, double *p, size_t j,
                                   double h, double *work, double *column)
{
  const size_t m = problem->rows;
  DEA_TRY_STATUS(shifted(problem, p, j, 2 * h, work));
  DEA_TRY_STATUS(shifted(problem, p, j, -2 * h, work + m));
  for (size_t i = 0; i < m; i++) {
    column[i] = -(work[i] - work[m + i]) / (12 * h);
  }
  DEA_TRY_STATUS(shifted(problem, p, j, h, work));
  DEA_TRY_STATUS(shifted(problem, p, j, -h, work + m));
  for (size_t i = 0; i < m; i++) {
    column[i] += 8 * (work[i] - work[m + i]) / (12 * h);
  }
  return DEA_OK;
}

/* dr/dp_j into column; work: [2 x rows]. */
static dea_status differentiate(const struct dea_lsq_problem *problem, double *p, size_t j,
                                double *work, double *column)
{
  const double share = problem->step > 0 ? problem->step : step_share;
  const double h = fmax(share * problem->param[j].scale, short_share * fabs(p[j]));
  const dea_status status = problem->second_order
                                ? difference(problem, p, j, h, work, column)
                                : difference_twice(problem, p, j, h, work, column);
  return status != DEA_E_DOMAIN // close to where the model ends
             ? status
             : difference(problem, p, j, short_share * problem->param[j].scale, work, column);
}

dea_status dea_lsq_jacobian(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                            const double *p, double *J)
{
  double q[DEA_LSQ_PARAMS_MAX];
  double *work = dea_alloc(ctx, 2 * problem->rows, sizeof *work);
  DEA_TRY_MEMORY(work != NULL);
  memcpy(q, p, problem->params * sizeof *q);
  dea_status status = DEA_OK;
  for (size_t j = 0; j < problem->params && status == DEA_OK; j++) {
    status = differentiate(problem, q, j, work, J + j * problem->rows);
  }
  dea_free(ctx, work);
  return status;
}

/* ---- the minimum ---- */

/* What cminpack's function knows: the free parameters are x, the others stay. */
struct search {
  const struct dea_lsq_problem *problem;
  double p[DEA_LSQ_PARAMS_MAX];
  size_t index[DEA_LSQ_PARAMS_MAX], free_count;
  double *work; // [2 x rows]
  dea_status status;
};

static double clip(const struct dea_lsq_problem *problem, size_t j, double value)
{
  return fmin(fmax(value, problem->param[j].low), problem->param[j].high);
}

static void spread(struct search *s, const double *x)
{
  for (size_t k = 0; k < s->free_count; k++) {
    s->p[s->index[k]] = clip(s->problem, s->index[k], x[k]);
  }
}

/* As cminpack wants it. Beyond a bound nothing changes: the derivative is 0 there. */
static int evaluate(void *user, int m, int n, const double *x, double *r, double *J, int stride,
                    int what)
{
  struct search *s = user;
  (void)n;
  spread(s, x);
  if (what == 1) {
    dea_status status = s->problem->residual(s->problem->user, s->p, r);
    if (status == DEA_E_DOMAIN) {
      for (int i = 0; i < m; i++) {
        r[i] = beyond;
      }
      return 0;
    }
    s->status = status;
    return status == DEA_OK ? 0 : -1;
  }
  for (size_t k = 0; k < s->free_count; k++) {
    const size_t j = s->index[k];
    double *column = J + k * (size_t)stride;
    if (x[k] != s->p[j]) {
      memset(column, 0, (size_t)m * sizeof *column);
      continue;
    }
    s->status = differentiate(s->problem, s->p, j, s->work, column);
    if (s->status != DEA_OK) {
      return -1;
    }
  }
  return 0;
}

/* One search over the free parameters from s->p, which it moves. */
static dea_status search_minimum(struct dea_context *ctx, struct search *s, double *J)
{
  const int m = (int)s->problem->rows, n = (int)s->free_count;
  double x[DEA_LSQ_PARAMS_MAX], diag[DEA_LSQ_PARAMS_MAX], qtf[DEA_LSQ_PARAMS_MAX];
  double wa1[DEA_LSQ_PARAMS_MAX], wa2[DEA_LSQ_PARAMS_MAX], wa3[DEA_LSQ_PARAMS_MAX];
  int pivot[DEA_LSQ_PARAMS_MAX], evaluations = 0, derivatives = 0;
  struct dea_arena memory = {.ctx = ctx};
  double *r = dea_arena_alloc(&memory, s->problem->rows, sizeof *r);
  double *wa4 = dea_arena_alloc(&memory, s->problem->rows, sizeof *wa4);
  if (memory.failed) {
    dea_arena_free(&memory);
    return DEA_E_MEMORY;
  }
  for (size_t k = 0; k < s->free_count; k++) {
    x[k] = s->p[s->index[k]];
  }
  s->status = DEA_OK;
  const double tolerance = s->problem->tolerance;
  int info = lmder(evaluate, s, m, n, x, r, J, m, tolerance > 0 ? tolerance : 1e-15,
                   tolerance > 0 ? tolerance : 1e-12, 0.0, EVALUATIONS_PER_PARAM * (n + 1), diag, 1,
                   10.0, 0, &evaluations, &derivatives, pivot, qtf, wa1, wa2, wa3, wa4);
  dea_arena_free(&memory);
  spread(s, x);
  if (info < 0) {
    return s->status == DEA_E_DOMAIN
               ? dea_fail(ctx, DEA_E_DOMAIN, "the model ends too close to the parameters found")
               : s->status;
  }
  return info == 0 || info == 5
             ? dea_fail(ctx, DEA_E_NOT_CONVERGED, "the least squares did not converge in %d steps",
                        evaluations)
             : DEA_OK;
}

/* Whether p_j is at a bound beyond which chi2 falls, by the slope J_j . r. */
static bool pushes_out(const struct dea_lsq_problem *problem, const struct dea_lsq_fit *fit,
                       size_t j)
{
  double slope = 0;
  for (size_t i = 0; i < fit->rows; i++) {
    slope += fit->J[j * fit->rows + i] * fit->r[i];
  }
  return (fit->p[j] <= problem->param[j].low && slope > 0) ||
         (fit->p[j] >= problem->param[j].high && slope < 0);
}

/* r, J and chi2 at fit->p. */
static dea_status refresh(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                          struct dea_lsq_fit *fit)
{
  dea_status status = problem->residual(problem->user, fit->p, fit->r);
  status = status == DEA_OK ? dea_lsq_jacobian(ctx, problem, fit->p, fit->J) : status;
  if (status == DEA_E_DOMAIN) {
    return dea_fail(ctx, status, "the model has no answer at these parameters");
  }
  DEA_TRY(ctx, status);
  fit->chi2 = 0;
  for (size_t i = 0; i < fit->rows; i++) {
    fit->chi2 += fit->r[i] * fit->r[i];
  }
  return DEA_OK;
}

static dea_status solve(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                        struct search *s, double *J, struct dea_lsq_fit *fit)
{
  DEA_TRY(ctx, refresh(ctx, problem, fit));
  for (int round = 0; round < ROUNDS_MAX; round++) {
    bool again = false;
    s->free_count = 0;
    for (size_t j = 0; j < fit->params; j++) {
      fit->at_bound[j] = !fit->held[j] && pushes_out(problem, fit, j);
      if (!fit->held[j] && !fit->at_bound[j]) {
        s->index[s->free_count++] = j;
      }
    }
    if (s->free_count == 0) {
      return DEA_OK;
    }
    memcpy(s->p, fit->p, fit->params * sizeof *s->p);
    DEA_TRY(ctx, search_minimum(ctx, s, J));
    memcpy(fit->p, s->p, fit->params * sizeof *s->p);
    DEA_TRY(ctx, refresh(ctx, problem, fit));
    for (size_t j = 0; j < fit->params; j++) { // a bound newly reached, or one to leave
      const struct dea_fit_param *param = &problem->param[j];
      bool at = fit->p[j] <= param->low || fit->p[j] >= param->high;
      again = again || (!fit->held[j] && at && fit->at_bound[j] != pushes_out(problem, fit, j));
    }
    if (!again) {
      return DEA_OK;
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the parameters at their bounds keep changing");
}

static bool is_held(const struct dea_lsq_problem *problem, const bool *held, size_t j)
{
  return held != NULL ? held[j] : problem->param[j].fixed;
}

dea_status dea_lsq_solve(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                         const double *start, const bool *held, struct dea_lsq_fit *out)
{
  const size_t m = problem->rows, n = problem->params;
  struct search s = {.problem = problem};
  size_t fixed = 0;
  *out = (struct dea_lsq_fit){.rows = m, .params = n, .memory = {.ctx = ctx}};
  for (size_t j = 0; j < n; j++) {
    fixed += is_held(problem, held, j) ? 1U : 0U;
  }
  if (n > DEA_LSQ_PARAMS_MAX || m == 0 || m + fixed < n) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "%zu measurements do not determine %zu parameters", m,
                    n - fixed);
  }
  out->r = dea_arena_alloc(&out->memory, m, sizeof *out->r);
  out->J = dea_arena_alloc(&out->memory, m * n, sizeof *out->J);
  double *J = dea_arena_alloc(&out->memory, m * n, sizeof *J);
  s.work = dea_arena_alloc(&out->memory, 2 * m, sizeof *s.work);
  dea_status status = dea_arena_status(&out->memory);
  if (status == DEA_OK) {
    for (size_t j = 0; j < n; j++) {
      out->held[j] = is_held(problem, held, j);
      out->p[j] = out->held[j] ? start[j] : clip(problem, j, start[j]);
    }
    status = solve(ctx, problem, &s, J, out);
  }
  DEA_TRY_ELSE(ctx, status, dea_lsq_free(out));
  return DEA_OK;
}

void dea_lsq_free(struct dea_lsq_fit *fit)
{
  dea_arena_free(&fit->memory);
  *fit = (struct dea_lsq_fit){0};
}

/* ---- profiles ---- */

dea_status dea_lsq_growth(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                          const struct dea_lsq_fit *fit, size_t j, double value, double unit,
                          double *from, double *out)
{
  bool held[DEA_LSQ_PARAMS_MAX];
  struct dea_lsq_fit moved;
  memcpy(held, fit->held, fit->params * sizeof *held);
  held[j] = true;
  from[j] = value;
  const dea_status status = dea_lsq_solve(ctx, problem, from, held, &moved);
  if (status == DEA_E_DOMAIN || status == DEA_E_NOT_CONVERGED) {
    dea_context_clear(ctx);
    memcpy(from, fit->p, fit->params * sizeof *from);
    *out = NAN;
    return DEA_OK;
  }
  DEA_TRY(ctx, status);
  memcpy(from, moved.p, fit->params * sizeof *from);
  *out = sqrt(fmax(0, moved.chi2 - fit->chi2) / unit) - 1;
  dea_lsq_free(&moved);
  return DEA_OK;
}

/* Where the growth is `unit` on one side; direction: -1 or 1. */
static dea_status profile_side(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                               const struct dea_lsq_fit *fit, size_t j, double direction,
                               double step, double unit, double *out)
{
  static const double beyond_model = 1e3; // as far as it goes
  double from[DEA_LSQ_PARAMS_MAX];
  double a = fit->p[j], fa = -1, b = a, fb = -1; // a inside; b beyond once fb > 0
  const double bound = direction < 0 ? problem->param[j].low : problem->param[j].high;
  memcpy(from, fit->p, fit->params * sizeof *from);
  for (int k = 0; k < 12 && fb < 0; k++, step *= 2) {
    a = b;
    fa = fb;
    if (a == bound) {
      *out = direction * INFINITY;
      return DEA_OK;
    }
    b = clip(problem, j, a + direction * step);
    DEA_TRY(ctx, dea_lsq_growth(ctx, problem, fit, j, b, unit, from, &fb));
    fb = isnan(fb) ? beyond_model : fb;
  }
  if (fb < 0) {
    *out = direction * INFINITY;
    return DEA_OK;
  }
  for (int k = 0; k < 40 && fabs(b - a) > 1e-4 * fabs(b - fit->p[j]); k++) {
    double share = k % 4 == 3 || fb > 100 ? 0.5 : fa / (fa - fb), f = NAN;
    double at = a + fmin(fmax(share, 0.02), 0.98) * (b - a);
    DEA_TRY(ctx, dea_lsq_growth(ctx, problem, fit, j, at, unit, from, &f));
    f = isnan(f) ? beyond_model : f;
    if (fabs(f) < 1e-5) {
      a = b = at;
    } else if (f < 0) {
      a = at;
      fa = f;
    } else {
      b = at;
      fb = f;
    }
  }
  *out = 0.5 * (a + b);
  return DEA_OK;
}

dea_status dea_lsq_profile(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                           const struct dea_lsq_fit *fit, size_t j, double unit, double step,
                           double out[2])
{
  DEA_TRY(ctx, profile_side(ctx, problem, fit, j, -1, step, unit, &out[0]));
  return profile_side(ctx, problem, fit, j, 1, step, unit, &out[1]);
}

/* Searches by NLopt in variables scaled to the range from 0 to 1. Each evaluation is kept in the
 * store; a search that is run again takes the same way, and so goes on where it was ended. */
#include "explore/optimise.h"

#include "explore/plan.h"
#include "explore/pool.h"

#include <math.h>
#include <string.h>

#ifdef DEA_HAVE_NLOPT
#include <nlopt.h>

static const double difference = 1e-4; // of central differences, as a share of the range

struct work {
  const struct dea_search *search;
  struct dea_pool *pool;
  dea_status status;
  size_t free[DEA_CASE_PARAMS_MAX], n; // variables that are searched
  double p[DEA_CASE_PARAMS_MAX];       // values of the others
  size_t wanted;                       // objective that is minimised
  double bound;                        // of the other one; INFINITY: none
  double scale[DEA_EXPLORE_OBJECTIVES_MAX];
  double worst; // objective seen, scaled: what a design without values is given
  size_t now;   // evaluations of this search
  nlopt_opt opt;
  struct dea_optimum best;
  double best_f;
};

// Evaluations -------------------------------------------------------------------------------------

/* Points that are to be there. */
struct batch {
  struct work *w;
  const double *p; // [count][params]
  size_t count, next;
};

static bool next_case(void *user, struct dea_case *out)
{
  struct batch *batch = user;
  const size_t n = batch->w->search->evaluator->param_count;
  while (batch->next < batch->count) {
    const double *p = batch->p + n * batch->next++;
    if (dea_store_find(batch->w->search->store, p) == NULL) {
      out->number = dea_store_count(batch->w->search->store);
      memcpy(out->p, p, n * sizeof *p);
      return true;
    }
  }
  return false;
}

static dea_status keep(void *user, const struct dea_case *done)
{
  const struct dea_search *search = ((struct batch *)user)->w->search;
  dea_progress(search->ctx, "designs", dea_store_count(search->store) + 1, 0);
  return dea_store_add(search->store, done);
}

/* Has points [count][params] evaluated. */
static bool evaluate(struct work *w, const double *p, size_t count)
{
  struct batch batch = {w, p, count, 0};
  if (w->status == DEA_OK && dea_interrupted(w->search->ctx)) {
    w->status = dea_fail(w->search->ctx, DEA_E_INTERRUPTED, "interrupted; what was done is kept");
  }
  if (w->status == DEA_OK) {
    w->status = dea_pool_run(w->pool, next_case, keep, &batch);
  }
  if (w->status != DEA_OK && w->opt != NULL) {
    nlopt_force_stop(w->opt);
  }
  return w->status == DEA_OK;
}

static void point_of(const struct work *w, const double *x, double *p)
{
  memcpy(p, w->p, w->search->evaluator->param_count * sizeof *p);
  for (size_t i = 0; i < w->n; i++) {
    const size_t j = w->free[i];
    p[j] = w->search->low[j] + x[i] * (w->search->high[j] - w->search->low[j]);
  }
}

// Objective and limits ----------------------------------------------------------------------------

/* Number of functions: the objective, the limits, and the bound of the other objective. */
static size_t functions(const struct work *w)
{
  return 1 + w->search->limit_count + (isfinite(w->bound) ? 1U : 0U);
}

/* Function k of a case, at most 0 where a limit holds; NAN where a value is missing. */
static double function_of(const struct work *w, size_t k, const double *q)
{
  const struct dea_search *search = w->search;
  if (k == 0) {
    return search->objective(search->user, w->wanted, q) / w->scale[w->wanted];
  }
  if (k <= search->limit_count) {
    return -search->margin(search->user, k - 1, q);
  }
  const size_t other = 1 - w->wanted;
  return (search->objective(search->user, other, q) - w->bound) / w->scale[other];
}

/* Notes a design that is within all limits and better than the best. Within the solver's tolerance
 * of a limit it pays for what it is beyond, so that it gains nothing by that. */
static void note(struct work *w, const struct dea_case *at)
{
  double off = 0;
  for (size_t k = 1; k < functions(w); k++) {
    const double g = function_of(w, k, at->q);
    off = g <= 1e-6 ? fmax(off, g) : INFINITY; // NAN too
  }
  const double f = function_of(w, 0, at->q) + 100 * off;
  if (f < w->best_f) {
    w->best_f = f;
    w->best.found = true;
    memcpy(w->best.p, at->p, sizeof w->best.p);
    for (size_t k = 0; k < w->search->objective_count; k++) {
      w->best.f[k] = w->search->objective(w->search->user, k, at->q);
    }
    w->best.evaluations = dea_store_count(w->search->store);
  }
}

/* Gradient of function k by central differences, or one-sided where one of the two designs has no
 * value or would lie outside of the range. around: cases x -+ h of each variable. */
static void difference_of(const struct work *w, size_t k, double f, const double *x,
                          const double *around, double *gradient)
{
  const size_t params = w->search->evaluator->param_count;
  for (size_t i = 0; i < w->n; i++) {
    double value[3] = {NAN, f, NAN},
           at[3] = {fmax(x[i] - difference, 0), x[i], fmin(x[i] + difference, 1)};
    for (size_t s = 0; s < 3; s += 2) {
      const struct dea_case *done =
          dea_store_find(w->search->store, around + (2 * i + s / 2) * params);
      value[s] = done != NULL ? function_of(w, k, done->q) : NAN;
    }
    const size_t low = isnan(value[0]) ? 1U : 0U, high = isnan(value[2]) ? 1U : 2U;
    gradient[i] = at[high] > at[low] ? (value[high] - value[low]) / (at[high] - at[low]) : 0;
  }
}

/* The same from the gradients that the evaluator gives: functions are linear in the values, so that
 * their change over a step along the gradients is their derivative. */
static void chain(const struct work *w, size_t k, const struct dea_case *at, double *gradient)
{
  const struct dea_evaluator *evaluator = w->search->evaluator;
  const double *slopes = at->q + evaluator->value_count, f = function_of(w, k, at->q);
  double moved[DEA_CASE_VALUES_MAX];
  for (size_t i = 0; i < w->n; i++) {
    const size_t j = w->free[i];
    const double range = w->search->high[j] - w->search->low[j];
    for (size_t v = 0; v < evaluator->value_count; v++) {
      moved[v] = at->q[v] + range * slopes[v * evaluator->param_count + j];
    }
    gradient[i] = function_of(w, k, moved) - f;
  }
}

/* All functions at x, and their gradients [functions][n] (NULL: not wanted). */
static void functions_at(struct work *w, const double *x, double *values, double *gradients)
{
  const size_t params = w->search->evaluator->param_count, count = functions(w);
  const bool differences = gradients != NULL && !w->search->evaluator->gradients;
  double p[(1 + 2 * DEA_CASE_PARAMS_MAX) * DEA_CASE_PARAMS_MAX], y[DEA_CASE_PARAMS_MAX];
  point_of(w, x, p);
  for (size_t i = 0; i < 2 * w->n && differences; i++) {
    memcpy(y, x, w->n * sizeof *y);
    y[i / 2] = i % 2 == 0 ? fmax(x[i / 2] - difference, 0) : fmin(x[i / 2] + difference, 1);
    point_of(w, y, p + (1 + i) * params);
  }
  if (!evaluate(w, p, differences ? 1 + 2 * w->n : 1)) {
    for (size_t k = 0; k < count; k++) {
      values[k] = 0;
    }
    if (gradients != NULL) {
      memset(gradients, 0, count * w->n * sizeof *gradients);
    }
    return;
  }
  const struct dea_case *at = dea_store_find(w->search->store, p);
  note(w, at);
  for (size_t k = 0; k < count; k++) {
    values[k] = function_of(w, k, at->q);
    if (gradients != NULL && isfinite(values[k])) {
      w->search->evaluator->gradients
          ? chain(w, k, at, gradients + k * w->n)
          : difference_of(w, k, values[k], x, p + params, gradients + k * w->n);
    } else if (gradients != NULL) {
      memset(gradients + k * w->n, 0, w->n * sizeof *gradients);
    }
    if (k == 0 && isfinite(values[k])) {
      w->worst = fmax(w->worst, values[k]);
    } else if (!isfinite(values[k])) {
      values[k] = k == 0 ? w->worst + 1 : 1;
    }
  }
}

enum { FUNCTIONS_MAX = 2 + DEA_EXPLORE_LIMITS_MAX };

static double objective(unsigned n, const double *x, double *gradient, void *user)
{
  struct work *w = user;
  double values[FUNCTIONS_MAX], gradients[FUNCTIONS_MAX * DEA_CASE_PARAMS_MAX];
  functions_at(w, x, values, gradient != NULL ? gradients : NULL);
  if (gradient != NULL) {
    memcpy(gradient, gradients, n * sizeof *gradient);
  }
  return values[0];
}

static void limits(unsigned m, double *result, unsigned n, const double *x, double *gradient,
                   void *user)
{
  struct work *w = user;
  double values[FUNCTIONS_MAX], gradients[FUNCTIONS_MAX * DEA_CASE_PARAMS_MAX];
  functions_at(w, x, values, gradient != NULL ? gradients : NULL);
  memcpy(result, values + 1, m * sizeof *result);
  if (gradient != NULL) {
    memcpy(gradient, gradients + n, (size_t)m * n * sizeof *gradient);
  }
}

// Searches ----------------------------------------------------------------------------------------

/* One search by NLopt from x. */
static void descend(struct work *w, double *x)
{
  static const nlopt_algorithm algorithms[] = {NLOPT_LD_SLSQP, NLOPT_LD_MMA, NLOPT_LN_COBYLA};
  const struct dea_search *search = w->search;
  double tolerances[FUNCTIONS_MAX], value;
  for (size_t k = 0; k < FUNCTIONS_MAX; k++) {
    tolerances[k] = 1e-8;
  }
  w->opt = nlopt_create(algorithms[search->method], (unsigned)w->n);
  if (w->opt == NULL) {
    w->status = DEA_E_MEMORY;
    return;
  }
  nlopt_set_lower_bounds1(w->opt, 0);
  nlopt_set_upper_bounds1(w->opt, 1);
  nlopt_set_min_objective(w->opt, objective, w);
  if (functions(w) > 1) {
    nlopt_add_inequality_mconstraint(w->opt, (unsigned)functions(w) - 1, limits, w, tolerances);
  }
  nlopt_set_xtol_abs1(w->opt, search->tolerance);
  nlopt_set_initial_step1(w->opt, 0.1);
  nlopt_set_maxeval(w->opt, (int)search->evaluations);
  nlopt_optimize(w->opt, x, &value); // how it ended does not matter: the best is noted
  nlopt_destroy(w->opt);
  w->opt = NULL;
}

/* Searches from every start. extra: one more to begin with; NULL: none. */
static dea_status search_free(struct work *w, const double *extra)
{
  const struct dea_search *search = w->search;
  double x[DEA_CASE_PARAMS_MAX] = {0}, values[FUNCTIONS_MAX];
  if (w->n == 0) {
    functions_at(w, x, values, NULL);
    return w->status;
  }
  const size_t draws = search->method == DEA_RANDOM ? search->evaluations : search->starts;
  double *u = dea_alloc(search->ctx, draws * w->n, sizeof *u);
  if (u == NULL) {
    return DEA_E_MEMORY;
  }
  search->method == DEA_RANDOM ? dea_sample_random(w->n, draws, 1, u)
                               : dea_sample_sobol(w->n, draws, 1, u);
  for (size_t s = extra != NULL ? 0 : 1; s <= draws && w->status == DEA_OK; s++) {
    for (size_t i = 0; i < w->n; i++) {
      const size_t j = w->free[i];
      const double range = search->high[j] - search->low[j];
      const double begin = s == 0 ? extra[j] : search->start[j];
      x[i] = s <= 1 && search->method != DEA_RANDOM
                 ? fmin(fmax((begin - search->low[j]) / range, 0), 1)
                 : u[(s > 0 ? s - 1 : 0) * w->n + i];
    }
    if (search->method == DEA_RANDOM) {
      functions_at(w, x, values, NULL);
    } else {
      descend(w, x);
    }
  }
  dea_free(search->ctx, u);
  return w->status;
}

/* The best over all combinations of what is counted off. */
static dea_status search_all(struct work *w, const double *extra)
{
  const struct dea_search *search = w->search;
  const size_t params = search->evaluator->param_count;
  size_t combinations = 1;
  w->n = 0;
  w->best = (struct dea_optimum){.found = false};
  w->best_f = INFINITY;
  for (size_t j = 0; j < params; j++) {
    if (search->value_count[j] > 0) {
      combinations *= search->value_count[j];
    } else {
      w->free[w->n++] = j;
    }
  }
  for (size_t c = 0; c < combinations; c++) {
    size_t rest = c;
    for (size_t j = params; j-- > 0;) {
      if (search->value_count[j] > 0) {
        w->p[j] = search->values[j][rest % search->value_count[j]];
        rest /= search->value_count[j];
      }
    }
    DEA_TRY(search->ctx, search_free(w, extra));
  }
  return DEA_OK;
}

/* Sizes of the objectives where the search begins, so that tolerances mean the same for all. */
static dea_status find_scale(struct work *w)
{
  const struct dea_search *search = w->search;
  double p[DEA_CASE_PARAMS_MAX] = {0};
  memcpy(p, search->start, search->evaluator->param_count * sizeof *p);
  evaluate(w, p, 1);
  const struct dea_case *at = w->status == DEA_OK ? dea_store_find(search->store, p) : NULL;
  for (size_t k = 0; k < DEA_EXPLORE_OBJECTIVES_MAX; k++) {
    const double f = at != NULL && k < search->objective_count
                         ? fabs(search->objective(search->user, k, at->q))
                         : NAN;
    w->scale[k] = f > 0 ? f : 1;
  }
  return w->status;
}

/* Between the best of each, the first under bounds of the second at even steps. */
static dea_status find_front(struct work *w, struct dea_optimum *out, size_t *count)
{
  const struct dea_search *search = w->search;
  struct dea_optimum last = *out;
  *count = out->found ? 1 : 0;
  w->wanted = 1;
  DEA_TRY(search->ctx, search_all(w, NULL));
  const struct dea_optimum end = w->best;
  w->wanted = 0;
  for (size_t k = 1; k + 1 < search->front && last.found && end.found; k++) {
    w->bound = out[0].f[1] + (end.f[1] - out[0].f[1]) * (double)k / (double)(search->front - 1);
    DEA_TRY(search->ctx, search_all(w, last.p));
    if (w->best.found) {
      last = out[(*count)++] = w->best;
    }
  }
  w->bound = INFINITY;
  if (end.found) {
    out[(*count)++] = end;
  }
  return DEA_OK;
}

dea_status dea_search_run(const struct dea_search *search, struct dea_optimum *out, size_t *count)
{
  struct work *w = dea_alloc(search->ctx, 1, sizeof *w);
  *count = 0;
  if (w == NULL) {
    return DEA_E_MEMORY;
  }
  w->search = search;
  w->bound = INFINITY;
  w->worst = -INFINITY;
  w->status = dea_pool_create(search->ctx, search->evaluator, search->processes, &w->pool);
  dea_status status = w->status == DEA_OK ? find_scale(w) : w->status;
  w->worst = 1;
  status = status == DEA_OK ? search_all(w, NULL) : status;
  if (status == DEA_OK) {
    out[0] = w->best;
    *count = w->best.found ? 1 : 0;
    status = search->objective_count > 1 ? find_front(w, out, count) : DEA_OK;
  }
  dea_pool_destroy(w->pool);
  dea_free(search->ctx, w);
  return status;
}

bool dea_search_is_built(void)
{
  return true;
}

#else

bool dea_search_is_built(void)
{
  return false;
}

dea_status dea_search_run(const struct dea_search *search, struct dea_optimum *out, size_t *count)
{
  (void)out;
  *count = 0;
  return dea_fail(search->ctx, DEA_E_UNSUPPORTED,
                  "dea optimise is not here: it is built when libnlopt-dev is installed");
}

#endif

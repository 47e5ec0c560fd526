/* Searches by NLopt in variables scaled to the range from 0 to 1. Each evaluation is kept in the
 * store; a search that is run again takes the same way, and so goes on where it was ended. */
#include "explore/optimise.h"

#include "explore/plan.h"
#include "explore/pool.h"

#include <math.h>
#include <nlopt.h>
#include <string.h>

// Objectives and limits ---------------------------------------------------------------------------

/* Scattered designs of one, or it alone. */
static size_t scattered(const struct dea_search *search)
{
  return search->scatter != NULL ? search->scatter_count : 1;
}

static void scatter(const struct dea_search *search, const double *p, size_t s, double *out)
{
  const size_t n = search->evaluator->param_count;
  for (size_t j = 0; j < n; j++) {
    out[j] = p[j] + (search->scatter != NULL ? search->scatter[s * n + j] : 0);
  }
}

/* The case of scattered design s of p by what the store has; NULL: it was not looked at. */
static const struct dea_case *case_of(const struct dea_search *search, const double *p, size_t s)
{
  double at[DEA_CASE_PARAMS_MAX];
  scatter(search, p, s, at);
  return dea_store_find(search->store, at);
}

/* Value r of a case: an objective, or what a limit is crossed by. */
static double value_of(const struct dea_search *search, size_t r, const double *q)
{
  return r < search->objective_count
             ? search->objective(search->user, r, q)
             : -search->margin(search->user, r - search->objective_count, q);
}

/* Values of scattered designs and what becomes of them: places in rising order for quantiles. */
struct spread {
  double value[DEA_EXPLORE_SCATTERED_MAX], mean, std;
  size_t order[DEA_EXPLORE_SCATTERED_MAX], count;
};

static void sort(struct spread *all)
{
  for (size_t i = 0; i < all->count; i++) { // few: by insertion, missing values last
    size_t k = i;
    for (; k > 0 && !(all->value[all->order[k - 1]] <= all->value[i]); k--) {
      all->order[k] = all->order[k - 1];
    }
    all->order[k] = i;
  }
}

/* Quantile of values in an order; the ends are not mixed with what is infinite. */
static double quantile_of(const struct dea_search *search, const struct spread *all,
                          const double *values)
{
  const double at = search->quantile * (double)(all->count - 1);
  const size_t below = (size_t)at, above = below + 1 < all->count ? below + 1 : below;
  const double low = values[all->order[below]], share = at - (double)below;
  return share > 0 ? low + share * (values[all->order[above]] - low) : low;
}

/* Statistic of value r over all scattered designs of p, which are there. */
static double statistic_of(const struct dea_search *search, const double *p, size_t r,
                           struct spread *all)
{
  all->count = scattered(search);
  for (size_t s = 0; s < all->count; s++) {
    all->value[s] = value_of(search, r, case_of(search, p, s)->q);
  }
  if (!isnan(search->quantile) && all->count > 1) {
    for (size_t i = 0; i < all->count; i++) {
      all->value[i] = isnan(all->value[i]) ? INFINITY : all->value[i];
    }
    sort(all);
    const double out = quantile_of(search, all, all->value);
    return isfinite(out) ? out : NAN;
  }
  double sum = 0, squares = 0;
  for (size_t i = 0; i < all->count; i++) {
    sum += all->value[i];
  }
  all->mean = sum / (double)all->count;
  for (size_t i = 0; i < all->count; i++) {
    squares += pow(all->value[i] - all->mean, 2);
  }
  all->std = all->count > 1 ? sqrt(squares / (double)(all->count - 1)) : 0;
  return all->mean + (all->count > 1 ? search->spread * all->std : 0);
}

/* Slope of that by one variable, of the slopes of all values. */
static double statistic_slope(const struct dea_search *search, const struct spread *all,
                              const double *slopes)
{
  if (!isnan(search->quantile) && all->count > 1) {
    return quantile_of(search, all, slopes);
  }
  double mean = 0, product = 0;
  for (size_t i = 0; i < all->count; i++) {
    mean += slopes[i] / (double)all->count;
    product += (all->value[i] - all->mean) * slopes[i];
  }
  return all->std > 0 ? mean + search->spread * product / ((double)(all->count - 1) * all->std)
                      : mean;
}

bool dea_search_compute(const struct dea_search *search, const double *p, double *out)
{
  struct spread all;
  for (size_t s = 0; s < scattered(search); s++) {
    if (case_of(search, p, s) == NULL) {
      return false;
    }
  }
  for (size_t r = 0; r < search->objective_count + search->limit_count; r++) {
    out[r] = statistic_of(search, p, r, &all);
  }
  return true;
}

unsigned dea_search_marks(const struct dea_search *search, const double *p, size_t k)
{
  unsigned marks = 0;
  for (size_t s = 0; s < scattered(search); s++) {
    const struct dea_case *done = case_of(search, p, s);
    marks |= done != NULL ? done->marks[k] : 0;
  }
  return marks;
}

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
  nlopt_opt opt;
  struct dea_optimum best;
  double best_f;
  double *around;            // points of one step, [2 searched or 1][scattered][params]
  size_t around_count, next; // of them: how many, and which is looked at next
};

// Evaluations -------------------------------------------------------------------------------------

static bool next_case(void *user, struct dea_case *out)
{
  struct work *w = user;
  const size_t n = w->search->evaluator->param_count;
  while (w->next < w->around_count) {
    const double *p = w->around + n * w->next++;
    if (dea_store_find(w->search->store, p) == NULL) {
      out->number = dea_store_count(w->search->store);
      memcpy(out->p, p, n * sizeof *p);
      return true;
    }
  }
  return false;
}

static dea_status keep(void *user, const struct dea_case *done)
{
  const struct dea_search *search = ((const struct work *)user)->search;
  dea_progress(search->ctx, "designs", dea_store_count(search->store) + 1, 0);
  return dea_store_add(search->store, done);
}

/* Adds the scattered designs of p to the points around. */
static void add_scattered(struct work *w, const double *p)
{
  for (size_t s = 0; s < scattered(w->search); s++) {
    scatter(w->search, p, s, w->around + w->around_count++ * w->search->evaluator->param_count);
  }
}

/* Has the points around evaluated, and takes them away. */
static bool evaluate(struct work *w)
{
  w->next = 0;
  if (w->status == DEA_OK && dea_interrupted(w->search->ctx)) {
    w->status = dea_fail(w->search->ctx, DEA_E_INTERRUPTED, "interrupted; what was done is kept");
  }
  if (w->status == DEA_OK) {
    w->status = dea_pool_run(w->pool, next_case, keep, w);
  }
  w->around_count = 0;
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

// Functions of a search ---------------------------------------------------------------------------

/* Number of functions: the objective, the limits, and the bound of the other objective. */
static size_t functions(const struct work *w)
{
  return 1 + w->search->limit_count + (isfinite(w->bound) ? 1U : 0U);
}

/* The value that function k is of, what is taken off it and what it is divided by. */
static size_t source_of(const struct work *w, size_t k, double *shift, double *scale)
{
  *shift = 0;
  *scale = 1;
  if (k > 0 && k <= w->search->limit_count) {
    return w->search->objective_count + k - 1;
  }
  const size_t objective = k == 0 ? w->wanted : 1 - w->wanted;
  *shift = k == 0 ? 0 : w->bound;
  *scale = w->scale[objective];
  return objective;
}

/* Notes a design that is within all limits and better than the best. Within the solver's tolerance
 * of a limit it pays for what it is beyond, so that it gains nothing by that. */
static void note(struct work *w, const double *p, const double *functions_of,
                 const double *objectives)
{
  double off = 0;
  for (size_t k = 1; k < functions(w); k++) {
    off = functions_of[k] <= 1e-6 ? fmax(off, functions_of[k]) : INFINITY; // NAN too
  }
  const double f = functions_of[0] + 100 * off;
  if (f < w->best_f) {
    w->best_f = f;
    w->best.found = true;
    memcpy(w->best.p, p, w->search->evaluator->param_count * sizeof *p);
    memcpy(w->best.f, objectives, w->search->objective_count * sizeof *objectives);
    w->best.evaluations = dea_store_count(w->search->store);
  }
}

// Gradients ---------------------------------------------------------------------------------------

/* Slope of value r of a case by a searched variable in units of its range, from the gradients that
 * the evaluator gives, NAN where it gives none: values are linear in those of the case, so that
 * their change over a step along the gradients is their derivative. */
static double slope_at(const struct work *w, size_t r, const struct dea_case *at, size_t i)
{
  const struct dea_evaluator *evaluator = w->search->evaluator;
  const size_t j = w->free[i];
  const double *slopes = at->q + evaluator->value_count,
               range = w->search->high[j] - w->search->low[j];
  double moved[DEA_CASE_VALUES_MAX];
  if (!evaluator->gradients) {
    return NAN;
  }
  for (size_t v = 0; v < evaluator->value_count; v++) {
    moved[v] = at->q[v] + range * slopes[v * evaluator->param_count + j];
  }
  return value_of(w->search, r, moved) - value_of(w->search, r, at->q);
}

/* The design at x with variable i moved within its range; where that is then. */
static double move_point(const struct work *w, const double *x, size_t i, double by, double *p)
{
  double y[DEA_CASE_PARAMS_MAX];
  memcpy(y, x, w->n * sizeof *y);
  y[i] = fmin(fmax(x[i] + by, 0), 1);
  point_of(w, y, p);
  return y[i];
}

/* The same by central differences, or one-sided where one of the two designs has no value or would
 * lie outside of the range; 0 where both are missing. */
static double difference_at(const struct work *w, size_t r, const double *x, size_t s, size_t i)
{
  double value[3], at[3], p[DEA_CASE_PARAMS_MAX];
  for (int k = 0; k < 3; k++) {
    at[k] = move_point(w, x, i, (k - 1) * difference, p);
    const struct dea_case *done = case_of(w->search, p, s);
    value[k] = done != NULL ? value_of(w->search, r, done->q) : NAN;
  }
  const size_t low = isnan(value[0]) ? 1U : 0U, high = isnan(value[2]) ? 1U : 2U;
  return at[high] > at[low] ? (value[high] - value[low]) / (at[high] - at[low]) : 0;
}

/* Whether the evaluator lacks a slope by a variable at p, of a value that is there. */
static bool is_lacking(const struct work *w, const double *p, size_t i)
{
  for (size_t s = 0; s < scattered(w->search); s++) {
    const struct dea_case *at = case_of(w->search, p, s);
    for (size_t k = 0; k < functions(w); k++) {
      double shift, scale;
      const size_t r = source_of(w, k, &shift, &scale);
      if (!isnan(value_of(w->search, r, at->q)) && isnan(slope_at(w, r, at, i))) {
        return true;
      }
    }
  }
  return false;
}

/* Has the designs x -+ h evaluated, for variables whose slopes the evaluator lacks at p, which is
 * x. */
static bool evaluate_around(struct work *w, const double *x, const double *p)
{
  const struct dea_search *search = w->search;
  double beside[DEA_CASE_PARAMS_MAX];
  for (size_t i = 0; i < w->n; i++) {
    if (!is_lacking(w, p, i)) {
      continue;
    }
    for (int k = -1; k <= 1; k += 2) {
      move_point(w, x, i, k * difference, beside);
      add_scattered(w, beside);
    }
    if (search->replaced != NULL) {
      search->replaced[w->free[i]]++;
    }
  }
  return w->around_count == 0 || evaluate(w);
}

/* Slope of value r by variable i at x, which is p. all: the values, as the statistic left them. */
static double slope_of(const struct work *w, size_t r, const struct spread *all, const double *x,
                       const double *p, size_t i)
{
  double slopes[DEA_EXPLORE_SCATTERED_MAX];
  for (size_t s = 0; s < all->count; s++) {
    slopes[s] = slope_at(w, r, case_of(w->search, p, s), i);
    slopes[s] = isnan(slopes[s]) ? difference_at(w, r, x, s, i) : slopes[s];
  }
  const double slope = statistic_slope(w->search, all, slopes);
  return isfinite(slope) ? slope : 0;
}

/* All functions at x, and their gradients [functions][n] (NULL: not wanted). */
static void functions_at(struct work *w, const double *x, double *values, double *gradients)
{
  const struct dea_search *search = w->search;
  const size_t count = functions(w);
  double p[DEA_CASE_PARAMS_MAX], looked[DEA_SEARCH_VALUES_MAX];
  memset(values, 0, count * sizeof *values);
  if (gradients != NULL) {
    memset(gradients, 0, count * w->n * sizeof *gradients);
  }
  point_of(w, x, p);
  add_scattered(w, p);
  if (!evaluate(w) || (gradients != NULL && !evaluate_around(w, x, p))) {
    return;
  }
  dea_search_compute(search, p, looked);
  for (size_t k = 0; k < count; k++) {
    double shift, scale;
    const size_t r = source_of(w, k, &shift, &scale);
    struct spread all;
    values[k] = (statistic_of(search, p, r, &all) - shift) / scale;
    for (size_t i = 0; i < w->n && gradients != NULL && isfinite(values[k]); i++) {
      gradients[k * w->n + i] = slope_of(w, r, &all, x, p, i) / scale;
    }
  }
  note(w, p, values, looked);
  w->worst = isfinite(values[0]) ? fmax(w->worst, values[0]) : w->worst;
  for (size_t k = 0; k < count; k++) {
    if (!isfinite(values[k])) {
      values[k] = k == 0 ? w->worst + 1 : 1;
    }
  }
}

enum { FUNCTIONS_MAX = DEA_SEARCH_VALUES_MAX };

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
  DEA_TRY_MEMORY(u != NULL);
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
  double looked[DEA_SEARCH_VALUES_MAX] = {0};
  add_scattered(w, search->start);
  const bool done = evaluate(w) && dea_search_compute(search, search->start, looked);
  for (size_t k = 0; k < DEA_EXPLORE_OBJECTIVES_MAX; k++) {
    const double f = done && k < search->objective_count ? fabs(looked[k]) : NAN;
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
  DEA_TRY_MEMORY(w != NULL);
  w->search = search;
  w->bound = INFINITY;
  w->worst = -INFINITY;
  w->around = dea_alloc(
      search->ctx, 2 * DEA_CASE_PARAMS_MAX * scattered(search) * search->evaluator->param_count,
      sizeof *w->around);
  w->status = w->around != NULL
                  ? dea_pool_create(search->ctx, search->evaluator, search->processes, &w->pool)
                  : DEA_E_MEMORY;
  dea_status status = w->status == DEA_OK ? find_scale(w) : w->status;
  w->worst = 1;
  status = status == DEA_OK ? search_all(w, NULL) : status;
  if (status == DEA_OK) {
    out[0] = w->best;
    *count = w->best.found ? 1 : 0;
    status = search->objective_count > 1 ? find_front(w, out, count) : DEA_OK;
  }
  dea_pool_destroy(w->pool);
  dea_free(search->ctx, w->around);
  dea_free(search->ctx, w);
  return status;
}

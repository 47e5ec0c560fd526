/* What a fit says beyond its numbers: combinations of parameters that the tests do not tell apart,
 * where the law ends to be stable, and which test or measurement would tell most. */
#include "identify/device_fit.h"

#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- combinations ---- */

/* A direction that the measurements (`what`: "tests") do not hold, or hardly: of two parameters of
 * one unit what they do hold, else the direction in units of the scales. */
static void name_direction(const struct dea_fit_param *params, size_t n, const double *direction,
                           bool open, const char *what, char out[DEA_FIT_WEAK_SIZE])
{
  size_t index[DEA_LSQ_PARAMS_MAX], count = 0;
  double most = 0;
  for (size_t j = 0; j < n; j++) {
    most = fmax(most, fabs(direction[j] / params[j].scale));
  }
  for (size_t j = 0; j < n; j++) {
    if (fabs(direction[j] / params[j].scale) > 0.05 * most) {
      index[count++] = j;
    }
  }
  const char *hold = open ? "determine only" : "hold little more than";
  if (count == 1) {
    snprintf(out, DEA_FIT_WEAK_SIZE, "the %s hardly determine %s", what, params[index[0]].name);
    return;
  }
  if (count == 2 && strcmp(params[index[0]].unit, params[index[1]].unit) == 0) {
    const double share = -direction[index[0]] / direction[index[1]]; // a + share b stays
    snprintf(out, DEA_FIT_WEAK_SIZE, "the %s %s %s %c %.3g %s", what, hold, params[index[0]].name,
             share > 0 ? '+' : '-', fabs(share), params[index[1]].name);
    return;
  }
  size_t used = (size_t)snprintf(out, DEA_FIT_WEAK_SIZE, "the %s %s notice a change of", what,
                                 open ? "do not" : "hardly");
  for (size_t k = 0; k < count && used < 160; k++) {
    const double part = direction[index[k]] / direction[index[0]];
    const double ratio = params[index[k]].scale / params[index[0]].scale;
    used += (size_t)snprintf(out + used, DEA_FIT_WEAK_SIZE - used, "%s %+.2g x %s",
                             k > 0 ? "," : "", part / ratio, params[index[k]].name);
  }
}

size_t dea_fit_identify_weak(const struct dea_fit_param *params, const struct dea_lsq_statistics *s,
                             const char *what, char out[DEA_FIT_WEAK_MAX][DEA_FIT_WEAK_SIZE])
{
  size_t count = 0;
  for (size_t k = s->active; k-- > 0 && count < DEA_FIT_WEAK_MAX;) {
    if (s->singular[k] * DEA_FIT_WEAK_CONDITION < s->singular[0]) {
      name_direction(params, s->params, s->direction + k * s->params, dea_lsq_is_open(s, k), what,
                     out[count++]);
    }
  }
  return count;
}

/* ---- stability ---- */

double dea_fit_unstable_from(const struct dea_material *material, enum dea_coupon_mode mode,
                             double to)
{
  enum { STEPS = 200 };
  for (int k = 0; k <= STEPS; k++) {
    const double l = 1 + (to - 1) * k / STEPS;
    if (!dea_coupon_is_stable(material, l, dea_coupon_across(mode, l))) {
      return l;
    }
  }
  return NAN;
}

void dea_fit_identify_stability(struct dea_fit *fit)
{
  struct dea_material material;
  dea_fit_model_material(&fit->model, fit->least_squares.p, NULL, &material);
  for (int mode = 0; mode < DEA_COUPON_MODES; mode++) {
    struct dea_fit_stability *stability = &fit->stability[mode];
    *stability = (struct dea_fit_stability){.mode = (enum dea_coupon_mode)mode, .to = 1};
    for (size_t s = 0; s < fit->series_count; s++) {
      const struct dea_fit_series *series = &fit->series[s];
      if (dea_fit_series_used(series) && (int)series->coupon.mode == mode) {
        stability->measured = true;
        for (size_t i = 0; i < series->rows; i++) {
          stability->to = fmax(stability->to, series->stretch[i]);
        }
      }
    }
    if (!stability->measured) {
      stability->to =
          fmax(fit->stretch_max, dea_fit_stretch_as_far((enum dea_coupon_mode)mode, fit->I1_max));
    }
    stability->unstable_from =
        dea_fit_unstable_from(&material, (enum dea_coupon_mode)mode, stability->to);
  }
}

double dea_fit_stretch_as_far(enum dea_coupon_mode mode, double I1)
{
  double low = 1, high = fmax(sqrt(I1), 2);
  for (int k = 0; k < 60; k++) {
    const double l = 0.5 * (low + high);
    if (dea_coupon_I1(mode, l) < I1) {
      low = l;
    } else {
      high = l;
    }
  }
  return low;
}

/* ---- the next test ---- */

enum { NEXT_ROWS = 10 };

static const double open_share = 1e-9; // added to J'J: what nothing is known of stays finite

/* What measurements hold of the parameters of a fit: J'J over those that are free, each in units
 * that give its own column the length 1. For D-optimality: which measurement would add most. */
struct information {
  size_t active[DEA_LSQ_PARAMS_MAX], count; // neither held nor at a bound
  double length[DEA_LSQ_PARAMS_MAX];
  double A[DEA_LSQ_PARAMS_MAX * DEA_LSQ_PARAMS_MAX]; // [count x count]
};

/* Adds rows; J: [rows x params] by columns, over the rows' uncertainties; all times `weight`. */
static void add_rows(struct information *to, const double *J, size_t rows, double weight)
{
  const size_t k = to->count;
  for (size_t a = 0; a < k; a++) {
    for (size_t b = 0; b < k; b++) {
      double sum = 0;
      for (size_t i = 0; i < rows; i++) {
        sum += J[to->active[a] * rows + i] * J[to->active[b] * rows + i];
      }
      to->A[a * k + b] += weight * sum / (to->length[a] * to->length[b]);
    }
  }
}

/* That of a fit whose residuals have the variance that its statistics say. scale: [params], taken
 * where the rows do not notice a parameter. What nothing is known of stays a finite number. */
static void begin_information(const struct dea_lsq_fit *fit, double variance, const double *scale,
                              struct information *out)
{
  *out = (struct information){.count = 0};
  for (size_t j = 0; j < fit->params; j++) {
    if (!fit->held[j] && !fit->at_bound[j]) {
      double sum = 0;
      for (size_t i = 0; i < fit->rows; i++) {
        sum += fit->J[j * fit->rows + i] * fit->J[j * fit->rows + i];
      }
      out->length[out->count] = sum > 0 ? sqrt(sum) : 1 / scale[j];
      out->active[out->count++] = j;
    }
  }
  add_rows(out, fit->J, fit->rows, 1 / variance);
  for (size_t a = 0; a < out->count; a++) {
    out->A[a * out->count + a] += open_share / variance;
  }
}

/* ln det A, and the diagonal of its inverse [count]. */
static double factor(const struct information *of, double *variance)
{
  const size_t k = of->count;
  double A[DEA_LSQ_PARAMS_MAX * DEA_LSQ_PARAMS_MAX], sum = 0;
  memcpy(A, of->A, k * k * sizeof *A);
  LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', (lapack_int)k, A, (lapack_int)k);
  for (size_t j = 0; j < k; j++) {
    sum += 2 * log(A[j * k + j]);
  }
  LAPACKE_dpotri(LAPACK_COL_MAJOR, 'L', (lapack_int)k, A, (lapack_int)k);
  for (size_t j = 0; j < k; j++) {
    variance[j] = A[j * k + j];
  }
  return sum;
}

/* Adds a measurement to a list [DEA_FIT_NEXT_MAX], the best first. */
static void add_next(struct dea_fit_next *list, size_t *count, const char *what, double shrink)
{
  size_t at = *count;
  while (at > 0 && list[at - 1].shrink > shrink) {
    at--;
  }
  if (at < DEA_FIT_NEXT_MAX) {
    const size_t kept = *count < DEA_FIT_NEXT_MAX ? *count : DEA_FIT_NEXT_MAX - 1;
    memmove(&list[at + 1], &list[at], (kept - at) * sizeof *list);
    list[at].shrink = shrink;
    snprintf(list[at].what, sizeof list[at].what, "%.79s", what);
    *count = kept + 1;
  }
}

/* A test that could be made, with ten rows up to the I1 that the data reach. */
static dea_status propose(struct dea_arena *arena, const struct dea_fit *fit, int which,
                          double longest_s, struct dea_fit_series *series, char what[80])
{
  double *stretch = dea_arena_alloc(arena, NEXT_ROWS, sizeof *stretch);
  double *time = dea_arena_alloc(arena, NEXT_ROWS, sizeof *time);
  DEA_TRY(arena->ctx, dea_arena_status(arena));
  const bool relaxation = which == DEA_COUPON_MODES;
  const enum dea_coupon_mode mode = relaxation ? DEA_UNIAXIAL : (enum dea_coupon_mode)which;
  const double to = dea_fit_stretch_as_far(mode, fit->I1_max);
  for (size_t i = 0; i < NEXT_ROWS; i++) {
    const double x = (double)(i + 1) / NEXT_ROWS;
    stretch[i] = relaxation ? to : 1 + (to - 1) * x;
    time[i] = longest_s * pow(10, 1 - 4 * (1 - x)); // four decades, to ten times as long
  }
  *series = (struct dea_fit_series){.rows = NEXT_ROWS, .stretch = stretch, .time_s = time};
  series->coupon = (struct dea_coupon){.mode = mode, .rows = NEXT_ROWS, .stretch = stretch};
  if (relaxation) {
    snprintf(what, 80, "relaxation at %.3g for %.3g s", to, 10 * longest_s);
    return dea_coupon_follow(arena, time, time[0], &series->coupon);
  }
  snprintf(what, 80, "%s to %.3g, slowly", dea_coupon_mode_names[mode], to);
  return DEA_OK;
}

/* Median share of the stress that its standard uncertainty has; a mean does here. */
static double relative_uncertainty(const struct dea_fit *fit)
{
  double sum = 0;
  size_t count = 0;
  for (size_t s = 0; s < fit->series_count; s++) {
    const struct dea_fit_series *series = &fit->series[s];
    for (size_t i = 0; i < series->rows && dea_fit_series_used(series); i++) {
      const double std = isnan(series->std_Pa[i]) ? fit->scatter_Pa : series->std_Pa[i];
      sum += log(std / fabs(series->stress_Pa[i]));
      count++;
    }
  }
  return exp(sum / (double)count) * sqrt(fit->statistics.variance);
}

static double longest_time(const struct dea_fit *fit)
{
  double most = 0;
  for (size_t s = 0; s < fit->series_count; s++) {
    const struct dea_fit_series *series = &fit->series[s];
    if (series->time_s != NULL && series->rows > 0 && dea_fit_series_used(series)) {
      most = fmax(most, series->time_s[series->rows - 1]);
    }
  }
  return most;
}

static dea_status weigh(struct dea_context *ctx, struct dea_arena *arena, struct dea_fit *fit,
                        int which, const struct information *base)
{
  const size_t n = fit->model.count;
  struct dea_fit_series series;
  struct dea_lsq_problem problem;
  char what[80];
  struct information now = *base;
  double stress[NEXT_ROWS], variance[DEA_LSQ_PARAMS_MAX];
  DEA_TRY(ctx, propose(arena, fit, which, longest_time(fit), &series, what));
  double *J = dea_arena_alloc(arena, NEXT_ROWS * n, sizeof *J);
  DEA_TRY(ctx, dea_fit_model_stress(arena, &fit->model, &series, &problem));
  if (problem.residual(problem.user, fit->least_squares.p, stress) != DEA_OK ||
      dea_lsq_jacobian(ctx, &problem, fit->least_squares.p, J) != DEA_OK) {
    dea_context_clear(ctx);
    return DEA_OK; // beyond the law: no advice
  }
  const double share = relative_uncertainty(fit);
  for (size_t k = 0; k < NEXT_ROWS * n; k++) {
    J[k] /= share * fmax(fabs(stress[k % NEXT_ROWS]), 1e-12);
  }
  add_rows(&now, J, NEXT_ROWS, 1);
  const double gain = factor(&now, variance) - factor(base, variance);
  add_next(fit->next, &fit->next_count, what, exp(-0.5 * gain / (double)base->count));
  return DEA_OK;
}

dea_status dea_fit_identify_next(struct dea_context *ctx, struct dea_fit *fit)
{
  struct information base;
  double scale[DEA_LSQ_PARAMS_MAX];
  struct dea_arena arena = {.ctx = ctx};
  dea_status status = DEA_OK;
  if (fit->statistics.active == 0 || !isfinite(fit->statistics.variance)) {
    return DEA_OK;
  }
  for (size_t j = 0; j < fit->model.count; j++) {
    scale[j] = fit->model.params[j].scale;
  }
  begin_information(&fit->least_squares, fit->statistics.variance, scale, &base);
  const int last = fit->model.branch_count > 0 ? DEA_COUPON_MODES : DEA_COUPON_MODES - 1;
  for (int which = 0; which <= last && status == DEA_OK; which++) {
    status = weigh(ctx, &arena, fit, which, &base);
  }
  dea_arena_free(&arena);
  return status;
}

/* ---- a device ---- */

static const double close_correlation = 0.95; // of two parameters that are told

static size_t place_of(const struct information *of, size_t param)
{
  size_t a = 0;
  while (a < of->count && of->active[a] != param) {
    a++;
  }
  return a;
}

/* What a candidate does for each pair. */
static void help_pairs(struct dea_device_fit *fit, const struct information *base,
                       const double *before, const double *after, const char *what)
{
  for (size_t k = 0; k < fit->pair_count; k++) {
    struct dea_device_pair *pair = &fit->pairs[k];
    const size_t a = place_of(base, pair->first), b = place_of(base, pair->second);
    if (a == base->count || b == base->count) {
      continue;
    }
    const double shrink = sqrt(fmax(after[a] / before[a], after[b] / before[b]));
    if (shrink < 0.7 && (pair->next[0] == '\0' || shrink < pair->shrink)) {
      snprintf(pair->next, sizeof pair->next, "%s", what);
      pair->shrink = shrink;
    }
  }
}

static void add_pair(struct dea_device_fit *fit, size_t a, size_t b, double correlation)
{
  if (fit->pair_count < DEA_DEVICE_PAIRS_MAX) {
    fit->pairs[fit->pair_count++] =
        (struct dea_device_pair){.first = a, .second = b, .correlation = correlation};
  }
}

/* Pairs that correlate, and parameters that one open direction moves together. */
static void find_pairs(struct dea_device_fit *fit)
{
  const struct dea_lsq_statistics *s = &fit->statistics;
  for (size_t a = 0; a < s->params; a++) {
    for (size_t b = 0; b < a; b++) {
      const double correlation = s->correlation[a * s->params + b];
      if (isfinite(s->std[a]) && isfinite(s->std[b]) && fabs(correlation) > close_correlation) {
        add_pair(fit, b, a, correlation);
      }
    }
  }
  for (size_t k = s->active; k-- > 0;) {
    const double *direction = s->direction + k * s->params;
    double largest[2] = {0, 0};
    size_t index[2] = {0, 0};
    if (s->singular[k] > 1e-9 * s->singular[0]) {
      break;
    }
    for (size_t j = 0; j < s->params; j++) {
      const double share = fabs(direction[j] / fit->params[j].param.scale);
      if (share > largest[0]) {
        largest[1] = largest[0];
        index[1] = index[0];
        largest[0] = share;
        index[0] = j;
      } else if (share > largest[1]) {
        largest[1] = share;
        index[1] = j;
      }
    }
    if (largest[1] > 1e-3 * largest[0]) {
      const bool in_order = index[0] < index[1];
      add_pair(fit, index[in_order ? 0 : 1], index[in_order ? 1 : 0], NAN);
    }
  }
}

void dea_device_identify(struct dea_device_fit *fit, const struct dea_device_candidate *candidates,
                         size_t count)
{
  struct information base, now;
  double scale[DEA_DEVICE_PARAMS_MAX];
  double before[DEA_DEVICE_PARAMS_MAX], after[DEA_DEVICE_PARAMS_MAX];
  struct dea_fit_param params[DEA_DEVICE_PARAMS_MAX];
  for (size_t j = 0; j < fit->param_count; j++) {
    params[j] = fit->params[j].param;
    scale[j] = params[j].scale;
  }
  fit->weak_count = dea_fit_identify_weak(params, &fit->statistics, "curves", fit->weak);
  find_pairs(fit);
  if (fit->statistics.active == 0 || !isfinite(fit->statistics.variance)) {
    return;
  }
  begin_information(&fit->least_squares, fit->statistics.variance, scale, &base);
  const double without = factor(&base, before);
  for (size_t c = 0; c < count; c++) {
    now = base;
    add_rows(&now, candidates[c].J, candidates[c].rows, 1);
    const double gain = factor(&now, after) - without;
    add_next(fit->next, &fit->next_count, candidates[c].what,
             exp(-0.5 * gain / (double)base.count));
    help_pairs(fit, &base, before, after, candidates[c].what);
  }
}

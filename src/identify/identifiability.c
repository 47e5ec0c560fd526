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

void dea_fit_identify_weak(struct dea_fit_core *core, const char *what)
{
  const struct dea_lsq_statistics *s = &core->statistics;
  for (size_t k = s->active; k-- > 0 && core->weak_count < DEA_FIT_WEAK_MAX;) {
    if (s->singular[k] * DEA_FIT_WEAK_CONDITION < s->singular[0]) {
      char text[DEA_FIT_WEAK_SIZE] = "";
      name_direction(core->params, s->params, s->direction + k * s->params, dea_lsq_is_open(s, k),
                     what, text);
      memcpy(core->weak[core->weak_count++], text, sizeof text);
    }
  }
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
  dea_fit_model_material(&fit->model, fit->core.least_squares.p, NULL, &material);
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

/* ---- the next measurement ---- */

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

/* That of a fit whose residuals have the variance that its statistics say. Scales are taken where
 * the rows do not notice a parameter. What nothing is known of stays a finite number. */
static void begin_information(const struct dea_fit_core *core, struct information *out)
{
  const struct dea_lsq_fit *fit = &core->least_squares;
  const double variance = core->statistics.variance;
  *out = (struct information){.count = 0};
  for (size_t j = 0; j < fit->params; j++) {
    if (!fit->held[j] && !fit->at_bound[j]) {
      double sum = 0;
      for (size_t i = 0; i < fit->rows; i++) {
        sum += fit->J[j * fit->rows + i] * fit->J[j * fit->rows + i];
      }
      out->length[out->count] = sum > 0 ? sqrt(sum) : 1 / core->params[j].scale;
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

/* Adds a measurement to the list of the next ones. */
static void add_next(struct dea_fit_core *core, const char *what, double shrink)
{
  struct dea_fit_next *list = core->next;
  size_t at = core->next_count;
  while (at > 0 && list[at - 1].shrink > shrink) {
    at--;
  }
  if (at < DEA_FIT_NEXT_MAX) {
    const size_t kept =
        core->next_count < DEA_FIT_NEXT_MAX ? core->next_count : DEA_FIT_NEXT_MAX - 1;
    memmove(&list[at + 1], &list[at], (kept - at) * sizeof *list);
    list[at].shrink = shrink;
    snprintf(list[at].what, sizeof list[at].what, "%.79s", what);
    core->next_count = kept + 1;
  }
}

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

/* Adds what each of the measurements would do to the list of the next ones. device: whose pairs it
 * would part; NULL: a material. */
static void rank(struct dea_fit_core *core, const struct dea_fit_proposal *list, size_t count,
                 struct dea_device_fit *device)
{
  struct information base, now;
  double before[DEA_LSQ_PARAMS_MAX], after[DEA_LSQ_PARAMS_MAX];
  if (core->statistics.active == 0 || !isfinite(core->statistics.variance)) {
    return;
  }
  begin_information(core, &base);
  const double without = factor(&base, before);
  for (size_t c = 0; c < count; c++) {
    now = base;
    add_rows(&now, list[c].J, list[c].rows, 1);
    const double gain = factor(&now, after) - without;
    add_next(core, list[c].what, exp(-0.5 * gain / (double)base.count));
    if (device != NULL) {
      help_pairs(device, &base, before, after, list[c].what);
    }
  }
}

/* ---- the next test of a material ---- */

/* Median share of the stress that its standard uncertainty has; a mean does here. */
static double relative_uncertainty(const struct dea_fit *fit)
{
  double sum = 0;
  size_t count = 0;
  for (size_t s = 0; s < fit->series_count; s++) {
    const struct dea_fit_series *series = &fit->series[s];
    for (size_t i = 0; i < series->rows && dea_fit_series_used(series); i++) {
      const double std = isnan(series->std_Pa[i]) ? fit->core.scatter : series->std_Pa[i];
      sum += log(std / fabs(series->stress_Pa[i]));
      count++;
    }
  }
  return exp(sum / (double)count) * sqrt(fit->core.statistics.variance);
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

/* Adds a test that could be made, with ten rows up to the I1 that the data reach. */
static dea_status propose(struct dea_arena *arena, const struct dea_fit *fit, int which,
                          struct dea_fit_proposal *list, size_t *count)
{
  struct dea_fit_proposal *out = &list[*count];
  struct dea_lsq_problem problem;
  double stress[NEXT_ROWS];
  double *stretch = dea_arena_alloc(arena, NEXT_ROWS, sizeof *stretch);
  double *time = dea_arena_alloc(arena, NEXT_ROWS, sizeof *time);
  double *J = dea_arena_alloc(arena, NEXT_ROWS * fit->model.count, sizeof *J);
  DEA_TRY(arena->ctx, dea_arena_status(arena));
  const bool relaxation = which == DEA_COUPON_MODES;
  const enum dea_coupon_mode mode = relaxation ? DEA_UNIAXIAL : (enum dea_coupon_mode)which;
  const double to = dea_fit_stretch_as_far(mode, fit->I1_max), longest_s = longest_time(fit);
  for (size_t i = 0; i < NEXT_ROWS; i++) {
    const double x = (double)(i + 1) / NEXT_ROWS;
    stretch[i] = relaxation ? to : 1 + (to - 1) * x;
    time[i] = longest_s * pow(10, 1 - 4 * (1 - x)); // four decades, to ten times as long
  }
  struct dea_fit_series series = {.rows = NEXT_ROWS, .stretch = stretch, .time_s = time};
  series.coupon = (struct dea_coupon){.mode = mode, .rows = NEXT_ROWS, .stretch = stretch};
  if (relaxation) {
    snprintf(out->what, sizeof out->what, "relaxation at %.3g for %.3g s", to, 10 * longest_s);
    DEA_TRY(arena->ctx, dea_coupon_follow(arena, time, time[0], &series.coupon));
  } else {
    snprintf(out->what, sizeof out->what, "%s to %.3g, slowly", dea_coupon_mode_names[mode], to);
  }
  DEA_TRY(arena->ctx, dea_fit_model_stress(arena, &fit->model, &series, &problem));
  if (problem.residual(problem.user, fit->core.least_squares.p, stress) != DEA_OK ||
      dea_lsq_jacobian(arena->ctx, &problem, fit->core.least_squares.p, J) != DEA_OK) {
    dea_context_clear(arena->ctx);
    return DEA_OK; // beyond the law: no advice
  }
  const double share = relative_uncertainty(fit);
  for (size_t k = 0; k < NEXT_ROWS * fit->model.count; k++) {
    J[k] /= share * fmax(fabs(stress[k % NEXT_ROWS]), 1e-12);
  }
  out->rows = NEXT_ROWS;
  out->J = J;
  ++*count;
  return DEA_OK;
}

dea_status dea_fit_identify_next(struct dea_context *ctx, struct dea_fit *fit)
{
  struct dea_fit_proposal list[DEA_COUPON_MODES + 1];
  size_t count = 0;
  struct dea_arena arena = {.ctx = ctx};
  dea_status status = DEA_OK;
  const int last = fit->model.branch_count > 0 ? DEA_COUPON_MODES : DEA_COUPON_MODES - 1;
  const struct dea_lsq_statistics *found = &fit->core.statistics;
  const bool any = found->active > 0 && isfinite(found->variance);
  for (int which = 0; which <= last && any && status == DEA_OK; which++) {
    status = propose(&arena, fit, which, list, &count);
  }
  if (status == DEA_OK) {
    rank(&fit->core, list, count, NULL);
  }
  dea_arena_free(&arena);
  return status;
}

/* ---- a device ---- */

static const double close_correlation = 0.95; // of two parameters that are told

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
  const struct dea_lsq_statistics *s = &fit->core.statistics;
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
    if (!dea_lsq_is_open(s, k)) {
      break;
    }
    for (size_t j = 0; j < s->params; j++) {
      const double share = fabs(direction[j] / fit->core.params[j].scale);
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

void dea_device_identify(struct dea_device_fit *fit, const struct dea_fit_proposal *list,
                         size_t count)
{
  dea_fit_identify_weak(&fit->core, "curves");
  find_pairs(fit);
  rank(&fit->core, list, count, fit);
}

/* What a fit says beyond its numbers: combinations of parameters that the tests do not tell apart,
 * where the law ends to be stable, and which test would tell most. */
#include "calibrate/fit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- combinations ---- */

void dea_fit_tell_direction(const struct dea_fit_param *params, size_t n, const double *direction,
                            bool open, const char *what, char out[200])
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
    snprintf(out, 200, "the %s hardly determine %s", what, params[index[0]].name);
    return;
  }
  if (count == 2 && strcmp(params[index[0]].unit, params[index[1]].unit) == 0) {
    const double share = -direction[index[0]] / direction[index[1]]; // a + share b stays
    snprintf(out, 200, "the %s %s %s %c %.3g %s", what, hold, params[index[0]].name,
             share > 0 ? '+' : '-', fabs(share), params[index[1]].name);
    return;
  }
  size_t used =
      (size_t)snprintf(out, 200, "the %s %s notice a change of", what, open ? "do not" : "hardly");
  for (size_t k = 0; k < count && used < 160; k++) {
    const double part = direction[index[k]] / direction[index[0]];
    const double ratio = params[index[k]].scale / params[index[0]].scale;
    used += (size_t)snprintf(out + used, 200 - used, "%s %+.2g x %s", k > 0 ? "," : "",
                             part / ratio, params[index[k]].name);
  }
}

void dea_fit_tell_weak(struct dea_fit *fit)
{
  const struct dea_lsq_statistics *s = &fit->statistics;
  for (size_t k = s->active; k-- > 0 && fit->weak_count < DEA_FIT_WEAK_MAX;) {
    if (s->singular[k] * DEA_FIT_WEAK_CONDITION < s->singular[0]) {
      dea_fit_tell_direction(fit->model.params, fit->model.count, s->direction + k * s->params,
                             s->singular[k] <= 1e-9 * s->singular[0], "tests",
                             fit->weak[fit->weak_count++]);
    }
  }
}

/* ---- stability ---- */

void dea_fit_tell_stability(struct dea_fit *fit)
{
  enum { STEPS = 200 };
  struct dea_material material;
  dea_fit_model_material(&fit->model, fit->least_squares.p, &material);
  for (int mode = 0; mode < DEA_COUPON_MODES; mode++) {
    struct dea_fit_stability *stability = &fit->stability[mode];
    *stability = (struct dea_fit_stability){
        .mode = (enum dea_coupon_mode)mode, .to = 1, .unstable_from = NAN};
    for (size_t s = 0; s < fit->series_count; s++) {
      const struct dea_fit_series *series = &fit->series[s];
      if (dea_fit_series_used(series) && (int)series->coupon.mode == mode) {
        stability->measured = true;
        for (size_t i = 0; i < series->rows; i++) {
          stability->to = fmax(stability->to, series->stretch[i]);
        }
      }
    }
    stability->to = stability->measured ? stability->to : fit->stretch_max;
    for (int k = 0; k <= STEPS && isnan(stability->unstable_from); k++) {
      const double l = 1 + (stability->to - 1) * k / STEPS;
      if (!dea_coupon_is_stable(&material, l, dea_coupon_across((enum dea_coupon_mode)mode, l))) {
        stability->unstable_from = l;
      }
    }
  }
}

/* ---- the next test ---- */

enum { NEXT_ROWS = 10 };

/* J'J over the active parameters, scaled: out [n x n]. */
static void add_information(const double *J, const double *weight, size_t m, size_t n,
                            const size_t *active, const double *length, double *out, size_t k)
{
  (void)n;
  for (size_t a = 0; a < k; a++) {
    for (size_t b = 0; b < k; b++) {
      double sum = 0;
      for (size_t i = 0; i < m; i++) {
        sum += weight[i] * weight[i] * J[active[a] * m + i] * J[active[b] * m + i];
      }
      out[a * k + b] += sum / (length[a] * length[b]);
    }
  }
}

/* ln det of a positive matrix by Cholesky; A is destroyed. */
static double log_determinant(double *A, size_t k)
{
  double sum = 0;
  for (size_t j = 0; j < k; j++) {
    for (size_t i = j; i < k; i++) {
      double s = A[i * k + j];
      for (size_t l = 0; l < j; l++) {
        s -= A[i * k + l] * A[j * k + l];
      }
      A[i * k + j] = i == j ? sqrt(fmax(s, 1e-300)) : s / A[j * k + j];
    }
    sum += 2 * log(A[j * k + j]);
  }
  return sum;
}

/* Stretch of that mode with the I1 of a uniaxial stretch. */
static double as_far(enum dea_coupon_mode mode, double uniaxial)
{
  const double wanted = uniaxial * uniaxial + 2 / uniaxial;
  double low = 1, high = fmax(uniaxial, 1.0001) * 2;
  for (int k = 0; k < 60; k++) {
    const double l = 0.5 * (low + high), l2 = dea_coupon_across(mode, l);
    const double I1 = l * l + l2 * l2 + 1 / (l * l * l2 * l2);
    if (I1 < wanted) {
      low = l;
    } else {
      high = l;
    }
  }
  return low;
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
  const double to = as_far(mode, fit->stretch_max);
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
                        int which, const size_t *active, const double *length, const double *base)
{
  const size_t k = fit->statistics.active;
  struct dea_fit_series series;
  struct dea_lsq_problem problem;
  struct dea_fit_next next;
  DEA_TRY(ctx, propose(arena, fit, which, longest_time(fit), &series, next.what));
  double stress[NEXT_ROWS], weight[NEXT_ROWS];
  double *J = dea_arena_alloc(arena, NEXT_ROWS * fit->model.count, sizeof *J);
  double *A = dea_arena_alloc(arena, 2 * k * k, sizeof *A);
  DEA_TRY(ctx, dea_fit_model_stress(arena, &fit->model, &series, &problem));
  if (problem.residual(problem.user, fit->least_squares.p, stress) != DEA_OK ||
      dea_lsq_jacobian(ctx, &problem, fit->least_squares.p, J) != DEA_OK) {
    dea_context_clear(ctx);
    return DEA_OK; // beyond the law: no advice
  }
  const double share = relative_uncertainty(fit);
  for (size_t i = 0; i < NEXT_ROWS; i++) {
    weight[i] = 1 / (share * fmax(fabs(stress[i]), 1e-12));
  }
  memcpy(A, base, k * k * sizeof *A);
  memcpy(A + k * k, base, k * k * sizeof *A);
  add_information(J, weight, NEXT_ROWS, fit->model.count, active, length, A, k);
  const double gain = log_determinant(A, k) - log_determinant(A + k * k, k);
  next.shrink = exp(-0.5 * gain / (double)k);
  size_t at = fit->next_count++;
  for (; at > 0 && fit->next[at - 1].shrink > next.shrink; at--) {
    fit->next[at] = fit->next[at - 1];
  }
  fit->next[at] = next;
  return DEA_OK;
}

dea_status dea_fit_tell_next(struct dea_context *ctx, struct dea_fit *fit)
{
  const size_t k = fit->statistics.active, m = fit->least_squares.rows;
  size_t active[DEA_LSQ_PARAMS_MAX], count = 0;
  double length[DEA_LSQ_PARAMS_MAX];
  struct dea_arena arena = {.ctx = ctx};
  double *base = dea_arena_alloc(&arena, k * k, sizeof *base);
  double *weight = dea_arena_alloc(&arena, m, sizeof *weight);
  dea_status status = dea_arena_status(&arena);
  for (size_t j = 0; j < fit->model.count && status == DEA_OK; j++) {
    if (!fit->least_squares.held[j] && !fit->least_squares.at_bound[j]) {
      double sum = 0;
      for (size_t i = 0; i < m; i++) {
        sum += fit->least_squares.J[j * m + i] * fit->least_squares.J[j * m + i];
      }
      length[count] = sum > 0 ? sqrt(sum) : 1 / fit->model.params[j].scale;
      active[count++] = j;
    }
  }
  for (size_t i = 0; i < m && status == DEA_OK; i++) {
    weight[i] = 1 / sqrt(fit->statistics.variance);
  }
  if (status == DEA_OK && k > 0 && isfinite(fit->statistics.variance)) {
    add_information(fit->least_squares.J, weight, m, fit->model.count, active, length, base, k);
    for (size_t a = 0; a < k; a++) {
      base[a * k + a] *= 1 + 1e-9; // what nothing is known of stays a number
    }
    const int last = fit->model.branch_count > 0 ? DEA_COUPON_MODES : DEA_COUPON_MODES - 1;
    for (int which = 0; which <= last && status == DEA_OK; which++) {
      status = weigh(ctx, &arena, fit, which, active, length, base);
    }
  }
  dea_arena_free(&arena);
  return status;
}

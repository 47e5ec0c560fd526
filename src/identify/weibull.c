#include "identify/weibull.h"

#include <lapacke.h>
#include <math.h>
#include <string.h>

enum { N = DEA_WEIBULL_PARAMS, STEPS_MAX = 200, HALVINGS_MAX = 60 };

static const double same = 1e-6; // least pivot of the scaled information: else not told apart

/* Which parameters are kept at which values. E_0 as its logarithm over the mean of ln E. */
struct kept {
  bool held[N];
  double value[N];
};

struct work {
  const struct dea_weibull_data *data;
  double mean; // of ln E
  size_t broken;
};

/* Coefficients of z in the free parameters: b, b ln E_0, b n, b p, in the order of the enum but for
 * the first two. */
struct point {
  double c[N];
  double log_likelihood;
  double gradient[N], information[N * N]; // rows of what is held are those of the unit matrix
};

/* z of a row is offset + sum of c_k x_k. */
static void row_of(const struct work *w, const struct kept *kept, size_t i, double x[N],
                   double *offset)
{
  const struct dea_weibull_data *d = w->data;
  double *of_shape = &x[DEA_WEIBULL_SHAPE];
  *of_shape = log(d->field_V_per_m[i]) - w->mean;
  x[DEA_WEIBULL_FIELD] = -1;
  x[DEA_WEIBULL_STRETCH] = x[DEA_WEIBULL_THICKNESS] = *offset = 0;
  if (d->stretch != NULL) {
    x[DEA_WEIBULL_STRETCH] = -log(d->stretch[i]);
    x[DEA_WEIBULL_THICKNESS] = -log(d->thickness_m[i] / d->thickness0_m);
    *offset = log(d->area_m2[i] / d->area0_m2);
  }
  for (int k = 0; k < N; k++) {
    if (k != DEA_WEIBULL_SHAPE && kept->held[k]) {
      *of_shape += kept->value[k] * x[k];
      x[k] = 0;
    }
  }
  if (kept->held[DEA_WEIBULL_SHAPE]) {
    *offset += kept->value[DEA_WEIBULL_SHAPE] * *of_shape;
    *of_shape = 0;
  }
}

static double shape_at(const struct kept *kept, const double c[N])
{
  return kept->held[DEA_WEIBULL_SHAPE] ? kept->value[DEA_WEIBULL_SHAPE] : c[DEA_WEIBULL_SHAPE];
}

/* Likelihood with its derivatives at p->c. */
static void evaluate(const struct work *w, const struct kept *kept, struct point *p)
{
  const double b = shape_at(kept, p->c), broken = (double)w->broken;
  memset(p->gradient, 0, sizeof p->gradient);
  memset(p->information, 0, sizeof p->information);
  p->log_likelihood = broken * log(b);
  for (size_t i = 0; i < w->data->rows; i++) {
    double x[N], z; // 0 of what is held
    row_of(w, kept, i, x, &z);
    for (size_t k = 0; k < N; k++) {
      z += p->c[k] * x[k];
    }
    const double hazard = exp(z), left = (w->data->survived[i] ? 0 : 1) - hazard;
    p->log_likelihood += (w->data->survived[i] ? 0 : z) - hazard;
    for (size_t a = 0; a < N; a++) {
      p->gradient[a] += left * x[a];
      for (size_t k = 0; k < N; k++) {
        p->information[a * N + k] += hazard * x[a] * x[k];
      }
    }
  }
  for (size_t k = 0; k < N; k++) {
    const bool shape = k == DEA_WEIBULL_SHAPE && !kept->held[k];
    p->gradient[k] += shape ? broken / b : 0;
    p->information[k * N + k] += kept->held[k] ? 1 : shape ? broken / (b * b) : 0;
  }
}

/* Step of Newton's method, 0 of what is held; false where the information is singular. */
static bool newton_step(const struct point *p, double step[N])
{
  double A[N * N], scale[N];
  for (size_t a = 0; a < N; a++) {
    scale[a] = 1 / sqrt(p->information[a * N + a]);
  }
  for (size_t a = 0; a < N; a++) {
    step[a] = p->gradient[a] * scale[a];
    for (size_t k = 0; k < N; k++) {
      A[a * N + k] = p->information[a * N + k] * scale[a] * scale[k];
    }
  }
  if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'L', N, 1, A, N, step, N) != 0) {
    return false;
  }
  for (size_t a = 0; a < N; a++) {
    step[a] *= scale[a];
    if (A[a * N + a] * A[a * N + a] < same || !isfinite(step[a])) {
      return false;
    }
  }
  return true;
}

/* The maximum from p->c on; false where it is not determined. */
static bool maximise(const struct work *w, const struct kept *kept, struct point *p)
{
  evaluate(w, kept, p);
  for (int round = 0; round < STEPS_MAX; round++) {
    double step[N], growth = 0;
    if (!newton_step(p, step)) {
      return false;
    }
    struct point next;
    double share = 1;
    for (int k = 0; k < HALVINGS_MAX; k++, share *= 0.5) {
      next = *p;
      for (size_t a = 0; a < N; a++) {
        next.c[a] += share * step[a];
      }
      if (shape_at(kept, next.c) > 0) {
        evaluate(w, kept, &next);
        growth = next.log_likelihood - p->log_likelihood;
        if (isfinite(growth) && growth >= 0) {
          break;
        }
      }
      growth = 0;
    }
    if (growth == 0) { // nothing larger is left
      return true;
    }
    *p = next;
    if (growth < 1e-13 * (1 + fabs(p->log_likelihood))) {
      return true;
    }
  }
  return false;
}

// What is known of it ----------------------------------------------------------------------------

/* Covariance of ln E_0, b, n, p from the inverse of the information by the chain rule; the shape is
 * free. */
static bool find_covariance(const struct kept *kept, const struct point *p,
                            struct dea_weibull_fit *out)
{
  double A[N * N], T[N][N] = {{0}}; // T[k][a]: dvalue_k/dc_a
  const double b = shape_at(kept, p->c);
  memcpy(A, p->information, sizeof A);
  if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', N, A, N) != 0 ||
      LAPACKE_dpotri(LAPACK_COL_MAJOR, 'L', N, A, N) != 0) {
    return false;
  }
  for (size_t k = 0; k < N; k++) {
    if (!kept->held[k] && k != DEA_WEIBULL_SHAPE) {
      T[k][k] = 1 / b;
      T[k][DEA_WEIBULL_SHAPE] = -p->c[k] / (b * b);
    }
  }
  T[DEA_WEIBULL_SHAPE][DEA_WEIBULL_SHAPE] = 1;
  for (size_t j = 0; j < N; j++) {
    for (size_t k = 0; k < N; k++) {
      double sum = 0;
      for (size_t a = 0; a < N; a++) {
        for (size_t e = 0; e < N; e++) {
          sum += T[j][a] * (a >= e ? A[e * N + a] : A[a * N + e]) * T[k][e];
        }
      }
      out->covariance[j][k] = sum;
    }
  }
  return true;
}

/* Twice what the likelihood falls to with parameter k kept at v; NAN: no maximum there. */
static double fall_at(const struct work *w, const struct kept *kept, const struct point *best,
                      size_t k, double v)
{
  struct kept with = *kept;
  struct point p = *best;
  with.held[k] = true;
  with.value[k] = v;
  for (size_t j = 0; j < N && k == DEA_WEIBULL_SHAPE; j++) { // E_0, n and p begin as they were
    p.c[j] *= j == k ? 1 : v / best->c[k];
  }
  if (!maximise(w, &with, &p)) { // too far from the best: from where that began
    p = *best;
    memset(p.c, 0, sizeof p.c);
    p.c[DEA_WEIBULL_SHAPE] = 1;
    if (!maximise(w, &with, &p)) {
      return NAN;
    }
  }
  return 2 * (best->log_likelihood - p.log_likelihood);
}

/* Where the likelihood has fallen by rise/2 on one side: steps that grow, then bisection. */
static double find_end(const struct work *w, const struct kept *kept, const struct point *best,
                       size_t k, double value, double std, double rise, int sign)
{
  double inner = value, outer = value, step = std;
  double fall = 0;
  for (int i = 0; i < 40 && fall < rise; i++, step *= 1.5) {
    inner = outer;
    outer = outer + sign * step;
    if (k == DEA_WEIBULL_SHAPE && outer <= 0) {
      outer = 0.5 * inner;
    }
    fall = fall_at(w, kept, best, k, outer);
    if (isnan(fall)) {
      return NAN;
    }
  }
  for (int i = 0; i < 34; i++) {
    const double middle = 0.5 * (inner + outer);
    fall = fall_at(w, kept, best, k, middle);
    if (isnan(fall)) {
      return NAN;
    }
    *(fall < rise ? &inner : &outer) = middle;
  }
  return 0.5 * (inner + outer);
}

static void fill(const struct work *w, const struct kept *kept, const struct point *best,
                 struct dea_weibull_fit *out)
{
  static const double of_68 = 1, of_95 = 3.841458820694124;
  const double b = shape_at(kept, best->c);
  out->log_likelihood = best->log_likelihood;
  out->broken = w->broken;
  for (size_t k = 0; k < N; k++) {
    const bool is_field = k == DEA_WEIBULL_FIELD; // as its logarithm over the mean
    const double value = kept->held[k]            ? kept->value[k]
                         : k == DEA_WEIBULL_SHAPE ? b
                                                  : best->c[k] / b;
    out->value[k] = is_field ? exp(value + w->mean) : value;
    out->std[k] = out->low[k] = out->high[k] = NAN;
    if (kept->held[k]) {
      continue;
    }
    const double std = sqrt(out->covariance[k][k]);
    const double low = find_end(w, kept, best, k, value, std, of_68, -1);
    const double high = find_end(w, kept, best, k, value, std, of_68, 1);
    out->std[k] = is_field ? std * out->value[k] : std;
    out->low[k] = is_field ? exp(low + w->mean) : low;
    out->high[k] = is_field ? exp(high + w->mean) : high;
    if (is_field) {
      out->low_95 = exp(find_end(w, kept, best, k, value, 2 * std, of_95, -1) + w->mean);
      out->high_95 = exp(find_end(w, kept, best, k, value, 2 * std, of_95, 1) + w->mean);
    }
  }
}

static dea_status check(struct dea_context *ctx, struct work *w)
{
  const struct dea_weibull_data *d = w->data;
  double low = INFINITY, high = -INFINITY;
  size_t free = 0;
  for (size_t i = 0; i < d->rows; i++) {
    w->mean += log(d->field_V_per_m[i]) / (double)d->rows;
    if (!d->survived[i]) {
      w->broken++;
      low = fmin(low, d->field_V_per_m[i]);
      high = fmax(high, d->field_V_per_m[i]);
    }
  }
  for (size_t k = 0; k < N; k++) {
    free += d->held[k] ? 0U : 1U;
  }
  if (w->broken == 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "nothing broke down: no law follows from films that all held");
  }
  if (w->broken < free || w->broken < 2 || low == high) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "%zu film%s broke down%s: too few for the %zu parameters of the law", w->broken,
                    w->broken == 1 ? "" : "s", w->broken > 1 && low == high ? " at one field" : "",
                    free);
  }
  return DEA_OK;
}

dea_status dea_weibull_solve(struct dea_context *ctx, const struct dea_weibull_data *data,
                             struct dea_weibull_fit *out)
{
  struct work w = {.data = data};
  struct kept kept = {.held = {false}};
  struct point p = {.c = {0}};
  *out = (struct dea_weibull_fit){.broken = 0};
  DEA_TRY(ctx, check(ctx, &w));
  for (size_t k = DEA_WEIBULL_STRETCH; k < N; k++) {
    kept.held[k] = data->held[k];
    kept.value[k] = data->given[k];
  }
  p.c[DEA_WEIBULL_SHAPE] = 1;
  if (!maximise(&w, &kept, &p) || !find_covariance(&kept, &p, out)) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "the tests do not tell the parameters apart: stretches and thicknesses vary "
                    "together, or not at all");
  }
  fill(&w, &kept, &p, out);
  return DEA_OK;
}

double dea_weibull_z(const struct dea_weibull_fit *fit, double field_V_per_m, double *std)
{
  const double b = fit->value[DEA_WEIBULL_SHAPE];
  const double over = log(field_V_per_m / fit->value[DEA_WEIBULL_FIELD]);
  const double J[2] = {-b, over};
  double variance = 0;
  for (int a = 0; a < 2; a++) {
    for (int k = 0; k < 2; k++) {
      variance += J[a] * fit->covariance[a][k] * J[k];
    }
  }
  *std = sqrt(fmax(0, variance));
  return b * over;
}

double dea_weibull_quantile(const struct dea_weibull_fit *fit, double share, double *log_std)
{
  const double b = fit->value[DEA_WEIBULL_SHAPE];
  const double field = fit->value[DEA_WEIBULL_FIELD] * pow(-log1p(-share), 1 / b);
  dea_weibull_z(fit, field, log_std);
  *log_std /= b;
  return field;
}

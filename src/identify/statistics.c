/* What residuals and their derivatives say of the parameters (docs/theory/fit.md, "Error bars").
 *
 * Symbol  meaning                                                           unit
 * U S V'  J with columns of length 1: J D^-1, D = diag(|J_j|)
 * R       correlation of the noise: rho_g^|i - k| within a group, else 0    1
 * M       1 - U U', what the fit leaves of the noise: r = M e
 * C       M R M, correlation of the residuals                               1
 *
 * With independent noise cov(p) = (J'J)^-1; with R it is J^+ R J^+', which needs U' R U only. */
#include "identify/least_squares.h"

#include <lapacke.h>
#include <math.h>
#include <string.h>

struct work {
  const struct dea_lsq_fit *fit;
  const struct dea_lsq_group *groups;
  size_t group_count, rows, k;       // k: active parameters
  size_t index[DEA_LSQ_PARAMS_MAX];  // of them
  double length[DEA_LSQ_PARAMS_MAX]; // of their columns
  double *U;                         // [rows x k]
  double *V;                         // [k x k]: V[a * k + b] = component a of vector b
  double *W, *T;                     // [rows x k]: R U and U (U' R U)
};

/* out = R u in one group, R_ik = rho^|i - k|: a sweep forth and one back. */
static void correlate(const double *u, size_t n, double rho, double *out)
{
  double run = 0;
  for (size_t i = 0; i < n; i++) {
    run = rho * run + u[i];
    out[i] = run;
  }
  run = 0;
  for (size_t i = n; i-- > 0;) {
    out[i] += rho * run;
    run = rho * run + u[i];
  }
}

/* W = R U and S = U' W [k x k]; lag: [group_count]. */
static void correlate_all(struct work *w, const double *lag, double *S)
{
  memcpy(w->W, w->U, w->rows * w->k * sizeof *w->W);
  for (size_t a = 0; a < w->k; a++) {
    for (size_t g = 0; g < w->group_count; g++) {
      const size_t at = a * w->rows + w->groups[g].first;
      correlate(w->U + at, w->groups[g].count, lag[g], w->W + at);
    }
  }
  for (size_t a = 0; a < w->k; a++) {
    for (size_t b = 0; b < w->k; b++) {
      double sum = 0;
      for (size_t i = 0; i < w->rows; i++) {
        sum += w->U[a * w->rows + i] * w->W[b * w->rows + i];
      }
      S[a * w->k + b] = sum;
    }
  }
}

/* C_ij for rows i and j = i or i + 1 of one group, r_ij: R_ij. Needs W and T. */
static double residual_correlation(const struct work *w, size_t i, size_t j, double r_ij)
{
  double sum = r_ij;
  for (size_t a = 0; a < w->k; a++) {
    const size_t at = a * w->rows;
    sum += w->T[at + i] * w->U[at + j] - w->U[at + i] * w->W[at + j] - w->W[at + i] * w->U[at + j];
  }
  return sum;
}

/* T = U S. */
static void fill_T(struct work *w, const double *S)
{
  memset(w->T, 0, w->rows * w->k * sizeof *w->T);
  for (size_t a = 0; a < w->k; a++) {
    for (size_t b = 0; b < w->k; b++) {
      for (size_t i = 0; i < w->rows; i++) {
        w->T[a * w->rows + i] += S[a * w->k + b] * w->U[b * w->rows + i];
      }
    }
  }
}

/* Expected sum of C_i,i+1 over that of C_ii in a group, when all groups have this correlation. */
static double expected_lag(struct work *w, const struct dea_lsq_group *group, double rho,
                           double *lags, double *S)
{
  for (size_t g = 0; g < w->group_count; g++) {
    lags[g] = rho;
  }
  correlate_all(w, lags, S);
  fill_T(w, S);
  double near = 0, own = 0;
  for (size_t n = 0; n < group->count; n++) {
    const size_t i = group->first + n;
    own += residual_correlation(w, i, i, 1);
    near += n + 1 < group->count ? residual_correlation(w, i, i + 1, rho) : 0;
  }
  return own > 0 ? near / own : 0;
}

/* Correlation of neighbours whose expectation the residuals of a group have; 0 when they could be
 * independent (two standard deviations of 1/sqrt(count)) or are too few to say. */
static double find_lag(struct work *w, const struct dea_lsq_group *group, double *lags, double *S)
{
  enum { LEAST = 8, HALVINGS = 24 };
  double near = 0, own = 0, low = 0, high = 0.9995;
  for (size_t n = 0; n < group->count; n++) {
    const double *r = w->fit->r + group->first + n;
    own += r[0] * r[0];
    near += n + 1 < group->count ? r[0] * r[1] : 0;
  }
  if (group->count < LEAST || !(own > 0)) {
    return 0;
  }
  const double seen = near / own;
  if (seen <= expected_lag(w, group, 0, lags, S) + 2 / sqrt((double)group->count)) {
    return 0;
  }
  for (int n = 0; n < HALVINGS; n++) {
    const double middle = 0.5 * (low + high);
    if (expected_lag(w, group, middle, lags, S) < seen) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return 0.5 * (low + high);
}

/* Singular values of the scaled J into singular[k], U and V. */
static dea_status decompose(struct dea_context *ctx, struct work *w, double *singular)
{
  const size_t m = w->rows, k = w->k;
  double spare[DEA_LSQ_PARAMS_MAX], *A = w->W; // not filled yet
  for (size_t a = 0; a < k; a++) {
    const double *column = w->fit->J + w->index[a] * m;
    double sum = 0;
    for (size_t i = 0; i < m; i++) {
      sum += column[i] * column[i];
    }
    w->length[a] = sqrt(sum);
    for (size_t i = 0; i < m; i++) {
      A[a * m + i] = sum > 0 ? column[i] / w->length[a] : 0;
    }
  }
  // V' by columns: [b + a k] of it is V[a k + b]
  const lapack_int info =
      LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'S', 'S', (lapack_int)m, (lapack_int)k, A, (lapack_int)m,
                     singular, w->U, (lapack_int)m, w->V, (lapack_int)k, spare);
  return info == 0 ? DEA_OK : dea_fail(ctx, DEA_E_NOT_CONVERGED, "no singular values of the fit");
}

/* Change of p_a along singular vector b. */
static double change(const struct work *w, size_t a, size_t b)
{
  return w->V[a * w->k + b] / (w->length[a] > 0 ? w->length[a] : 1);
}

bool dea_lsq_is_open(const struct dea_lsq_statistics *statistics, size_t k)
{
  static const double undetermined = 1e-9;
  return statistics->singular[k] <= undetermined * statistics->singular[0];
}

/* Covariances from S = U' R U; what is not determined has std INFINITY. */
static void fill_covariance(const struct work *w, const double *S, struct dea_lsq_statistics *out)
{
  const size_t n = out->params, k = w->k;
  for (size_t a = 0; a < k; a++) {
    for (size_t b = 0; b < k; b++) {
      double sum = 0, plain = 0;
      for (size_t c = 0; c < k; c++) {
        for (size_t d = 0; d < k; d++) {
          if (!dea_lsq_is_open(out, c) && !dea_lsq_is_open(out, d)) {
            sum += change(w, a, c) / out->singular[c] * S[c * k + d] * change(w, b, d) /
                   out->singular[d];
          }
        }
        plain += !dea_lsq_is_open(out, c)
                     ? change(w, a, c) * change(w, b, c) / (out->singular[c] * out->singular[c])
                     : 0;
      }
      out->covariance[w->index[a] * n + w->index[b]] = sum;
      out->naive_std[w->index[a]] = a == b ? sqrt(plain) : out->naive_std[w->index[a]];
    }
  }
  for (size_t a = 0; a < k; a++) {
    bool open = !(w->length[a] > 0);
    for (size_t c = 0; c < k; c++) {
      open = open || (dea_lsq_is_open(out, c) && fabs(w->V[a * k + c]) > 1e-3);
    }
    const size_t j = w->index[a];
    out->std[j] = open ? INFINITY : sqrt(out->covariance[j * n + j]);
  }
}

static void fill_directions(const struct work *w, struct dea_lsq_statistics *out)
{
  for (size_t b = 0; b < w->k; b++) {
    for (size_t a = 0; a < w->k; a++) {
      out->direction[b * out->params + w->index[a]] = change(w, a, b);
    }
  }
  out->condition = w->k == 0                     ? 1
                   : out->singular[w->k - 1] > 0 ? out->singular[0] / out->singular[w->k - 1]
                                                 : INFINITY;
}

static void count_effective(const struct work *w, struct dea_lsq_statistics *out)
{
  out->effective_rows = (double)w->rows;
  for (size_t g = 0; g < w->group_count; g++) {
    const double n = (double)w->groups[g].count;
    out->effective[g] = fmax(1, n * (1 - out->lag[g]) / (1 + out->lag[g]));
    out->effective_rows -= n - out->effective[g];
  }
}

/* chi2 over its expectation m - tr(U' R U). Where the scatter is to be found, of the rows that were
 * measured: what a prior misses says nothing of it. */
static double reduce(struct work *w, const double *S, bool known)
{
  double expected = (double)w->rows, chi2 = w->fit->chi2;
  size_t rows = 0;
  for (size_t a = 0; a < w->k; a++) {
    expected -= S[a * w->k + a];
  }
  for (size_t g = 0; g < w->group_count; g++) {
    rows += w->groups[g].count;
  }
  if (!known && rows < w->rows) {
    expected = chi2 = 0;
    fill_T(w, S);
    for (size_t g = 0; g < w->group_count; g++) {
      for (size_t n = 0; n < w->groups[g].count; n++) {
        const size_t i = w->groups[g].first + n;
        expected += residual_correlation(w, i, i, 1);
        chi2 += w->fit->r[i] * w->fit->r[i];
      }
    }
  }
  return w->rows > w->k && expected > 0 ? chi2 / expected : NAN;
}

/* Scale of the covariance by chi2 against its expectation. */
static void scale(struct work *w, const double *S, bool known, struct dea_lsq_statistics *out)
{
  const double freedom = out->effective_rows - (double)w->k;
  out->reduced_chi2 = reduce(w, S, known);
  const double excess = out->reduced_chi2 - 1;
  out->widened = known ? excess > 2 * sqrt(2 / fmax(freedom, 1)) : false;
  out->variance = known && !out->widened ? 1 : out->reduced_chi2;
  if (isnan(out->variance)) {
    out->variance = known ? 1 : INFINITY; // as many rows as parameters: nothing is left to tell
  }
  const size_t n = out->params;
  for (size_t j = 0; j < n; j++) {
    out->std[j] *= sqrt(out->variance);
    for (size_t l = 0; l < n; l++) {
      const double c = out->covariance[j * n + l];
      out->correlation[j * n + l] =
          c != 0 ? c / sqrt(out->covariance[j * n + j] * out->covariance[l * n + l]) : 0;
    }
  }
  for (size_t j = 0; j < n * n; j++) {
    out->covariance[j] *= out->covariance[j] != 0 ? out->variance : 1;
  }
}

static dea_status find(struct dea_context *ctx, struct work *w, bool known,
                       struct dea_lsq_statistics *out)
{
  const size_t k = w->k, n = out->params, groups = w->group_count;
  struct dea_arena *memory = &out->memory;
  out->std = dea_arena_alloc(memory, n, sizeof *out->std);
  out->naive_std = dea_arena_alloc(memory, n, sizeof *out->naive_std);
  out->covariance = dea_arena_alloc(memory, n * n, sizeof *out->covariance);
  out->correlation = dea_arena_alloc(memory, n * n, sizeof *out->correlation);
  out->singular = dea_arena_alloc(memory, k, sizeof *out->singular);
  out->direction = dea_arena_alloc(memory, k * n, sizeof *out->direction);
  out->lag = dea_arena_alloc(memory, groups, sizeof *out->lag);
  out->effective = dea_arena_alloc(memory, groups, sizeof *out->effective);
  w->U = dea_arena_alloc(memory, w->rows * k, sizeof *w->U);
  w->W = dea_arena_alloc(memory, w->rows * k, sizeof *w->W);
  w->T = dea_arena_alloc(memory, w->rows * k, sizeof *w->T);
  w->V = dea_arena_alloc(memory, k * k, sizeof *w->V);
  double *S = dea_arena_alloc(memory, k * k, sizeof *S);
  double *lags = dea_arena_alloc(memory, groups, sizeof *lags);
  DEA_TRY(ctx, dea_arena_status(memory));
  for (size_t j = 0; j < n; j++) {
    out->std[j] = out->naive_std[j] = NAN;
  }
  DEA_TRY(ctx, k > 0 ? decompose(ctx, w, out->singular) : DEA_OK);
  for (size_t g = 0; g < groups; g++) {
    out->lag[g] = find_lag(w, &w->groups[g], lags, S);
  }
  correlate_all(w, out->lag, S);
  count_effective(w, out);
  fill_covariance(w, S, out);
  fill_directions(w, out);
  scale(w, S, known, out);
  return DEA_OK;
}

dea_status dea_lsq_statistics_find(struct dea_context *ctx, const struct dea_lsq_fit *fit,
                                   const struct dea_lsq_group *groups, size_t group_count,
                                   bool scale_known, struct dea_lsq_statistics *out)
{
  struct work w = {.fit = fit, .groups = groups, .group_count = group_count, .rows = fit->rows};
  *out = (struct dea_lsq_statistics){.params = fit->params, .memory = {.ctx = ctx}};
  for (size_t j = 0; j < fit->params; j++) {
    if (!fit->held[j] && !fit->at_bound[j]) {
      w.index[w.k++] = j;
    }
  }
  out->active = w.k;
  dea_status status = find(ctx, &w, scale_known, out);
  DEA_TRY_ELSE(ctx, status, dea_lsq_statistics_free(out));
  return DEA_OK;
}

double dea_lsq_std_of(const struct dea_lsq_statistics *statistics, const double *slope)
{
  const size_t n = statistics->params;
  double variance = 0;
  for (size_t k = 0; k < statistics->active; k++) {
    double along = 0, all = 0;
    for (size_t j = 0; j < n; j++) {
      along += slope[j] * statistics->direction[k * n + j];
      all += fabs(slope[j] * statistics->direction[k * n + j]);
    }
    if (dea_lsq_is_open(statistics, k) && fabs(along) > 1e-6 * all) { // beyond rounding
      return INFINITY;
    }
  }
  for (size_t a = 0; a < n; a++) {
    for (size_t b = 0; b < n; b++) {
      variance += slope[a] * statistics->covariance[a * n + b] * slope[b];
    }
  }
  return isfinite(variance) ? sqrt(fmax(0, variance)) : INFINITY;
}

void dea_lsq_statistics_free(struct dea_lsq_statistics *statistics)
{
  dea_arena_free(&statistics->memory);
  *statistics = (struct dea_lsq_statistics){0};
}

/* identify: least squares and error bars against closed forms, and coverage of the error bars. */
// ctest: quick, heavy
#include "context_fixture.h"
#include "identify/least_squares.h"
#include "testing.h"

#include <stdbool.h>
#include <string.h>

enum { ROWS_MAX = 200, TRIALS = 1000 };

static const struct dea_fit_param open_params[] = {
    {.low = -INFINITY, .high = INFINITY, .scale = 1},
    {.low = -INFINITY, .high = INFINITY, .scale = 1},
};

/* Measurements y +- std of a model of p at x, and Gaussian priors on p in the last rows. */
struct line {
  double (*model)(const double *p, double x);
  size_t count, prior_count;
  double x[ROWS_MAX], y[ROWS_MAX], std;
  double prior[3], prior_std[3];
};

static dea_status residual(void *user, const double *p, double *r)
{
  const struct line *line = user;
  for (size_t i = 0; i < line->count; i++) {
    r[i] = (line->model(p, line->x[i]) - line->y[i]) / line->std;
    if (isnan(r[i])) {
      return DEA_E_DOMAIN;
    }
  }
  for (size_t j = 0; j < line->prior_count; j++) {
    r[line->count + j] = (p[j] - line->prior[j]) / line->prior_std[j];
  }
  return DEA_OK;
}

static struct dea_lsq_problem problem_of(struct line *line, size_t params)
{
  return (struct dea_lsq_problem){.rows = line->count + line->prior_count,
                                  .params = params,
                                  .param = open_params,
                                  .residual = residual,
                                  .user = line};
}

static double straight(const double *p, double x)
{
  return p[0] + p[1] * x;
}

static double saturating(const double *p, double x)
{
  return p[0] * (1 - exp(-p[1] * x));
}

static double sum_of_two(const double *p, double x)
{
  return (p[0] + 1.3 * p[1]) * x;
}

static double logarithm(const double *p, double x)
{
  return log(p[0]) + 0 * x;
}

/* Uniform and standard normal numbers, the same in every run. */
static double uniform(uint64_t *seed)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return ((double)(*seed >> 11) + 0.5) / 9007199254740992.0;
}

static double normal(uint64_t *seed)
{
  double a = uniform(seed), b = uniform(seed);
  return sqrt(-2 * log(a)) * cos(6.283185307179586 * b);
}

/* The posterior of a straight line with Gaussian priors is Gaussian, with the precision
 * A = sum of (1, x)(1, x)'/s^2 + diag(1/S_j^2) and the mean A^-1 (sum of (1, x) y/s^2 + m_j/S_j^2).
 */
TEST(test_linear_gaussian_posterior)
{
  struct line line = {.model = straight,
                      .count = 20,
                      .prior_count = 2,
                      .std = 0.3,
                      .prior = {1.0, 3.0},
                      .prior_std = {0.1, 0.05}};
  uint64_t seed = 11;
  double A[3] = {0}, b[2] = {0};
  for (size_t i = 0; i < line.count; i++) {
    line.x[i] = 0.1 * (double)i;
    line.y[i] = 1.2 + 2.8 * line.x[i] + line.std * normal(&seed);
    double w = 1 / (line.std * line.std);
    A[0] += w;
    A[1] += w * line.x[i];
    A[2] += w * line.x[i] * line.x[i];
    b[0] += w * line.y[i];
    b[1] += w * line.y[i] * line.x[i];
  }
  A[0] += 100;
  A[2] += 400;
  b[0] += 100 * 1.0;
  b[1] += 400 * 3.0;
  const double det = A[0] * A[2] - A[1] * A[1];
  struct dea_lsq_problem problem = problem_of(&line, 2);
  struct dea_lsq_fit fit;
  struct dea_lsq_statistics s;
  const struct dea_lsq_group group = {0, line.count};
  const double start[2] = {0, 0};
  assert_int_equal(dea_lsq_solve(ctx, &problem, start, NULL, &fit), DEA_OK);
  assert_int_equal(dea_lsq_statistics_find(ctx, &fit, &group, 1, true, &s), DEA_OK);
  assert_close(fit.p[0], (A[2] * b[0] - A[1] * b[1]) / det, 1e-9, 0);
  assert_close(fit.p[1], (A[0] * b[1] - A[1] * b[0]) / det, 1e-9, 0);
  assert_false(s.widened);
  assert_close(s.lag[0], 0, 0, 0);
  assert_close(s.std[0], sqrt(A[2] / det), 1e-9, 0);
  assert_close(s.std[1], sqrt(A[0] / det), 1e-9, 0);
  assert_close(s.correlation[1], -A[1] / sqrt(A[0] * A[2]), 1e-9, 0);
  double interval[2]; // of a Gaussian: one standard deviation either way
  assert_int_equal(dea_lsq_profile(ctx, &problem, &fit, 1, 1, 0.7 * s.std[1], interval), DEA_OK);
  assert_close(interval[0], fit.p[1] - s.std[1], 1e-6, 0);
  assert_close(interval[1], fit.p[1] + s.std[1], 1e-6, 0);
  dea_lsq_statistics_free(&s);
  dea_lsq_free(&fit);
}

TEST(test_derivatives)
{
  struct line line = {.model = saturating, .count = 30, .std = 0.5};
  double J[2 * 30];
  const double p[2] = {3, 0.8};
  for (size_t i = 0; i < line.count; i++) {
    line.x[i] = 0.2 * (double)i;
  }
  struct dea_lsq_problem problem = problem_of(&line, 2);
  assert_int_equal(dea_lsq_jacobian(ctx, &problem, p, J), DEA_OK);
  for (size_t i = 0; i < line.count; i++) {
    const double e = exp(-p[1] * line.x[i]);
    assert_close(J[i], (1 - e) / line.std, 0, 1e-12);
    assert_close(J[30 + i], p[0] * line.x[i] * e / line.std, 0, 1e-10);
  }
}

/* A parameter that wants to leave its bounds stays there, and is let go again where it must. */
TEST(test_bounds)
{
  struct line line = {.model = straight, .count = 10, .std = 1};
  const struct dea_fit_param params[2] = {{.low = -1, .high = 0.5, .scale = 1},
                                          {.low = 2.5, .high = 10, .scale = 1}};
  const double start[2] = {0.4, 2.5};
  for (size_t i = 0; i < line.count; i++) {
    line.x[i] = (double)i;
    line.y[i] = 1 + 3 * line.x[i];
  }
  struct dea_lsq_problem problem = problem_of(&line, 2);
  problem.param = params;
  struct dea_lsq_fit fit;
  struct dea_lsq_statistics s;
  assert_int_equal(dea_lsq_solve(ctx, &problem, start, NULL, &fit), DEA_OK);
  assert_close(fit.p[0], 0.5, 0, 0);
  assert_close(fit.p[1], 3 + 0.5 * 45 / 285, 1e-9, 0); // the slope of y - 0.5 through 0
  assert_true(fit.at_bound[0] && !fit.at_bound[1]);
  assert_int_equal(dea_lsq_statistics_find(ctx, &fit, NULL, 0, true, &s), DEA_OK);
  assert_true(isnan(s.std[0]));
  assert_close(s.std[1], 1 / sqrt(285), 1e-9, 0);
  dea_lsq_statistics_free(&s);
  dea_lsq_free(&fit);
  const bool held[2] = {true, false}; // held where the caller wants it, also outside
  const double outside[2] = {2, 5};
  assert_int_equal(dea_lsq_solve(ctx, &problem, outside, held, &fit), DEA_OK);
  assert_close(fit.p[0], 2, 0, 0);
  assert_close(fit.p[1], 3 - 1.0 * 45 / 285, 1e-9, 0);
  dea_lsq_free(&fit);
}

/* Only p0 + 1.3 p1 is in the data: both are open, the direction says so, chi2 is still least. */
TEST(test_what_is_not_determined)
{
  struct line line = {.model = sum_of_two, .count = 10, .std = 1};
  const double start[2] = {1, 1};
  for (size_t i = 0; i < line.count; i++) {
    line.x[i] = (double)i;
    line.y[i] = 2 * line.x[i];
  }
  struct dea_lsq_problem problem = problem_of(&line, 2);
  struct dea_lsq_fit fit;
  struct dea_lsq_statistics s;
  assert_int_equal(dea_lsq_solve(ctx, &problem, start, NULL, &fit), DEA_OK);
  assert_close(fit.p[0] + 1.3 * fit.p[1], 2, 1e-9, 0);
  assert_int_equal(dea_lsq_statistics_find(ctx, &fit, NULL, 0, true, &s), DEA_OK);
  assert_true(isinf(s.std[0]) && isinf(s.std[1]) && s.condition > 1e9);
  assert_close(s.direction[2] / s.direction[3], -1.3, 1e-6, 0); // along it nothing changes
  dea_lsq_statistics_free(&s);
  dea_lsq_free(&fit);
}

/* ln p = m +- s: the interval is exp(m - s) to exp(m + s), not symmetric. */
TEST(test_profile_that_bends)
{
  struct line line = {.model = logarithm, .count = 1, .x = {1}, .y = {0.7}, .std = 0.4};
  struct dea_lsq_problem problem = problem_of(&line, 1);
  const double start = 1;
  const struct dea_fit_param positive = {.low = 1e-9, .high = INFINITY, .scale = 1},
                             tight = {.low = 1.8, .high = INFINITY, .scale = 1};
  struct dea_lsq_fit fit;
  double interval[2];
  problem.param = &positive;
  assert_int_equal(dea_lsq_solve(ctx, &problem, &start, NULL, &fit), DEA_OK);
  assert_close(fit.p[0], exp(0.7), 1e-9, 0);
  assert_int_equal(dea_lsq_profile(ctx, &problem, &fit, 0, 1, 0.8, interval), DEA_OK);
  assert_close(interval[0], exp(0.3), 1e-4, 0);
  assert_close(interval[1], exp(1.1), 1e-4, 0);
  problem.param = &tight; // the lower side ends at the bound
  assert_int_equal(dea_lsq_profile(ctx, &problem, &fit, 0, 1, 0.8, interval), DEA_OK);
  assert_true(isinf(interval[0]) && interval[0] < 0);
  assert_close(interval[1], exp(1.1), 1e-4, 0);
  dea_lsq_free(&fit);
}

/* Share of `TRIALS` data sets of the saturating curve whose interval of +- one standard uncertainty
 * holds the truth; noise: x_i = rho x_i-1 + sqrt(1 - rho^2) n_i of standard deviation std. */
static double coverage(double rho, bool known, size_t j)
{
  static const double truth[2] = {2, 0.6}, start[2] = {1, 1};
  struct line line = {.model = saturating, .count = 150, .std = 0.1};
  const struct dea_lsq_group group = {0, line.count};
  uint64_t seed = 5;
  int held = 0;
  struct dea_lsq_problem problem = problem_of(&line, 2);
  for (int t = 0; t < TRIALS; t++) {
    double noise = normal(&seed);
    struct dea_lsq_fit fit;
    struct dea_lsq_statistics s;
    for (size_t i = 0; i < line.count; i++) {
      line.x[i] = 5.0 * (double)(i + 1) / (double)line.count;
      line.y[i] = saturating(truth, line.x[i]) + 0.1 * noise;
      noise = rho * noise + sqrt(1 - rho * rho) * normal(&seed);
    }
    assert_int_equal(dea_lsq_solve(ctx, &problem, start, NULL, &fit), DEA_OK);
    assert_int_equal(dea_lsq_statistics_find(ctx, &fit, &group, 1, known, &s), DEA_OK);
    held += fabs(fit.p[j] - truth[j]) <= s.std[j] ? 1 : 0;
    dea_lsq_statistics_free(&s);
    dea_lsq_free(&fit);
  }
  return held / (double)TRIALS;
}

/* 68.3 % to 3 %, which is two standard deviations of 1000 trials. */
TEST(test_coverage_of_white_noise)
{
  for (size_t j = 0; j < 2; j++) {
    assert_close(coverage(0, true, j), 0.683, 0, 0.03);
    assert_close(coverage(0, false, j), 0.683, 0, 0.03);
  }
}

TEST(test_coverage_of_correlated_noise)
{
  for (size_t j = 0; j < 2; j++) {
    assert_close(coverage(0.6, true, j), 0.683, 0, 0.03);
    assert_close(coverage(0.6, false, j), 0.683, 0, 0.03);
  }
}

TESTS(context_set_up, context_tear_down)

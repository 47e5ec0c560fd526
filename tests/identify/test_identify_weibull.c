/* identify: Weibull's law of breakdown against the equations of its maximum, coverage, scaling. */
// ctest: slow
#include "context_fixture.h"
#include "identify/weibull.h"
#include "testing.h"

#include <math.h>

enum { ROWS = 100, TRIALS = 300 };

static double field[ROWS], stretch[ROWS], thickness[ROWS], area[ROWS];
static bool survived[ROWS];

static struct dea_weibull_data plain(size_t rows)
{
  for (size_t i = 0; i < rows; i++) {
    stretch[i] = 1;
    thickness[i] = 50e-6;
    area[i] = 1e-4;
  }
  return (struct dea_weibull_data){.rows = rows,
                                   .field_V_per_m = field,
                                   .stretch = stretch,
                                   .thickness_m = thickness,
                                   .area_m2 = area,
                                   .survived = survived,
                                   .thickness0_m = 50e-6,
                                   .area0_m2 = 1e-4,
                                   .held = {false, false, true, true}};
}

static unsigned long long seed = 1;

static double uniform(void)
{
  seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
  return ((double)(seed >> 11) + 0.5) / 9007199254740992.0;
}

/* Field at which a film breaks whose law has these numbers. */
static double draw(double E0, double b, double n, double p, size_t i)
{
  return E0 * pow(stretch[i], n) * pow(thickness[i] / 50e-6, p) *
         pow(-log(uniform()) * 1e-4 / area[i], 1 / b);
}

/* The equation of the shape at the maximum, solved by bisection: with films that survived in both
 * sums over all, but not in the mean of the logarithms of those that broke. */
static double shape_by_bisection(size_t rows)
{
  double low = 0.1, high = 100;
  for (int k = 0; k < 200; k++) {
    const double b = 0.5 * (low + high);
    double sum = 0, weighted = 0, logs = 0;
    size_t broken = 0;
    for (size_t i = 0; i < rows; i++) {
      const double x = field[i] / 1e8;
      sum += pow(x, b);
      weighted += pow(x, b) * log(x);
      logs += survived[i] ? 0 : log(x);
      broken += survived[i] ? 0U : 1U;
    }
    *(weighted / sum - 1 / b - logs / (double)broken < 0 ? &low : &high) = b;
  }
  return low;
}

TEST(test_against_its_equations)
{
  for (int censored = 0; censored < 2; censored++) {
    struct dea_weibull_data data = plain(25);
    struct dea_weibull_fit fit;
    for (size_t i = 0; i < 25; i++) {
      field[i] = draw(1e8, 8, 0, 0, i);
      survived[i] = censored && field[i] > 1e8;
      field[i] = survived[i] ? 1e8 : field[i];
    }
    assert_int_equal(dea_weibull_solve(ctx, &data, &fit), DEA_OK);
    const double b = shape_by_bisection(25);
    double sum = 0;
    for (size_t i = 0; i < 25; i++) {
      sum += pow(field[i] / 1e8, b);
    }
    assert_close(fit.value[DEA_WEIBULL_SHAPE], b, 1e-7, 0);
    assert_close(fit.value[DEA_WEIBULL_FIELD], 1e8 * pow(sum / (double)fit.broken, 1 / b), 1e-7, 0);
    assert_true(isnan(fit.std[DEA_WEIBULL_STRETCH]));
    double std;
    assert_close(dea_weibull_z(&fit, fit.value[DEA_WEIBULL_FIELD], &std), 0, 0, 1e-12);
    assert_true(std > 0);
  }
}

/* At the ends of the interval of E_0 the likelihood has fallen by 1/2, the shape fitted anew. */
TEST(test_profile)
{
  struct dea_weibull_data data = plain(25);
  struct dea_weibull_fit fit;
  for (size_t i = 0; i < 25; i++) {
    field[i] = draw(1e8, 8, 0, 0, i);
    survived[i] = false;
  }
  assert_int_equal(dea_weibull_solve(ctx, &data, &fit), DEA_OK);
  for (int side = 0; side < 2; side++) {
    const double E0 = side == 0 ? fit.low[DEA_WEIBULL_FIELD] : fit.high[DEA_WEIBULL_FIELD];
    double best = -INFINITY;
    for (double b = 2; b < 20; b += 1e-3) {
      double sum = 0;
      for (size_t i = 0; i < 25; i++) {
        const double z = b * log(field[i] / E0);
        sum += log(b) + z - exp(z);
      }
      best = fmax(best, sum);
    }
    assert_close(fit.log_likelihood - best, 0.5, 1e-4, 0);
  }
  assert_true(fit.low_95 < fit.low[DEA_WEIBULL_FIELD]);
  assert_true(fit.high_95 > fit.high[DEA_WEIBULL_FIELD]);
}

/* Other units of area, and another reference, change E_0 by the law and nothing else. */
TEST(test_area_scales)
{
  struct dea_weibull_data data = plain(ROWS);
  struct dea_weibull_fit first, other;
  for (size_t i = 0; i < ROWS; i++) {
    area[i] = i % 2 == 0 ? 1e-4 : 1e-2;
    field[i] = draw(1e8, 6, 0, 0, i);
    survived[i] = false;
  }
  assert_int_equal(dea_weibull_solve(ctx, &data, &first), DEA_OK);
  data.area0_m2 = 4e-4;
  assert_int_equal(dea_weibull_solve(ctx, &data, &other), DEA_OK);
  const double b = first.value[DEA_WEIBULL_SHAPE];
  assert_close(other.value[DEA_WEIBULL_SHAPE], b, 1e-8, 0);
  assert_close(other.value[DEA_WEIBULL_FIELD], first.value[DEA_WEIBULL_FIELD] * pow(0.25, 1 / b),
               1e-8, 0);
  assert_close(first.value[DEA_WEIBULL_FIELD], 1e8, 0, 4 * first.std[DEA_WEIBULL_FIELD]);
}

/* Of 300 sets of 100 films, a third of which survive, the profile's interval holds the truth in 68
 * %
 * (+- 6 %, a little more than two standard deviations of the count), for all four parameters. */
TEST(test_coverage)
{
  skip_sanitized();
  const double truth[DEA_WEIBULL_PARAMS] = {1.2e8, 9, 0.63, -0.25};
  int held[DEA_WEIBULL_PARAMS] = {0};
  seed = 20;
  for (int trial = 0; trial < TRIALS; trial++) {
    struct dea_weibull_data data = plain(ROWS);
    struct dea_weibull_fit fit;
    for (size_t k = 0; k < DEA_WEIBULL_PARAMS; k++) {
      data.held[k] = false;
    }
    for (size_t i = 0; i < ROWS; i++) {
      stretch[i] = 1 + 0.5 * (double)(i % 4);
      thickness[i] = (i % 3 == 0 ? 20e-6 : 80e-6) / (stretch[i] * stretch[i]);
      const double limit =
          1.05 * truth[0] * pow(stretch[i], truth[2]) * pow(thickness[i] / 50e-6, truth[3]);
      field[i] = draw(truth[0], truth[1], truth[2], truth[3], i);
      survived[i] = field[i] > limit;
      field[i] = survived[i] ? limit : field[i];
    }
    assert_int_equal(dea_weibull_solve(ctx, &data, &fit), DEA_OK);
    for (size_t k = 0; k < DEA_WEIBULL_PARAMS; k++) {
      held[k] += fit.low[k] <= truth[k] && truth[k] <= fit.high[k];
    }
  }
  for (size_t k = 0; k < DEA_WEIBULL_PARAMS; k++) {
    print_message("parameter %zu: %.1f %%\n", k, 100.0 * held[k] / TRIALS);
    assert_close((double)held[k] / TRIALS, 0.683, 0, 0.06);
  }
}

TESTS(context_set_up, context_tear_down)

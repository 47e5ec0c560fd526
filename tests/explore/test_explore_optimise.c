/* Searches for optima that are known in closed form, to 1e-4: with limits, whole numbers, gradients
 * of the evaluator, designs without values, a front, and searches that go on, also after Ctrl-C. */
#include "explore/optimise.h"

#include <math.h>
#include <signal.h>
#include <string.h>

#include "testing.h"

#include "own_folder.h"

static bool gradients, partly;

/* Of p: the sum, the product, and the square of the distance to (2.4, p0). */
static dea_status three(void *user, struct dea_context *own, struct dea_case *io)
{
  const double x = io->p[0], y = io->p[1];
  if (x > 4.5) { // such a device has no equilibrium
    snprintf(io->why, sizeof io->why, "none");
    return DEA_OK;
  }
  const double q[] = {x + y, x * y, (x - 2.4) * (x - 2.4) + 3 * (y - x) * (y - x)};
  const double slopes[] = {
      1, 1, y, x, 2 * (x - 2.4) - 6 * (y - x), 6 * (y - x),
  };
  memcpy(io->q, q, sizeof q);
  if (*(const bool *)user) {
    memcpy(io->q + 3, slopes, sizeof slopes);
  }
  if (partly) { // none by y
    io->q[4] = io->q[6] = io->q[8] = NAN;
  }
  return DEA_OK;
}

static double pick(const void *user, size_t k, const double *q)
{
  return q[((const int *)user)[k]];
}

static double product_margin(const void *user, size_t limit, const double *q)
{
  return (q[1] - 2) / 2;
}

static const double wholes[] = {1, 2, 3, 4, 5};

static struct dea_evaluator evaluator = {
    .param_count = 2, .value_count = 3, .evaluate = three, .user = &gradients};

static struct dea_search search_of(const int objectives[2], size_t count)
{
  return (struct dea_search){.ctx = ctx,
                             .evaluator = &evaluator,
                             .processes = 2,
                             .start = {3, 1},
                             .low = {0.1, 0.1},
                             .high = {5, 5},
                             .objective = pick,
                             .margin = product_margin,
                             .user = objectives,
                             .objective_count = count,
                             .starts = 2,
                             .evaluations = 400,
                             .front = 5,
                             .tolerance = 1e-6};
}

/* Runs a search in a store of its own; returns how many evaluations were made. */
static size_t run(struct dea_search *search, const char *name, struct dea_optimum *out,
                  size_t *count)
{
  const struct dea_shard whole = {1, 1};
  evaluator.gradients = gradients;
  assert_int_equal(dea_store_open(ctx, in_folder(name), "q", &evaluator, &whole, &search->store),
                   DEA_OK);
  const size_t before = dea_store_count(search->store);
  assert_int_equal(dea_search_run(search, out, count), DEA_OK);
  const size_t now = dea_store_count(search->store);
  dea_store_close(search->store);
  return now - before;
}

/* The least sum where the product is at least 2: both the root of 2. */
TEST(test_limit)
{
  static const int sum[] = {0, 0};
  struct dea_optimum best;
  size_t count, evaluations[3];
  static const enum dea_method methods[] = {DEA_SLSQP, DEA_MMA, DEA_COBYLA};
  static const char *const names[] = {"slsqp", "mma", "cobyla"};
  for (size_t m = 0; m < 3; m++) {
    struct dea_search search = search_of(sum, 1);
    search.limit_count = 1;
    search.method = methods[m];
    evaluations[m] = run(&search, names[m], &best, &count);
    assert_int_equal(count, 1);
    assert_close(best.p[0], sqrt(2), 1e-4, 0);
    assert_close(best.p[1], sqrt(2), 1e-4, 0);
    assert_close(best.f[0], 2 * sqrt(2), 2e-6, 0);
    // the same search again asks for nothing
    assert_int_equal(run(&search, names[m], &best, &count), 0);
    assert_close(best.p[0], sqrt(2), 1e-4, 0);
  }
  gradients = true;
  struct dea_search search = search_of(sum, 1);
  search.limit_count = 1;
  const size_t with = run(&search, "gradients", &best, &count);
  gradients = false;
  assert_close(best.p[1], sqrt(2), 1e-4, 0);
  assert_true(with < evaluations[0] / 3);
}

/* x of 1 to 5 only: x = 2, y = 2; with limits off. */
TEST(test_whole)
{
  static const int distance[] = {2, 2};
  struct dea_optimum best;
  size_t count;
  struct dea_search search = search_of(distance, 1);
  search.values[0] = wholes;
  search.value_count[0] = 5;
  run(&search, "whole", &best, &count);
  assert_true(best.found && best.p[0] == 2);
  assert_close(best.p[1], 2, 1e-4, 0);
  search.value_count[0] = 0; // and freely, from a start without a value
  search.start[0] = 4.9;
  run(&search, "free", &best, &count);
  assert_close(best.p[0], 2.4, 1e-4, 0);
  assert_close(best.p[1], 2.4, 1e-4, 0);
}

/* Sum against distance: with y = y(x) least of (x - 2.4)^2 + 3 (y - x)^2 at x + y = s, which by
 * Lagrange is 3 (s - 4.8)^2 / 13 (x moves by 6/13 of the way, y by 7/13). */
TEST(test_front)
{
  static const int both[] = {0, 2};
  struct dea_optimum front[DEA_EXPLORE_FRONT_MAX];
  size_t count;
  struct dea_search search = search_of(both, 2);
  run(&search, "front", front, &count);
  assert_int_equal(count, 5);
  assert_close(front[0].f[0], 0.2, 1e-4, 0);
  assert_close(front[4].f[1], 0, 0, 1e-6);
  for (size_t k = 1; k < 4; k++) {
    const double s = front[k].f[0] - 4.8;
    assert_close(front[k].f[1], 3 * s * s / 13, 1e-4, 0);
  }
}

/* x is missed by d to either side: the product stays at least 2 at the smaller x, which is then the
 * root of 2 and d; by the worst, and by mean and spread, where the standard deviations of sum and
 * product over -d, 0, d are d and d y. */
TEST(test_scatter)
{
  static const int sum[] = {0, 0};
  static const double d = 0.3, shifts[] = {0, 0, 0.3, 0, -0.3, 0};
  struct dea_optimum best;
  size_t count;
  for (size_t k = 0; k < 4; k++) {
    struct dea_search search = search_of(sum, 1);
    char name[8] = {'s', (char)('0' + k), '\0'};
    double looked[DEA_SEARCH_VALUES_MAX];
    search.limit_count = 1;
    search.scatter = shifts;
    search.scatter_count = 3;
    search.quantile = k < 2 ? 1 : NAN;
    search.spread = k < 2 ? 0 : 2;
    gradients = k % 2 == 0;
    run(&search, name, &best, &count);
    const double far = k < 2 ? d : 2 * d;
    assert_close(best.p[0], sqrt(2) + far, 1e-4, 0);
    assert_close(best.p[1], sqrt(2), 1e-4, 0);
    assert_close(best.f[0], 2 * sqrt(2) + 2 * far, 2e-6, 0);
    assert_int_equal(dea_store_open(ctx, in_folder(name), "q", &evaluator, NULL, &search.store),
                     DEA_OK);
    assert_true(dea_search_compute(&search, best.p, looked));
    assert_close(looked[0], best.f[0], 1e-12, 0);
    best.p[0] += d; // one that scatters stands for no design of its own
    assert_false(dea_search_compute(&search, best.p, looked));
    dea_store_close(search.store);
  }
  gradients = false;
}

static volatile sig_atomic_t stopped;
static size_t designs, stop_at;

static void count_design(void *user, const char *what, size_t done, size_t total)
{
  designs++;
  stopped = designs == stop_at || stopped;
}

/* Ctrl-C while designs are evaluated: what was done is kept, and the search that goes on makes
 * those that are missing, none twice. */
TEST(test_interrupt)
{
  static const int sum[] = {0, 0};
  const struct dea_shard whole = {1, 1};
  struct dea_optimum best, again;
  size_t count;
  struct dea_search search = search_of(sum, 1);
  search.limit_count = 1;
  dea_context_set_progress(ctx, count_design, NULL);
  dea_context_set_interrupt(ctx, &stopped);
  designs = stop_at = 0;
  const size_t all = run(&search, "uninterrupted", &best, &count);
  assert_int_equal(designs, all);
  designs = 0;
  stop_at = all / 3;
  assert_int_equal(
      dea_store_open(ctx, in_folder("stopped"), "q", &evaluator, &whole, &search.store), DEA_OK);
  assert_int_equal(dea_search_run(&search, &again, &count), DEA_E_INTERRUPTED);
  const size_t kept = dea_store_count(search.store);
  dea_store_close(search.store);
  assert_int_equal(kept, designs);
  assert_in_range(kept, stop_at, all - 1);
  dea_context_clear(ctx);
  stopped = 0;
  designs = stop_at = 0;
  assert_int_equal(run(&search, "stopped", &again, &count), all - kept);
  assert_int_equal(designs, all - kept);
  assert_memory_equal(again.p, best.p, 2 * sizeof *best.p);
  dea_context_set_progress(ctx, NULL, NULL);
  dea_context_set_interrupt(ctx, NULL);
}

TESTS(set_up, tear_down)

/* Searches for optima that are known in closed form: how many designs each method needs, beside one
 * without gradients and random designs. */
#include "explore/optimise.h"
#include "verify.h"

#include <unistd.h>

/* The least sum of a_i / x_i where the sum of x_i is at most 1: x_i = sqrt(a_i) / sum of sqrt(a_k)
 * and the square of that sum, by Cauchy and Schwarz. Values: both sums. */
static const double a[] = {1, 4, 9, 16, 25, 36, 49, 64};

/* Rosenbrock's valley: its floor is at 1, 1, ... */
struct problem {
  const char *name;
  size_t n, limits;
  bool gradients;
  double low, high, start;
};

static void quotients(size_t n, const double *x, double *q, double *slopes)
{
  q[0] = q[1] = 0;
  for (size_t i = 0; i < n; i++) {
    q[0] += a[i] / x[i];
    q[1] += x[i];
    slopes[i] = -a[i] / (x[i] * x[i]);
    slopes[n + i] = 1;
  }
}

static void valley(size_t n, const double *x, double *q, double *slopes)
{
  q[0] = 1; // so that a share of it means something
  q[1] = 0;
  memset(slopes, 0, 2 * n * sizeof *slopes);
  for (size_t i = 0; i + 1 < n; i++) {
    const double off = x[i + 1] - x[i] * x[i];
    q[0] += 100 * off * off + (1 - x[i]) * (1 - x[i]);
    slopes[i] += -400 * off * x[i] - 2 * (1 - x[i]);
    slopes[i + 1] += 200 * off;
  }
}

static dea_status evaluate(void *user, struct dea_context *ctx, struct dea_case *io)
{
  const struct problem *problem = user;
  double slopes[2 * DEA_CASE_PARAMS_MAX];
  (void)ctx;
  problem->limits > 0 ? quotients(problem->n, io->p, io->q, slopes)
                      : valley(problem->n, io->p, io->q, slopes);
  if (problem->gradients) {
    memcpy(io->q + 2, slopes, 2 * problem->n * sizeof *slopes);
  }
  return DEA_OK;
}

static double objective(const void *user, size_t k, const double *q)
{
  (void)user;
  (void)k;
  return q[0];
}

static double margin(const void *user, size_t limit, const double *q)
{
  (void)user;
  (void)limit;
  return 1 - q[1];
}

static double optimum_of(const struct problem *problem)
{
  double sum = 0;
  for (size_t i = 0; i < problem->n; i++) {
    sum += sqrt(a[i]);
  }
  return problem->limits > 0 ? sum * sum : 1;
}

/* Number of designs until one within the limits is within `share` of the optimum; 0: none is. */
static size_t needed(const struct dea_store *store, double optimum, double share, double *best)
{
  size_t found = 0;
  *best = INFINITY;
  for (size_t i = 0; i < dea_store_count(store); i++) {
    const double *q = dea_store_get(store, i)->q;
    if (1 - q[1] >= -1e-6 && q[0] < *best) {
      *best = q[0];
      found = found == 0 && q[0] <= (1 + share) * optimum ? i + 1 : found;
    }
  }
  return found;
}

static void search(struct dea_context *ctx, struct problem *problem, enum dea_method method,
                   size_t evaluations, const char *folder)
{
  static const char *const names[] = {"slsqp", "mma", "cobyla", "random"};
  const struct dea_evaluator evaluator = {.user = problem,
                                          .param_count = problem->n,
                                          .value_count = 2,
                                          .gradients = problem->gradients,
                                          .evaluate = evaluate};
  const struct dea_shard whole = {1, 1};
  struct dea_search search = {.ctx = ctx,
                              .evaluator = &evaluator,
                              .processes = 1,
                              .objective = objective,
                              .margin = margin,
                              .objective_count = 1,
                              .limit_count = problem->limits,
                              .method = method,
                              .starts = 1,
                              .evaluations = evaluations,
                              .tolerance = 1e-7};
  struct dea_optimum best;
  size_t count;
  double f;
  for (size_t j = 0; j < problem->n; j++) {
    search.start[j] = problem->start;
    search.low[j] = problem->low;
    search.high[j] = problem->high;
  }
  verify_ok(ctx, dea_store_remove(ctx, folder));
  verify_ok(ctx, dea_store_open(ctx, folder, "verify", &evaluator, &whole, &search.store));
  verify_ok(ctx, dea_search_run(&search, &best, &count));
  const double optimum = optimum_of(problem);
  const size_t first = needed(search.store, optimum, 1e-4, &f);
  const char *what = problem->gradients    ? "with gradients"
                     : method < DEA_COBYLA ? "with differences"
                                           : "without gradients";
  printf("| %s | %zu | %s | %s | ", problem->name, problem->n, names[method], what);
  if (first > 0) {
    printf("%zu", first);
  } else {
    printf("none of %zu", dea_store_count(search.store));
  }
  printf(" | %zu | %.1e |\n", dea_store_count(search.store), f / optimum - 1);
  if (method == DEA_SLSQP || (method == DEA_MMA && problem->limits > 0)) {
    verify_relative(problem->name, f, optimum, 1e-4);
  }
  dea_store_close(search.store);
}

int main(int argc, char **argv)
{
  struct dea_context *ctx;
  const bool small = verify_is_small(argc, argv);
  char folder[] = "/tmp/dea-verify-XXXXXX";
  struct problem problems[] = {{"quotients", 4, 1, false, 0.01, 1, 0.1},
                               {"quotients", 8, 1, false, 0.01, 1, 0.1},
                               {"valley", 4, 0, false, -2, 2, -1}};
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  if (mkdtemp(folder) == NULL) {
    return 1;
  }
  puts(
      "# How many designs a search needs\n"
      "\n"
      "`dea optimise` on functions whose optimum is known in closed form: the least sum of\n"
      "a_i / x_i where the x_i sum up to at most 1, with a_i = 1, 4, 9, ... (Cauchy and Schwarz),\n"
      "and Rosenbrock's valley plus 1. From one start, until a design within the limits is within\n"
      "1e-4 of the optimum; every design counts, those of central differences too. `random`: the\n"
      "best of random designs.\n"
      "\n"
      "| function | variables | method | | designs until 1e-4 | in all | best, off by |\n"
      "|---|---|---|---|---|---|---|");
  for (size_t k = 0; k < (small ? 1 : 3); k++) {
    struct problem *problem = &problems[k];
    problem->gradients = true;
    search(ctx, problem, DEA_SLSQP, 2000, folder);
    search(ctx, problem, DEA_MMA, 2000, folder);
    problem->gradients = false;
    search(ctx, problem, DEA_SLSQP, 2000, folder);
    search(ctx, problem, DEA_MMA, 2000, folder);
    search(ctx, problem, DEA_COBYLA, 5000, folder);
    search(ctx, problem, DEA_RANDOM, small ? 500 : 20000, folder);
  }
  dea_store_remove(ctx, folder);
  rmdir(folder);
  dea_context_destroy(ctx);
  return verify_end();
}

/* Parts of src/explore on functions in closed form: sequences, quantiles, indices, processes, a
 * store that is cut off anywhere, and a sparse grid. */
#include "base/correlations.h"
#include "explore/explore_sweep.h"
#include "explore/plan.h"
#include "explore/pool.h"
#include "explore/store.h"
#include "io/sparse_grid.h"

#include <math.h>
#include <signal.h>
#include <string.h>

#include "testing.h"

#include "own_folder.h"

static const double pi = 3.14159265358979323846;

/* Each dimension of the first 2^k points has one point in each of 2^k intervals, and the first two
 * in each box of area 2^-k: what makes the sequence one of Sobol's. */
TEST(test_sobol)
{
  enum { K = 10, N = 1 << K };
  double *u = calloc((size_t)N * DEA_SOBOL_DIMENSIONS, sizeof *u);
  dea_sample_sobol(DEA_SOBOL_DIMENSIONS, N, 3, u);
  for (size_t d = 0; d < DEA_SOBOL_DIMENSIONS; d++) {
    int hits[N] = {0};
    for (size_t i = 0; i < N; i++) {
      hits[(size_t)(u[i * DEA_SOBOL_DIMENSIONS + d] * N)]++;
    }
    for (size_t i = 0; i < N; i++) {
      assert_int_equal(hits[i], 1);
    }
  }
  for (size_t a = 0; a <= K; a++) {
    int hits[N] = {0};
    const size_t across = (size_t)1 << a, up = (size_t)N >> a;
    for (size_t i = 0; i < N; i++) {
      const double *at = u + i * DEA_SOBOL_DIMENSIONS;
      hits[(size_t)(at[0] * (double)across) * up + (size_t)(at[1] * (double)up)]++;
    }
    for (size_t i = 0; i < N; i++) {
      assert_int_equal(hits[i], 1);
    }
  }
  free(u);
}

TEST(test_quantile)
{
  for (double x = -8; x <= 8; x += 0.25) {
    const double u = 0.5 * erfc(-x / sqrt(2));
    if (u < 1) {
      // from 1 - u = 1e-16 on, u itself has no more digits
      assert_true(fabs(dea_normal_quantile(u) - x) <
                  (x < 3 ? 1e-12 : 1e-16 * exp(0.5 * x * x) * 3));
    }
  }
}

/* Samples with correlations: those of the normal numbers behind them, and each still even. */
TEST(test_correlated_samples)
{
  enum { N = 1 << 14, D = 3 };
  static struct dea_explore_file file = {.variable_count = D, .correlation_count = 3};
  const double wanted[] = {0.8, -0.3, 0.2}; // 2 with 1, 3 with 1, 3 with 2
  for (int k = 0; k < 3; k++) {
    file.correlations[k].si = wanted[k];
  }
  double *u = calloc((size_t)N * D, sizeof *u), product[D][D] = {{0}};
  int hits[D][16] = {{0}};
  dea_sample_sobol(D, N, 1, u);
  dea_sample_correlate(&file, N, u);
  for (size_t i = 0; i < N; i++) {
    for (size_t a = 0; a < D; a++) {
      hits[a][(size_t)(16 * u[i * D + a])]++;
      for (size_t b = 0; b <= a; b++) {
        product[a][b] += dea_normal_quantile(u[i * D + a]) * dea_normal_quantile(u[i * D + b]) / N;
      }
    }
  }
  for (size_t a = 0, next = 0; a < D; a++) {
    assert_close(product[a][a], 1, 0, 2e-3);
    for (size_t b = 0; b < a; b++) {
      assert_close(product[a][b], wanted[next++], 0, 2e-3);
    }
    for (size_t k = 0; k < 16; k++) {
      assert_in_range(hits[a][k], N / 16 - 32, N / 16 + 32); // a standard deviation of random ones
    }
  }
  free(u);
}

/* Ishigami and Homma's function, whose indices are known in closed form, to 1 %. */
TEST(test_ishigami)
{
  enum { N = 1 << 14, D = 3 };
  const double A = 7, B = 0.1;
  double *u = calloc((size_t)N * 2 * D, sizeof *u), *f = calloc((size_t)N * (D + 2), sizeof *f);
  dea_sample_sobol(2 * D, N, 1, u);
  for (size_t b = 0; b < D + 2; b++) {
    for (size_t i = 0; i < N; i++) {
      double x[D];
      for (size_t j = 0; j < D; j++) {
        x[j] = pi * (2 * u[i * 2 * D + j + (b == 1 || b == j + 2 ? D : 0)] - 1);
      }
      f[b * N + i] = sin(x[0]) + A * pow(sin(x[1]), 2) + B * pow(x[2], 4) * sin(x[0]);
    }
  }
  const double V1 = 0.5 * pow(1 + B * pow(pi, 4) / 5, 2), V2 = A * A / 8,
               V13 = 8 * B * B * pow(pi, 8) / 225, V = V1 + V2 + V13;
  const double first[D] = {V1 / V, V2 / V, 0}, total[D] = {(V1 + V13) / V, V2 / V, V13 / V};
  f[7] = NAN; // a failed case takes its sample with it
  for (size_t j = 0; j < D; j++) {
    double s, t;
    dea_sobol_index(f, f + N, f + (2 + j) * N, N, &s, &t);
    assert_true(fabs(s - first[j]) < 0.01 * fmax(first[j], 0.3));
    assert_true(fabs(t - total[j]) < 0.01 * total[j]);
  }
  free(u);
  free(f);
}

TEST(test_spread)
{
  double values[1001];
  struct dea_spread spread;
  for (int i = 0; i <= 1000; i++) {
    values[i] = (i * 5) % 1001; // all of 0 to 1000
  }
  assert_int_equal(dea_spread_find(ctx, values, 1001, &spread), DEA_OK);
  assert_true(fabs(spread.mean - 500) < 1e-9 && fabs(spread.std - sqrt(1001 * 1002 / 12.0)) < 1e-9);
  assert_true(fabs(spread.quantile[0] - 25) < 1e-9 && fabs(spread.quantile[3] - 840) < 1e-9);
}

/* Groups of neighbours: each case in one, which is a box of the plan; they begin from one of them.
 */
TEST(test_order)
{
  enum { N = 1000, D = 3, GROUP = 20 };
  static double p[N * D];
  const bool whole[D] = {true, false, false};
  bool there[N] = {false};
  struct dea_arena memory = {.ctx = ctx};
  struct dea_order order;
  dea_sample_sobol(D, N, 1, p);
  for (size_t i = 0; i < N; i++) {
    p[i * D] = p[i * D] < 0.5 ? 4 : 8;
    p[i * D + 2] *= 1e-6; // the range counts, not the unit
  }
  assert_int_equal(dea_order_of(&memory, p, N, D, whole, GROUP, &order), DEA_OK);
  size_t groups = 0;
  for (size_t from = 0, to = 0; from < N; from = to, groups++) {
    double low[D] = {INFINITY, INFINITY, INFINITY}, high[D] = {0};
    assert_int_equal(order.first[from], order.cases[from]);
    for (to = from; to < N && order.first[to] == order.first[from]; to++) {
      const size_t i = order.cases[to];
      assert_false(there[i]);
      there[i] = true;
      for (size_t j = 0; j < D; j++) {
        low[j] = fmin(low[j], p[i * D + j]);
        high[j] = fmax(high[j], p[i * D + j]);
      }
    }
    assert_true(to - from <= GROUP && to - from >= GROUP / 2 - 1);
    assert_true(high[0] == low[0] && high[1] - low[1] < 0.3 && high[2] - low[2] < 0.3e-6);
  }
  assert_int_equal(groups, 64);
  assert_int_equal(dea_order_of(&memory, p, N, D, whole, 1, &order), DEA_OK);
  for (size_t i = 0; i < N; i++) { // nobody begins from another: as planned
    assert_true(order.cases[i] == i && order.first[i] == i);
  }
  dea_arena_free(&memory);
}

// Processes ---------------------------------------------------------------------------------------

/* q = p0^2 + p1; case 3 has no second value, case 5 ends its process, case 6 that with a signal. */
static dea_status square(void *user, struct dea_context *own, struct dea_case *io)
{
  if (io->number == 5 || io->number == 6) {
    io->number == 5 ? _exit(3) : (void)kill(getpid(), SIGKILL);
  }
  io->q[0] = io->p[0] * io->p[0] + io->p[1];
  snprintf(io->id, sizeof io->id, "id%zu", io->number);
  if (io->number == 3) {
    snprintf(io->why, sizeof io->why, "none, \nno \"value\"");
  } else {
    io->q[1] = -io->p[1];
  }
  return DEA_OK;
}

static const struct dea_evaluator evaluator = {
    .param_count = 2, .value_count = 2, .evaluate = square};

struct taken {
  size_t next, count, done;
  struct dea_store *store;
  struct dea_case cases[64];
};

static bool give(void *user, struct dea_case *out)
{
  struct taken *taken = user;
  if (taken->next == taken->count) {
    return false;
  }
  out->number = taken->next++;
  out->p[0] = 0.1 * (double)out->number;
  out->p[1] = 1 / 3.0;
  return true;
}

static dea_status take(void *user, const struct dea_case *done)
{
  struct taken *taken = user;
  taken->cases[done->number] = *done;
  taken->done++;
  return taken->store != NULL ? dea_store_add(taken->store, done) : DEA_OK;
}

TEST(test_pool)
{
  struct dea_pool *pool;
  static struct taken taken;
  taken = (struct taken){.count = 40};
  assert_int_equal(dea_pool_create(ctx, &evaluator, 3, &pool), DEA_OK);
  assert_int_equal(dea_pool_run(pool, give, take, &taken), DEA_OK);
  assert_int_equal(taken.done, 40);
  for (size_t i = 0; i < 40; i++) {
    const struct dea_case *now = &taken.cases[i];
    const double p = 0.1 * (double)i;
    if (i == 5 || i == 6) {
      assert_string_equal(now->why, i == 5 ? "the process of this case ended by exit code 3"
                                           : "the process of this case ended by signal 9");
      assert_true(isnan(now->q[0]));
    } else {
      assert_true(now->q[0] == p * p + 1 / 3.0 && isnan(now->q[1]) == (i == 3));
    }
  }
  taken = (struct taken){.count = 10}; // the same processes again
  assert_int_equal(dea_pool_run(pool, give, take, &taken), DEA_OK);
  assert_int_equal(taken.done, 10);
  dea_pool_destroy(pool);
}

// The store ---------------------------------------------------------------------------------------

static const struct dea_shard whole = {1, 1};

TEST(test_store)
{
  struct dea_store *store, *other;
  struct dea_pool *pool;
  static struct taken taken;
  char name[600];
  snprintf(name, sizeof name, "%s/store", folder);
  assert_int_equal(dea_store_open(ctx, name, "q1", &evaluator, &whole, &store), DEA_OK);
  taken = (struct taken){.count = 12, .store = store};
  assert_int_equal(dea_pool_create(ctx, &evaluator, 2, &pool), DEA_OK);
  assert_int_equal(dea_pool_run(pool, give, take, &taken), DEA_OK);
  dea_pool_destroy(pool);
  assert_int_equal(dea_store_open(ctx, name, "q1", &evaluator, &whole, &other), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "another process writes"));
  assert_int_equal(dea_store_remove(ctx, name), DEA_E_IO); // what is computed would be lost
  assert_non_null(strstr(dea_context_message(ctx), "another process writes"));
  dea_store_close(store);
  assert_int_equal(dea_store_open(ctx, name, "q2", &evaluator, NULL, &other), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "another question"));
  snprintf(name, sizeof name, "%s/store/part-1-of-1.csv", folder);
  FILE *file = fopen(name, "rb");
  static char bytes[8192];
  const size_t length = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  const char *head = strchr(bytes, '\n');
  for (size_t cut = 0; cut <= length; cut += cut < 100 ? 9 : 37) { // ended anywhere, or zeros there
    size_t whole_lines = 0;
    for (size_t i = (size_t)(head - bytes) + 1; i < cut; i++) {
      whole_lines += bytes[i] == '\n' ? 1U : 0U;
    }
    file = fopen(name, "wb");
    fwrite(bytes, 1, cut, file);
    fwrite((char[40]){0}, 1, cut % 2 == 0 ? 0 : 40, file);
    fclose(file);
    char in[600];
    snprintf(in, sizeof in, "%s/store", folder);
    assert_int_equal(dea_store_open(ctx, in, "q1", &evaluator, &whole, &store), DEA_OK);
    assert_int_equal(dea_store_count(store), whole_lines);
    for (size_t i = 0; i < 12; i++) { // what is lacking, and once more what is there
      const struct dea_case *there = dea_store_find(store, taken.cases[i].p);
      if (there == NULL) {
        assert_int_equal(dea_store_add(store, &taken.cases[i]), DEA_OK);
      } else {
        assert_memory_equal(there->q, taken.cases[i].q, sizeof(double));
        assert_string_equal(there->id, taken.cases[i].id);
      }
    }
    dea_store_close(store);
    assert_int_equal(dea_store_open(ctx, in, "q1", &evaluator, NULL, &store), DEA_OK);
    assert_int_equal(dea_store_count(store), 12);
    assert_int_equal(dea_store_torn(store), 0);
    dea_store_close(store);
  }
  snprintf(name, sizeof name, "%s/store", folder);
  assert_int_equal(dea_store_remove(ctx, name), DEA_OK);
  assert_int_equal(dea_store_open(ctx, name, "q1", &evaluator, NULL, &store), DEA_OK);
  assert_int_equal(dea_store_count(store), 0);
  dea_store_close(store);
}

// Emulator ----------------------------------------------------------------------------------------

enum { CASES = 177, VOLTS = 9 };

/* An emulator of a function of shares and voltage with `keys` keys. */
struct emulated {
  struct dea_emulator e;
  unsigned char nodes[CASES * DEA_EMULATOR_KEYS_MAX];
  double volts[VOLTS], values[CASES * VOLTS];
  unsigned flags[CASES * VOLTS];
  const struct dea_column *column;
};

static void emulate(size_t keys, int level, double (*f)(const double *share, double V),
                    struct emulated *out)
{
  out->e =
      (struct dea_emulator){.model = "",
                            .device = "",
                            .key_count = keys,
                            .case_count = keys > 0 ? dea_sparse_grid(keys, level, out->nodes) : 1,
                            .voltage_count = VOLTS,
                            .quantity_count = 1,
                            .level = level,
                            .nodes = out->nodes,
                            .voltages_V = out->volts,
                            .quantities = &out->column,
                            .values = out->values,
                            .flags = out->flags};
  out->column = &dea_point_columns[0];
  for (size_t k = 0; k < VOLTS; k++) {
    out->volts[k] = 500.0 * (double)k;
  }
  for (size_t c = 0; c < out->e.case_count; c++) {
    double share[DEA_EMULATOR_KEYS_MAX];
    for (size_t j = 0; j < keys; j++) {
      share[j] = dea_sparse_grid_share(level, out->nodes[c * keys + j]);
    }
    for (size_t k = 0; k < VOLTS; k++) {
      out->values[c * VOLTS + k] = f(share, out->volts[k]);
      out->flags[c * VOLTS + k] = 0;
    }
  }
  assert_int_equal(dea_emulator_build(ctx, &out->e), DEA_OK);
}

/* Of degree 4 in each and of total degree within the grid of level 2, times degree 4 in V. */
static double polynomial(const double *share, double V)
{
  const double x = share[0], y = share[1], v = V / 4000;
  return (1 + x * x * x * x - 2 * y * y * y + x * x * y - x * y * y + 3 * x * y) *
         (v - v * v * v * v);
}

static double smooth(const double *share, double V)
{
  return (exp(1.5 * share[0]) * sin(2 + share[1]) + cosh(share[2])) * pow(V / 4000, 2) *
         exp(V / 9000);
}

TEST(test_sparse_grid)
{
  static const size_t counts[3][4] = {{3, 5, 9, 17}, {5, 13, 29, 65}, {7, 25, 69, 177}};
  static struct emulated of;
  double value, error, worst = 0;
  unsigned flags;
  for (size_t keys = 1; keys <= 3; keys++) {
    for (int level = 1; level <= 4; level++) {
      assert_int_equal(dea_sparse_grid(keys, level, NULL), counts[keys - 1][level - 1]);
    }
  }
  emulate(2, 2, polynomial, &of);
  for (int i = 0; i < 50; i++) {
    const double share[2] = {i / 49.0, 0.5 + 0.5 * sin(i)}, V = 80 * i;
    assert_int_equal(dea_emulator_at(ctx, &of.e, share, &V, 1, &value, &error, &flags), DEA_OK);
    assert_close(value, polynomial(share, V), 0, 1e-12);
  }
  dea_emulator_free(ctx, &of.e);
  emulate(3, 3, smooth, &of); // the error that is stored bounds the true one
  for (int i = 0; i < 500; i++) {
    const double share[3] = {i % 7 / 6.0, i % 11 / 10.0, i % 13 / 12.0}, V = 7.9 * i;
    assert_int_equal(dea_emulator_at(ctx, &of.e, share, &V, 1, &value, &error, &flags), DEA_OK);
    const double off = fabs(value - smooth(share, V));
    assert_true(off <= error);
    worst = fmax(worst, off);
  }
  assert_true(worst > 1e-9 && worst < 1e-3);
  dea_emulator_free(ctx, &of.e);
}

TESTS(set_up, tear_down)

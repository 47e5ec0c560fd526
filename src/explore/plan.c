#include "explore/plan.h"

#include "base/correlations.h"
#include "io/sparse_grid.h"

#include <math.h>

// Points of the unit cube -------------------------------------------------------------------------

enum { BITS = 32, DEGREE_MAX = 7 };

/* Primitive polynomials and first direction numbers of the dimensions from the second on: S. Joe
 * and F. Y. Kuo, SIAM J. Sci. Comput. 30, 2635 (2008), their table "new-joe-kuo-6". */
static const struct {
  unsigned char degree, polynomial;
  unsigned char first[DEGREE_MAX];
} directions[DEA_SOBOL_DIMENSIONS - 1] = {
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
};

/* Direction numbers of a dimension by their recurrence, the first bit highest. */
static void find_directions(size_t dimension, uint32_t v[BITS])
{
  for (unsigned k = 0; k < BITS; k++) {
    v[k] = UINT32_C(1) << (BITS - 1 - k);
  }
  if (dimension == 0) {
    return;
  }
  const unsigned s = directions[dimension - 1].degree, a = directions[dimension - 1].polynomial;
  for (unsigned k = 0; k < s; k++) {
    v[k] *= directions[dimension - 1].first[k];
  }
  for (unsigned k = s; k < BITS; k++) {
    v[k] = v[k - s] ^ (v[k - s] >> s);
    for (unsigned i = 1; i < s; i++) {
      v[k] ^= ((a >> (s - 1 - i)) & 1U) != 0 ? v[k - i] : 0;
    }
  }
}

/* SplitMix64: a number from a counter. */
static uint64_t mix(uint64_t *state)
{
  uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

/* Middle of one of 2^32 intervals. */
static double unit_of(uint32_t x)
{
  return ((double)x + 0.5) * 0x1p-32;
}

void dea_sample_sobol(size_t dimensions, size_t count, unsigned long long seed, double *out)
{
  uint64_t state = seed;
  for (size_t d = 0; d < dimensions; d++) {
    uint32_t v[BITS], x = (uint32_t)(mix(&state) >> 32); // the shift
    find_directions(d, v);
    for (size_t i = 0; i < count; i++) {
      out[i * dimensions + d] = unit_of(x);
      unsigned bit = 0; // the lowest 0 of i (Antonov and Saleev)
      while (bit < BITS - 1 && ((i >> bit) & 1U) != 0) {
        bit++;
      }
      x ^= v[bit];
    }
  }
}

void dea_sample_random(size_t dimensions, size_t count, unsigned long long seed, double *out)
{
  uint64_t state = seed;
  for (size_t i = 0; i < dimensions * count; i++) {
    out[i] = unit_of((uint32_t)(mix(&state) >> 32));
  }
}

double dea_normal_quantile(double u)
{
  const bool upper = u > 0.5; // the lower half has the digits
  const double share = upper ? 1 - u : u;
  const double t = sqrt(-2 * log(share));
  double x = -(t - (2.30753 + 0.27061 * t) / (1 + t * (0.99229 + t * 0.04481))); // Hastings
  for (int k = 0; k < 4; k++) { // Halley on P(X <= x) = erfc(-x / sqrt(2)) / 2
    const double off = (0.5 * erfc(-x * 0.70710678118654752440) - share) /
                       (0.39894228040143267794 * exp(-0.5 * x * x));
    x -= off / (1 + 0.5 * x * off);
  }
  return upper ? -x : x;
}

void dea_sample_correlate(const struct dea_explore_file *file, size_t count, double *u)
{
  const size_t n = file->variable_count;
  double L[DEA_CASE_PARAMS_MAX * DEA_CASE_PARAMS_MAX], z[DEA_CASE_PARAMS_MAX];
  if (file->correlation_count == 0) {
    return;
  }
  dea_correlations_factor(file->correlations, file->correlation_count, n, L);
  for (size_t i = 0; i < count; i++, u += n) {
    for (size_t j = 0; j < n; j++) {
      z[j] = dea_normal_quantile(u[j]);
    }
    for (size_t j = 0; j < n; j++) {
      double sum = 0;
      for (size_t k = 0; k <= j; k++) {
        sum += L[j * n + k] * z[k];
      }
      u[j] = fmin(fmax(0.5 * erfc(-sum * 0.70710678118654752440), 0x1p-33), 1 - 0x1p-33);
    }
  }
}

// Cases -------------------------------------------------------------------------------------------

/* Value of a variable at a share of its distribution. */
static double value_at(const struct dea_variable *variable, double u)
{
  const double mean = variable->param.param.prior, std = variable->param.param.prior_std;
  double value;
  if (variable->value_count > 0) {
    const size_t i = (size_t)(u * (double)variable->value_count);
    return variable->values[i < variable->value_count ? i : variable->value_count - 1];
  }
  switch (variable->text->distribution.value) {
  case DEA_NORMAL:
    value = mean + std * dea_normal_quantile(u);
    break;
  case DEA_LOGNORMAL:
    value = mean * exp(std / mean * dea_normal_quantile(u));
    break;
  default:
    value = variable->low + (variable->high - variable->low) * u;
  }
  value = fmin(fmax(value, isnan(variable->low) ? -INFINITY : variable->low),
               isnan(variable->high) ? INFINITY : variable->high);
  return variable->param.whole ? round(value) : value;
}

static dea_status cannot_be_made(struct dea_context *ctx)
{
  return dea_fail(ctx, DEA_E_DESIGN, "the plan cannot be made");
}

static dea_status too_many(const struct dea_design_space *space, double count)
{
  DEA_TRY(space->ctx,
          dea_finding_add(space->ctx, DEA_ERROR, space->file->plan.location,
                          "%.3g cases are too many: at most %d", count, DEA_EXPLORE_CASES_MAX));
  return cannot_be_made(space->ctx);
}

/* A sparse grid is of few numbers that change evenly from low to high, at rising voltages. */
static dea_status check_sparse(const struct dea_design_space *space)
{
  const struct dea_explore_file *file = space->file;
  for (size_t j = 0; j < space->variable_count; j++) {
    const struct dea_variable *variable = &space->variables[j];
    const struct dea_label *name = &variable->text->text.name;
    if (variable->value_count > 0 || variable->param.whole ||
        variable->text->distribution.value != DEA_UNIFORM) {
      DEA_TRY(space->ctx,
              dea_finding_add(space->ctx, DEA_ERROR, name->location,
                              "%s: a sparse grid needs low and high, of no whole number",
                              name->text));
    }
  }
  if (space->variable_count > DEA_EMULATOR_KEYS_MAX) {
    DEA_TRY(space->ctx,
            dea_finding_add(space->ctx, DEA_ERROR, file->plan.location,
                            "a sparse grid has at most %d variables", DEA_EMULATOR_KEYS_MAX));
  }
  if (space->voltage_count < 2) {
    DEA_TRY(space->ctx, dea_finding_add(space->ctx, DEA_ERROR, file->plan.location,
                                        "a sparse grid needs voltages between which it can "
                                        "interpolate, such as voltages: [0 kV, 1 kV, 2 kV]"));
  }
  return DEA_OK;
}

dea_status dea_plan_check(const struct dea_design_space *space)
{
  const struct dea_explore_file *file = space->file;
  struct dea_context *ctx = space->ctx;
  const bool grid = file->plan.value == DEA_PLAN_GRID;
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  for (size_t j = 0; j < space->variable_count && grid; j++) {
    const struct dea_label *name = &space->variables[j].text->text.name;
    if (space->variables[j].value_count == 0) {
      DEA_TRY(ctx,
              dea_finding_add(ctx, DEA_ERROR, name->location,
                              "%s: a grid needs values, or steps from low to high", name->text));
    }
  }
  DEA_TRY(ctx, file->plan.value == DEA_PLAN_SPARSE ? check_sparse(space) : DEA_OK);
  if (file->correlation_count > 0 &&
      (grid || file->plan.value == DEA_PLAN_SPARSE || file->plan.value == DEA_PLAN_INDICES)) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, file->correlations[0].location,
                                 "correlations are of samples: plan: %s",
                                 file->plan.value != DEA_PLAN_INDICES
                                     ? "sobol, not a grid"
                                     : "sobol; indices are of variables that are independent of "
                                       "each other"));
  }
  return dea_finding_count(ctx, DEA_ERROR) == errors ? DEA_OK : cannot_be_made(ctx);
}

static dea_status build_grid(struct dea_arena *memory, const struct dea_design_space *space,
                             struct dea_plan *out)
{
  const size_t n = space->variable_count;
  double count = 1;
  for (size_t j = 0; j < n; j++) {
    count *= (double)space->variables[j].value_count;
  }
  if (count > DEA_EXPLORE_CASES_MAX) {
    return too_many(space, count);
  }
  out->samples = out->count = (size_t)count;
  out->p = dea_arena_alloc(memory, out->count * n, sizeof *out->p);
  DEA_TRY_MEMORY(out->p != NULL);
  for (size_t c = 0; c < out->count; c++) {
    size_t rest = c;
    for (size_t j = n; j-- > 0;) { // the last variable changes first
      const struct dea_variable *variable = &space->variables[j];
      out->p[c * n + j] = variable->values[rest % variable->value_count];
      rest /= variable->value_count;
    }
  }
  return DEA_OK;
}

static dea_status build_sparse(struct dea_arena *memory, const struct dea_design_space *space,
                               struct dea_plan *out)
{
  const size_t n = space->variable_count;
  const int level = (int)space->file->level.si;
  out->samples = out->count = dea_sparse_grid(n, level, NULL);
  out->p = dea_arena_alloc(memory, out->count * n, sizeof *out->p);
  out->nodes = dea_arena_alloc(memory, out->count * n, 1);
  DEA_TRY_MEMORY(!memory->failed);
  dea_sparse_grid(n, level, out->nodes);
  for (size_t i = 0; i < out->count * n; i++) {
    out->p[i] = value_at(&space->variables[i % n], dea_sparse_grid_share(level, out->nodes[i]));
  }
  return DEA_OK;
}

static dea_status build_samples(struct dea_arena *memory, const struct dea_design_space *space,
                                struct dea_plan *out)
{
  const size_t n = space->variable_count, samples = (size_t)space->file->samples.si;
  const bool indices = space->file->plan.value == DEA_PLAN_INDICES;
  const size_t dimensions = indices ? 2 * n : n, blocks = indices ? n + 2 : 1;
  if (dimensions > DEA_SOBOL_DIMENSIONS) {
    DEA_TRY(space->ctx,
            dea_finding_add(space->ctx, DEA_ERROR, space->file->plan.location,
                            "indices of at most %d variables", DEA_SOBOL_DIMENSIONS / 2));
    return cannot_be_made(space->ctx);
  }
  if (samples * blocks > DEA_EXPLORE_CASES_MAX) {
    return too_many(space, (double)(samples * blocks));
  }
  out->samples = samples;
  out->count = samples * blocks;
  out->p = dea_arena_alloc(memory, out->count * n, sizeof *out->p);
  double *u = dea_arena_alloc(memory, samples * dimensions, sizeof *u);
  DEA_TRY_MEMORY(!memory->failed);
  (space->file->plan.value == DEA_PLAN_RANDOM ? dea_sample_random : dea_sample_sobol)(
      dimensions, samples, (unsigned long long)space->file->seed.si, u);
  if (!indices) {
    dea_sample_correlate(space->file, samples, u);
  }
  for (size_t b = 0; b < blocks; b++) {
    for (size_t i = 0; i < samples; i++) {
      for (size_t j = 0; j < n; j++) { // block 0: A, 1: B, 2 + j: A with column j of B
        const bool second = b == 1 || b == j + 2;
        out->p[(b * samples + i) * n + j] =
            value_at(&space->variables[j], u[i * dimensions + j + (second ? n : 0)]);
      }
    }
  }
  return DEA_OK;
}

dea_status dea_plan_build(struct dea_arena *memory, const struct dea_design_space *space,
                          struct dea_plan *out)
{
  const int kind = space->file->plan.value;
  *out = (struct dea_plan){0};
  DEA_TRY(space->ctx, dea_plan_check(space));
  DEA_TRY(space->ctx, kind == DEA_PLAN_GRID     ? build_grid(memory, space, out)
                      : kind == DEA_PLAN_SPARSE ? build_sparse(memory, space, out)
                                                : build_samples(memory, space, out));
  out->cases = dea_arena_alloc(memory, out->count, sizeof(struct dea_case *));
  return dea_arena_status(memory);
}

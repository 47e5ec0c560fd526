#include "identify/fit_core.h"

#include <math.h>
#include <string.h>

size_t dea_fit_priors_add(const struct dea_fit_param *params, size_t count, const double *p,
                          double *r)
{
  size_t n = 0;
  for (size_t j = 0; j < count; j++) {
    if (!isnan(params[j].prior)) {
      if (r != NULL) {
        r[n] = (p[j] - params[j].prior) / params[j].prior_std;
      }
      n++;
    }
  }
  return n;
}

dea_status dea_fit_core_statistics(struct dea_context *ctx, struct dea_fit_core *core)
{
  dea_lsq_statistics_free(&core->statistics);
  return dea_lsq_statistics_find(ctx, &core->least_squares, core->groups, core->group_count,
                                 core->scale_known, &core->statistics);
}

dea_status dea_fit_core_solve(struct dea_context *ctx, struct dea_fit_core *core,
                              dea_status (*solve)(void *user), void *user)
{
  enum { ROUNDS_MAX = 20 };
  static const double first = 0.01, same = 1e-3;
  const bool sought =
      !core->scale_known && dea_fit_priors_add(core->params, core->param_count, NULL, NULL) > 0;
  core->scatter *= sought ? first : 1;
  for (int round = 1;; round++) {
    DEA_TRY(ctx, solve(user));
    DEA_TRY(ctx, dea_fit_core_statistics(ctx, core));
    const double factor = sqrt(core->statistics.variance);
    if (!sought || round == ROUNDS_MAX || !(factor > 0) || !isfinite(factor) ||
        fabs(factor - 1) <= same) {
      return DEA_OK;
    }
    core->scatter *= factor;
  }
}

/* The interval of parameter j by its profile, where the normal form is poor or for `all`. */
static dea_status find_interval(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                                const struct dea_fit_core *core, size_t j, bool all,
                                struct dea_fit_value *value)
{
  const struct dea_lsq_fit *fit = &core->least_squares;
  const double std = core->statistics.std[j], naive = core->statistics.naive_std[j];
  if (!(std > 0) || isinf(std)) {
    return DEA_OK;
  }
  const double unit = (std / naive) * (std / naive); // correlated, widened
  for (int sign = -1; sign <= 1; sign += 2) {
    double from[DEA_LSQ_PARAMS_MAX], growth;
    memcpy(from, fit->p, fit->params * sizeof *from);
    DEA_TRY(ctx, dea_lsq_growth(ctx, problem, fit, j, fit->p[j] + sign * std, unit, from, &growth));
    value->bends = value->bends || !(fabs(growth) < 0.15);
  }
  if (value->bends || all) {
    double interval[2];
    const bool logarithmic = core->params[j].logarithmic;
    DEA_TRY(ctx, dea_lsq_profile(ctx, problem, fit, j, unit, 0.7 * std, interval));
    value->low = logarithmic ? exp(interval[0]) : interval[0];
    value->high = logarithmic ? exp(interval[1]) : interval[1];
  }
  return DEA_OK;
}

dea_status dea_fit_core_values(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                               bool profiles, bool all, struct dea_fit_core *core)
{
  for (size_t j = 0; j < core->param_count; j++) {
    const struct dea_fit_param *param = &core->params[j];
    const double p = core->least_squares.p[j], std = core->statistics.std[j];
    core->values[j] = (struct dea_fit_value){.value = param->logarithmic ? exp(p) : p,
                                             .std = param->logarithmic ? exp(p) * std : std,
                                             .low = NAN,
                                             .high = NAN,
                                             .fixed = param->fixed,
                                             .at_bound = core->least_squares.at_bound[j]};
    if (profiles || all) {
      dea_progress(ctx, "profiles", j, core->param_count);
      DEA_TRY(ctx, find_interval(ctx, problem, core, j, all, &core->values[j]));
    }
  }
  return DEA_OK;
}

void dea_fit_core_scatter(struct dea_fit_core *core)
{
  double squares = 0;
  size_t rows = 0;
  for (size_t g = 0; g < core->group_count; g++) {
    rows += core->groups[g].count;
  }
  for (size_t i = 0; i < rows; i++) { // groups lie behind each other, priors behind them
    squares += core->least_squares.r[i] * core->least_squares.r[i];
  }
  core->scatter *= core->scale_known ? 1 : sqrt(squares / (double)(rows > 0 ? rows : 1));
}

void dea_fit_core_free(struct dea_fit_core *core)
{
  dea_lsq_statistics_free(&core->statistics);
  dea_lsq_free(&core->least_squares);
}

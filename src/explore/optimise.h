/* The best design: within bounds and limits, for one objective or the front of two. */
#pragma once

#include "explore/explore_file.h"
#include "explore/store.h"

/* What an evaluator's values mean to a search. All lent. */
struct dea_search {
  struct dea_context *ctx;
  const struct dea_evaluator *evaluator;
  struct dea_store *store; // every evaluation is kept there, and taken from there
  size_t processes;
  double start[DEA_CASE_PARAMS_MAX], low[DEA_CASE_PARAMS_MAX], high[DEA_CASE_PARAMS_MAX];
  /* Values that a variable can take alone: [value_count], 0 for all of its range. */
  const double *values[DEA_CASE_PARAMS_MAX];
  size_t value_count[DEA_CASE_PARAMS_MAX];
  /* Objective k to be minimised, k = 0 or 1, and margins of limits, [limit_count], below 0 where
   * they are crossed, each linear in values of a case, so that gradients go through them too. */
  double (*objective)(const void *user, size_t k, const double *q);
  double (*margin)(const void *user, size_t limit, const double *q);
  const void *user;
  size_t objective_count, limit_count;
  enum dea_method method;
  size_t starts, evaluations, front;
  double tolerance;
  /* What a design is looked at with, [scatter_count][params], added to its numbers: its functions
   * are then a statistic over all of these, of each function by itself. NULL: the design alone. */
  const double *scatter;
  size_t scatter_count;
  double quantile; // the value that this share of them keeps below; NAN: the mean and
  double spread;   // so many standard deviations
  /* Designs at which differences stood in for a gradient that the evaluator did not give, by each
   * variable, [param_count]; NULL: not wanted. */
  size_t *replaced;
};

/* A point that a search came to. f: objectives, of scattered designs their statistics. */
struct dea_optimum {
  double p[DEA_CASE_PARAMS_MAX], f[DEA_EXPLORE_OBJECTIVES_MAX];
  unsigned marks;     // last mark of it, or of all that it stands for together
  bool found;         // a design within all limits
  size_t evaluations; // after which it was found, those of before among them
};

/* Searches. out: of one objective one optimum; of two the front from the best of the first to the
 * best of the second, [*count] of at most DEA_EXPLORE_FRONT_MAX. An interruption ends it with
 * DEA_E_INTERRUPTED, all evaluations kept. */
dea_status dea_search_run(const struct dea_search *search, struct dea_optimum *out, size_t *count);
/* Objectives [objective_count], then what limits are crossed by [limit_count] (at most 0: within),
 * of the design p by what the store has; NAN where a value is missing. false: it was not looked at.
 */
enum { DEA_SEARCH_VALUES_MAX = DEA_EXPLORE_OBJECTIVES_MAX + 2 * DEA_EXPLORE_LIMITS_MAX };
bool dea_search_compute(const struct dea_search *search, const double *p, double *out);
/* Mark k of the design p by what the store has, or of all that it stands for together. */
unsigned dea_search_marks(const struct dea_search *search, const double *p, size_t k);

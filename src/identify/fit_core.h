/* What fits of materials and of devices have in common: parameters, the minimum, its error bars,
 * and what the measurements do not determine (docs/theory/fit.md). */
#pragma once

#include "identify/least_squares.h"

enum {
  DEA_FIT_NEXT_MAX = 5,
  DEA_FIT_WEAK_MAX = 4,
  DEA_FIT_WEAK_SIZE = 400,
  DEA_FIT_GROUPS_MAX = 32,
};

/* A parameter as found, in its unit. */
struct dea_fit_value {
  double value;
  double std;       // standard uncertainty; NAN: fixed or at a bound, INFINITY: not determined
  double low, high; // 68 % interval by its profile, NAN: not computed, infinite: open
  bool fixed, at_bound, bends; // bends: the profile is not that of the normal form
};

/* What one more measurement would do. */
struct dea_fit_next {
  char what[80];
  double shrink; // factor on the mean error bar (geometric mean over the free parameters)
};

/* A measurement that could be made: derivatives of what it would give [rows x params], over its
 * assumed uncertainty; lent. */
struct dea_fit_proposal {
  char what[96];
  size_t rows;
  const double *J;
};

struct dea_fit_core {
  struct dea_fit_param params[DEA_LSQ_PARAMS_MAX];
  size_t param_count;
  bool scale_known; // uncertainties were given
  double scatter;   // SI: root mean square misfit where they were not; while fitting a scale
  struct dea_lsq_group groups[DEA_FIT_GROUPS_MAX]; // rows of each test or curve that is fitted
  size_t group_count;
  struct dea_lsq_fit least_squares;
  struct dea_lsq_statistics statistics;
  struct dea_fit_value values[DEA_LSQ_PARAMS_MAX];
  char weak[DEA_FIT_WEAK_MAX][DEA_FIT_WEAK_SIZE]; // combinations that are not told apart, in words
  size_t weak_count;
  struct dea_fit_next next[DEA_FIT_NEXT_MAX]; // the best first
  size_t next_count;
};

/* Adds the residuals of all priors at p to r (NULL: none). Returns their number. */
size_t dea_fit_priors_add(const struct dea_fit_param *params, size_t count, const double *p,
                          double *r);
/* Fits and finds the statistics. solve: puts the minimum in the place of that in least_squares;
 * where the rows change it sets the groups anew. It is called once; where priors weigh by a scatter
 * that is to be found too, again, each time with the scatter that was found last, until it stays:
 * then it begins at a hundredth of the guess, so that at first the rows speak and not a prior that
 * they contradict. */
dea_status dea_fit_core_solve(struct dea_context *ctx, struct dea_fit_core *core,
                              dea_status (*solve)(void *user), void *user);
/* Statistics of the minimum as it is now. */
dea_status dea_fit_core_statistics(struct dea_context *ctx, struct dea_fit_core *core);
/* Fills values. profiles: looks for intervals, which are computed where the normal form is poor, or
 * for `all`. */
dea_status dea_fit_core_values(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                               bool profiles, bool all, struct dea_fit_core *core);
/* At the end: the scatter where no uncertainty was given, from the guess that was fitted with. */
void dea_fit_core_scatter(struct dea_fit_core *core);
void dea_fit_core_free(struct dea_fit_core *core);

// What the measurements do not determine (identifiability.c) --------------------------------------

/* Finds combinations of parameters that the measurements (`what`: "tests") do not hold, or hardly.
 */
void dea_fit_identify_weak(struct dea_fit_core *core, const char *what);

/* Which designs: the numbers of every case of a grid or of samples. */
#pragma once

#include "explore/design_space.h"

enum { DEA_SOBOL_DIMENSIONS = 21 };

/* Points [count][dimensions] of the unit cube, each coordinate above 0 and below 1: the first ones
 * of Sobol's sequence with the direction numbers of Joe and Kuo, shifted by the seed. dimensions:
 * at most DEA_SOBOL_DIMENSIONS. */
void dea_sample_sobol(size_t dimensions, size_t count, unsigned long long seed, double *out);
/* The same without any order. */
void dea_sample_random(size_t dimensions, size_t count, unsigned long long seed, double *out);

/* x with P(X <= x) = u of a standard normal distribution; 0 < u < 1. */
double dea_normal_quantile(double u);
/* Gives shares u [count][variables] of the variables of a file its correlations, by the normal
 * numbers behind them; without any they stay. */
void dea_sample_correlate(const struct dea_explore_file *file, size_t count, double *u);

/* Numbers of cases [count][params], in memory of an arena. Of indices: A, B, then for each variable
 * A with the variable of B, of `samples` each. */
struct dea_plan {
  double *p;
  const struct dea_case **cases; // [count] as far as they are done, else NULL; who does them fills
  size_t count, samples;
  unsigned char *nodes; // of a sparse grid (io/sparse_grid.h)
};
/* Whether a plan can be made of the variables as they are given, which a search does not ask.
 * Errors are findings; DEA_E_DESIGN then. */
dea_status dea_plan_check(const struct dea_design_space *space);
/* Errors (too many cases, what has no range) are findings; DEA_E_DESIGN then. */
dea_status dea_plan_build(struct dea_arena *memory, const struct dea_design_space *space,
                          struct dea_plan *out);

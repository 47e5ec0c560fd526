/* Load points at rising voltages of which some are computed and the others interpolated between
 * them (docs/theory/loads.md, "Voltages between computed ones"). Knows nothing of models. */
#pragma once

#include "result/load_point.h"

#include <stddef.h>

/* A gap: what lies between two computed points. All lent. */
struct dea_sampled_line {
  struct dea_load_point *points; // [count]
  const double *voltages_V;      // [count] of these, rising
  bool *computed;                // [count] which of them are; the first and the last
  size_t count;
};

/* Marks in wanted [count] the middles of those gaps that are not to be interpolated: their ends are
 * no two points of one smooth line, or the estimated error of a number is more than it may be by
 * the tolerance, a share of what that number changes by. Returns how many. */
size_t dea_sampled_line_halve(const struct dea_sampled_line *line, double tolerance, bool *wanted);

/* Interpolates what is not computed, with flag and estimated errors. */
void dea_sampled_line_fill(const struct dea_sampled_line *line);

/* Correlations of several uncertain numbers, as files list them: 2 with 1, 3 with 1, 3 with 2, ...
 */
#pragma once

#include "base/context.h"
#include "base/value.h"

enum { DEA_CORRELATED_MAX = 64 }; // numbers

/* Whether there are as many as n numbers have, or none, and some numbers can have them: their
 * matrix has no negative eigenvalue. Otherwise one finding, at the first of them. what: "variable".
 * listed: [count] */
dea_status dea_correlations_check(struct dea_context *ctx, const struct dea_quantity *listed,
                                  size_t count, size_t n, const char *what);
/* The factor L [n][n] of their matrix, lower, C = L L^T: L times independent normal numbers are
 * normal ones with these correlations. Unit matrix without any. false: no numbers have these. */
bool dea_correlations_factor(const struct dea_quantity *listed, size_t count, size_t n, double *L);

/* What samples say: moments, quantiles, the probability of a limit, Sobol indices. */
#pragma once

#include "base/context.h"

enum { DEA_SHARES = 5 };
/* Quantiles that are given: 2.5, 16, 50, 84 and 97.5 %. */
extern const double dea_shares[DEA_SHARES];

struct dea_spread {
  size_t count; // of samples with a value
  double mean, std, quantile[DEA_SHARES];
};

/* Of values [count]; NAN are left out. DEA_E_MEMORY. */
dea_status dea_spread_find(struct dea_context *ctx, const double *values, size_t count,
                           struct dea_spread *out);

/* First and total index of a variable after Jansen (Comput. Phys. Commun. 117, 35, 1999), from
 * values [samples] at A, at B, and at A with this variable of B. Samples with a NAN are left out.
 */
void dea_sobol_index(const double *a, const double *b, const double *ab, size_t samples,
                     double *first, double *total);

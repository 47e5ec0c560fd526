#include "base/correlations.h"

#include <math.h>
#include <string.h>

static const double little = 1e-6; // of 1: what rounding to a few digits makes of a singular matrix

// a pivot of 0 has a column of 0
bool dea_correlations_factor(const struct dea_quantity *listed, size_t count, size_t n, double *L)
{
  bool good = true;
  memset(L, 0, n * n * sizeof *L);
  for (size_t i = 0, next = 0; i < n; i++) {
    double pivot = 1;
    for (size_t j = 0; j < i; j++) {
      double sum = count > 0 ? listed[next++].si : 0;
      for (size_t k = 0; k < j; k++) {
        sum -= L[i * n + k] * L[j * n + k];
      }
      const double by = L[j * n + j];
      L[i * n + j] = by > 0 ? sum / by : 0;
      good = good && (by > 0 || fabs(sum) <= sqrt(little));
      pivot -= L[i * n + j] * L[i * n + j];
    }
    good = good && pivot >= -little;
    L[i * n + i] = pivot > little ? sqrt(pivot) : 0;
  }
  return good;
}

dea_status dea_correlations_check(struct dea_context *ctx, const struct dea_quantity *listed,
                                  size_t count, size_t n, const char *what)
{
  const size_t wanted = n > 0 ? n * (n - 1) / 2 : 0;
  double L[DEA_CORRELATED_MAX * DEA_CORRELATED_MAX];
  if (count == 0) {
    return DEA_OK;
  }
  if (count != wanted) {
    return dea_finding_add(ctx, DEA_ERROR, listed[0].location,
                           "%zu correlations where %zu %ss have %zu", count, n, what, wanted);
  }
  return n > DEA_CORRELATED_MAX || dea_correlations_factor(listed, count, n, L)
             ? DEA_OK
             : dea_finding_add(ctx, DEA_ERROR, listed[0].location,
                               "no numbers have these correlations: their matrix has a negative "
                               "eigenvalue");
}

#include "explore/sample_statistics.h"

#include "base/sort.h"

#include <math.h>
#include <stdlib.h>

const double dea_shares[DEA_SHARES] = {0.025, 0.16, 0.5, 0.84, 0.975};

dea_status dea_spread_find(struct dea_context *ctx, const double *values, size_t count,
                           struct dea_spread *out)
{
  double *sorted = dea_alloc(ctx, count, sizeof *sorted);
  DEA_TRY_MEMORY(sorted != NULL);
  *out = (struct dea_spread){0, 0, 0, {NAN, NAN, NAN, NAN, NAN}};
  for (size_t i = 0; i < count; i++) {
    if (!isnan(values[i])) {
      sorted[out->count++] = values[i];
      out->mean += values[i];
    }
  }
  out->mean /= (double)out->count; // NAN without any
  for (size_t i = 0; i < out->count; i++) {
    out->std += (sorted[i] - out->mean) * (sorted[i] - out->mean);
  }
  out->std = out->count > 1 ? sqrt(out->std / (double)(out->count - 1)) : NAN;
  qsort(sorted, out->count, sizeof *sorted, dea_rising);
  for (size_t k = 0; k < DEA_SHARES && out->count > 0; k++) {
    const double at = dea_shares[k] * (double)(out->count - 1);
    const size_t i = (size_t)at;
    const double next = sorted[i + 1 < out->count ? i + 1 : i];
    out->quantile[k] = sorted[i] + (at - (double)i) * (next - sorted[i]);
  }
  dea_free(ctx, sorted);
  return DEA_OK;
}

void dea_sobol_index(const double *a, const double *b, const double *ab, size_t samples,
                     double *first, double *total)
{
  double n = 0, sum = 0, squares = 0, of_first = 0, of_total = 0;
  for (size_t i = 0; i < samples; i++) {
    if (!isnan(a[i]) && !isnan(b[i]) && !isnan(ab[i])) {
      n += 1;
      sum += a[i] + b[i];
    }
  }
  const double mean = sum / (2 * n);
  for (size_t i = 0; i < samples; i++) {
    if (!isnan(a[i]) && !isnan(b[i]) && !isnan(ab[i])) {
      squares += (a[i] - mean) * (a[i] - mean) + (b[i] - mean) * (b[i] - mean);
      of_first += (b[i] - ab[i]) * (b[i] - ab[i]);
      of_total += (a[i] - ab[i]) * (a[i] - ab[i]);
    }
  }
  const double variance = squares / (2 * n);
  *first = 1 - of_first / (2 * n * variance);
  *total = of_total / (2 * n * variance);
}

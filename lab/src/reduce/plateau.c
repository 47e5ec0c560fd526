#include "reduce/reduce_parts.h"

enum {
  THINNED_MAX = 100000
}; // values that quantiles are taken of; evenly chosen of longer channels

/* Every n-th number of a channel (operation 0), or of its second differences (1). */
static size_t thin_values(const struct dea_channel *voltage, bool differences, double *out)
{
  size_t every = 1 + voltage->count / THINNED_MAX, n = 0;
  const double *u = voltage->values;
  for (size_t i = 0; i < voltage->count; i += every) {
    double value = !differences                      ? u[i]
                   : i > 0 && i + 1 < voltage->count ? u[i - 1] - 2.0 * u[i] + u[i + 1]
                                                     : NAN;
    if (!isnan(value)) {
      out[n++] = value;
    }
  }
  return n;
}

/* Voltage of rest: 0 when the voltage takes both signs, else its end that is nearer to 0. */
static double rest_voltage(double *values, size_t n, double low_V, double high_V)
{
  double largest = fmax(fabs(low_V), fabs(high_V));
  if (low_V < -0.05 * largest && high_V > 0.05 * largest) {
    return 0.0;
  }
  double near_V = fabs(low_V) < fabs(high_V) ? low_V : high_V;
  size_t m = 0;
  for (size_t i = 0; i < n; i++) {
    if (fabs(values[i] - near_V) <= 0.02 * largest) {
      values[m++] = values[i];
    }
  }
  return dea_median(values, m);
}

dea_status dea_voltage_scale_find(struct dea_context *ctx, const struct dea_channel *voltage,
                                  struct dea_voltage_scale *out)
{
  *out = (struct dea_voltage_scale){0};
  size_t capacity = voltage->count < THINNED_MAX ? voltage->count : THINNED_MAX;
  double *values = dea_alloc(ctx, capacity + 1, sizeof *values);
  DEA_TRY_MEMORY(values != NULL);
  size_t n = thin_values(voltage, true, values);
  double noise = dea_spread(values, n, 0.0) / sqrt(6.0); // variance of 1, -2, 1 is 6
  out->noise_V = isnan(noise) ? 0.0 : noise;
  n = thin_values(voltage, false, values);
  if (n > 0) {
    double low_V = dea_quantile(values, n, 0.001), high_V = dea_quantile(values, n, 0.999);
    out->low_V = low_V;
    out->high_V = high_V;
    out->largest_V = fmax(fabs(low_V), fabs(high_V));
    out->rest_V = rest_voltage(values, n, low_V, high_V);
  }
  dea_free(ctx, values);
  if (out->largest_V == 0.0 && out->noise_V == 0.0) { // pulses rarer than the quantiles see
    for (size_t i = 0; i < voltage->count; i++) {
      out->largest_V = fmax(out->largest_V, fabs(voltage->values[i])); // not NAN
    }
  }
  out->active_V = fmax(6.0 * out->noise_V, 0.02 * out->largest_V);
  out->tolerance_V = fmax(4.0 * out->noise_V, 0.01 * out->largest_V);
  return DEA_OK;
}

/* Mean of the numbers among samples begin <= i < end; NAN without. */
static double mean_of(const double *u, size_t begin, size_t end)
{
  double sum = 0.0;
  size_t n = 0;
  for (size_t i = begin; i < end; i++) {
    if (!isnan(u[i])) {
      sum += u[i];
      n++;
    }
  }
  return n > 0 ? sum / (double)n : NAN;
}

/* True when the means of the four quarters differ by less than half a tolerance: a plateau, not a
 * piece of a ramp (which runs through two tolerances) or the top of a sine (one). */
static bool is_flat(const double *u, size_t begin, size_t end, double tolerance_V)
{
  size_t n = end - begin;
  if (n < 4) {
    return false;
  }
  double low = INFINITY, high = -INFINITY;
  for (size_t q = 0; q < 4; q++) {
    double mean = mean_of(u, begin + q * n / 4, begin + (q + 1) * n / 4);
    low = fmin(low, mean);
    high = fmax(high, mean);
  }
  return high - low < 0.5 * tolerance_V;
}

/* End of the run from begin on that stays within the tolerance of its own mean. A few samples that
 * are off (a discharge pulls the voltage down) do not end it. */
static size_t run_end(const double *u, size_t begin, size_t end, double tolerance_V)
{
  double sum = 0.0;
  size_t n = 0, last = begin;
  for (size_t i = begin; i < end; i++) {
    if (isnan(u[i])) {
      continue;
    }
    if (n == 0 || fabs(u[i] - sum / (double)n) <= tolerance_V) {
      sum += u[i];
      n++;
      last = i;
    } else if (i - last > 2 + n / 50) {
      break;
    }
  }
  return last + 1;
}

dea_status dea_plateaus_find(struct dea_context *ctx, const struct dea_channel *voltage,
                             size_t begin, size_t end, double tolerance_V, struct dea_plateau **out,
                             size_t *count)
{
  const double *u = voltage->values;
  struct dea_plateau *found = NULL;
  size_t n = 0, capacity = 0;
  *out = NULL;
  *count = 0;
  for (size_t at = begin; at < end;) {
    size_t stop = run_end(u, at, end, tolerance_V);
    double mean_V = mean_of(u, at, stop);
    while (at < stop && fabs(u[at] - mean_V) > tolerance_V) { // of the way to it
      at++;
    }
    if (is_flat(u, at, stop, tolerance_V)) {
      dea_status status = dea_array_grow(ctx, &found, n, &capacity, sizeof *found);
      DEA_TRY_ELSE(ctx, status, dea_free(ctx, found));
      found[n++] = (struct dea_plateau){at, stop, mean_of(u, at, stop)};
    }
    at = stop > at ? stop : at + 1;
  }
  *out = found;
  *count = n;
  return DEA_OK;
}

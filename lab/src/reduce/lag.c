/* Whether a series moves with the voltage: of two clocks that were put together wrongly it moves
 * before it, or long after. */
#include "reduce/reduce_parts.h"

enum { BINS_MAX = 2048, BINS_MIN = 64 };

/* Means of the samples (their squares) in `count` equal parts of a span; NAN where there is none.
 */
static void bin(const struct dea_channel *series, struct dea_span span, bool squares, double *out,
                size_t count)
{
  const double width_s = (span.end_s - span.begin_s) / (double)count;
  size_t i = dea_channel_index(series, span.begin_s);
  for (size_t b = 0; b < count; b++) {
    const double end_s = span.begin_s + (double)(b + 1) * width_s;
    double sum = 0;
    size_t n = 0;
    for (; i < series->count && dea_channel_time(series, i) < end_s; i++) {
      const double value = series->values[i];
      if (!isnan(value)) {
        sum += squares ? value * value : value;
        n++;
      }
    }
    out[b] = n > 0 ? sum / (double)n : NAN;
  }
}

/* Size of the correlation of x with y `shift` parts later; NAN with less than half of the pairs. */
static double correlation(const double *x, const double *y, size_t count, ptrdiff_t shift)
{
  double n = 0, sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
  const size_t from = shift < 0 ? (size_t)-shift : 0,
               to = shift > 0 ? count - (size_t)shift : count;
  for (size_t i = from; i < to; i++) {
    const double a = x[i], b = y[(size_t)((ptrdiff_t)i + shift)];
    if (!isnan(a) && !isnan(b)) {
      n++;
      sx += a;
      sy += b;
      sxx += a * a;
      syy += b * b;
      sxy += a * b;
    }
  }
  const double ways = (sxx - sx * sx / n) * (syy - sy * sy / n);
  return 2 * n >= (double)count && ways > 0 ? fabs(sxy - sx * sy / n) / sqrt(ways) : NAN;
}

/* The nearest of the shifts at which the correlation is largest, but for what is like it: equal
 * cycles repeat it. r: [2 most + 1] of all shifts. */
static ptrdiff_t nearest_top(const double *r, ptrdiff_t most)
{
  const double alike = 0.05;
  double best = 0;
  ptrdiff_t shift = 0;
  for (ptrdiff_t i = 0; i <= 2 * most; i++) {
    best = fmax(best, r[i]); // not NAN
  }
  while (shift < most && !(r[most + shift] >= best - alike) && !(r[most - shift] >= best - alike)) {
    shift++;
  }
  const bool later = r[most + shift] >= best - alike;
  const ptrdiff_t way = later ? 1 : -1;
  ptrdiff_t at = most + way * shift;
  while (at + way >= 0 && at + way <= 2 * most && r[at + way] > r[at]) { // up to the top
    at += way;
  }
  return at - most;
}

/* x, y: room for `count`; r: for one more. */
static struct dea_lag search(const struct dea_channel *voltage, const struct dea_channel *series,
                             struct dea_span span, double *x, double *y, double *r, size_t count)
{
  const ptrdiff_t most = (ptrdiff_t)(count / 2);
  bin(voltage, span, true, x, count);
  bin(series, span, false, y, count);
  for (ptrdiff_t shift = -most; shift <= most; shift++) {
    r[most + shift] = correlation(x, y, count, shift);
  }
  const ptrdiff_t shift = nearest_top(r, most);
  return (struct dea_lag){(double)shift * (span.end_s - span.begin_s) / (double)count,
                          r[most + shift], r[most]};
}

dea_status dea_lag_find(struct dea_context *ctx, const struct dea_channel *voltage,
                        const struct dea_channel *series, struct dea_span span, struct dea_lag *out)
{
  const size_t of_voltage = dea_channel_index(voltage, span.end_s) -
                            dea_channel_index(voltage, span.begin_s),
               of_series =
                   dea_channel_index(series, span.end_s) - dea_channel_index(series, span.begin_s);
  size_t count = (of_voltage < of_series ? of_voltage : of_series) / 2;
  count = count < BINS_MAX ? count : BINS_MAX;
  *out = (struct dea_lag){NAN, NAN, NAN};
  if (!(span.end_s > span.begin_s) || count < BINS_MIN) {
    return DEA_OK;
  }
  double *x = dea_alloc(ctx, 3 * count + 1, sizeof *x);
  DEA_TRY_MEMORY(x != NULL);
  *out = search(voltage, series, span, x, x + count, x + 2 * count, count);
  dea_free(ctx, x);
  return DEA_OK;
}

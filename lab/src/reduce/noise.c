/* The mean of n samples of a sensor is not n^-1/2 as uncertain as one: neighbours are correlated by
 * the sensor's own filter and by what shakes the bench. Derivation: docs/theory/reduction.md. */
#include "reduce/reduce_parts.h"

#include "base/dense.h"

#include <string.h>

enum { PER_WINDOW = 32, OWN_SPREAD = 8 };

static bool is_empty(struct dea_span span)
{
  return !(span.end_s > span.begin_s);
}

static size_t samples_in(const struct dea_channel *series, struct dea_span span, size_t *first)
{
  if (is_empty(span)) {
    *first = 0;
    return 0;
  }
  *first = dea_channel_index(series, span.begin_s);
  size_t end = dea_channel_index(series, span.end_s);
  return end > *first ? end - *first : 0;
}

/* Copies the samples of a span, outliers as NAN: beyond 6 of their own spreads, or, where they are
 * too few to tell that, beyond a given limit. scratch: [2 x samples]. */
static size_t copy_span(const struct dea_channel *series, struct dea_span span, double limit,
                        double *scratch)
{
  size_t first, n = samples_in(series, span, &first), numbers = 0;
  double *sorted = scratch + n;
  for (size_t i = 0; i < n; i++) {
    scratch[i] = series->values[first + i];
    if (!isnan(scratch[i])) {
      sorted[numbers++] = scratch[i];
    }
  }
  if (numbers < 3) {
    return n;
  }
  double median = dea_median(sorted, numbers);
  double own = 6.0 * dea_spread(sorted, numbers, median);
  limit = numbers < OWN_SPREAD ? limit : own > 0.0 ? own : INFINITY;
  for (size_t i = 0; i < n; i++) {
    scratch[i] = fabs(scratch[i] - median) > limit ? NAN : scratch[i];
  }
  return n;
}

size_t dea_window_longest(const struct dea_channel *series, const struct dea_span *spans,
                          size_t count)
{
  size_t longest = 0, first;
  for (size_t i = 0; i < count; i++) {
    size_t n = samples_in(series, spans[i], &first);
    longest = n > longest ? n : longest;
  }
  return longest;
}

struct dea_window dea_window_mean(const struct dea_channel *series, struct dea_span span,
                                  double limit, double *scratch)
{
  struct dea_window w = {.mean = NAN, .time_s = NAN};
  size_t first;
  double sum = 0.0, times = 0.0;
  samples_in(series, span, &first);
  w.all = copy_span(series, span, limit, scratch);
  for (size_t i = 0; i < w.all; i++) {
    if (!isnan(scratch[i])) {
      sum += scratch[i];
      times += dea_channel_time(series, first + i) - span.begin_s;
      w.count++;
    }
  }
  if (w.count > 0 && 2 * w.count >= w.all) {
    w.mean = sum / (double)w.count;
    w.time_s = span.begin_s + times / (double)w.count;
  }
  return w;
}

// Blocks -----------------------------------------------------------------------------------------

/* Takes the straight line off values at 0, 1, ... (NAN stays out); numbers there are. */
static size_t subtract_line(double *values, size_t count)
{
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (size_t i = 0; i < count; i++) {
    if (!isnan(values[i])) {
      double x = (double)i;
      n += 1;
      sx += x;
      sy += values[i];
      sxx += x * x;
      sxy += x * values[i];
    }
  }
  double spread = sxx - (n > 0 ? sx * sx / n : 0.0);
  double slope = spread > 0.0 ? (sxy - sx * sy / n) / spread : 0.0;
  for (size_t i = 0; i < count; i++) {
    values[i] -= (sy - slope * sx) / n + slope * (double)i;
  }
  return (size_t)n;
}

/* Sums over all windows: of the products of residuals at each lag, and what each lag's covariance
 * contributes to them. */
struct sums {
  double products[DEA_NOISE_LAGS + 1], pairs[DEA_NOISE_LAGS + 1];
  size_t windows[DEA_NOISE_BLOCKS + 1]; // of so many blocks
};

static void add_window(struct sums *sums, const double *residuals, size_t m)
{
  for (size_t lag = 0; lag <= DEA_NOISE_LAGS && lag < m; lag++) {
    for (size_t i = 0; i + lag < m; i++) {
      double product = residuals[i] * residuals[i + lag];
      if (!isnan(product)) {
        sums->products[lag] += product;
        sums->pairs[lag] += 1.0;
      }
    }
  }
  sums->windows[m]++;
}

/* Element i, j of P T P, where P = 1 - B B^T takes a line off m values and T has ones at distance
 * `lag` from its diagonal. B^T T is given as bt [2][m], B^T T B as btb. */
static double projected(double b[2][DEA_NOISE_BLOCKS], double bt[2][DEA_NOISE_BLOCKS],
                        double btb[2][2], size_t i, size_t j, size_t lag)
{
  size_t distance = i > j ? i - j : j - i;
  double value = distance == lag ? 1.0 : 0.0;
  for (int p = 0; p < 2; p++) {
    value -= b[p][i] * bt[p][j] + bt[p][i] * b[p][j];
    for (int q = 0; q < 2; q++) {
      value += b[p][i] * btb[p][q] * b[q][j];
    }
  }
  return value;
}

/* Adds `windows` times the expected sums of products at each lag for a covariance of 1 at lag
 * `column` alone. */
static void add_expected(size_t m, size_t windows, size_t lags, double *A)
{
  double b[2][DEA_NOISE_BLOCKS], bt[2][DEA_NOISE_BLOCKS], btb[2][2] = {{0}}, norm = 0.0;
  for (size_t i = 0; i < m; i++) {
    b[0][i] = 1.0 / sqrt((double)m);
    b[1][i] = (double)i - 0.5 * (double)(m - 1);
    norm += b[1][i] * b[1][i];
  }
  for (size_t i = 0; i < m; i++) {
    b[1][i] /= sqrt(norm);
  }
  for (size_t column = 0; column <= lags; column++) {
    memset(btb, 0, sizeof btb);
    for (int p = 0; p < 2; p++) {
      for (size_t i = 0; i < m; i++) {
        bt[p][i] = (i >= column ? b[p][i - column] : 0.0) +
                   (i + column < m && column > 0 ? b[p][i + column] : 0.0);
        btb[p][0] += bt[p][i] * b[0][i];
        btb[p][1] += bt[p][i] * b[1][i];
      }
    }
    for (size_t lag = 0; lag <= lags; lag++) {
      for (size_t i = 0; i + lag < m; i++) {
        A[lag + column * (lags + 1)] += (double)windows * projected(b, bt, btb, i, i + lag, column);
      }
    }
  }
}

/* Covariances at 0 to `lags` blocks, those beyond being 0, without what the lines took with them.
 * false: cannot be told. */
static bool solve(const struct sums *sums, size_t lags, double *covariance)
{
  double A[(DEA_NOISE_LAGS + 1) * (DEA_NOISE_LAGS + 1)] = {0};
  for (size_t m = 3; m <= DEA_NOISE_BLOCKS; m++) {
    if (sums->windows[m] > 0) {
      add_expected(m, sums->windows[m], lags, A);
    }
  }
  for (size_t lag = 0; lag <= lags; lag++) { // as if no block were missing
    double all = 0.0;
    for (size_t m = 3; m <= DEA_NOISE_BLOCKS; m++) {
      all += m > lag ? (double)(sums->windows[m] * (m - lag)) : 0.0;
    }
    covariance[lag] = sums->pairs[lag] > 0.0 ? sums->products[lag] * all / sums->pairs[lag] : 0.0;
  }
  return dea_dense_solve(lags + 1, A, covariance) == DEA_OK && covariance[0] >= 0.0;
}

/* Adds lags as long as their correlation stands out of the noise of its estimate. */
static void find_covariance(const struct sums *sums, struct dea_noise *out)
{
  size_t smallest = 0;
  for (size_t m = DEA_NOISE_BLOCKS; m > 2; m--) {
    smallest = sums->windows[m] > 0 ? m : smallest;
  }
  size_t most = smallest / 4 < DEA_NOISE_LAGS ? smallest / 4 : DEA_NOISE_LAGS;
  for (size_t lags = 0; smallest > 0 && lags <= most; lags++) {
    double covariance[DEA_NOISE_LAGS + 1] = {0};
    if (!solve(sums, lags, covariance) ||
        (lags > 0 && !(covariance[lags] >
                       covariance[0] * fmax(0.03, 1.5 / sqrt(fmax(1.0, sums->pairs[lags])))))) {
      break;
    }
    out->lags = lags;
    memcpy(out->covariance, covariance, sizeof covariance);
  }
}

/* Means of the blocks of a window; how many. */
static size_t blocks_of(const double *values, size_t n, size_t block, double *out)
{
  size_t m = n / block < DEA_NOISE_BLOCKS ? n / block : DEA_NOISE_BLOCKS;
  for (size_t k = 0; k < m; k++) {
    double sum = 0.0;
    size_t valid = 0;
    for (size_t i = k * block; i < (k + 1) * block; i++) {
      if (!isnan(values[i])) {
        sum += values[i];
        valid++;
      }
    }
    out[k] = 2 * valid >= block ? sum / (double)valid : NAN;
  }
  return m;
}

/* Eight times the usual spread of the samples of a span: what an outlier among few exceeds. */
static double usual_limit(const struct dea_channel *series, const struct dea_span *spans,
                          size_t count, double *scratch, double *spreads)
{
  size_t known = 0;
  for (size_t w = 0; w < count; w++) {
    size_t n = copy_span(series, spans[w], INFINITY, scratch), numbers = 0;
    for (size_t i = 0; i < n; i++) {
      numbers += isnan(scratch[i]) ? 0U : 1U;
    }
    if (numbers > 2) {
      double median = dea_median(scratch, n); // numbers first
      spreads[known++] = dea_spread(scratch, numbers, median);
    }
  }
  double limit = 8.0 * dea_median(spreads, known);
  return limit > 0.0 ? limit : INFINITY;
}

dea_status dea_noise_estimate(struct dea_context *ctx, const struct dea_channel *series,
                              const struct dea_span *spans, size_t count, struct dea_noise *out)
{
  struct sums sums = {0};
  size_t longest = dea_window_longest(series, spans, count);
  double squares = 0.0, freedom = 0.0;
  *out = (struct dea_noise){.block = 1, .sample = NAN, .limit = INFINITY};
  out->covariance[0] = NAN;
  double *scratch = dea_alloc(ctx, 2 * longest + 1, sizeof *scratch);
  double *spreads = dea_alloc(ctx, count, sizeof *spreads);
  if (scratch == NULL || spreads == NULL) {
    dea_free(ctx, spreads);
    dea_free(ctx, scratch);
    return DEA_E_MEMORY;
  }
  out->limit = usual_limit(series, spans, count, scratch, spreads);
  dea_free(ctx, spreads);
  out->block = 1 + (longest > 0 ? longest - 1 : 0) / PER_WINDOW;
  for (size_t w = 0; w < count; w++) {
    double blocks[DEA_NOISE_BLOCKS];
    size_t n = copy_span(series, spans[w], out->limit, scratch);
    size_t m = blocks_of(scratch, n, out->block, blocks);
    if (m > 2 && subtract_line(blocks, m) > 2) {
      add_window(&sums, blocks, m);
    }
    size_t numbers = subtract_line(scratch, n);
    for (size_t i = 0; i < n && numbers > 2; i++) {
      squares += isnan(scratch[i]) ? 0.0 : scratch[i] * scratch[i];
    }
    freedom += numbers > 2 ? (double)(numbers - 2) : 0.0;
  }
  dea_free(ctx, scratch);
  find_covariance(&sums, out);
  if (freedom > 0.0) { // a line takes more of correlated noise with it: at least that of the means
    out->sample = fmax(sqrt(squares / freedom), sqrt(fmax(0.0, out->covariance[0])));
  }
  return DEA_OK;
}

double dea_noise_of_mean(const struct dea_noise *noise, size_t count)
{
  double m = fmax((double)count / (double)noise->block, 1.0 / (double)noise->block);
  double sum = m * noise->covariance[0];
  for (size_t lag = 1; lag <= noise->lags && (double)lag < m; lag++) {
    sum += 2.0 * (m - (double)lag) * noise->covariance[lag];
  }
  return sum / (m * m);
}

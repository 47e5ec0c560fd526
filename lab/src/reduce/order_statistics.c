#include "reduce/reduce_parts.h"

/* Moves the k-th smallest value to place k, those below it before it (Hoare's selection). */
static double select_value(double *values, size_t count, size_t place)
{
  ptrdiff_t low = 0, high = (ptrdiff_t)count - 1, k = (ptrdiff_t)place;
  while (low < high) {
    double pivot = values[k];
    ptrdiff_t i = low, j = high;
    do {
      while (values[i] < pivot) {
        i++;
      }
      while (values[j] > pivot) {
        j--;
      }
      if (i <= j) {
        double value = values[i];
        values[i++] = values[j];
        values[j--] = value;
      }
    } while (i <= j);
    low = j < k ? i : low;
    high = k < i ? j : high;
  }
  return values[k];
}

double dea_quantile(double *values, size_t count, double share)
{
  if (count == 0) {
    return NAN;
  }
  return select_value(values, count, (size_t)(share * (double)(count - 1) + 0.5));
}

/* Numbers to the front; how many. */
static size_t numbers_first(double *values, size_t count)
{
  size_t n = 0;
  for (size_t i = 0; i < count; i++) {
    if (!isnan(values[i])) {
      double value = values[i];
      values[i] = values[n];
      values[n++] = value;
    }
  }
  return n;
}

double dea_median(double *values, size_t count)
{
  size_t n = numbers_first(values, count);
  if (n == 0) {
    return NAN;
  }
  double upper = select_value(values, n, n / 2);
  if (n % 2 == 1) {
    return upper;
  }
  double lower = values[0];
  for (size_t i = 1; i < n / 2; i++) {
    lower = fmax(lower, values[i]);
  }
  return lower + 0.5 * (upper - lower);
}

double dea_spread(double *values, size_t count, double centre)
{
  for (size_t i = 0; i < count; i++) {
    values[i] = fabs(values[i] - centre);
  }
  return 1.4826 * dea_median(values, count); // 1 / quantile of 3/4 of a normal distribution
}

/* Takes a value out of a sorted list, or puts one in; the new length. */
static size_t sorted_change(double *sorted, size_t n, double value, bool in)
{
  size_t at = 0;
  // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): n of them are there
  while (at < n && sorted[at] < value) {
    at++;
  }
  if (in) {
    for (size_t i = n; i > at; i--) {
      sorted[i] = sorted[i - 1];
    }
    sorted[at] = value;
    return n + 1;
  }
  for (size_t i = at + 1; i < n; i++) {
    sorted[i - 1] = sorted[i];
  }
  return n - 1;
}

void dea_running_median(const double *values, size_t count, size_t half, double *out)
{
  double sorted[2 * DEA_RUNNING_HALF_MAX + 2];
  size_t n = 0;
  half = half < DEA_RUNNING_HALF_MAX ? half : DEA_RUNNING_HALF_MAX;
  for (size_t i = 0; i < half && i < count; i++) {
    n = isnan(values[i]) ? n : sorted_change(sorted, n, values[i], true);
  }
  for (size_t i = 0; i < count; i++) {
    if (i + half < count && !isnan(values[i + half])) {
      n = sorted_change(sorted, n, values[i + half], true);
    }
    if (i > half && !isnan(values[i - half - 1])) {
      n = sorted_change(sorted, n, values[i - half - 1], false);
    }
    out[i] = n == 0 ? NAN : n % 2 == 1 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
  }
}

#include "identify/life.h"

#include <math.h>

static const double same_voltage = 0.99;

/* Whether a cycle is one of the test itself, not of a look at the specimen at a lower voltage. */
static bool is_judged(const struct dea_life_rows *rows, size_t i, double largest_V)
{
  return fabs(rows->asked_V[i]) >= same_voltage * largest_V;
}

static double largest_voltage(const struct dea_life_rows *rows)
{
  double largest_V = 0;
  for (size_t i = 0; i < rows->count; i++) {
    largest_V = fmax(largest_V, fabs(rows->asked_V[i])); // not NAN
  }
  return largest_V;
}

/* Mean stroke of the first cycles, and the row behind them; NAN where there are not so many. */
static double first_stroke(const struct dea_life_rows *rows, double largest_V, size_t cycles,
                           size_t *behind)
{
  double sum = 0;
  size_t n = 0;
  for (*behind = 0; *behind < rows->count && n < cycles; ++*behind) {
    if (is_judged(rows, *behind, largest_V) && !isnan(rows->stroke[*behind])) {
      sum += fabs(rows->stroke[*behind]);
      n++;
    }
  }
  return n == cycles && n > 0 ? sum / (double)n : NAN;
}

/* First of `lasting` judged cycles in a row whose value is beyond a limit: below it, or above;
 * those without a value neither count nor part the others. rows->count: there are none. */
static size_t first_beyond(const struct dea_life_rows *rows, const double *values, size_t from,
                           double largest_V, double limit, bool below, size_t lasting)
{
  size_t first = rows->count, n = 0;
  for (size_t i = from; i < rows->count; i++) {
    if (!is_judged(rows, i, largest_V) || isnan(values[i])) {
      continue;
    }
    bool beyond = below ? fabs(values[i]) < limit : fabs(values[i]) > limit;
    first = beyond && n == 0 ? i : first;
    n = beyond ? n + 1 : 0;
    if (n == lasting) {
      return first;
    }
  }
  return rows->count;
}

/* Of the last judged cycle up to a row; NAN without. */
static double last_stroke(const struct dea_life_rows *rows, double largest_V, size_t row)
{
  for (size_t i = row + 1; i > 0; i--) {
    if (is_judged(rows, i - 1, largest_V) && !isnan(rows->stroke[i - 1])) {
      return rows->stroke[i - 1];
    }
  }
  return NAN;
}

static size_t first_breakdown(const struct dea_life_rows *rows)
{
  size_t i = 0;
  while (i < rows->count && !(rows->breakdown[i] > 0)) {
    i++;
  }
  return i;
}

void dea_life_judge(const struct dea_life_rows *rows, const struct dea_life_criterion *criterion,
                    struct dea_life *out)
{
  double largest_V = largest_voltage(rows);
  size_t behind, at[DEA_LIFE_ENDS];
  double reference = first_stroke(rows, largest_V, criterion->reference_cycles, &behind);
  at[DEA_LIFE_SURVIVED] = at[DEA_LIFE_TOLD] = rows->count;
  // comparisons with NAN are false: what is not known is not beyond
  at[DEA_LIFE_STROKE] =
      first_beyond(rows, rows->stroke, behind, largest_V, (1 - criterion->stroke_loss) * reference,
                   true, criterion->lasting);
  at[DEA_LIFE_LEAKAGE] = first_beyond(rows, rows->leakage_A, 0, largest_V, criterion->leakage_A,
                                      false, criterion->lasting);
  at[DEA_LIFE_BREAKDOWN] = criterion->breakdown ? first_breakdown(rows) : rows->count;
  *out = (struct dea_life){.row = rows->count - 1, .first_stroke = reference};
  for (int end = DEA_LIFE_STROKE; end <= DEA_LIFE_BREAKDOWN; end++) {
    if (at[end] < rows->count && (out->end == DEA_LIFE_SURVIVED || at[end] < out->row)) {
      out->end = (enum dea_life_end)end;
      out->row = at[end];
    }
  }
  out->last_stroke = last_stroke(rows, largest_V, out->row);
  for (int k = 0; k < DEA_LIFE_CLOCKS; k++) {
    out->clock[k] = rows->clock[k][out->row];
  }
}

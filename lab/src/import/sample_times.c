#include "import/sample_times.h"

#include <math.h>

/* Times are written with a few digits, so that steps of one length seem to differ. Up to this share
 * of a step they are taken for uniform. */
static const double jitter_max = 0.01;

/* The first row from `i` on that has a time; the column's count: none. */
static size_t next_number(const struct dea_table_column *column, size_t i)
{
  while (i < column->count && isnan(column->values[i])) {
    i++;
  }
  return i;
}

/* How often a time is that of the row before. */
static size_t count_repeats(const struct dea_table_column *column)
{
  size_t count = 0, before = next_number(column, 0);
  for (size_t i = before; i < column->count; i = next_number(column, i + 1)) {
    count += i > before && column->values[i] == column->values[before];
    before = i;
  }
  return count;
}

static dea_status refuse(struct dea_context *ctx, const struct dea_table *table,
                         const struct dea_table_column *column, size_t row, size_t row_before)
{
  const struct dea_location location = {table->file, 0, 0};
  double first = column->values[next_number(column, 0)];
  double before = column->values[row_before], now = column->values[row];
  if (now == before && count_repeats(column) == 1) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location,
                                 "the time column '%.60s' repeats %.10g in row %zu of its numbers: "
                                 "row %zu repeats the time of row %zu: take one out",
                                 column->name, now, row + 1, row + 1, row_before + 1));
  } else if (now == before) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location,
                                 "the time column '%.60s' repeats %.10g in row %zu of its numbers: "
                                 "it has too few digits; give the rate in a mapping (rate: 10 kHz)",
                                 column->name, now, row + 1));
  } else if (before > first && now <= first + (before - first) * 1e-3) {
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_ERROR, location,
                            "the time column '%.60s' starts again in row %zu of its numbers "
                            "(%.10g after %.10g): the file holds several measurements, split it",
                            column->name, row + 1, now, before));
  } else {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location,
                                 "the time column '%.60s' falls in row %zu of its numbers (%.10g "
                                 "after %.10g)",
                                 column->name, row + 1, now, before));
  }
  return dea_fail(ctx, DEA_E_IO, "'%s' has times that do not rise", table->file);
}

/* Start and interval of `count` times that rise, if they are uniform. */
static bool is_uniform(const struct dea_table_column *c, size_t count, double *start,
                       double *interval)
{
  size_t last = c->count, i = next_number(c, 0);
  while (last > 0 && isnan(c->values[last - 1])) {
    last--;
  }
  *start = count > 0 ? c->values[i] : 0;
  *interval = count > 1 ? (c->values[last - 1] - *start) / (double)(count - 1) : 0;
  double worst = 0;
  for (size_t n = 0; n < count; n++, i = next_number(c, i + 1)) {
    worst = fmax(worst, fabs(c->values[i] - (*start + (double)n * *interval)));
  }
  return count > 1 && worst <= jitter_max * *interval;
}

dea_status dea_clock_read(struct dea_context *ctx, const struct dea_table *table, size_t column,
                          double factor, struct dea_clock *out)
{
  const struct dea_table_column *c = &table->columns[column];
  size_t before = c->count;
  *out = (struct dea_clock){0};
  for (size_t i = next_number(c, 0); i < c->count; i = next_number(c, i + 1)) {
    if (before < c->count && !(c->values[i] > c->values[before])) {
      return refuse(ctx, table, c, i, before);
    }
    before = i;
    out->count++;
  }
  if (out->count == 0 && c->count > 0) {
    return dea_fail(ctx, DEA_E_IO, "in '%s' the time column '%.60s' has no times", table->file,
                    c->name);
  }
  double start, interval;
  bool uniform = is_uniform(c, out->count, &start, &interval);
  out->start_s = start * factor;
  if (uniform) {
    out->interval_s = interval * factor;
    return DEA_OK;
  }
  out->time_s = dea_alloc(ctx, out->count, sizeof *out->time_s);
  DEA_TRY_MEMORY(out->time_s != NULL);
  size_t n = 0;
  for (size_t i = next_number(c, 0); i < c->count; i = next_number(c, i + 1)) {
    out->time_s[n++] = c->values[i] * factor;
  }
  return DEA_OK;
}

dea_status dea_clock_parse(struct dea_context *ctx, const struct dea_table *table, size_t column,
                           size_t times, double factor, double offset, size_t step, double *out)
{
  const struct dea_table_column *c = &table->columns[column], *t = &table->columns[times];
  size_t n = 0;
  for (size_t i = 0; i < c->count; i++) {
    if (!isnan(t->values[i])) {
      out[step * n++] = c->values[i] * factor + offset;
    } else if (!isnan(c->values[i])) {
      const struct dea_location location = {table->file, 0, 0};
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location,
                                   "the time column '%.60s' has no time in row %zu of its numbers, "
                                   "where '%.60s' has a value",
                                   t->name, i + 1, c->name));
      return dea_fail(ctx, DEA_E_IO, "'%s' has values without a time", table->file);
    }
  }
  return DEA_OK;
}

dea_status dea_clock_check_seconds(struct dea_context *ctx, const struct dea_table *table,
                                   size_t column)
{
  // 2000 to 2050 in days since 1900, with steps below a quarter of an hour
  static const double first_day = 36526, last_day = 54788, step_days = 0.01;
  const struct dea_location location = {table->file, 0, 0};
  const struct dea_table_column *c = &table->columns[column];
  double first, interval;
  size_t count = 0;
  for (size_t i = next_number(c, 0); i < c->count; i = next_number(c, i + 1)) {
    count++;
  }
  is_uniform(c, count, &first, &interval);
  double span = interval * (double)(count - 1);
  // 1e11 s are 3000 years
  const char *unit = first > 1e17 ? "ns" : first > 1e14 ? "us" : first > 1e11 ? "ms" : NULL;
  if (first >= first_day && first < last_day && span > 0 && interval < step_days &&
      (floor(first) != first || span < 1)) {
    unit = "day";
  }
  if (unit == NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx,
          dea_finding_add(ctx, DEA_ERROR, location,
                          "the time column '%.60s' has no unit, and %.12g looks like %s%s: say "
                          "which it is in a mapping (time_unit: %s, or time_unit: s)",
                          c->name, first, unit,
                          unit[0] == 'd' ? "s of a spreadsheet" : " since 1970", unit));
  return dea_fail(ctx, DEA_E_IO, "'%s' has times of an unknown unit", table->file);
}

bool dea_clock_same(const struct dea_clock *a, const struct dea_clock *b)
{
  if (a->count != b->count || (a->time_s == NULL) != (b->time_s == NULL)) {
    return false;
  }
  if (a->time_s == NULL) {
    return fabs(a->start_s - b->start_s) <= 1e-3 * a->interval_s &&
           fabs(a->interval_s - b->interval_s) * (double)a->count <= 1e-3 * a->interval_s;
  }
  for (size_t i = 0; i < a->count; i++) {
    double step = i > 0 ? a->time_s[i] - a->time_s[i - 1] : 1e-6;
    if (!(fabs(a->time_s[i] - b->time_s[i]) <= 1e-3 * step)) {
      return false;
    }
  }
  return true;
}

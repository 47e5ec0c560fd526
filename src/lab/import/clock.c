#include "lab/import/clock.h"

#include <math.h>

/* Times are written with a few digits, so that steps of one length seem to differ. Up to this share
 * of a step they are taken for uniform. */
static const double jitter_max = 0.01;

static dea_status refuse(struct dea_context *ctx, const struct dea_table *table,
                         const struct dea_table_column *column, size_t row)
{
  const struct dea_location location = {table->file, 0, 0};
  double before = row > 0 ? column->values[row - 1] : NAN, now = column->values[row];
  if (isnan(now) || (row > 0 && isnan(before))) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location,
                                 "the time column '%.60s' has no time in row %zu of its numbers",
                                 column->name, row + (isnan(now) ? 1 : 0)));
  } else if (now == before) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location,
                                 "the time column '%.60s' repeats %.10g in row %zu of its numbers: "
                                 "it has too few digits; give the rate in a mapping (rate: 10 kHz)",
                                 column->name, now, row + 1));
  } else if (now <= column->values[0] + fabs(before - column->values[0]) * 1e-3) {
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

dea_status dea_clock_read(struct dea_context *ctx, const struct dea_table *table, size_t column,
                          double factor, struct dea_clock *out)
{
  const struct dea_table_column *c = &table->columns[column];
  *out = (struct dea_clock){.count = c->count};
  for (size_t i = 0; i < c->count; i++) {
    if (isnan(c->values[i]) || (i > 0 && !(c->values[i] > c->values[i - 1]))) {
      return refuse(ctx, table, c, i);
    }
  }
  double step =
      c->count > 1 ? (c->values[c->count - 1] - c->values[0]) / (double)(c->count - 1) : 0;
  double worst = 0;
  for (size_t i = 0; i < c->count; i++) {
    worst = fmax(worst, fabs(c->values[i] - (c->values[0] + (double)i * step)));
  }
  out->start_s = c->count > 0 ? c->values[0] * factor : 0;
  if (c->count > 1 && worst <= jitter_max * step) {
    out->interval_s = step * factor;
    return DEA_OK;
  }
  out->time_s = dea_alloc(ctx, c->count, sizeof *out->time_s);
  if (out->time_s == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < c->count; i++) {
    out->time_s[i] = c->values[i] * factor;
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
  double first = c->count > 0 ? c->values[0] : 0;
  double span = c->count > 1 ? c->values[c->count - 1] - first : 0;
  // 1e11 s are 3000 years
  const char *unit = first > 1e17 ? "ns" : first > 1e14 ? "us" : first > 1e11 ? "ms" : NULL;
  if (first >= first_day && first < last_day && span > 0 &&
      span < step_days * (double)(c->count - 1) && (floor(first) != first || span < 1)) {
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

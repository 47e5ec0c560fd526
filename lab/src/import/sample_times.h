/* Times of samples: an interval where they are uniform. */
#pragma once

#include "import/import.h"

struct dea_clock {
  double start_s, interval_s; // interval 0: by time_s
  double *time_s;             // [count], owned; NULL with an interval
  size_t count;               // without rows that have no time
};

/* The clock of a column of times, SI value = value * factor. Times that fall or repeat are findings
 * with their row, DEA_E_IO then. */
dea_status dea_clock_read(struct dea_context *ctx, const struct dea_table *table, size_t column,
                          double factor, struct dea_clock *out);
/* The values of the rows that have a time as value * factor + offset, out[0], out[step], ... A
 * value without a time is a finding with its row, DEA_E_IO then. times: a column as long as the
 * other. */
dea_status dea_clock_parse(struct dea_context *ctx, const struct dea_table *table, size_t column,
                           size_t times, double factor, double offset, size_t step, double *out);
/* Whether the times of a column without a unit can be seconds: those since 1970 in ms, us or ns and
 * the days of spreadsheets are findings that ask for time_unit, DEA_E_IO then. */
dea_status dea_clock_check_seconds(struct dea_context *ctx, const struct dea_table *table,
                                   size_t column);
/* Whether two of them are the same to a thousandth of a step. */
bool dea_clock_same(const struct dea_clock *a, const struct dea_clock *b);

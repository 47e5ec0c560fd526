/* Times that are written as text: "09:15:00.5", "2026-03-02 09:15:00". */
#pragma once

#include "table/slices.h"

/* A time of the day in seconds (hours, minutes, seconds, with a decimal point or comma), with a
 * date before it or not: YYYY-MM-DD, YYYY/MM/DD or DD.MM.YYYY, then a blank or T; in days since
 * 1970. Behind one with a date may stand its zone, Z or +01:00, which is taken off the seconds.
 * Dates that may be read in two ways (03/02/2026) are none. False: it is no such text. */
bool dea_clock_text(struct dea_slice field, double *days, double *seconds, bool *dated);

/* The same down a column: seconds since its first one, which is 0. Zero-initialise; the first one
 * may be given twice. */
struct dea_text_clock {
  bool begun, dated;
  double first_day, first_s, last_s;
  double midnights; // that times without a date have passed
  double before_s;  // the last one since the first
  bool stands;      // one repeats or falls: it is no clock of rows
};
/* fraction_s: what a column of its own adds to it. False: it is no such text, or one with a date
 * where the others have none. */
bool dea_text_clock_next(struct dea_text_clock *clock, struct dea_slice field, double fraction_s,
                         double *seconds);

/* The computer's clock. */
#pragma once

/* Seconds of a clock that only goes forward, from an unknown start. */
double dea_clock_s(void);
/* Waits; a signal ends it early. At most an hour, nothing for less than 0. */
void dea_clock_wait(double seconds);
/* Now in UTC, "2026-11-29T12:10:51Z"; "" where that is not known. Returns out. */
enum { DEA_STAMP_SIZE = 32 };
const char *dea_clock_stamp(char out[DEA_STAMP_SIZE]);

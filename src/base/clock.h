/* The computer's clock. */
#pragma once

/* Seconds of a clock that only goes forward, from an unknown start. */
double dea_clock_s(void);
/* Waits; a signal ends it early. At most an hour, nothing for less than 0. */
void dea_clock_wait(double seconds);

#define _POSIX_C_SOURCE 200809L // clock_gettime
#include "base/clock.h"

#include <time.h>

double dea_clock_s(void)
{
  struct timespec now;
#ifdef CLOCK_BOOTTIME // of Linux: goes on while the computer sleeps
  clock_gettime(CLOCK_BOOTTIME, &now);
#else
  clock_gettime(CLOCK_MONOTONIC, &now);
#endif
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void dea_clock_wait(double seconds)
{
  if (seconds > 0) {
    double limited = seconds < 3600 ? seconds : 3600;
    struct timespec wait = {.tv_sec = (time_t)limited};
    wait.tv_nsec = (long)(1e9 * (limited - (double)wait.tv_sec));
    nanosleep(&wait, NULL);
  }
}

const char *dea_clock_stamp(char out[DEA_STAMP_SIZE])
{
  time_t now = time(NULL);
  struct tm utc;
  if (gmtime_r(&now, &utc) == NULL ||
      strftime(out, DEA_STAMP_SIZE, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0) {
    out[0] = '\0';
  }
  return out;
}

/* Timing for the benchmark programs: wall time, and one JSON line a figure. */
#pragma once

#include "base/context.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* Time since some fixed moment [s]. */
static inline double bench_now_s(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Processor time of this program so far [s]: other work on the machine counts less. */
static inline double bench_processor_s(void)
{
  return (double)clock() / CLOCKS_PER_SEC;
}

/* Shortest time [s] of `repeats` calls of work(user), after one call that is not counted: the
 * shortest is the one that other work on the machine disturbed least. */
static inline double bench_best_s(void (*work)(void *user), void *user, int repeats)
{
  double best = 1e300;
  work(user);
  for (int i = 0; i < repeats; i++) {
    double start = bench_now_s();
    work(user);
    double time = bench_now_s() - start;
    best = time < best ? time : best;
  }
  return best;
}

static inline int bench_compare(const void *a, const void *b)
{
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Median of values[count]; sorts them. */
static inline double bench_median(double *values, size_t count)
{
  qsort(values, count, sizeof *values, bench_compare);
  return count % 2 == 1 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}

/* One figure; name and unit: plain text without quotes. */
static inline void bench_print(const char *name, double value, const char *unit)
{
  printf("{\"name\": \"%s\", \"value\": %.6g, \"unit\": \"%s\"}\n", name, value, unit);
  fflush(stdout);
}

/* Ends the program when a call has failed. */
static inline void bench_need(dea_status status, struct dea_context *ctx)
{
  if (status != DEA_OK) {
    fprintf(stderr, "%s: %s\n", dea_status_message(status), dea_context_message(ctx));
    exit(1);
  }
}

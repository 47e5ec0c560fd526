/* Histories beside measured ones, on one clock. */
#pragma once

#include "result/compare.h"

/* A voltage in time, lent; times never fall. */
struct dea_voltage_track {
  const double *time_s, *voltage_V; // [count]
  size_t count;
};

/* What is to be added to the times of `a` so that its pulses lie on those of `b`. */
struct dea_clock_shift {
  double shift_s;
  size_t edges;        // pulses of a that have one of b of their height there
  double resolution_s; // how well edges are seen: mean time between samples there, of both
};

/* Finds the shift from the rising edges of the first DEA_CLOCK_EDGES_MAX pulses of each: a pulse is
 * what is above 5 % of the largest |V|, its edge where half of its own height is reached, between
 * samples linear. Of the shifts that bring the most edges together it is the smallest, and 0 when
 * it is below the resolution. edges 0: no
 * pulse of the one is of the height of one of the other; shift 0 then. */
enum { DEA_CLOCK_EDGES_MAX = 256 };
void dea_clock_shift_find(const struct dea_voltage_track *a, const struct dea_voltage_track *b,
                          struct dea_clock_shift *out);

/* A column of a curve in time minus what was measured, at the measured times; the curve's times
 * are moved by the shift, between its points it is linear. Times within the resolution of a jump of
 * the curve are left out, since they may be on either side of it. out: freed by the caller, also
 * after a failure; count 0: no moment in common. */
dea_status dea_compare_history(struct dea_context *ctx, const struct dea_curve *curve, int column,
                               const struct dea_clock_shift *clock, const double *time_s,
                               const double *values, size_t count, struct dea_misfit *out);

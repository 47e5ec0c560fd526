/* One clock for two histories. */
#pragma once

#include "result/compare.h"

/* What is to be added to the times of `a` so that its pulses lie on those of `b`. */
struct dea_clock_shift {
  double shift_s;
  size_t edges;        // pulses of a that have one of b of their height there
  double resolution_s; // how well edges are seen: mean time between samples there, of both
};

/* Finds the shift of voltages in time from the rising edges of the first DEA_CLOCK_EDGES_MAX pulses
 * of each: a pulse is what is above 5 % of the largest |V|, its edge where half of its own height
 * is reached, between samples linear. Of the shifts that bring the most edges together it is the
 * smallest, and 0 when it is below the resolution. edges 0: no pulse of the one is of the height of
 * one of the other; shift 0 then. */
enum { DEA_CLOCK_EDGES_MAX = 256 };
void dea_clock_shift_find(const struct dea_samples *a, const struct dea_samples *b,
                          struct dea_clock_shift *out);

/* The complementary energy of a device, and other numbers of it, from samples: least squares of
 * B-splines with values of their slopes (docs/theory/reduced-model.md). */
#pragma once

#include "base/arena.h"
#include "model/model.h"
#include "model/reduced/reduced_core.h"

/* An equilibrium at a force and a voltage. */
struct dea_reduced_sample {
  double voltage_V;
  struct dea_compliance at;
  struct dea_load_point point;
};

/* Of samples [forces][voltages], ascending in both. */
struct dea_reduced_grid {
  const struct dea_reduced_sample *samples;
  size_t forces, voltages;
  bool even; // in the voltage
};

/* Fits Phi to each stride-th force and voltage, with half as many cells as these have steps. out:
 * breaks and coefficients live in memory. Counts have to be odd multiples of the stride, plus 1. */
dea_status dea_reduced_fit_energy(struct dea_arena *memory, const struct dea_reduced_grid *grid,
                                  size_t stride, struct dea_reduced_spline *out);
/* The same of one number of each sample, values [forces][voltages], interpolated. */
dea_status dea_reduced_fit_values(struct dea_arena *memory, const struct dea_reduced_grid *grid,
                                  const double *values, struct dea_reduced_spline *out);
/* Least squares of a polynomial of degree 2 at x [count], c [3]; of fewer points of a lower one. */
dea_status dea_reduced_fit_polynomial(struct dea_context *ctx, const double *x, const double *y,
                                      size_t count, double c[3]);

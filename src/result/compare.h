/* Misfit of two curves, quantity by quantity. */
#pragma once

#include "base/arena.h"
#include "result/columns.h"
#include "result/result.h"

/* One quantity. difference = a - b, all in SI. range: largest minus smallest b at these places (the
 * largest |b| when all are equal); relative values are over it. Arrays [count] in its memory. */
struct dea_misfit {
  int column;                        // of the context
  const struct dea_column *quantity; // that; lent
  size_t count;
  double *at; // voltage [V]; time [s] of a history, place [m] of a profile
  double *a, *b;
  double *a_std, *b_std; // standard uncertainties, NAN where unknown
  struct dea_arena memory;
  double rms, largest, largest_at, bias, range;
  double relative_rms, relative_largest;
  // Of the points whose b_std is known and not 0, against sqrt(a_std^2 + b_std^2), or b_std where
  // a_std is unknown; NAN without any.
  size_t std_count;
  double chi_square; // mean of (difference over that)^2: 1 when all differences are noise
  double within_1_std, within_2_std; // shares of them that differ by no more than that
};

struct dea_comparison {
  struct dea_misfit *misfits; // owned
  size_t misfit_count;
  bool
      part_only; // the interpolated curve turns back in voltage: only its part before that was used
};

/* Compares curve a with curve b at common voltages. Equal lists of voltages are compared point by
 * point (loops too). Otherwise one curve is interpolated by a piecewise cubic that adds no extremes
 * (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 1984), nothing is extrapolated: a at the
 * voltages of b if b was measured, else the one with more points at those of the other.
 * b_std: [b->count] uncertainties of a measured b, else NULL. column: only that quantity, -1 for
 * all. DEA_E_ARGUMENT when there is nothing to compare. out: owned by the caller, NULL on failure.
 */
dea_status dea_compare_curves(struct dea_context *ctx, const struct dea_curve *a,
                              const struct dea_curve *b, const struct dea_load_point *b_std,
                              int column, struct dea_comparison **out);
void dea_comparison_destroy(struct dea_context *ctx, struct dea_comparison *comparison);
/* Keeps the misfits of these columns; returns how many there are. count 0: all stay. */
size_t dea_comparison_keep(struct dea_comparison *comparison, const int *columns, size_t count);

/* A misfit of a column with room for that many points, by hand: add, then summarise. Freed by the
 * caller, also after a failure. */
dea_status dea_misfit_make(struct dea_context *ctx, int column, size_t capacity,
                           struct dea_misfit *out);
/* Adds a point, at most room; not one where a or b is NAN. std: of b, NAN for unknown; of a there
 * is none until it is set. */
void dea_misfit_add(struct dea_misfit *misfit, double at, double a, double b, double std);
/* Fills what follows from the points, of which there is at least one. */
void dea_misfit_summarise(struct dea_misfit *misfit);
void dea_misfit_free(struct dea_misfit *misfit);
/* Root mean square of a_std where it is known; NAN where it is known nowhere. */
double dea_misfit_a_std_rms(const struct dea_misfit *misfit);

/* Value at x of the monotone cubic through (x[i], y[i]), x strictly rising, count >= 1; NAN outside
 * [x[0], x[count-1]]. */
double dea_interpolate(const double *x, const double *y, size_t count, double at);
/* Its slope at point i, of at least two. */
double dea_interpolate_slope(const double *x, const double *y, size_t count, size_t i);

/* Value at `at` of the straight pieces through (x[i], y[i]), x never falling (of two equal ones the
 * later counts); NAN outside. */
double dea_interpolate_linear(const double *x, const double *y, size_t count, double at);

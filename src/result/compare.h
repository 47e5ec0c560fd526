/* Series of computed and measured numbers, and the misfit of one from another. */
#pragma once

#include "base/arena.h"
#include "result/columns.h"
#include "result/result.h"

/* One quantity over an abscissa, all in SI: voltage [V], time [s], or place across the film [m].
 * Arrays [count], lent or of an arena. */
struct dea_samples {
  size_t count;
  double *at, *value; // value: NAN where there is none
  double *std;        // standard uncertainties, NAN where unknown; NULL: none is known
};

/* Over the voltage in the order of the points; over the rising voltage, of the part before the
 * curve turns back; or over the time, which does not fall. */
enum dea_abscissa { DEA_BY_VOLTAGE, DEA_BY_RISING_VOLTAGE, DEA_BY_TIME };

/* The points of a curve that have a number in a column, with its uncertainties where std [count of
 * the curve] is not NULL. */
dea_status dea_samples_of_curve(struct dea_arena *memory, const struct dea_curve *curve,
                                const struct dea_load_point *std, int column, enum dea_abscissa by,
                                struct dea_samples *out);
/* Whether some sample has an uncertainty. */
bool dea_samples_have_std(const struct dea_samples *samples);

/* How a series is read between its samples. */
struct dea_reading {
  bool smooth;   // by the cubic of dea_interpolate; else linear
  double margin; // a place beyond the ends by no more than that is at the end
  double jump;   // places within that of two samples of one place are left out
};

/* One quantity. difference = a - b, all in SI. range: largest minus smallest b at these places (the
 * largest |b| when all are equal); relative values are over it. Arrays [count] of an arena. */
struct dea_misfit {
  int column;                        // of the context
  const struct dea_column *quantity; // that; lent
  size_t count;
  double *at; // voltage [V]; time [s] of a history, place [m] of a profile
  double *a, *b;
  double *a_std, *b_std; // standard uncertainties, NAN where unknown
  double rms, largest, largest_at, bias, range;
  double relative_rms, relative_largest;
  // Of the points whose b_std is known and not 0, against sqrt(a_std^2 + b_std^2), or b_std where
  // a_std is unknown; NAN without any.
  size_t std_count;
  double chi_square; // mean of (difference over that)^2: 1 when all differences are noise
  double within_1_std, within_2_std; // shares of them that differ by no more than that
};

/* a minus b at the places of b; a->at does not fall. Nothing is extrapolated; what the one or the
 * other does not have is left out. count 0: no place in common, and no number follows. */
dea_status dea_misfit_compute(struct dea_arena *memory, int column, const struct dea_samples *a,
                              const struct dea_samples *b, const struct dea_reading *reading,
                              struct dea_misfit *out);
/* Root mean square of a_std where it is known; NAN where it is known nowhere. */
double dea_misfit_a_std_rms(const struct dea_misfit *misfit);

struct dea_comparison {
  struct dea_misfit *misfits; // of an arena
  size_t misfit_count;
  bool
      part_only; // the interpolated curve turns back in voltage: only its part before that was used
};

/* Whether a column is one of these; of none asked for, count 0, each is. */
bool dea_column_is_wanted(int column, const int *columns, size_t count);

/* Compares curve a with curve b at common voltages. Equal lists of voltages are compared point by
 * point (loops too). Otherwise one curve is interpolated by a piecewise cubic that adds no extremes
 * (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 1984), nothing is extrapolated: a at the
 * voltages of b if b was measured, else the one with more points at those of the other.
 * b_std: [b->count] uncertainties of a measured b, else NULL. columns [count]: only those, 0: all
 * that say something. DEA_E_ARGUMENT when there is nothing to compare, of several columns none. */
dea_status dea_compare_curves(struct dea_arena *memory, const struct dea_curve *a,
                              const struct dea_curve *b, const struct dea_load_point *b_std,
                              const int *columns, size_t count, struct dea_comparison *out);

/* Value at x of the monotone cubic through (x[i], y[i]), x strictly rising, count >= 1; NAN outside
 * [x[0], x[count-1]]. */
double dea_interpolate(const double *x, const double *y, size_t count, double at);
/* Its slope at point i, of at least two. */
double dea_interpolate_slope(const double *x, const double *y, size_t count, size_t i);

/* Value at `at` of the straight pieces through (x[i], y[i]), x never falling (of two equal ones the
 * later counts); NAN outside. */
double dea_interpolate_linear(const double *x, const double *y, size_t count, double at);

// One clock for two histories --------------------------------------------------------------------

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

// Profiles across the film beside measured ones --------------------------------------------------

/* Which half of a model's line from the centre to the frame: model 3d has one along a fibre and one
 * halfway between two fibres; a model without a direction has the former only. */
enum dea_half { DEA_HALF_FIBRE, DEA_HALF_BETWEEN, DEA_HALVES };

/* The film as a sensor above it sees it: displacement out of the plane at the places as they moved,
 * on both sides of the centre, each the same. */
struct dea_film_line {
  struct dea_samples samples; // count 0: the model has none, or none that leaves the plane
  bool directed;              // the model tells the two halves apart
  bool between_records;       // formed of two voltages that were computed
};

/* Line of a model of the result at a voltage: of the profile within 0.5 % of it, or linear in the
 * voltage between the first two neighbours that have it between them. */
dea_status dea_film_line_build(struct dea_arena *memory, const struct dea_result *result,
                               const char *model, double voltage_V, enum dea_half half,
                               struct dea_film_line *out);

/* line minus measured at the measured places, on both sides of the centre; those beyond the film
 * are left out. */
dea_status dea_film_line_compare(struct dea_arena *memory, const struct dea_film_line *line,
                                 const struct dea_samples *measured, struct dea_misfit *out);

/* Curves beside a reference: models, simulations and a measurement in one figure and one table, or
 * pairs, each in a figure with its difference. */
#pragma once

#include "base/json.h"
#include "compare/measured.h"
#include "plot/plot.h"
#include "result/compare.h"

enum { DEA_SET_CURVES_MAX = 16 };

/* A model of a run, or a measured table. */
struct dea_set_curve {
  char name[DEA_LABEL_SIZE];         // short, for keys and tables
  const struct dea_result *result;   // lent; NULL: a table
  const char *model;                 // lent; "": a table
  const struct dea_curve *curve;     // against the voltage; lent, NULL: none
  const struct dea_curve *reference; // that it is set against; lent
};

enum dea_set_kind { DEA_SET_VOLTAGE, DEA_SET_PROFILE, DEA_SET_HISTORY };

/* One quantity of a curve beside the reference: against the voltage, across the film, or in time.
 */
struct dea_set_misfit {
  enum dea_set_kind kind;
  size_t curve;    // of the set's curves
  size_t measured; // profile, or column of the history, of what was measured
  enum dea_half half;
  struct dea_film_line line;         // of a profile
  const struct dea_curve *transient; // of a history; lent
  struct dea_clock_shift clock;      // of the transient's times; edges 0: clocks as they are
  struct dea_misfit misfit;
};

/* Reference, measured or reference_result, pairs and the context of the memory are set by the
 * caller, who frees the memory. */
struct dea_compare_set {
  char reference[DEA_LABEL_SIZE];
  bool pairs;                                // each curve has figures of its own
  const struct dea_measured *measured;       // lent; NULL: the reference is a run
  const struct dea_result *reference_result; // lent; NULL: the reference is a measurement
  struct dea_set_curve curves[DEA_SET_CURVES_MAX];
  size_t curve_count;
  struct dea_set_misfit *misfits; // by kind, then by curve or profile
  size_t misfit_count;
  struct dea_arena memory;
};

/* Adds a curve, whose name, and result with model or curve, are set; reference_model: of the
 * reference run, "" for the same or else its first. DEA_E_UNSUPPORTED for one too many,
 * DEA_E_ARGUMENT where the reference has no such model. */
dea_status dea_compare_set_add(struct dea_context *ctx, struct dea_compare_set *set,
                               const struct dea_set_curve *what, const char *reference_model);
/* Computes all misfits of these columns [count], 0: of all. What is left out, and signs that
 * differ, become notes; DEA_E_ARGUMENT when nothing is left or no curve has a quantity that was
 * asked for. */
dea_status dea_compare_set_compute(struct dea_context *ctx, struct dea_compare_set *set,
                                   const int *columns, size_t count);
/* Misfit of a column against the voltage, of a curve; NULL when there is none. Lent. */
const struct dea_misfit *dea_compare_set_find(const struct dea_compare_set *set, size_t curve,
                                              int column);
/* The one against the voltage with the largest relative difference, likewise. */
const struct dea_set_misfit *dea_compare_set_worst(const struct dea_compare_set *set);

/* What was measured of a column in time; value NULL: nothing. */
struct dea_samples dea_measured_history(const struct dea_measured *measured, size_t column);
/* A column of a history's transient on the measured clock. */
dea_status dea_compare_set_transient(const struct dea_set_misfit *history, int column,
                                     struct dea_arena *memory, struct dea_samples *out);

/* DEA_E_ARGUMENT that says which models a result has. name: of the result. */
dea_status dea_compare_no_model(struct dea_context *ctx, const char *name,
                                const struct dea_result *result, const char *model);
/* Name of what a curve is set against: that of the reference, and of a run the model. */
void dea_compare_set_beside(const struct dea_compare_set *set, size_t curve,
                            char out[DEA_LABEL_SIZE]);
/* "along a fibre", "between fibres". */
extern const char *const dea_half_names[DEA_HALVES];

/* Object {schema, tolerance, reference, comparisons: [{a, b, quantities: [misfit]}], profiles: [{a,
 * half, voltage_V, misfit}], histories: [{a, shift_s, edges, misfit}]} with misfit {quantity, unit,
 * points, rms, largest, largest_at_V (_m, _s), bias, range, relative_rms, relative_largest,
 * a_std_rms (of the uncertainties of a), std_points, chi_square_per_point, within_1_std,
 * within_2_std, within}; what is of std only where uncertainties are known, `within` only with a
 * tolerance (NAN: none). NULL when memory is short.
 */
json_t *dea_compare_set_json(const struct dea_compare_set *set, double tolerance);
/* Writes into directory (made if need be) compare_KEY for each quantity: all curves and the
 * reference with a band of one standard deviation; compare_profile at the largest voltage that was
 * measured and computed; compare_history_KEY. Of pairs compare_KEY_MODEL (compare_KEY where there
 * is one pair): both curves, and below their difference, with error bars where the uncertainty is
 * known. Script, data and pictures each. */
dea_status dea_compare_set_draw(struct dea_context *ctx, const struct dea_compare_set *set,
                                const struct dea_plot_format *format, const char *directory);

/* Weighted nonlinear least squares within bounds, and what its residuals say of the parameters.
 *
 * Symbol  meaning                                                             unit
 * p       parameters [n]
 * r       residuals [m], each over its standard uncertainty                   1
 * J       dr/dp [m x n], by columns: J[j * m + i] = dr_i/dp_j
 * chi2    sum of r_i^2                                                        1
 *
 * Derivations: docs/theory/fit.md. */
#pragma once

#include "base/arena.h"

enum { DEA_LSQ_PARAMS_MAX = 24, DEA_FIT_PARAM_NAME = 128 };

/* A parameter. Numbers are those that the search sees: the logarithm of a relaxation time. */
struct dea_fit_param {
  char name[DEA_FIT_PARAM_NAME];    // "c1", "modulus 2", "time 2"
  const char *unit;                 // of the value: "Pa", "1", "s"
  bool fixed, logarithmic, started; // started: the file says where the search begins
  bool locks;       // the tests reach where the chains would be fully stretched at `low`
  double start;     // where the search begins
  double low, high; // bounds, infinite for none
  double scale;     // > 0, a change that matters; steps of derivatives are a share of it
  double limit;     // of a coefficient of either sign: beyond it, it could only cancel another one
  double prior, prior_std; // NAN: none
};

struct dea_lsq_problem {
  size_t rows, params;
  const struct dea_fit_param *param; // [params] of which bounds, scale and `fixed` count
  double step;                       // share of the scale that derivatives step; 0: 1e-3
  bool second_order;                 // derivatives by two evaluations in place of four
  double tolerance; // relative, of chi2 and parameters at the end; 0: as far as numbers go
  /* DEA_E_DOMAIN where the model has no answer; any other failure ends the work. */
  dea_status (*residual)(void *user, const double *p, double *r);
  void *user;
};

struct dea_lsq_fit {
  size_t rows, params;
  double p[DEA_LSQ_PARAMS_MAX];
  double *r;                         // [rows] at p; NULL: of a fit that was not made
  double *J;                         // [rows x params] at p, also of parameters that are held
  bool held[DEA_LSQ_PARAMS_MAX];     // fixed by the caller
  bool at_bound[DEA_LSQ_PARAMS_MAX]; // and chi2 would fall beyond it
  double chi2;                       // sum of squares of r
  struct dea_arena memory;
};

/* Derivatives by central differences of fourth order: exact but for rounding (about 1e-13 of the
 * values) where the model is linear in p, as all laws are in their moduli; else with an error of
 * about 1e-12 (step / scale)^4; of second order 1e-6. Where the model ends within the step, a
 * shorter one. */
dea_status dea_lsq_jacobian(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                            const double *p, double *J);

/* Levenberg and Marquardt (cminpack) with an active set: a parameter that would leave its bounds
 * stays at the bound as long as chi2 falls beyond it. start: [params]; held: [params] those that
 * keep their start, NULL: what is fixed. DEA_E_ARGUMENT with fewer rows than free parameters or too
 * many parameters, DEA_E_DOMAIN when the model has no answer at the start, DEA_E_NOT_CONVERGED.
 * out: empty on failure. */
dea_status dea_lsq_solve(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                         const double *start, const bool *held, struct dea_lsq_fit *out);
void dea_lsq_free(struct dea_lsq_fit *fit);

// Statistics --------------------------------------------------------------------------------------

/* Rows in the order in which they were measured: those of one test. What is in no group (priors) is
 * taken as independent. */
struct dea_lsq_group {
  size_t first, count;
};

struct dea_lsq_statistics {
  size_t params, active; // active: neither held nor at a bound
  double *std;         // [params] standard uncertainty; NAN of what is not active, INFINITY of what
                       // the rows do not determine
  double *naive_std;   // [params] the same for independent residuals, not widened
  double *covariance;  // [params x params], 0 of what is not active
  double *correlation; // [params x params]
  /* Of J with columns of length 1, over the active parameters: singular values [active], falling,
   * and unit changes of the parameters that they belong to [active x params] (row k: change of p
   * along which the residuals move by singular[k], the columns' lengths taken off). */
  double *singular, *direction;
  double condition;      // largest over smallest singular value
  double *lag;           // [groups] correlation of neighbours, 0 where none is seen
  double *effective;     // [groups] rows that independent ones would be
  double effective_rows; // of all groups
  double reduced_chi2;   // chi2 over what is expected of it with these correlations; of the groups
                         // alone where the scale is to be found
  double variance;       // factor on the covariance: 1, or reduced_chi2 where `widened`
  bool widened;          // the residuals are larger than their uncertainties explain
  struct dea_arena memory;
};

/* What the rows say of the parameters. scale_known: the uncertainties behind the rows are real;
 * the covariance is then widened only where chi2 lies beyond its 97.7 % range. Else it is scaled by
 * the residuals. out: freed by the caller after success. */
dea_status dea_lsq_statistics_find(struct dea_context *ctx, const struct dea_lsq_fit *fit,
                                   const struct dea_lsq_group *groups, size_t group_count,
                                   bool scale_known, struct dea_lsq_statistics *out);
/* Whether the rows do not determine the direction of that number. */
bool dea_lsq_is_open(const struct dea_lsq_statistics *statistics, size_t k);
/* Standard uncertainty of a number with these slopes [params] by the parameters. INFINITY where it
 * moves along a direction that the rows do not determine, or where nothing is known of any. */
double dea_lsq_std_of(const struct dea_lsq_statistics *statistics, const double *slope);
void dea_lsq_statistics_free(struct dea_lsq_statistics *statistics);

/* sqrt of the growth of chi2 over `unit`, less 1, with p_j at `value` and all others fitted anew;
 * NAN where the model has no answer. from: [params] where they begin, moved along. */
dea_status dea_lsq_growth(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                          const struct dea_lsq_fit *fit, size_t j, double value, double unit,
                          double *from, double *out);
/* Profile likelihood: the lower and the upper value of parameter j at which chi2, with all others
 * fitted anew, has grown by `unit` (1: 68.3 %). step: a first guess of the half width. A side that
 * reaches its bound, or where chi2 does not grow so far, is open: +-INFINITY. */
dea_status dea_lsq_profile(struct dea_context *ctx, const struct dea_lsq_problem *problem,
                           const struct dea_lsq_fit *fit, size_t j, double unit, double step,
                           double out[2]);

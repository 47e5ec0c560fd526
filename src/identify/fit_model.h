/* A law with branches as a problem of least squares: parameters, residuals over the tests, a start.
 */
#pragma once

#include "identify/fit_core.h"
#include "identify/fit_file.h"

// J. D. Ferry's constants of many polymers, from which a search begins
#define DEA_FIT_WLF_C1 8.86
#define DEA_FIT_WLF_C2_K 101.6

/* What a fit file says of a parameter, over what stands in it already (unit, limits, scale). Errors
 * are findings at the text's places. */
dea_status dea_fit_param_read(struct dea_context *ctx, const struct dea_fit_parameter_text *text,
                              struct dea_fit_param *param);

/* The first law_count parameters are the law's, in its order; then modulus and time of each branch;
 * then c1 and c2 of the shift, where there is one. */
struct dea_fit_model {
  const struct dea_law *law;
  struct dea_fit_param params[DEA_LSQ_PARAMS_MAX];
  size_t count, law_count, branch_count;
  const struct dea_fit_file *file; // lent
  double reference_K, coldest_K;   // of a shift, NAN: none; of the fitted tests
};

/* The tests that are fitted, all or but a part of one. */
struct dea_fit_rows {
  const struct dea_fit_series *series; // [count]
  size_t count;
  size_t without, from, to; // rows from..to - 1 of series `without` are left out
  double std_Pa;            // of rows without an uncertainty of their own
};

/* Model of that name ("yeoh", "ogden-2": the parameters whose keys end in 1 and 2) with what the
 * file says of its parameters. Errors are findings, DEA_E_DESIGN then. */
dea_status dea_fit_model_create(struct dea_context *ctx, const struct dea_fit_file *file,
                                const struct dea_label *name, const struct dea_fit_series *series,
                                size_t series_count, struct dea_fit_model *out);
/* Adds branches between two times; times_s: fixed ones, NULL: free. */
void dea_fit_model_branches(struct dea_fit_model *model, size_t count, double from_s, double to_s,
                            const struct dea_quantity *times);
/* Free parameters. */
size_t dea_fit_model_free(const struct dea_fit_model *model);
/* The material at p, as it is in a test; NULL: at the reference temperature. */
void dea_fit_model_material(const struct dea_fit_model *model, const double *p,
                            const struct dea_fit_test *test, struct dea_material *out);
/* Whether a series counts as fitted: its test is for that. */
bool dea_fit_series_used(const struct dea_fit_series *series);

/* Finds the minimum: moduli by linear least squares over a grid of the other parameters, on few
 * rows; from the best of them with a shear modulus at rest above 0 by variable projection (G. H.
 * Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413-432), and then over all rows. */
dea_status dea_fit_model_solve(struct dea_context *ctx, const struct dea_fit_model *model,
                               const struct dea_fit_rows *rows, struct dea_lsq_fit *out);
/* The problem that the above solves; memory of the arena, which has to outlive it. */
dea_status dea_fit_model_problem(struct dea_arena *arena, const struct dea_fit_model *model,
                                 const struct dea_fit_rows *rows, struct dea_lsq_problem *out);
/* Stresses of one series as "residuals", for their derivatives by the parameters. */
dea_status dea_fit_model_stress(struct dea_arena *arena, const struct dea_fit_model *model,
                                const struct dea_fit_series *series, struct dea_lsq_problem *out);

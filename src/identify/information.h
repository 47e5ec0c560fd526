/* What measurements hold of the parameters of a fit: J'J over those that are free, each in units
 * that give its own column the length 1. For D-optimality: which measurement would add most. */
#pragma once

#include "identify/least_squares.h"

struct dea_information {
  size_t active[DEA_LSQ_PARAMS_MAX], count; // neither held nor at a bound
  double length[DEA_LSQ_PARAMS_MAX];
  double A[DEA_LSQ_PARAMS_MAX * DEA_LSQ_PARAMS_MAX]; // [count x count]
};

/* That of a fit whose residuals have the variance that its statistics say. scale: [params], taken
 * where the rows do not notice a parameter. What nothing is known of stays a finite number. */
void dea_information_start(const struct dea_lsq_fit *fit, double variance, const double *scale,
                           struct dea_information *out);
/* Adds rows; J: [rows x params] by columns, over the rows' uncertainties; all times `weight`. */
void dea_information_add(struct dea_information *to, const double *J, size_t rows, double weight);
/* ln det A, and the diagonal of its inverse [count]. */
double dea_information_factor(const struct dea_information *of, double *variance);

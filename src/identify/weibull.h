/* Weibull's distribution of breakdown fields by maximum likelihood, with films that survived.
 *
 * Symbol  meaning                                                             unit
 * E       true field at breakdown, or the largest that was survived           V/m
 * s, h    mean in-plane stretch, thickness as it then was                     1, m
 * A       unstretched area                                                    m^2
 * E_0     field at which 63.2 % of films of area A_0, thickness h_0 at s = 1 have broken
 * n, p    powers of s and h/h_0
 * b       shape
 *
 *   1 - P = exp(-(A/A_0) (E / (E_0 s^n (h/h_0)^p))^b)          (docs/theory/breakdown.md, eqs 1, 2)
 *
 * With z = b ln E - b ln E_0 - b n ln s - b p ln(h/h_0) + ln(A/A_0) the logarithm of the
 * likelihood, sum over those that broke of (ln b + z) minus sum over all of exp z, is concave in b,
 * b ln E_0, b n, b p: Newton's method with shorter steps finds its one maximum. Derivation:
 * docs/theory/fit.md. A life takes the place of the field where specimens are cycled
 * (life_fit.h), all alike: n, p held at 0.
 */
#pragma once

#include "base/context.h"

enum dea_weibull_param {
  DEA_WEIBULL_FIELD,     // E_0
  DEA_WEIBULL_SHAPE,     // b
  DEA_WEIBULL_STRETCH,   // n
  DEA_WEIBULL_THICKNESS, // p
  DEA_WEIBULL_PARAMS
};

struct dea_weibull_data {
  size_t rows;
  const double *field_V_per_m;                   // [rows] > 0
  const double *stretch, *thickness_m, *area_m2; // the same; NULL: all alike
  const bool *survived;                          // [rows]
  double thickness0_m, area0_m2;                 // h_0, A_0
  bool held[DEA_WEIBULL_PARAMS]; // kept at `given`: neither E_0 nor the shape can be
  double given[DEA_WEIBULL_PARAMS];
};

struct dea_weibull_fit {
  double value[DEA_WEIBULL_PARAMS];
  double std[DEA_WEIBULL_PARAMS]; // by the curvature at the maximum; NAN of what is held
  double low[DEA_WEIBULL_PARAMS], high[DEA_WEIBULL_PARAMS]; // 68.3 % by the profile; NAN as above
  double low_95, high_95;                                   // of E_0, by the profile
  double covariance[DEA_WEIBULL_PARAMS]
                   [DEA_WEIBULL_PARAMS]; // of ln E_0, b, n, p; 0 of what is held
  double log_likelihood;
  size_t broken; // rows that broke
};

/* DEA_E_ARGUMENT where too few rows broke (fewer than parameters that are not held, or than two of
 * different field), or where the rows do not tell the parameters apart. */
dea_status dea_weibull_solve(struct dea_context *ctx, const struct dea_weibull_data *data,
                             struct dea_weibull_fit *out);

/* z of a field on the reference film (s = 1, h_0, A_0), and its standard uncertainty; the chance is
 * 1 - exp(-exp z). */
double dea_weibull_z(const struct dea_weibull_fit *fit, double field_V_per_m, double *std);

/* Field by which that share of reference films breaks, and the standard uncertainty of its
 * logarithm. */
double dea_weibull_quantile(const struct dea_weibull_fit *fit, double share, double *log_std);

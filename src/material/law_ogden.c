/* Ogden law with up to three terms, in the principal stretches:
 * W = sum_p (mu_p/alpha_p) (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3);
 * shear modulus sum_p mu_p alpha_p / 2. A term whose alpha is 0 is absent: its limit
 * mu ln(l1 l2 l3) does no work in an incompressible material.
 *
 * symbol   meaning                           unit
 * mu_p     coefficient, of alpha_p's sign    Pa
 * alpha_p  exponent                          1 */
#include "material/law.h"

enum { TERM_COUNT = 3, PARAM_COUNT = 2 * TERM_COUNT };

static const struct dea_law_param params[PARAM_COUNT] = {
    {"mu1", "Pa", -1e12, 1e12, true, "coefficient of the first term; sum of mu alpha > 0"},
    {"alpha1", "1", -100.0, 100.0, true, "exponent of the first term"},
    {"mu2", "Pa", -1e12, 1e12, false, "coefficient of the second term"},
    {"alpha2", "1", -100.0, 100.0, false, "exponent of the second term"},
    {"mu3", "Pa", -1e12, 1e12, false, "coefficient of the third term"},
    {"alpha3", "1", -100.0, 100.0, false, "exponent of the third term"},
};

static dea_status principal(const double *p, dea_scalar lambda, dea_scalar *w, dea_scalar *w1,
                            dea_scalar *w2)
{
  if (!(DEA_RE(lambda) > 0.0)) {
    return DEA_E_DOMAIN;
  }
  const dea_scalar inverse = 1.0 / lambda;
  dea_scalar sum = 0.0, sum1 = 0.0, sum2 = 0.0;
  for (int i = 0; i < TERM_COUNT; i++) {
    const double mu = p[2 * i], alpha = p[2 * i + 1];
    if (mu == 0.0 || alpha == 0.0) {
      continue;
    }
    const dea_scalar power = pow(lambda, alpha);
    sum += mu / alpha * (power - 1.0);
    sum1 += mu * power;
    sum2 += mu * (alpha - 1.0) * power;
  }
  *w = sum;
  *w1 = sum1 * inverse;
  *w2 = sum2 * inverse * inverse;
  return DEA_OK;
}

static double shear_modulus(const double *p)
{
  double sum = 0.0;
  for (int i = 0; i < TERM_COUNT; i++) {
    sum += 0.5 * p[2 * i] * p[2 * i + 1];
  }
  return sum;
}

const struct dea_law DEA_NAME(dea_law_ogden) = {
    .name = "ogden",
    .long_name = "Ogden, one to three powers of the principal stretches",
    .source = "R. W. Ogden, Proc. R. Soc. A 326 (1972) 565-584",
    .param_count = PARAM_COUNT,
    .params = params,
    .principal = principal,
    .shear_modulus = shear_modulus,
};

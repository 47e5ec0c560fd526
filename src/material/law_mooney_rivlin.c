/* Mooney-Rivlin law: W = c10 (I1 - 3) + c01 (I2 - 3); shear modulus 2 (c10 + c01).
 *
 * symbol  meaning                            unit
 * c10     coefficient of I1 - 3              Pa
 * c01     coefficient of I2 - 3              Pa */
#include "material/law.h"

enum { C10, C01, PARAM_COUNT };

static const struct dea_law_param params[PARAM_COUNT] = {
    [C10] = {"c10", "Pa", -1e12, 1e12, true, "coefficient of I1 - 3; c10 + c01 > 0"},
    [C01] = {"c01", "Pa", -1e12, 1e12, true, "coefficient of I2 - 3; c10 + c01 > 0"},
};

static dea_status invariants(const double *p, dea_scalar I1, dea_scalar I2, dea_scalar I4,
                             struct dea_law_energy *e)
{
  (void)I4;
  *e = (struct dea_law_energy){
      .W = p[C10] * (I1 - 3.0) + p[C01] * (I2 - 3.0), .W1 = p[C10], .W2 = p[C01]};
  return DEA_OK;
}

static double shear_modulus(const double *p)
{
  return 2.0 * (p[C10] + p[C01]);
}

const struct dea_law DEA_NAME(dea_law_mooney_rivlin) = {
    .name = "mooney-rivlin",
    .long_name = "Mooney-Rivlin, first order in I1 - 3 and I2 - 3",
    .source = "M. Mooney, J. Appl. Phys. 11 (1940) 582-592; "
              "R. S. Rivlin, Phil. Trans. R. Soc. A 241 (1948) 379-397",
    .param_count = PARAM_COUNT,
    .params = params,
    .invariants = invariants,
    .shear_modulus = shear_modulus,
};

/* Yeoh law (paper eq 10, summed from i = 1): W = c1 x + c2 x^2 + c3 x^3 with x = I1 - 3; shear
 * modulus 2 c1.
 *
 * symbol      meaning                        unit
 * c1, c2, c3  C10, C20, C30 of the paper     Pa */
#include "material/law.h"

enum { C1, C2, C3, PARAM_COUNT };

static const struct dea_law_param params[PARAM_COUNT] = {
    [C1] = {"c1", "Pa", 0.5, 1e12, true, "coefficient of I1 - 3, half the shear modulus"},
    [C2] = {"c2", "Pa", -1e12, 1e12, true, "coefficient of (I1 - 3)^2"},
    [C3] = {"c3", "Pa", -1e12, 1e12, true, "coefficient of (I1 - 3)^3"},
};

static dea_status invariants(const double *p, dea_scalar I1, dea_scalar I2, dea_scalar I4,
                             struct dea_law_energy *e)
{
  (void)I2;
  (void)I4;
  const dea_scalar x = I1 - 3.0;
  *e = (struct dea_law_energy){
      .W = x * (p[C1] + x * (p[C2] + x * p[C3])), // paper eq 10
      .W1 = p[C1] + x * (2.0 * p[C2] + x * 3.0 * p[C3]),
      .W11 = 2.0 * p[C2] + x * 6.0 * p[C3],
  };
  return DEA_OK;
}

static double shear_modulus(const double *p)
{
  return 2.0 * p[C1];
}

const struct dea_law DEA_NAME(dea_law_yeoh) = {
    .name = "yeoh",
    .long_name = "Yeoh, third order in I1 - 3",
    .source = "O. H. Yeoh, Rubber Chem. Technol. 66 (1993) 754-771",
    .param_count = PARAM_COUNT,
    .params = params,
    .invariants = invariants,
    .shear_modulus = shear_modulus,
};

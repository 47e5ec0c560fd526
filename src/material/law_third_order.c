/* Third-order deformation law (James, Green and Simpson):
 * W = c10 x + c01 y + c11 x y + c20 x^2 + c30 x^3 with x = I1 - 3, y = I2 - 3; shear modulus
 * 2 (c10 + c01).
 *
 * symbol                    meaning                        unit
 * c10, c01, c11, c20, c30   coefficients                   Pa */
#include "material/law.h"

enum { C10, C01, C11, C20, C30, PARAM_COUNT };

static const struct dea_law_param params[PARAM_COUNT] = {
    [C10] = {"c10", "Pa", -1e12, 1e12, true, "coefficient of I1 - 3; c10 + c01 > 0"},
    [C01] = {"c01", "Pa", -1e12, 1e12, true, "coefficient of I2 - 3; c10 + c01 > 0"},
    [C11] = {"c11", "Pa", -1e12, 1e12, true, "coefficient of (I1 - 3) (I2 - 3)"},
    [C20] = {"c20", "Pa", -1e12, 1e12, true, "coefficient of (I1 - 3)^2"},
    [C30] = {"c30", "Pa", -1e12, 1e12, true, "coefficient of (I1 - 3)^3"},
};

static dea_status invariants(const double *p, dea_scalar I1, dea_scalar I2, dea_scalar I4,
                             struct dea_law_energy *e)
{
  (void)I4;
  const dea_scalar x = I1 - 3.0, y = I2 - 3.0;
  *e = (struct dea_law_energy){
      .W = x * (p[C10] + p[C11] * y + x * (p[C20] + x * p[C30])) + p[C01] * y,
      .W1 = p[C10] + p[C11] * y + x * (2.0 * p[C20] + x * 3.0 * p[C30]),
      .W2 = p[C01] + p[C11] * x,
      .W11 = 2.0 * p[C20] + x * 6.0 * p[C30],
      .W12 = p[C11],
  };
  return DEA_OK;
}

static double shear_modulus(const double *p)
{
  return 2.0 * (p[C10] + p[C01]);
}

const struct dea_law DEA_NAME(dea_law_third_order) = {
    .name = "third-order",
    .long_name = "third-order deformation: polynomial in I1 - 3 and I2 - 3",
    .source = "A. G. James, A. Green, G. M. Simpson, J. Appl. Polym. Sci. 19 (1975) 2033-2058",
    .param_count = PARAM_COUNT,
    .params = params,
    .invariants = invariants,
    .shear_modulus = shear_modulus,
};

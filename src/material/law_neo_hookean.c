/* Neo-Hookean law: W = mu/2 (I1 - 3).
 *
 * symbol  meaning                            unit
 * mu      shear modulus                      Pa */
#include "material/law.h"

enum { MU, PARAM_COUNT };

static const struct dea_law_param params[PARAM_COUNT] = {
    [MU] = {"mu", "Pa", 1.0, 1e12, true, "shear modulus"},
};

static dea_status invariants(const double *p, dea_scalar I1, dea_scalar I2, dea_scalar I4,
                             struct dea_law_energy *e)
{
  (void)I2;
  (void)I4;
  *e = (struct dea_law_energy){.W = 0.5 * p[MU] * (I1 - 3.0), .W1 = 0.5 * p[MU]};
  return DEA_OK;
}

static double shear_modulus(const double *p)
{
  return p[MU];
}

const struct dea_law DEA_NAME(dea_law_neo_hookean) = {
    .name = "neo-hookean",
    .long_name = "neo-Hookean, first order in I1 - 3",
    .source = "L. R. G. Treloar, Trans. Faraday Soc. 39 (1943) 241-246",
    .param_count = PARAM_COUNT,
    .params = params,
    .invariants = invariants,
    .shear_modulus = shear_modulus,
};

/* Gent law: W = -(mu Jm/2) ln(1 - x), x = (I1 - 3)/Jm, for x < 1; it locks up at x = 1.
 *
 * symbol  meaning                            unit
 * mu      shear modulus                      Pa
 * Jm      I1 - 3 at lock-up                  1 */
#include "material/law.h"

enum { MU, JM, PARAM_COUNT };

static const struct dea_law_param params[PARAM_COUNT] = {
    [MU] = {"mu", "Pa", 1.0, 1e12, true, "shear modulus"},
    [JM] = {"jm", "1", 1e-3, 1e9, true, "value of I1 - 3 at which the chains are fully stretched"},
};

static dea_status invariants(const double *p, dea_scalar I1, dea_scalar I2, dea_scalar I4,
                             struct dea_law_energy *e)
{
  (void)I2;
  (void)I4;
  const double mu = p[MU], Jm = p[JM];
  const dea_scalar x = (I1 - 3.0) / Jm;
  if (!(DEA_RE(x) < 1.0)) { // also when it is not a number
    return DEA_E_DOMAIN;
  }
  // -ln(1 - x) = 2 artanh(x/(2 - x)) keeps its digits near x = 0, where 1 - x does not.
  const dea_scalar g = 1.0 / (1.0 - x);
  *e = (struct dea_law_energy){
      .W = mu * Jm * atanh(x / (2.0 - x)),
      .W1 = 0.5 * mu * g,
      .W11 = 0.5 * mu * g * g / Jm,
  };
  return DEA_OK;
}

static double shear_modulus(const double *p)
{
  return p[MU];
}

static double locking_share(const double *p, double I1)
{
  return (I1 - 3.0) / p[JM];
}

const struct dea_law DEA_NAME(dea_law_gent) = {
    .name = "gent",
    .long_name = "Gent, limited chain extensibility",
    .source = "A. N. Gent, Rubber Chem. Technol. 69 (1996) 59-61",
    .param_count = PARAM_COUNT,
    .params = params,
    .invariants = invariants,
    .shear_modulus = shear_modulus,
    .locking_share = locking_share,
};

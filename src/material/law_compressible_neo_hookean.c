/* Compressible neo-Hookean solid: W = mu/2 (I1 - 3 - 2 ln J) + lambda/2 ln^2 J.
 *
 * symbol   meaning                            unit
 * E, nu    Young's modulus, Poisson's ratio   Pa, 1
 * mu       E/(2 (1 + nu))                     Pa
 * lambda   E nu/((1 + nu) (1 - 2 nu))         Pa */
#include "material/law.h"

enum { YOUNG_MODULUS, POISSON_RATIO, PARAM_COUNT };

static const struct dea_law_param params[PARAM_COUNT] = {
    [YOUNG_MODULUS] = {"young_modulus", "Pa", 1.0, 1e15, true, "Young's modulus"},
    [POISSON_RATIO] = {"poisson_ratio", "1", -0.99, 0.499, true, "Poisson's ratio"},
};

static double shear_modulus(const double *p)
{
  return p[YOUNG_MODULUS] / (2.0 * (1.0 + p[POISSON_RATIO]));
}

static dea_status compressible(const double *p, dea_scalar i1, dea_scalar j,
                               struct dea_law_volume *e)
{
  const double E = p[YOUNG_MODULUS], nu = p[POISSON_RATIO];
  const double mu = shear_modulus(p), lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  const dea_scalar J = 1.0 + j;
  // ln(1 + j) = 2 artanh(j/(2 + j)) keeps its digits near j = 0, where 1 + j does not.
  const dea_scalar l = 2.0 * atanh(j / (2.0 + j));
  *e = (struct dea_law_volume){
      .W = mu * (0.5 * i1 - l) + 0.5 * lambda * l * l,
      .W1 = 0.5 * mu,
      .WJ = (lambda * l - mu) / J,
      .WJJ = (lambda * (1.0 - l) + mu) / (J * J),
  };
  return DEA_OK;
}

const struct dea_law DEA_NAME(dea_law_compressible_neo_hookean) = {
    .name = "compressible-neo-hookean",
    .long_name = "neo-Hookean with a logarithm of the volume",
    .source = "J. C. Simo, K. S. Pister, Comput. Methods Appl. Mech. Eng. 46 (1984) 201-215",
    .param_count = PARAM_COUNT,
    .params = params,
    .compressible = compressible,
    .shear_modulus = shear_modulus,
};

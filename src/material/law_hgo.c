/* Holzapfel-Gasser-Ogden law with one family of fibres in a neo-Hookean matrix:
 * W = mu/2 (I1 - 3) + k1/(2 k2) (exp(k2 E^2) - 1),  E = kappa (I1 - 3) + (1 - 3 kappa) (I4 - 1).
 * Fibres carry tension only: their part is 0 for E <= 0. At k2 = 0 it is k1/2 E^2, for kappa = 0
 * the standard reinforcing model.
 *
 * symbol  meaning                                              unit
 * mu      shear modulus of the matrix                          Pa
 * k1      stiffness of the fibre family                        Pa
 * k2      its stiffening, 0 for none                           1
 * kappa   dispersion: 0 all along a0, 1/3 in all directions    1
 * E       strain of the fibres                                 1 */
#include "material/law.h"

enum { MU, K1, K2, KAPPA, PARAM_COUNT };

static const struct dea_law_param params[PARAM_COUNT] = {
    [MU] = {"mu", "Pa", 1.0, 1e12, true, "shear modulus of the matrix"},
    [K1] = {"k1", "Pa", 0.0, 1e12, true, "stiffness of the fibre family"},
    [K2] = {"k2", "1", 0.0, 1e6, false, "exponential stiffening of the fibres, 0 for none"},
    [KAPPA] = {"kappa", "1", 0.0, 1.0 / 3.0, false,
               "dispersion of the fibres, 0 aligned, 1/3 none"},
};

/* exp(q) leaves the range of double shortly above. */
static const double exponent_max = 700.0;

static dea_status invariants(const double *p, dea_scalar I1, dea_scalar I2, dea_scalar I4,
                             struct dea_law_energy *e)
{
  (void)I2;
  const double mu = p[MU], k1 = p[K1], k2 = p[K2];
  const double a = p[KAPPA], b = 1.0 - 3.0 * p[KAPPA]; // dE/dI1, dE/dI4
  const dea_scalar E = a * (I1 - 3.0) + b * (I4 - 1.0);
  *e = (struct dea_law_energy){.W = 0.5 * mu * (I1 - 3.0), .W1 = 0.5 * mu};
  if (DEA_RE(E) <= 0.0) {
    return DEA_OK;
  }
  const dea_scalar q = k2 * E * E;
  if (!(DEA_RE(q) < exponent_max)) { // also when it is not a number
    return DEA_E_DOMAIN;
  }
  // (exp(q) - 1)/q as exp(q/2) sinh(q/2)/(q/2): no digits lost, and 1 at q = 0.
  const dea_scalar half = exp(0.5 * q),
                   ratio = DEA_RE(q) > 0.0 ? half * sinh(0.5 * q) / (0.5 * q) : 1.0;
  const dea_scalar first = k1 * E * half * half, second = k1 * half * half * (1.0 + 2.0 * q);
  e->W += 0.5 * k1 * E * E * ratio;
  e->W1 += a * first;
  e->W4 = b * first;
  e->W11 = a * a * second;
  e->W14 = a * b * second;
  e->W44 = b * b * second;
  return DEA_OK;
}

static double shear_modulus(const double *p)
{
  return p[MU];
}

const struct dea_law DEA_NAME(dea_law_hgo) = {
    .name = "holzapfel-gasser-ogden",
    .long_name = "Holzapfel-Gasser-Ogden, neo-Hookean with one family of fibres",
    .source = "T. C. Gasser, R. W. Ogden, G. A. Holzapfel, J. R. Soc. Interface 3 (2006) 15-35",
    .param_count = PARAM_COUNT,
    .params = params,
    .anisotropic = true,
    .invariants = invariants,
    .shear_modulus = shear_modulus,
};

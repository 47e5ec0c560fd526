/* Arruda-Boyce law (eight chains), the inverse Langevin function expanded to five terms:
 * W = mu sum_i C_i / lm^(2i-2) (I1^i - 3^i), C = 1/2, 1/20, 11/1050, 19/7000, 519/673750.
 *
 * The parameter mu (n k T of the chains) is not the shear modulus of the ground state, which is
 * 2 W1 = mu (1 + 3/(5 lm^2) + 99/(175 lm^4) + 513/(875 lm^6) + 42039/(67375 lm^8)).
 *
 * symbol  meaning                            unit
 * mu      modulus of the chains              Pa
 * lm      locking stretch of a chain         1 */
#include "material/law.h"

enum { MU, LAMBDA_M, PARAM_COUNT };
enum { TERM_COUNT = 5 };

static const double series[TERM_COUNT] = {1.0 / 2.0, 1.0 / 20.0, 11.0 / 1050.0, 19.0 / 7000.0,
                                          519.0 / 673750.0};

static const struct dea_law_param params[PARAM_COUNT] = {
    [MU] = {"mu", "Pa", 1.0, 1e12, true, "modulus of the chains (below the shear modulus)"},
    [LAMBDA_M] = {"lambda_m", "1", 1.0, 1e6, true, "stretch at which a chain is fully extended"},
};

static dea_status invariants(const double *p, dea_scalar I1, dea_scalar I2, dea_scalar I4,
                             struct dea_law_energy *e)
{
  (void)I2;
  (void)I4;
  const double y = 1.0 / (p[LAMBDA_M] * p[LAMBDA_M]);
  dea_scalar W = 0.0, W1 = 0.0, W11 = 0.0;
  // Horner's scheme in I1, from the last term down; the constant is that of I1 = 3.
  double W_rest = 0.0;
  for (int i = TERM_COUNT; i >= 1; i--) {
    const double c = series[i - 1];
    W11 = i >= 2 ? W11 * y * I1 + i * (i - 1) * c * y : W11;
    W1 = W1 * y * I1 + i * c;
    W = W * y * I1 + c;
    W_rest = W_rest * y * 3.0 + c;
  }
  *e = (struct dea_law_energy){
      .W = p[MU] * (W * I1 - W_rest * 3.0), .W1 = p[MU] * W1, .W11 = p[MU] * W11};
  return DEA_OK;
}

static double shear_modulus(const double *p)
{
  const double y = 1.0 / (p[LAMBDA_M] * p[LAMBDA_M]);
  double W1 = 0.0;
  for (int i = TERM_COUNT; i >= 1; i--) {
    W1 = W1 * y * 3.0 + i * series[i - 1];
  }
  return 2.0 * p[MU] * W1;
}

/* Stretch of the eight chains over theirs: the five terms go on beyond it, the chains do not. */
static double locking_share(const double *p, double I1)
{
  return sqrt(I1 / 3.0) / p[LAMBDA_M];
}

const struct dea_law DEA_NAME(dea_law_arruda_boyce) = {
    .name = "arruda-boyce",
    .long_name = "Arruda-Boyce eight-chain, five terms",
    .source = "E. M. Arruda, M. C. Boyce, J. Mech. Phys. Solids 41 (1993) 389-412",
    .param_count = PARAM_COUNT,
    .params = params,
    .invariants = invariants,
    .shear_modulus = shear_modulus,
    .locking_share = locking_share,
};

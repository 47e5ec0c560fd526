/* Hyperelastic laws: an energy density per unstretched volume and its derivatives, nothing else.
 *
 * A law is one file, law_<name>.c, that defines one `const struct dea_law`, and one line in
 * law_list.h. It knows neither elements nor solvers. Three forms:
 *
 *   invariants  : W(I1, I2, I4), with I1 = tr C, I2 = (tr^2 C - tr C^2)/2, I4 = a0 . C a0
 *   principal   : W = sum over the three principal stretches of w(lambda)     (Valanis and Landel)
 *   compressible: W(I1, J), J the volume ratio
 *
 * Conventions: W = 0 in the unstretched state. The incompressibility constraint of the first two is
 * the caller's, so their stress is free up to a pressure; the third resists a change of volume
 * itself and has no stress in the unstretched state. */
#pragma once

#include "base/status.h"
#include "material/scalar.h"

#include <stdbool.h>
#include <stddef.h>

enum { DEA_LAW_PARAM_MAX = 8 };

/* One parameter: key in the design file, unit as udunits2 reads it, admissible range (inclusive).
 */
struct dea_law_param {
  const char *key;
  const char *unit; // "Pa", "1", "radian"
  double min, max;
  bool required; // an optional one is 0 when it is not given
  const char *meaning;
};

/* Energy [Pa] and derivatives by the invariants [Pa]; what a law does not use stays 0. */
struct dea_law_energy {
  dea_scalar W;
  dea_scalar W1, W2, W4;
  dea_scalar W11, W12, W22, W14, W24, W44;
};

/* The same of a compressible law, by I1 and J. */
struct dea_law_volume {
  dea_scalar W;
  dea_scalar W1, WJ;
  dea_scalar W11, W1J, WJJ;
};

struct dea_law {
  const char *name;      // in design files: "yeoh"
  const char *long_name; // "Yeoh (1993), third order in I1 - 3"
  const char *source;    // where the law was published
  size_t param_count;
  const struct dea_law_param *params; // [param_count]
  bool anisotropic;                   // uses I4
  /* Invariant form, or NULL. p: [param_count] SI. Adds nothing: every member of *e is set.
   * DEA_E_DOMAIN beyond the law's domain (Gent past lock-up); *e is then unspecified. */
  dea_status (*invariants)(const double *p, dea_scalar I1, dea_scalar I2, dea_scalar I4,
                           struct dea_law_energy *e);
  /* Principal form, or NULL: w [Pa], dw/dlambda, d2w/dlambda2 at one stretch. */
  dea_status (*principal)(const double *p, dea_scalar lambda, dea_scalar *w, dea_scalar *w1,
                          dea_scalar *w2);
  /* Compressible form, or NULL. By I1 - 3 and J - 1 > -1, whose digits small strains need. */
  dea_status (*compressible)(const double *p, dea_scalar I1_less_3, dea_scalar J_less_1,
                             struct dea_law_volume *e);
  /* Shear modulus of the ground state [Pa] (isotropic part), for the small-strain limit and for
   * scaling. */
  double (*shear_modulus)(const double *p);
  /* A measure of stretch over its value where the chains are fully stretched, 1 there; NULL for a
   * law that does not lock up. */
  double (*locking_share)(const double *p, double I1);
};

/* Law of that name, or NULL. Static storage. */
const struct dea_law *DEA_NAME(dea_law_find)(const char *name);
/* All laws in the order of law_list.h; *count is set. Static storage. */
const struct dea_law *const *DEA_NAME(dea_law_all)(size_t *count);

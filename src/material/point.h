/* A material point in three dimensions: energy, stress and tangent of a law from the deformation
 * gradient. The law's W is taken as it stands: there is no split into volume and shape, and the
 * pressure (incompressibility) is the caller's.
 *
 * Tensors are row-major: F[3 i + J] = dx_i/dX_J, P[3 i + J], A[9 (3 i + J) + 3 k + L]. */
#pragma once

#include "material/law.h"

struct dea_point {
  dea_scalar W;     // energy per reference volume [Pa]
  dea_scalar P[9];  // first Piola-Kirchhoff stress dW/dF [Pa]
  dea_scalar A[81]; // tangent d2W/dF2 [Pa], symmetric in its two pairs of indices
};

/* param: [law->param_count] SI. F: det F > 0. fibre: unit vector a0 in the reference configuration,
 * may be NULL for a law that is not anisotropic (DEA_E_ARGUMENT otherwise). DEA_E_DOMAIN when det F
 * is not positive, when F has an entry that is not finite, and beyond the law's domain; *out is
 * then unspecified. */
dea_status DEA_NAME(dea_point_elastic)(const struct dea_law *law, const double *param,
                                       const dea_scalar F[9], const double fibre[3],
                                       struct dea_point *out);

/* The same without the tangent: out->A is not set. */
dea_status DEA_NAME(dea_point_stress)(const struct dea_law *law, const double *param,
                                      const dea_scalar F[9], const double fibre[3],
                                      struct dea_point *out);

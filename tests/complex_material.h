/* The material kernels compiled with complex numbers (DEA_COMPLEX), behind plain signatures: the
 * types of law.h exist here in their real form only. Laws are named, everything is SI. */
#pragma once

#include "base/status.h"

#include <complex.h>
#include <stdbool.h>

/* W, then W1 W2 W4, then W11 W12 W22 W14 W24 W44. */
dea_status complex_invariants(const char *law, const double *param,
                              const double complex invariant[3], double complex out[10]);
/* W, then W1 WJ, then W11 W1J WJJ; argument: I1 - 3, J - 1. */
dea_status complex_compressible(const char *law, const double *param,
                                const double complex argument[2], double complex out[6]);
/* w, w', w''. */
dea_status complex_principal(const char *law, const double *param, double complex lambda,
                             double complex out[3]);
/* W, s1 s2, k11 k12 k22. */
dea_status complex_plane_elastic(const char *law, const double *param, double fibre_angle_rad,
                                 const double complex lambda[2], double complex out[6]);
void complex_plane_electric(double eps_at_rest, double eps_slope, double nominal_field_V_per_m,
                            const double complex lambda[2], double complex out[6]);
dea_status complex_point(const char *law, const double *param, const double complex F[9],
                         const double fibre[3], double complex *W, double complex P[9],
                         double complex A[81]);

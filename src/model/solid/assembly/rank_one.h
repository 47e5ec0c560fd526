/* What one number of the whole adds to K: stiffness times s s^T, with its slope s by all
 * displacements, as the pressure of an enclosed volume does (docs/theory/loads.md). It is no entry
 * of K: with Z = K^-1 S and M = diag(1/stiffness) + S^T Z,
 *
 *   (K + S C S^T)^-1 r = K^-1 r - Z M^-1 Z^T r,
 *
 * and K + S C S^T has as many negative eigenvalues less than K as M has. */
#pragma once

#include "model/solid/assembly/problem.h"

void dea_solid_rank_one_destroy(struct dea_solid *s);
/* With a new factor of K: Z and M. *fewer: negative eigenvalues. solve: by the factor alone. */
dea_status dea_solid_rank_one_factor(struct dea_context *ctx, struct dea_solid *s,
                                     dea_status (*solve)(struct dea_context *ctx,
                                                         struct dea_solid *s, Vec right, Vec x),
                                     int *fewer);
/* x from K^-1 right to the solution of the whole. */
dea_status dea_solid_rank_one_correct(struct dea_context *ctx, struct dea_solid *s, Vec right,
                                      Vec x);
/* v . S C S^T v at the state. v: [dofs]. */
double dea_solid_rank_one_curvature(const struct dea_solid *s, const double *v);

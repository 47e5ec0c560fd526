/* How far a tangent is from positive definite (docs/theory/branches.md, Shift). */
#pragma once

#include "model/solid/assembly/problem.h"

/* Lowest [Pa] of the eigenvalues K v = lowest L v, to a tenth, of a K that has been factorised with
 * `negative` pivots below 0: that of dea_solid_create_laplace, by which K is shifted. *lowest_Pa is
 * that of those found where they are not all, 0 where none is. All ranks get the same bits. */
dea_status dea_solid_lowest_by_laplace(struct dea_context *ctx, struct dea_solid *s, Mat L,
                                       int negative, double *lowest_Pa);

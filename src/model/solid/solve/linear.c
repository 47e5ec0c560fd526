/* Linear algebra: factor, inertia, shift, solve. */
#include "model/solid/solve/internal.h"

#include <string.h>

dea_status dea_solid_factorise(struct dea_context *ctx, struct dea_solid *s, int *negative)
{
  MatFactorInfo info;
  PetscInt minus, zero, plus;
  MatFactorInfoInitialize(&info);
  if (!s->analysed) {
    DEA_TRY(ctx, dea_solid_petsc(
                     ctx, MatGetFactor(s->K, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, &s->factor),
                     "MatGetFactor"));
    MatMumpsSetIcntl(s->factor, 24, 1); // null pivots and
    MatMumpsSetIcntl(s->factor, 13, 1); // no parallel root, so that the inertia is counted
    DEA_TRY(ctx, dea_solid_petsc(ctx, MatCholeskyFactorSymbolic(s->factor, s->K, NULL, &info),
                                 "MatCholeskyFactorSymbolic"));
    s->analysed = true;
  }
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatCholeskyFactorNumeric(s->factor, s->K, &info),
                               "MatCholeskyFactorNumeric"));
  DEA_TRY(ctx,
          dea_solid_petsc(ctx, MatGetInertia(s->factor, &minus, &zero, &plus), "MatGetInertia"));
  *negative = (int)(minus + zero);
  return DEA_OK;
}

dea_status dea_solid_shift(struct dea_context *ctx, struct dea_solid *s, double amount)
{
  PetscScalar *values;
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecGetArray(s->right, &values), "VecGetArray"));
  for (size_t i = 3 * s->first_node; i < 3 * s->end_node; i++) {
    values[i - 3 * s->first_node] = amount * s->metric[i];
  }
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecRestoreArray(s->right, &values), "VecRestoreArray"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatDiagonalSet(s->K, s->right, ADD_VALUES), "MatDiagonalSet"));
  return DEA_OK;
}

dea_status dea_solid_solve_linear(struct dea_context *ctx, struct dea_solid *s, const double *right,
                                  double *out)
{
  size_t first = 3 * s->first_node, here = 3 * (s->end_node - s->first_node);
  PetscScalar *values;
  memmove(out, right, s->dofs * sizeof(double));
  dea_solid_frame_vector(s, false, out);
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecGetArray(s->right, &values), "VecGetArray"));
  memcpy(values, out + first, here * sizeof(double));
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecRestoreArray(s->right, &values), "VecRestoreArray"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatSolve(s->factor, s->right, s->solution), "MatSolve"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecGetArray(s->solution, &values), "VecGetArray"));
  memset(out, 0, s->dofs * sizeof(double)); // zero where other ranks have it
  memcpy(out + first, values, here * sizeof(double));
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecRestoreArray(s->solution, &values), "VecRestoreArray"));
  dea_solid_sum(s, out, s->dofs);
  dea_solid_frame_vector(s, true, out);
  return DEA_OK;
}

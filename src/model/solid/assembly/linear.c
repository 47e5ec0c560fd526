/* Linear algebra: factor, inertia, solve. */
#include "model/solid/assembly/internal.h"

#include <string.h>

dea_status dea_solid_end_matrix(struct dea_context *ctx, Mat A)
{
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY), "MatAssemblyBegin"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY), "MatAssemblyEnd"));
  return DEA_OK;
}

/* Analysis of A's pattern. room_percent: for pivots that come later than planned. */
static dea_status analyse(struct dea_context *ctx, Mat A, PetscInt room_percent, Mat *factor)
{
  MatFactorInfo info;
  MatFactorInfoInitialize(&info);
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatGetFactor(A, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, factor),
                               "MatGetFactor"));
  MatMumpsSetIcntl(*factor, 24, 1); // null pivots and
  MatMumpsSetIcntl(*factor, 13, 1); // no parallel root, so that the inertia is counted
  MatMumpsSetIcntl(*factor, 14, room_percent);
  dea_status status = dea_solid_petsc(ctx, MatCholeskyFactorSymbolic(*factor, A, NULL, &info),
                                      "MatCholeskyFactorSymbolic");
  if (status != DEA_OK) {
    MatDestroy(factor); // sets it to NULL: not analysed
  }
  return status;
}

dea_status dea_solid_factor(struct dea_context *ctx, Mat A, Mat *factor)
{
  enum { ROOM = 25, ROOM_MAX = 400 };
  MatFactorInfo info;
  MatFactorError error = MAT_FACTOR_NOERROR;
  MatFactorInfoInitialize(&info);
  for (PetscInt room = ROOM; room <= ROOM_MAX; room *= 2) {
    if (*factor == NULL) {
      DEA_TRY(ctx, analyse(ctx, A, room, factor));
    }
    DEA_TRY(ctx, dea_solid_petsc(ctx, MatCholeskyFactorNumeric(*factor, A, &info),
                                 "MatCholeskyFactorNumeric"));
    DEA_TRY(ctx, dea_solid_petsc(ctx, MatFactorGetError(*factor, &error), "MatFactorGetError"));
    if (error != MAT_FACTOR_OUTMEMORY) {
      break;
    }
    MatDestroy(factor); // PETSc takes no second attempt with it
  }
  if (error == MAT_FACTOR_OUTMEMORY) {
    return dea_fail(ctx, DEA_E_MEMORY, "the factors of the tangent find no room in memory");
  }
  return error == MAT_FACTOR_NOERROR
             ? DEA_OK
             : dea_fail(ctx, DEA_E_NOT_CONVERGED, "the tangent cannot be factorised");
}

dea_status dea_solid_factorise(struct dea_context *ctx, struct dea_solid *s, int *negative)
{
  PetscInt minus, zero, plus;
  DEA_TRY(ctx, dea_solid_factor(ctx, s->K, &s->factor));
  DEA_TRY(ctx,
          dea_solid_petsc(ctx, MatGetInertia(s->factor, &minus, &zero, &plus), "MatGetInertia"));
  *negative = (int)(minus + zero) - (int)s->free_potentials;
  return DEA_OK;
}

/* This rank's unknowns as K has them, node by node, from where the solid has them. */
static void to_nodes(const struct dea_solid *s, const double *solid, double *nodes)
{
  for (size_t n = s->first_node, k = 0; n < s->end_node; n++) {
    for (int i = 0; i < s->per_node; i++) {
      nodes[k++] = solid[dea_solid_at(s, (int)n, i)];
    }
  }
}

static void from_nodes(const struct dea_solid *s, const double *nodes, double *solid)
{
  for (size_t n = s->first_node, k = 0; n < s->end_node; n++) {
    for (int i = 0; i < s->per_node; i++) {
      solid[dea_solid_at(s, (int)n, i)] = nodes[k++];
    }
  }
}

dea_status dea_solid_from_vector(struct dea_context *ctx, const struct dea_solid *s, Vec vector,
                                 double *out)
{
  const PetscScalar *values;
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecGetArrayRead(vector, &values), "VecGetArrayRead"));
  memset(out, 0, s->dofs * sizeof(double)); // zero where other ranks have it
  from_nodes(s, values, out);
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecRestoreArrayRead(vector, &values), "VecRestoreArrayRead"));
  dea_solid_sum(s, out, s->dofs);
  dea_solid_frame_vector(s, true, out);
  return DEA_OK;
}

dea_status dea_solid_to_vector(struct dea_context *ctx, const struct dea_solid *s, double *values,
                               Vec vector)
{
  PetscScalar *rows;
  dea_solid_frame_vector(s, false, values);
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecGetArray(vector, &rows), "VecGetArray"));
  to_nodes(s, values, rows);
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecRestoreArray(vector, &rows), "VecRestoreArray"));
  return DEA_OK;
}

dea_status dea_solid_solve_linear(struct dea_context *ctx, struct dea_solid *s, const double *right,
                                  double *out)
{
  memmove(out, right, s->dofs * sizeof(double));
  DEA_TRY(ctx, dea_solid_to_vector(ctx, s, out, s->right));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatSolve(s->factor, s->right, s->solution), "MatSolve"));
  DEA_TRY(ctx, dea_solid_from_vector(ctx, s, s->solution, out));
  return DEA_OK;
}

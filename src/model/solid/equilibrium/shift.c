#include "model/solid/equilibrium/shift.h"

#include "model/solid/assembly/matrix.h"
#include "model/solid/assembly/ranks.h"

#include <lapacke.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* Lanczos' method on K^-1 L by the factor that is there, in the scalar product of L: its
 * eigenvalues are 1/lowest and so on, and those below 0 lie at one end of it. All vectors are kept,
 * and made orthogonal to all before. (SLEPc's takes twice as many solutions: it is asked for
 * eigenvectors.) */

enum { STEPS_FIRST = 12, STEPS_EACH = 6, STEPS_MOST = 60 };

struct lanczos {
  struct dea_solid *s;
  Mat L;
  Vec *v, *Lv;                         // [steps + 1] each
  int steps;                           // at most
  double a[STEPS_MOST], b[STEPS_MOST]; // diagonal of the tridiagonal matrix, and what is beside it
};

/* Rank 0's value on all. */
static double agreed(double value)
{
  double here = dea_solid_rank() == 0 ? value : 0;
  dea_solid_sum(&here, 1);
  return here;
}

/* v[k] as long as 1, and L v[k]; *length: what it was. */
static dea_status normalise(struct dea_context *ctx, struct lanczos *z, int k, double *length)
{
  PetscScalar square;
  DEA_PETSC(ctx, MatMult(z->L, z->v[k], z->Lv[k]));
  DEA_PETSC(ctx, VecDot(z->v[k], z->Lv[k], &square));
  *length = sqrt(fmax(agreed(square), 0));
  if (*length > 0) {
    DEA_PETSC(ctx, VecScale(z->v[k], 1 / *length));
    DEA_PETSC(ctx, VecScale(z->Lv[k], 1 / *length));
  }
  return DEA_OK;
}

/* v[0]: K^-1 L of what looks like chance and is the same each time. */
static dea_status begin(struct dea_context *ctx, struct lanczos *z, double *length)
{
  PetscScalar *x;
  PetscInt from, to;
  DEA_PETSC(ctx, VecGetOwnershipRange(z->v[1], &from, &to));
  DEA_PETSC(ctx, VecGetArrayWrite(z->v[1], &x));
  for (PetscInt i = from; i < to; i++) {
    uint64_t bits = ((uint64_t)i + 1) * 0x9e3779b97f4a7c15u; // the golden ratio's
    x[i - from] = (double)((bits ^ (bits >> 29)) * 0xbf58476d1ce4e5b9u >> 11) / 0x1p53 - 0.5;
  }
  DEA_PETSC(ctx, VecRestoreArrayWrite(z->v[1], &x));
  DEA_PETSC(ctx, MatMult(z->L, z->v[1], z->Lv[1]));
  DEA_TRY(ctx, dea_solid_solve_rows(ctx, z->s, z->Lv[1], z->v[0]));
  return DEA_CHAIN(ctx, normalise(ctx, z, 0, length));
}

/* v[k + 1] from v[k], with a[k] and b[k]. */
static dea_status step(struct dea_context *ctx, struct lanczos *z, int k)
{
  PetscScalar along[STEPS_MOST];
  DEA_TRY(ctx, dea_solid_solve_rows(ctx, z->s, z->Lv[k], z->v[k + 1]));
  z->a[k] = 0;
  for (int pass = 0; pass < 2; pass++) { // the second takes what rounding has left of the first
    DEA_PETSC(ctx, VecMDot(z->v[k + 1], k + 1, z->Lv, along));
    z->a[k] += agreed(along[k]);
    for (int i = 0; i <= k; i++) {
      along[i] = -along[i];
    }
    DEA_PETSC(ctx, VecMAXPY(z->v[k + 1], k + 1, along, z->v));
  }
  return DEA_CHAIN(ctx, normalise(ctx, z, k + 1, &z->b[k]));
}

/* What `count` steps say of `negative` eigenvalues: true where they are all there, and the lowest
 * to a tenth. *lowest_Pa: of those that there are. */
static bool says(const struct lanczos *z, int count, int negative, double *lowest_Pa)
{
  double value[STEPS_MOST], beside[STEPS_MOST], vector[STEPS_MOST * STEPS_MOST];
  int found = 0;
  memcpy(value, z->a, (size_t)count * sizeof *value);
  memcpy(beside, z->b, (size_t)count * sizeof *beside);
  *lowest_Pa = 0;
  if (LAPACKE_dstev(LAPACK_COL_MAJOR, 'V', count, value, beside, vector, count) != 0) {
    return false;
  }
  while (found < count && value[found] < 0) { // from the lowest up: the last one is 1/lowest
    found++;
  }
  if (found == 0) {
    return false;
  }
  double off = z->b[count - 1] * vector[found * count - 1];
  *lowest_Pa = 1 / value[found - 1];
  return found >= negative && fabs(off / value[found - 1]) < 0.1;
}

static dea_status iterate(struct dea_context *ctx, struct lanczos *z, int negative,
                          double *lowest_Pa)
{
  double length = 0;
  DEA_TRY(ctx, begin(ctx, z, &length));
  for (int k = 0; k < z->steps && length > 0; k++) {
    DEA_TRY(ctx, dea_solid_check_interruption(ctx));
    DEA_TRY(ctx, step(ctx, z, k));
    length = z->b[k];
    if ((k % 3 == 2 || k + 1 == z->steps || length == 0) && says(z, k + 1, negative, lowest_Pa)) {
      return DEA_OK;
    }
  }
  return DEA_OK;
}

dea_status dea_solid_lowest_by_laplace(struct dea_context *ctx, struct dea_solid *s, Mat L,
                                       int negative, double *lowest_Pa)
{
  struct lanczos z = {.s = s, .L = L, .steps = STEPS_FIRST + STEPS_EACH * negative};
  Vec **const vectors[] = {&z.v, &z.Lv};
  dea_status status = DEA_OK;
  *lowest_Pa = 0;
  z.steps = z.steps < STEPS_MOST ? z.steps : STEPS_MOST;
  for (int i = 0; i < 2 && status == DEA_OK; i++) {
    int code = VecDuplicateVecs(s->work.right, z.steps + 1, vectors[i]);
    status = dea_solid_petsc(ctx, code, "VecDuplicateVecs");
  }
  status = status == DEA_OK ? iterate(ctx, &z, negative, lowest_Pa) : status;
  for (int i = 0; i < 2; i++) {
    if (*vectors[i] != NULL) {
      VecDestroyVecs(z.steps + 1, vectors[i]);
    }
  }
  return DEA_CHAIN(ctx, status);
}

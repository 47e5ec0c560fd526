#include "model/solid/assembly/rank_one.h"

#include "model/solid/assembly/ranks.h"

#include <lapacke.h>
#include <string.h>

void dea_solid_rank_one_destroy(struct dea_solid *s)
{
  for (size_t i = 0; i < DEA_RANK_ONE_MAX; i++) {
    VecDestroy(&s->work.rank_one.slope[i]);
    VecDestroy(&s->work.rank_one.solved[i]);
  }
}

dea_status dea_solid_rank_one_factor(struct dea_context *ctx, struct dea_solid *s,
                                     dea_status (*solve)(struct dea_context *ctx,
                                                         struct dea_solid *s, Vec right, Vec x),
                                     int *fewer)
{
  struct dea_solid_rank_one *r = &s->work.rank_one;
  const size_t n = r->count;
  double value[DEA_RANK_ONE_MAX] = {0}, vector[DEA_RANK_ONE_MAX * DEA_RANK_ONE_MAX];
  *fewer = 0;
  for (size_t i = 0; i < n; i++) {
    DEA_TRY(ctx, solve(ctx, s, r->slope[i], r->solved[i]));
    for (size_t j = 0; j <= i; j++) {
      PetscScalar product;
      DEA_PETSC(ctx, VecDot(r->slope[j], r->solved[i], &product));
      vector[i * n + j] = vector[j * n + i] = product + (i == j ? 1 / r->stiffness[i] : 0);
    }
  }
  if (n > 0 && LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', (int)n, vector, (int)n, value) != 0) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the tangent of an enclosed volume has no factor");
  }
  memset(r->inverse, 0, sizeof r->inverse);
  for (size_t k = 0; k < n; k++) {
    *fewer += value[k] < 0;
    for (size_t ij = 0; ij < n * n && value[k] != 0; ij++) {
      r->inverse[ij] += vector[ij / n * n + k] * vector[ij % n * n + k] / value[k];
    }
  }
  r->solved_count = n;
  return DEA_OK;
}

dea_status dea_solid_rank_one_correct(struct dea_context *ctx, struct dea_solid *s, Vec right,
                                      Vec x)
{
  const struct dea_solid_rank_one *r = &s->work.rank_one;
  const size_t n = r->solved_count;
  PetscScalar along[DEA_RANK_ONE_MAX];
  for (size_t i = 0; i < n; i++) {
    DEA_PETSC(ctx, VecDot(r->solved[i], right, &along[i]));
  }
  for (size_t ij = 0; ij < n * n; ij++) {
    DEA_PETSC(ctx, VecAXPY(x, -r->inverse[ij] * along[ij % n], r->solved[ij / n]));
  }
  return DEA_OK;
}

double dea_solid_rank_one_curvature(const struct dea_solid *s, const double *v)
{
  double sum = 0;
  for (size_t i = 0; i < s->problem.load_count; i++) {
    const struct dea_solid_load *load = &s->problem.loads[i];
    if (load->along != NULL) {
      const double along = load->along(load->self, s->state.u, v);
      sum += load->whole(load->self, s->state.u, NULL) * along * along;
    }
  }
  return sum;
}

#include "model/solid/assembly/mass.h"

#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/matrix.h"

#include <string.h>

/* ---- mass ---- */

static dea_status mass_of(const struct dea_solid *s, size_t e, double *mass)
{
  const struct dea_element *element = dea_solid_element(s, e);
  double X[DEA_HEX_DOFS_MAX];
  dea_solid_gather(s, e, s->problem.grid->X, X);
  return dea_element_mass(element, dea_solid_part_material(s, e), X, mass);
}

/* A += factor d at free displacements, the same in all local axes; d[apart n] is of node n, or of
 * its first component. */
static dea_status add_diagonal(struct dea_context *ctx, struct dea_solid *s, Mat A, double factor,
                               const double *d, size_t apart)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t i = 3 * p->first_node; i < 3 * p->end_node; i++) {
    const double value = p->held[i] ? 0 : factor * d[apart * (i / 3) + i % apart];
    const PetscInt row = (PetscInt)((size_t)p->per_node * (i / 3) + i % 3);
    if (value != 0) {
      DEA_PETSC(ctx, MatSetValue(A, row, row, value, ADD_VALUES));
    }
  }
  DEA_TRY(ctx, dea_solid_bodies_add_diagonal(ctx, s, A, factor, d, apart));
  return DEA_CHAIN(ctx, dea_solid_end_matrix(ctx, A));
}

dea_status dea_solid_add_mass(struct dea_context *ctx, struct dea_solid *s, Mat A, double factor)
{
  DEA_TRY(ctx, dea_solid_add_scalar(ctx, s, A, factor, mass_of));
  const double *mass_kg = s->problem.point_mass;
  return DEA_CHAIN(ctx, mass_kg != NULL ? add_diagonal(ctx, s, A, factor, mass_kg, 1) : DEA_OK);
}

/* 0 in K's pattern. */
static dea_status create_like_tangent(struct dea_context *ctx, const struct dea_solid *s, Mat *A)
{
  DEA_PETSC(ctx, MatDuplicate(s->work.K, MAT_DO_NOT_COPY_VALUES, A));
  DEA_PETSC(ctx, MatSetOption(*A, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE));
  return DEA_OK;
}

dea_status dea_solid_create_mass(struct dea_context *ctx, struct dea_solid *s, Mat *M)
{
  DEA_TRY(ctx, create_like_tangent(ctx, s, M));
  DEA_TRY(ctx, dea_solid_add_mass(ctx, s, *M, 1));
  PetscReal size;
  DEA_PETSC(ctx, MatNorm(*M, NORM_INFINITY, &size));
  return size > 0 ? DEA_OK
                  : dea_fail(ctx, DEA_E_ARGUMENT, "the solid has no mass: no density is known");
}

dea_status dea_solid_mass_apply(struct dea_context *ctx, const struct dea_solid *s, const double *v,
                                double *out)
{
  const struct dea_solid_problem *p = &s->problem;
  dea_status status = DEA_OK;
  memset(out, 0, 3 * p->grid->node_count * sizeof *out);
  for (size_t k = 0; k < p->own_count && status == DEA_OK; k++) {
    double X[DEA_HEX_DOFS_MAX], moving[DEA_HEX_DOFS_MAX], force[DEA_HEX_DOFS_MAX];
    size_t e = p->own[k];
    const struct dea_element *element = dea_solid_element(s, e);
    const int *nodes = p->grid->nodes + e * DEA_HEX_NODES_MAX;
    dea_solid_gather(s, e, p->grid->X, X);
    const int count = dea_solid_gather(s, e, v, moving);
    status = dea_element_mass_times(element, dea_solid_part_material(s, e), X, moving, force);
    for (int i = 0; i < 3 * count && status == DEA_OK; i++) {
      out[3 * nodes[i / 3] + i % 3] += force[i];
    }
  }
  status = dea_solid_allreduce(NULL, status);
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "an element is inverted");
  }
  dea_solid_sum(out, 3 * p->grid->node_count);
  for (size_t i = 0; i < 3 * p->grid->node_count && p->point_mass != NULL; i++) {
    out[i] += p->point_mass[i / 3] * v[i];
  }
  return DEA_OK;
}

/* ---- volume and grad : grad ---- */

/* L of an element [nodes][nodes], NULL: not wanted, and its volume. */
static dea_status metric_of(const struct dea_solid *s, size_t e, double *laplace, double *lumped,
                            double *volume)
{
  double X[DEA_HEX_DOFS_MAX] = {0};
  const struct dea_element *element = dea_solid_element(s, e);
  int count = dea_solid_gather(s, e, s->problem.grid->X, X);
  *volume = 0;
  DEA_TRY_STATUS(element->type->metric(element, dea_solid_part_material(s, e), X, laplace, lumped));
  for (int n = 0; n < count; n++) {
    *volume += lumped[n];
  }
  return DEA_OK;
}

static dea_status laplace_of(const struct dea_solid *s, size_t e, double *laplace)
{
  double lumped[DEA_HEX_NODES_MAX] = {0}, volume;
  return metric_of(s, e, laplace, lumped, &volume);
}

dea_status dea_solid_add_laplace(struct dea_context *ctx, struct dea_solid *s, Mat A,
                                 double amount_Pa)
{
  return DEA_CHAIN(ctx, dea_solid_add_scalar(ctx, s, A, amount_Pa, laplace_of));
}

dea_status dea_solid_create_laplace(struct dea_context *ctx, struct dea_solid *s, Mat *out)
{
  DEA_TRY(ctx, create_like_tangent(ctx, s, out));
  return DEA_CHAIN(ctx, dea_solid_add_laplace(ctx, s, *out, 1));
}

void dea_solid_lump_volume(const struct dea_solid *s, double *volume)
{
  const struct dea_solid_problem *p = &s->problem;
  memset(volume, 0, p->dofs * sizeof *volume);
  for (size_t e = 0; e < p->grid->element_count; e++) {
    double lumped[DEA_HEX_NODES_MAX] = {0}, whole;
    const int *nodes = p->grid->nodes + e * DEA_HEX_NODES_MAX;
    metric_of(s, e, NULL, lumped, &whole);
    for (int n = 0; n < dea_grid_nodes_of(p->grid, e); n++) {
      for (int i = 0; i < 3; i++) {
        volume[3 * nodes[n] + i] += lumped[n];
      }
    }
  }
}

dea_status dea_solid_create_volume(struct dea_context *ctx, struct dea_solid *s, Mat *out)
{
  DEA_TRY(ctx, create_like_tangent(ctx, s, out));
  dea_solid_lump_volume(s, s->work.trial);
  return DEA_CHAIN(ctx, add_diagonal(ctx, s, *out, 1, s->work.trial, 3));
}

double dea_solid_volume_of(const struct dea_solid *s, size_t e)
{
  double lumped[DEA_HEX_NODES_MAX] = {0}, volume;
  metric_of(s, e, NULL, lumped, &volume);
  return volume;
}

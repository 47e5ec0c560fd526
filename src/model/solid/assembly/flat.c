/* What flat elements ask of the solver: modes without stiffness (docs/theory/membrane.md). */
#include "model/solid/assembly/internal.h"

#include <string.h>

static const double neutral = 1e-10; // tau: stiffness that counts as none, in units of M

static dea_status add_spring(struct dea_context *ctx, struct dea_solid *s, size_t e)
{
  const int *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
  const struct dea_constituent *layer = &s->layers[s->layer[e]];
  double X[DEA_FLAT_DOFS_MAX], stiffness[DEA_FLAT_NODES_MAX];
  dea_status status = dea_membrane_check(layer);
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "a membrane takes isotropic hyperelastic laws only");
  }
  for (int n = 0; n < s->flat.nodes; n++) {
    memcpy(X + 3 * n, s->grid->X + 3 * nodes[n], 3 * sizeof(double));
  }
  status = dea_membrane_stiffness(&s->flat, layer, X, stiffness);
  if (status != DEA_OK) {
    return DEA_OK; // inverted: dea_solid_check says where
  }
  for (int i = 0; i < 3 * s->flat.nodes; i++) {
    s->spring[3 * nodes[i / 3] + i % 3] += stiffness[i / 3];
  }
  return DEA_OK;
}

dea_status dea_solid_create_springs(struct dea_context *ctx, struct dea_solid *s)
{
  for (size_t e = 0; e < s->grid->element_count; e++) {
    if (!s->grid->flat[e]) {
      continue;
    }
    if (s->per_node != 3) {
      return dea_fail(ctx, DEA_E_UNSUPPORTED, "a membrane takes the field V/h, not a coupled one");
    }
    if (s->spring == NULL) {
      s->spring = dea_alloc(ctx, s->dofs, sizeof *s->spring);
      if (s->per_node != 3) {
        return dea_fail(ctx, DEA_E_UNSUPPORTED,
                        "a membrane takes the field V/h, not a coupled one");
      }
      if (s->spring == NULL) {
        return DEA_E_MEMORY;
      }
    }
    DEA_TRY(ctx, add_spring(ctx, s, e));
  }
  return DEA_OK;
}

dea_status dea_solid_add_springs(struct dea_context *ctx, struct dea_solid *s)
{
  if (s->spring == NULL) {
    return DEA_OK;
  }
  PetscScalar *values;
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecGetArray(s->right, &values), "VecGetArray"));
  for (size_t i = 3 * s->first_node; i < 3 * s->end_node; i++) {
    values[i - 3 * s->first_node] = neutral * s->spring[i];
  }
  DEA_TRY(ctx, dea_solid_petsc(ctx, VecRestoreArray(s->right, &values), "VecRestoreArray"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatDiagonalSet(s->K, s->right, ADD_VALUES), "MatDiagonalSet"));
  return DEA_OK;
}

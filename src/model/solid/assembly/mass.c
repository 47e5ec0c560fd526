#include "model/solid/assembly/mass.h"

#include "model/solid/assembly/internal.h"
#include "model/solid/element/mass.h"

#include <string.h>

static dea_status mass_of(const struct dea_solid *s, size_t e, double *mass)
{
  const struct dea_constituent *layer = &s->layers[s->layer[e]];
  double X[DEA_HEX_DOFS_MAX];
  dea_solid_places(s, e, X);
  return s->grid->flat[e] ? dea_membrane_mass(&s->flat, layer, X, mass)
                          : dea_hex_mass(&s->shape, layer, X, mass);
}

dea_status dea_solid_add_mass(struct dea_context *ctx, struct dea_solid *s, Mat A, double factor)
{
  DEA_TRY(ctx, dea_solid_add_scalar(ctx, s, A, factor, mass_of));
  return DEA_OK;
}

dea_status dea_solid_create_mass(struct dea_context *ctx, struct dea_solid *s, Mat *M)
{
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatDuplicate(s->K, MAT_DO_NOT_COPY_VALUES, M), "MatDuplicate"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatSetOption(*M, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE),
                               "MatSetOption"));
  DEA_TRY(ctx, dea_solid_add_mass(ctx, s, *M, 1));
  PetscReal size;
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatNorm(*M, NORM_INFINITY, &size), "MatNorm"));
  return size > 0 ? DEA_OK
                  : dea_fail(ctx, DEA_E_ARGUMENT, "the solid has no mass: no density is known");
}

dea_status dea_solid_mass_apply(struct dea_context *ctx, const struct dea_solid *s, const double *v,
                                double *out)
{
  dea_status status = DEA_OK;
  memset(out, 0, 3 * s->grid->node_count * sizeof *out);
  for (size_t k = 0; k < s->own_count && status == DEA_OK; k++) {
    double mass[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
    size_t e = s->own[k];
    const int *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
    int count = dea_grid_nodes_of(s->grid, e, s->shape.nodes);
    status = mass_of(s, e, mass);
    for (int a = 0; a < count && status == DEA_OK; a++) {
      for (int b = 0; b < count; b++) {
        for (int i = 0; i < 3; i++) {
          out[3 * nodes[a] + i] += mass[a * count + b] * v[3 * nodes[b] + i];
        }
      }
    }
  }
  status = dea_solid_agree(NULL, s, status);
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "an element is inverted");
  }
  dea_solid_sum(s, out, 3 * s->grid->node_count);
  return DEA_OK;
}

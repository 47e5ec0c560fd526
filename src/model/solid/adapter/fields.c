#include "model/solid/adapter/fields.h"

#include "model/solid/assembly/potential.h"
#include "model/solid/recovery/recover.h"

/* Potentials of a coupled field [V], owned by the caller; NULL for thin films. */
static dea_status find_potentials(struct dea_context *ctx, const struct dea_solid *s, double **out)
{
  *out = NULL;
  if (s->field == NULL) {
    return DEA_OK;
  }
  *out = dea_alloc(ctx, s->grid->node_count, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t n = 0; n < s->grid->node_count; n++) {
    (*out)[n] = dea_solid_field_scale(s) * s->u[3 * s->grid->node_count + n];
  }
  return DEA_OK;
}

/* ply: of the middle surface, negative for all elements. */
static dea_status recover(struct dea_context *ctx, const struct dea_solid *s, int ply,
                          struct dea_field_mesh **out)
{
  double *potential_V;
  *out = NULL;
  DEA_TRY(ctx, find_potentials(ctx, s, &potential_V));
  const struct dea_recover_input input = {.grid = s->grid,
                                          .elements = &s->elements,
                                          .kind = s->kind,
                                          .constituents = s->layers,
                                          .constituent = s->layer,
                                          .active = s->active,
                                          .u = s->u,
                                          .multiplier = s->multiplier,
                                          .potential_V = potential_V,
                                          .voltage_V = s->voltage_V};
  dea_status status =
      ply < 0 ? dea_recover_volume(ctx, &input, out) : dea_recover_surface(ctx, &input, ply, out);
  dea_free(ctx, potential_V);
  return status;
}

dea_status dea_solid_volume(struct dea_context *ctx, const struct dea_solid *solid,
                            struct dea_field_mesh **out)
{
  DEA_TRY(ctx, recover(ctx, solid, -1, out));
  return DEA_OK;
}

dea_status dea_solid_surface(struct dea_context *ctx, const struct dea_solid *solid, int ply,
                             struct dea_field_mesh **out)
{
  DEA_TRY(ctx, recover(ctx, solid, ply, out));
  return DEA_OK;
}

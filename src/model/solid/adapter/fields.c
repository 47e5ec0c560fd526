#include "model/solid/adapter/fields.h"

#include "model/solid/assembly/potential.h"
#include "model/solid/recovery/recover.h"

/* Potentials of a coupled field [V], owned by the caller; NULL for thin films. */
static dea_status find_potentials(struct dea_context *ctx, const struct dea_solid *s, double **out)
{
  const struct dea_solid_problem *p = &s->problem;
  *out = NULL;
  if (p->field == NULL) {
    return DEA_OK;
  }
  *out = dea_alloc(ctx, p->grid->node_count, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t n = 0; n < p->grid->node_count; n++) {
    (*out)[n] = dea_solid_field_scale(s) * s->state.u[3 * p->grid->node_count + n];
  }
  return DEA_OK;
}

/* ply: of the middle surface, negative for all elements. */
static dea_status recover(struct dea_context *ctx, const struct dea_solid *s, int ply,
                          struct dea_field_mesh **out)
{
  const struct dea_solid_problem *p = &s->problem;
  double *potential_V = NULL, *across_V = dea_alloc(ctx, p->grid->element_count, sizeof *across_V);
  *out = NULL;
  dea_status status = across_V != NULL ? find_potentials(ctx, s, &potential_V) : DEA_E_MEMORY;
  for (size_t e = 0; e < p->grid->element_count && status == DEA_OK; e++) {
    across_V[e] = dea_solid_voltage_across(s, e, s->state.voltage_V);
  }
  const struct dea_recover_input input = {.grid = p->grid,
                                          .elements = &p->elements,
                                          .kind = p->kind,
                                          .constituents = p->constituents,
                                          .bulk_factor = s->state.bulk_factor,
                                          .constituent = p->constituent_of,
                                          .active = p->active,
                                          .u = s->state.u,
                                          .multiplier = s->state.multiplier,
                                          .across_V = across_V,
                                          .potential_V = potential_V};
  if (status == DEA_OK) {
    status =
        ply < 0 ? dea_recover_volume(ctx, &input, out) : dea_recover_surface(ctx, &input, ply, out);
  }
  dea_free(ctx, across_V);
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

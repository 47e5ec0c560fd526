#include "model/solid/solve/fields.h"

#include "model/solid/recover.h"
#include "model/solid/solve/internal.h"

static struct dea_recover_input input_of(const struct dea_solid *s)
{
  return (struct dea_recover_input){.grid = s->grid,
                                    .shape = &s->shape,
                                    .layers = s->layers,
                                    .layer = s->layer,
                                    .active = s->active,
                                    .u = s->u,
                                    .multiplier = s->multiplier,
                                    .voltage_V = s->voltage_V};
}

dea_status dea_solid_volume(struct dea_context *ctx, const struct dea_solid *solid,
                            struct dea_field_mesh **out)
{
  const struct dea_recover_input input = input_of(solid);
  DEA_TRY(ctx, dea_recover_volume(ctx, &input, out));
  return DEA_OK;
}

dea_status dea_solid_surface(struct dea_context *ctx, const struct dea_solid *solid, int sheet,
                             struct dea_field_mesh **out)
{
  const struct dea_recover_input input = input_of(solid);
  DEA_TRY(ctx, dea_recover_surface(ctx, &input, sheet, out));
  return DEA_OK;
}

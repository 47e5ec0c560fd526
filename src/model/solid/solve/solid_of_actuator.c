#include "model/solid/actuator.h"
#include "model/solid/solve/solid.h"

dea_status dea_solid_of_actuator(struct dea_context *ctx, const struct dea_actuator *actuator,
                                 const struct dea_grid *grid, struct dea_solid **out)
{
  bool coupled = actuator->device->solid_field == DEA_FIELD_COUPLED;
  const struct dea_solid_options options = {
      .order_z = actuator->plate.order_z,
      .layer_count = DEA_LAYER_COUNT,
      .layers = actuator->layers,
      .layer_of = dea_actuator_layer,
      .field = coupled ? DEA_SOLID_FIELD_COUPLED : DEA_SOLID_FIELD_THIN,
      .electrode = dea_actuator_electrode,
      .active = dea_actuator_active,
      .held = dea_actuator_held,
      .frame = dea_actuator_frame,
      .self = actuator,
  };
  DEA_TRY(ctx, dea_solid_create(ctx, grid, &options, out));
  return DEA_OK;
}

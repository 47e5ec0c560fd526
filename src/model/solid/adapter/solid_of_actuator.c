#include "model/solid/adapter/solid_of_actuator.h"

#include <string.h>

dea_status dea_solid_of_actuator(struct dea_context *ctx, const struct dea_actuator *actuator,
                                 const struct dea_grid *grid, struct dea_solid **out)
{
  bool coupled = actuator->settings.field == DEA_FIELD_COUPLED;
  const struct dea_solid_options options = {
      .order_z = actuator->plate.order_z,
      .constituent_count = DEA_CONSTITUENT_COUNT,
      .constituents = actuator->constituents,
      .constituent_of = dea_actuator_constituent,
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

void dea_branches_of_material(const struct dea_material *material, struct dea_branches *out)
{
  out->count = material->branch_count;
  memcpy(out->branch, material->branches, material->branch_count * sizeof *out->branch);
}

void dea_branches_of_device(const struct dea_device *device, struct dea_branches *out)
{
  memset(out, 0, DEA_CONSTITUENT_COUNT * sizeof *out);
  dea_branches_of_material(&device->film, &out[DEA_CONSTITUENT_FILM]);
  if (device->electrode_thickness_m > 0) {
    dea_branches_of_material(&device->electrode, &out[DEA_CONSTITUENT_ELECTRODE]);
  }
}

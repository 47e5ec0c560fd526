#include "device/generator.h"

static dea_status fill(struct dea_context *ctx, const struct dea_design *design,
                       struct dea_device *device)
{
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  DEA_TRY(ctx,
          (design->parts != NULL ? dea_generator_parts : dea_generator_disc)(ctx, design, device));
  size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  if (found > 0) {
    return dea_fail(ctx, DEA_E_DESIGN, "'%s' has %zu error%s", design->file, found,
                    found > 1 ? "s" : "");
  }
  return DEA_OK;
}

dea_status dea_device_build(struct dea_context *ctx, const struct dea_design *design,
                            struct dea_device **out)
{
  *out = NULL;
  struct dea_device *device = dea_alloc(ctx, 1, sizeof *device);
  DEA_TRY_MEMORY(device != NULL);
  DEA_TRY_ELSE(ctx, fill(ctx, design, device), dea_device_destroy(ctx, device));
  *out = device;
  return DEA_OK;
}

bool dea_device_is_observed(const struct dea_device *device)
{
  return !device->disc || (device->layout != NULL && device->layout->monitor_count > 0);
}

void dea_device_destroy(struct dea_context *ctx, struct dea_device *device)
{
  if (device != NULL) {
    dea_layout_destroy(ctx, device->layout);
    dea_free(ctx, device);
  }
}

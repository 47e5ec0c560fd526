/* What model "3d" does not take of a design, as far as it is known without a mesh: in the core, so
 * that no module is loaded for it. */
#pragma once

#include "device/device.h"

/* Findings at their places, and DEA_E_DESIGN, as `check` of a model. */
dea_status dea_solid_check_design(struct dea_context *ctx, const struct dea_design *design,
                                  const struct dea_device *device);
/* The same of the material of one ply. */
dea_status dea_solid_check_ply(struct dea_context *ctx, const struct dea_layout *layout,
                               size_t ply);

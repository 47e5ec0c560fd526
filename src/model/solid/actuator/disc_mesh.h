/* The mesh of a device: that of blocks which a disc brings along, or a free one. */
#pragma once

#include "model/solid/actuator/layout_mesh.h"

/* Of any device; its layout is lent to what is not a disc. On failure out is empty. */
dea_status dea_device_mesh_create(struct dea_context *ctx, const struct dea_device *device,
                                  const struct dea_model_settings *settings,
                                  struct dea_layout_mesh *out);
/* The same with the elements of `like`, which outlives it, of a device that differs in numbers
 * only; as dea_mesh_follow. */
dea_status dea_device_mesh_follow(struct dea_context *ctx, const struct dea_device *device,
                                  const struct dea_model_settings *settings,
                                  const struct dea_layout_mesh *like, struct dea_layout_mesh *out);

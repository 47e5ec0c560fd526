/* The mesh of a device: that of blocks which a disc brings along, or a free one. */
#pragma once

#include "model/solid/actuator/layout_mesh.h"

/* Blocks of a plate, which is a disc's, extruded through a layout of its own. like: with the
 * elements of that mesh, moved (DEA_E_ARGUMENT where other elements come of it); NULL: those of the
 * plate. device: need not have a layout. *fit: whether blocks have all monitors of its layout. On
 * failure, or where it does not fit, out is empty. */
dea_status dea_disc_mesh_create(struct dea_context *ctx, const struct dea_device *device,
                                const struct dea_model_settings *settings,
                                const struct dea_fibre_disc *plate,
                                const struct dea_layout_mesh *like, struct dea_layout_mesh *out,
                                bool *fit);

/* Of any device; its layout is lent to what is not a disc. On failure out is empty. */
dea_status dea_device_mesh_create(struct dea_context *ctx, const struct dea_device *device,
                                  const struct dea_model_settings *settings,
                                  struct dea_layout_mesh *out);
/* The same with the elements of `like`, which outlives it, of a device that differs in numbers
 * only; as dea_mesh_follow. */
dea_status dea_device_mesh_follow(struct dea_context *ctx, const struct dea_device *device,
                                  const struct dea_model_settings *settings,
                                  const struct dea_layout_mesh *like, struct dea_layout_mesh *out);

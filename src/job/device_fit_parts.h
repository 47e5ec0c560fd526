/* Parts of a fit of a device (device_fit_run.h). */
#pragma once

#include "job/device_fit_model.h"

/* Reads the measured curves, one a quantity of each file. Errors are findings. */
dea_status dea_device_curves_read(struct dea_context *ctx, struct dea_device_fit *fit);
/* Sets groups and stops of a model: each voltage once, rising; and the stop of each row. */
dea_status dea_device_stops_build(struct dea_context *ctx, struct dea_device_fit *fit,
                                  struct dea_device_model *model);
/* The fitted design as a file, into fit->design; file: as it was, device: built from it. */
dea_status dea_device_design_build(struct dea_context *ctx, struct dea_device_fit *fit,
                                   const struct dea_design_bytes *file,
                                   const struct dea_device *device);

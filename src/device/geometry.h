/* Geometry of a device: lengths of the stretched film, and whether the parts fit together. */
#ifndef DEA_DEVICE_GEOMETRY_H
#define DEA_DEVICE_GEOMETRY_H

#include "device/device.h"

/* Fills every length and number of device from the design. */
void dea_geometry_fill(const struct dea_design *design, struct dea_device *device);
/* Adds a finding for each thing that does not fit, at the value at fault. Fails only for memory. */
dea_status dea_geometry_check(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_device *device);

#endif

/* Geometry of a device: lengths of the stretched film, and whether the parts fit together. */
#pragma once

#include "device/device.h"

/* A length in the stretched film: an unstretched one grows with the film. */
double dea_length_stretched_m(const struct dea_inplane_length *length, double pre_stretch);
/* Fills every length and number of device from the design, and fits the breakdown field of its
 * film, if that is there already, to them (dea_device_fit_breakdown). */
void dea_geometry_fill(const struct dea_design *design, struct dea_device *device);
/* Adds findings where settings of studies do not fit a device of any generator. */
dea_status dea_geometry_fit_studies(struct dea_context *ctx, const struct dea_design *design,
                                    const struct dea_device *device);
/* Adds a finding for each thing that does not fit, at the value at fault. Fails only for memory. */
dea_status dea_geometry_check(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_device *device);

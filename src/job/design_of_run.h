/* The design that a run computed, read again from the run. */
#pragma once

#include "io/results_h5.h"

/* design, device: owned by the caller; after a failure (as of dea_design_read_memory and
 * dea_device_build) those that could be made, or NULL. */
dea_status dea_design_of_run(struct dea_context *ctx, const struct dea_run *run,
                             struct dea_design **design, struct dea_device **device);

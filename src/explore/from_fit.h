/* Parameters that dea fit has found as variables of an exploration (key `from_fit`). */
#pragma once

#include "explore/explore_file.h"
#include "study/device_param.h"

/* Adds the parameters of the fit that the file names, if any, to its variables, with the fit's
 * values, standard uncertainties and correlations. What is wrong becomes findings at from_fit. */
dea_status dea_from_fit_read(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device, struct dea_explore_file *io);

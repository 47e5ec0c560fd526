/* What study "uncertainty" tells of a design. */
#pragma once

#include "design/design.h"
#include "device/device.h"

/* Whether what it names are numbers of the design, with uncertainties of theirs; DEA_E_DESIGN after
 * findings. */
dea_status dea_uncertainty_check(struct dea_context *ctx, const struct dea_design *design,
                                 const struct dea_device *device);

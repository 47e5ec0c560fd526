/* Reading of designs that a file compares itself with. */
#pragma once

#include "design/read.h"

/* Reads the designs that a design compares itself with. DEA_E_DESIGN after all were tried. */
dea_status dea_design_read_variants(struct dea_context *ctx, const struct dea_design_source *source,
                                    struct dea_design *design);

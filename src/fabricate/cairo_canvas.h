/* What draws PDF, SVG and PNG: cairo, which is a module. */
#pragma once

#include "figures/canvas.h"

/* The type that draws with cairo. DEA_E_UNSUPPORTED when that is not installed. */
dea_status dea_canvas_open(struct dea_context *ctx, const struct dea_canvas_type **out);

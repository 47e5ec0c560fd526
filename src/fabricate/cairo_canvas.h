/* What draws PDF, SVG and PNG: cairo, which is a module. */
#pragma once

#include "figures/canvas.h"

/* Path of the module that draws with cairo into out[size]; false when it is not here. */
bool dea_canvas_find(char *out, size_t size);
/* The type that draws with cairo. DEA_E_UNSUPPORTED when that is not installed. */
dea_status dea_canvas_open(struct dea_context *ctx, const struct dea_canvas_type **out);

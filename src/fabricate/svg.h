/* A sheet as SVG for laser cutters: user units are mm, hairlines, a group for each layer. */
#pragma once

#include "base/text.h"
#include "fabricate/workshop.h"

/* The file of part number `index` with all its copies. DEA_E_MEMORY is the only failure. */
dea_status dea_svg_write(const struct dea_workshop *workshop, size_t index, struct dea_text *out);

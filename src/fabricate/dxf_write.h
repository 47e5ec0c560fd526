/* A sheet as DXF (AC1015, which is AutoCAD 2000): tool paths in mm, a layer for each way of
 * working.
 */
#pragma once

#include "base/text.h"
#include "fabricate/workshop.h"

/* The file of part number `index` with all its copies. DEA_E_MEMORY is the only failure. */
dea_status dea_dxf_write(const struct dea_workshop *workshop, size_t index, struct dea_text *out);
/* The shapes of a layout that its parts are of, each on a layer of its name, where they lie in the
 * flat film and without kerf: what a shape of kind `drawing` reads. Letters that a layer's name may
 * not have are "_". DEA_E_MEMORY is the only failure. */
dea_status dea_dxf_write_layout(const struct dea_layout *layout, struct dea_text *out);

/* Words beside a sheet: "frdea-4.yaml: Frame of the pre-stretch; seen from ...; 2 copies, ...". */
void dea_sheet_labels(const struct dea_workshop *workshop, size_t index, struct dea_text *out);

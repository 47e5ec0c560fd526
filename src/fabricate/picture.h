/* The drawing of an actuator (figures/device_drawing.h) with what the workshop adds to it:
 * frame, leads with their pads, anchors of fibres, alignment marks. */
#pragma once

#include "fabricate/workshop.h"
#include "figures/canvas.h"

/* DEA_E_MEMORY is the only failure of both. */
dea_status dea_picture_size(const struct dea_workshop *workshop, double out_mm[2]);
dea_status dea_picture_draw(const struct dea_paper *paper, const struct dea_workshop *workshop);

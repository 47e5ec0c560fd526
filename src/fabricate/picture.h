/* The drawing of an actuator, as figure 3 of the paper: top view and section with dimensions, in
 * the stretched and the unstretched film. The thickness is not to scale. */
#ifndef DEA_FABRICATE_PICTURE_H
#define DEA_FABRICATE_PICTURE_H

#include "fabricate/canvas.h"
#include "fabricate/workshop.h"

void dea_picture_size(const struct dea_workshop *workshop, double out_mm[2]);
void dea_picture_draw(const struct dea_paper *paper, const struct dea_workshop *workshop);

#endif

/* A PDF at scale 1:1: a page with dimensions for each part, and one for each sheet with copies. */
#pragma once

#include "fabricate/workshop.h"
#include "figures/canvas.h"

/* Draws all pages on a canvas that begins with a page of dea_pages_first_size. Neither fails. */
dea_status dea_pages_draw(const struct dea_paper *paper, const struct dea_workshop *workshop);
dea_status dea_pages_first_size(const struct dea_workshop *workshop, double out_mm[2]);

/* The drawing of a device: what lies where, from above and to scale. */
#ifndef DEA_OUTPUT_LAYOUT_SVG_H
#define DEA_OUTPUT_LAYOUT_SVG_H

#include "base/text.h"
#include "device/layout.h"

/* Adds an SVG with plies (a colour a material), electrodes (a colour a channel), supports, rigid
 * bodies, monitors, and lines of symmetry, with a scale bar and a legend that lists the plies from
 * top to bottom with their thicknesses. It needs no style from outside. number: tells the drawings
 * of one page apart. */
void dea_layout_svg(const struct dea_layout *layout, int number, struct dea_text *out);

#endif

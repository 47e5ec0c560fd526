/* The drawing of an actuator, the only one of the project: `dea check --svg`, the report, the C
 * interface and the workshop all have it, on a canvas of their own.
 *
 * From above and to scale: plies (a colour a material), electrodes (a colour a channel), rigid
 * bodies, supports, pressures, monitors, lines of symmetry, with sizes. Below that a section along
 * x through the middle, its thickness not to scale, and a legend. */
#pragma once

#include "base/text.h"
#include "device/layout.h"
#include "figures/canvas.h"

/* What is drawn beside the layout, such as leads and marks of the workshop. */
struct dea_drawn_shape {
  struct dea_contour contour; // in the layout's coordinates; lent
  bool over;                  // over plies and electrodes, else below all
  unsigned colour;            // of its fill
  double opacity;             // of its fill; 0: none
  double dash_mm;             // of its line; 0: drawn through
  const char *note;           // words at its size; NULL: no size
  double stretch;             // of a circle, whose unstretched size is told too; 1: none
};

struct dea_device_drawing {
  const struct dea_layout *layout; // lent
  const char *title, *below;       // head of the page; NULL: none
  const struct dea_drawn_shape *shapes;
  size_t shape_count;
};

/* Colour of what is connected to a channel. */
unsigned dea_device_drawing_channel(size_t channel);
/* Size of its page, and drawing it on one of that size. */
void dea_device_drawing_size(const struct dea_device_drawing *drawing, double out_mm[2]);
void dea_device_drawing_draw(const struct dea_paper *paper,
                             const struct dea_device_drawing *drawing);
/* Adds it as an SVG to a text. number: tells the drawings of one page apart. DEA_E_MEMORY is the
 * only failure, which marks the text too. */
dea_status dea_device_drawing_add_svg(const struct dea_device_drawing *drawing, int number,
                                      struct dea_text *out);

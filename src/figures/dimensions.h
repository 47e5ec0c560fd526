/* What technical drawings are made of: labels with leaders, dimensions with arrows, title and scale
 * of a page. Lengths in mm on the page. */
#pragma once

#include "figures/canvas.h"

enum { DEA_CALLOUT_LABEL = 72, DEA_CALLOUT_NOTE = 96, DEA_CALLOUT_BELOW = 32 };

/* A label beside a drawing, with a leader to a point, or to a circle where that faces the label. */
struct dea_callout {
  double x_mm, y_mm;
  double radius_mm; // 0: a point
  bool bare;        // leader without an arrow: to a dimension that has its own
  char label[DEA_CALLOUT_LABEL], note[DEA_CALLOUT_NOTE];
  char below[DEA_CALLOUT_BELOW]; // a second line of the note, or none
};

/* Labels in two columns left and right of a box {x min, y min, x max, y max}. */
void dea_dimensions_callouts(const struct dea_paper *paper, const double box_mm[4],
                             const struct dea_callout *callouts, size_t count);
/* Height that these take, the box's at least; callouts are told apart by their x alone. */
double dea_dimensions_height(const double box_mm[4], const struct dea_callout *callouts,
                             size_t count);
/* A line between two points with arrows at its ends: inside, or outside where it is short; sets the
 * place where a leader starts. */
void dea_dimensions_dimension(const struct dea_paper *paper, const double from_mm[2],
                              const double to_mm[2], struct dea_callout *callout);
/* Dash-dotted cross of a centre. */
void dea_dimensions_centre(const struct dea_paper *paper, double x_mm, double y_mm, double half_mm);
/* Title, a line below it, and at the foot a bar of 50 mm that shows whether it was printed 1:1. */
void dea_dimensions_head(const struct dea_paper *paper, double width_mm, double height_mm,
                         const char *title, const char *below);
void dea_dimensions_scale(const struct dea_paper *paper, double width_mm, const char *words);
/* Text that is cut to a width, with dots at its end. */
void dea_dimensions_fit(const struct dea_paper *paper, double x_mm, double y_mm, double size_mm,
                        bool bold, unsigned colour, double width_mm, const char *text);
/* Length in mm, at most three decimals: "46.667". */
void dea_length_text(char *out, size_t size, double length_m);

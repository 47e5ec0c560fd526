/* What the figures of study force share: its curve in parts, one for each depth of the tip. */
#ifndef DEA_OUTPUT_FIGURE_STOPS_H
#define DEA_OUTPUT_FIGURE_STOPS_H

#include "output/figure.h"

/* Of the first model with such a curve; count 0 when there is none. */
struct dea_stops {
  const struct dea_curve *curve; // lent
  size_t count;
  size_t first[DEA_DESIGN_STOPS_MAX + 1]; // first point of each, and one past the last
  size_t by_depth[DEA_DESIGN_STOPS_MAX];  // their numbers, the least deep one first
};
void dea_stops_find(const struct dea_result *result, struct dea_stops *out);
/* Look of the i-th curve, without title. */
struct dea_series dea_stops_style(size_t i);

#endif

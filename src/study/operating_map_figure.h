/* What study "operating-map" found, drawn: limits and lines of equal displacement over a parameter
 * of the design. */
#pragma once

#include "result/figure.h"

enum { DEA_OPERATING_MAP_FIGURES = 3 };
extern const struct dea_figure dea_operating_map_figures[DEA_OPERATING_MAP_FIGURES];

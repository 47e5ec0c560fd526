/* What study "uncertainty" tells of a design. */
#ifndef DEA_STUDY_UNCERTAINTY_H
#define DEA_STUDY_UNCERTAINTY_H

#include "design/design.h"

#include <stdbool.h>

/* Whether its section is written, so that curves of all models get bands. */
bool dea_uncertainty_written(const struct dea_design *design);

#endif

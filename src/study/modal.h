/* What study "modal" tells of a design. */
#ifndef DEA_STUDY_MODAL_H
#define DEA_STUDY_MODAL_H

#include "design/design.h"

#include <stdbool.h>

/* Whether a design asks for it. */
bool dea_modal_asked(const struct dea_design *design);

#endif

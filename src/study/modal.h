/* Study "modal": whether a design asks for it. */
#pragma once

#include "design/design.h"

#include <stdbool.h>

/* Whether a design asks for it. */
bool dea_modal_asked(const struct dea_design *design);

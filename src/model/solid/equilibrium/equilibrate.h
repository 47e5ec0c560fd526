/* Equilibrium with the constraints of all multipliers met (docs/theory/branches.md). */
#pragma once

#include "model/solid/assembly/problem.h"

/* At the controls as they are, downhill from where it is, as dea_solid_minimise. */
dea_status dea_solid_equilibrate(struct dea_context *ctx, struct dea_solid *s,
                                 struct dea_solid_report *report);

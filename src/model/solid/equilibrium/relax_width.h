/* Which of the equilibria of a wrinkled film is taken (docs/theory/membrane.md, "Free edges"). */
#pragma once

#include "model/solid/assembly/problem.h"

/* From an equilibrium of a film that wrinkles to the one that it has after it has spread in its
 * plane as if it could not wrinkle. Nothing to do for one that is in tension all over, for a solid
 * without relaxed films and with inertia; where no such equilibrium is found the solid stays where
 * it was. */
dea_status dea_solid_relax_width(struct dea_context *ctx, struct dea_solid *solid,
                                 struct dea_solid_report *report);

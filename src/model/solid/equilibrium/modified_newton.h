/* From one equilibrium to another close by with the factor of the first (docs/theory/branches.md).
 */
#pragma once

#include "model/solid/assembly/problem.h"

/* With the factor of the last equilibrium, which the solid is at, to that at the controls as they
 * are, its unstable modes, and multipliers of loads: where there is no such mode and these follow
 * *there is true, and the new factor is there for the next step. Otherwise the solid is where it
 * was: the way is too long, or the field is coupled. from_V: voltage that the solid is at, NAN
 * where not only the voltage changes; where it came there the same way the bend of that is taken
 * along. intermediate: near the equilibrium is enough, for one further on, and multipliers need not
 * follow. *rate: what the second step is over the first, about in proportion to the way; 0: not
 * known; NULL: not wanted. Fails only where no shorter way would help. */
dea_status dea_solid_follow(struct dea_context *ctx, struct dea_solid *s, double from_V,
                            bool intermediate, struct dea_solid_report *report, double *rate,
                            bool *there);

/* Equilibrium with the constraints of all multipliers met, at the controls as they are, downhill
 * from where it is, as dea_solid_minimise. */
dea_status dea_solid_equilibrate(struct dea_context *ctx, struct dea_solid *s,
                                 struct dea_solid_report *report);

/* The side that a film without tension has buckled to (docs/theory/branches.md). */
#ifndef DEA_MODEL_SOLID_SOLVE_SIDE_H
#define DEA_MODEL_SOLID_SOLVE_SIDE_H

#include "model/solid/plate.h"
#include "model/solid/solve/solid.h"

/* Goes over to an equilibrium with the centre node on the side that is wanted, from one where it is
 * not: pushes the film inside the electrodes there. *moved: whether there was one; if not the solid
 * stays where it is. Nothing to do with DEA_SIDE_ANY or on the right side. */
dea_status dea_side_take(struct dea_context *ctx, struct dea_solid *solid,
                         const struct dea_grid *grid, const struct dea_plate *plate, size_t centre,
                         enum dea_solid_side side, struct dea_solid_report *report, bool *moved);

#endif

/* The side that a film without tension has buckled to (docs/theory/branches.md). */
#ifndef DEA_MODEL_SOLID_ADAPTER_BUCKLING_BRANCH_H
#define DEA_MODEL_SOLID_ADAPTER_BUCKLING_BRANCH_H

#include "model/solid/assembly/solid.h"
#include "model/solid/mesh/fibre_disc.h"

/* Goes over to an equilibrium with the centre node on the side that is wanted, from one where it is
 * not: pushes the film inside the electrodes there. *moved: whether there was one; if not the solid
 * stays where it is. Nothing to do with DEA_BRANCH_ANY or on the right side. */
dea_status dea_buckling_branch_take(struct dea_context *ctx, struct dea_solid *solid,
                                    const struct dea_grid *grid, const struct dea_fibre_disc *plate,
                                    size_t centre, enum dea_buckling_branch side,
                                    struct dea_solid_report *report, bool *moved);

#endif

/* The side that a film without tension has buckled to (docs/theory/branches.md). */
#pragma once

#include "model/model.h"
#include "model/solid/assembly/solid.h"
#include "model/solid/mesh/grid.h"

/* Where the film is; of a surface all that is nearer to it than half its thickness. */
struct dea_film_band {
  double middle_m, thickness_m;
};
bool dea_film_band_has(const struct dea_film_band *film, double z_m);

/* Goes over to a stable equilibrium on the side that is wanted, that of the largest displacement of
 * film and fibres out of the plane, from one that is not there: turns what is on the other side
 * into its mirror image, and goes down from there. *moved: whether there was one; if not the solid
 * stays where it is. Nothing to do with DEA_BRANCH_ANY or on the right side. */
dea_status dea_buckling_branch_select(struct dea_context *ctx, struct dea_solid *solid,
                                      const struct dea_grid *grid, const struct dea_film_band *film,
                                      enum dea_buckling_branch side,
                                      struct dea_solid_report *report, bool *moved);

/* What folds the film to one side of the middle plane (sign: 1 the fibres', -1 the other): its
 * middle goes from z to sign (sqrt(z^2 + h^2) - h), with the film's thickness h, so that there is
 * no crease, and each column leans as that slopes. out: [node_count][3]. */
void dea_buckling_branch_fold(const struct dea_solid *solid, const struct dea_grid *grid,
                              const struct dea_film_band *film, int sign, double *out);

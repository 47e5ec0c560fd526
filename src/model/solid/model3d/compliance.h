/* How a coordinate of a solid and its charge change with a force along the coordinate and with the
 * voltage (docs/theory/reduced-model.md). */
#pragma once

#include "model/model.h"
#include "model/solid/assembly/internal_variables.h"
#include "model/solid/model3d/motions.h"

/* The gas around the film. */
struct dea_air {
  double density_kg_per_m3; // 0: none
  struct dea_motions film;  // solid and grid
  int ply;
  const struct dea_layout_sector *sector; // that the solid is
};

/* At the solid's last equilibrium, at a voltage. slope: of the coordinate by the unknowns [dofs];
 * copies: of the solid in the device; branches: [its part materials]. Fills all of out but value
 * and force. */
dea_status dea_compliance_find(struct dea_context *ctx, struct dea_solid *solid, double copies,
                               double voltage_V, const double *slope,
                               const struct dea_branches *branches, const struct dea_air *air,
                               int with, struct dea_compliance *out);

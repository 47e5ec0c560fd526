/* Fields of a solid at its last equilibrium (recover.h). */
#pragma once

#include "model/solid/assembly/solid.h"
#include "model/solid/recovery/recover_error.h"
#include "result/field_mesh.h"

/* out: owned by the caller, NULL on failure. The symmetry is left to the caller. */
dea_status dea_solid_volume(struct dea_context *ctx, const struct dea_solid *solid,
                            struct dea_field_mesh **out);
dea_status dea_solid_surface(struct dea_context *ctx, const struct dea_solid *solid, int ply,
                             struct dea_field_mesh **out);
/* A quantity that is a sum of weight [3 nodes] times u, and where it is read. */
struct dea_solid_quantity {
  const double *weight;
  struct dea_recover_probe probes[2];
  size_t probe_count;
};
/* Estimated errors [m] of quantities, not negative, from the factor of the last equilibrium; NAN
 * where there is none, or it is of an unstable one. part: as dea_recover_errors, untouched where
 * the errors are NAN. count <= DEA_ERRORS_MAX. */
dea_status dea_solid_errors(struct dea_context *ctx, struct dea_solid *solid,
                            const struct dea_solid_quantity *of, size_t count, double *error_m,
                            double *part);

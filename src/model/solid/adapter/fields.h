/* Fields of a solid at its last equilibrium (recover.h). */
#ifndef DEA_MODEL_SOLID_ADAPTER_FIELDS_H
#define DEA_MODEL_SOLID_ADAPTER_FIELDS_H

#include "model/solid/assembly/solid.h"
#include "result/field_mesh.h"

/* out: owned by the caller, NULL on failure. The symmetry is left to the caller. */
dea_status dea_solid_volume(struct dea_context *ctx, const struct dea_solid *solid,
                            struct dea_field_mesh **out);
dea_status dea_solid_surface(struct dea_context *ctx, const struct dea_solid *solid, int ply,
                             struct dea_field_mesh **out);
/* Estimated errors [m] of displacements, not negative, each a sum of weight[k] [3 nodes] times
 * u, from the factor of the last equilibrium; NAN where there is none, or it is of an unstable one.
 * part: as dea_recover_errors, untouched where the errors are NAN. count <= DEA_ERRORS_MAX. */
dea_status dea_solid_errors(struct dea_context *ctx, struct dea_solid *solid,
                            const double *const *weight, size_t count, double *error_m,
                            double *part);

#endif

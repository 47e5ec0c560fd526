/* Fields of a solid at its last equilibrium (recover.h). */
#pragma once

#include "model/solid/assembly/solid.h"
#include "model/solid/recovery/recover_error.h"
#include "result/field_mesh.h"

/* The middle surface of a ply, or all elements. out: owned by the caller, NULL on failure. The
 * symmetry is left to the caller. */
enum { DEA_ALL_PLIES = -1 };
dea_status dea_solid_fields(struct dea_context *ctx, const struct dea_solid *solid, int ply,
                            struct dea_field_mesh **out);
/* Estimated errors [m] of quantities, not negative, from the factor of the last equilibrium; NAN
 * where there is none, or it is of an unstable one. of: z [dofs] are the quantity's weights, in
 * whose place the answer comes. part: as dea_recover_errors, untouched where the errors are NAN.
 * count <= DEA_ERRORS_MAX. */
dea_status dea_solid_errors(struct dea_context *ctx, struct dea_solid *solid,
                            const struct dea_recover_quantity *of, size_t count, double *error_m,
                            double *part);

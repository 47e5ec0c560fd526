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

#endif

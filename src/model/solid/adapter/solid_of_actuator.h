/* The solid of an actuator, and the viscous branches of its constituents. */
#ifndef DEA_MODEL_SOLID_ADAPTER_SOLID_OF_ACTUATOR_H
#define DEA_MODEL_SOLID_ADAPTER_SOLID_OF_ACTUATOR_H

#include "model/solid/actuator/actuator.h"
#include "model/solid/assembly/internal_variables.h"

/* The solid of an actuator on its mesh. actuator, grid: lent, outlive the solid. */
dea_status dea_solid_of_actuator(struct dea_context *ctx, const struct dea_actuator *actuator,
                                 const struct dea_grid *grid, struct dea_solid **out);
void dea_branches_of_material(const struct dea_material *material, struct dea_branches *out);
/* Branches of its film, and of electrodes of a thickness. out: [DEA_CONSTITUENT_COUNT]. */
void dea_branches_of_device(const struct dea_device *device, struct dea_branches *out);

#endif

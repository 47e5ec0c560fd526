/* State of a solid between two solves: displacements, multipliers, voltage, dead loads, places of
 * held nodes and parameters of loads, and those of the equilibrium before, from which the next one
 * is predicted. Prescribed displacements and goals of loads are asked for anew after a load. */
#pragma once

#include "model/model.h"
#include "model/solid/assembly/solid.h"

/* Adds the solid's arrays, and marks of its mesh, supports and materials. Lent by the solid. */
dea_status dea_solid_save(struct dea_context *ctx, struct dea_solid *solid, struct dea_state *out);
/* Factorises the tangent there, from which the next solve starts as it would have. DEA_E_ARGUMENT
 * when an array is missing or of another length; the solid is then as it was. */
dea_status dea_solid_load(struct dea_context *ctx, struct dea_solid *solid,
                          const struct dea_state *state);

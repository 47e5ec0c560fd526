/* Gas that moves with a surface in a rigid wall (docs/theory/reduced-model.md). */
#pragma once

#include "device/layout_sector.h"
#include "result/field_mesh.h"

enum { DEA_AIR_SHAPES_MAX = 16 };

/* Added masses per density [m^3], both faces together, of shapes [count][point_count][3] of a
 * surface that stands where its field displacement_m has moved it. Surface and masses are those of
 * one copy of the sector. cells: about as many on the whole. out: [count][count], symmetric. */
dea_status dea_air_mass(struct dea_context *ctx, const struct dea_field_mesh *surface,
                        const struct dea_layout_sector *sector, size_t cells, const double *shapes,
                        size_t count, double *out);

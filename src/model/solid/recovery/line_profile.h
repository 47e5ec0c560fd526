/* What a surface of a solid shows along a straight line through its centre. */
#pragma once

#include "model/model.h"
#include "result/field_mesh.h"

/* Along the rays at the angle `plus` (places > 0) and `minus` (places < 0) from the z axis, in
 * ascending order of the place; a place where parts meet stands there once for each. Both rays lie
 * on edges of cells and on mirror planes, where one principal direction is along the ray.
 * pre_stretch: of the surface. surface: from dea_solid_fields. *columns: what out lends from,
 * owned by the caller (dea_free). */
dea_status dea_line_profile(struct dea_context *ctx, const struct dea_field_mesh *surface,
                            double plus, double minus, double pre_stretch, double **columns,
                            struct dea_profile *out);

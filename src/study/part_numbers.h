/* Numbers of a design of the general form that can change little by little, and devices with others
 * in their place. */
#pragma once

#include "study/design_gradient.h"

/* Adds the numbers of plies, channels, bodies, springs and pressures that are not 0, under the keys
 * of --set ("plies.film.thickness"; of what has no name "springs[0].stiffness"), those of the
 * plies' materials (material_numbers.h), and those of shapes, of any value
 * ("shapes.hub.radius"; `all`: also places that are 0 where the file says nothing). What is held
 * and moved is not among them. out: [DEA_NUMBERS_MAX]. */
dea_status dea_part_numbers(struct dea_context *ctx, const struct dea_design *design,
                            const struct dea_device *device, bool all,
                            struct dea_design_number *out, size_t *count);

/* The device with another value of one of them. scratch: for what the device does not outlive, the
 * caller's; the layout of *out is the caller's too (dea_layout_destroy). */
dea_status dea_part_change(struct dea_context *ctx, const struct dea_design *design,
                           const struct dea_design_number *number, double value,
                           struct dea_arena *scratch, struct dea_device *out);

/* Numbers of a design of the general form that can change little by little, and devices with others
 * in their place. */
#ifndef DEA_STUDY_PART_NUMBERS_H
#define DEA_STUDY_PART_NUMBERS_H

#include "study/design_gradient.h"

/* Adds the numbers of plies, channels, bodies, springs and pressures that are not 0, under the keys
 * of --set ("plies.film.thickness"; of what has no name "springs[0].stiffness"), and those of the
 * plies' materials ("plies.film.law.c1"). What is held and moved and where shapes are is not among
 * them. out: [DEA_NUMBERS_MAX]. */
void dea_part_numbers(const struct dea_design *design, const struct dea_device *device,
                      struct dea_design_number *out, size_t *count);

/* The device with another value of one of them. scratch: for what the device does not outlive, the
 * caller's; the layout of *out is the caller's too (dea_layout_destroy). */
dea_status dea_part_change(struct dea_context *ctx, const struct dea_design *design,
                           const struct dea_design_number *number, double value,
                           struct dea_arena *scratch, struct dea_device *out);

#endif

/* The indenter of compute.force, for studies that press it in before something else happens. */
#pragma once

#include "model/model.h"

/* The indenter that the design describes. */
struct dea_probe dea_force_indenter(const struct dea_design *design);
/* Stops that the design asks for: depths and preloads. */
size_t dea_force_stops(const struct dea_design *design);
/* The first depth that the design asks for, 0 without any [m]. */
double dea_force_first_depth_m(const struct dea_design *design);
/* Presses it to the stop of that number, first depths, then preloads, at the model's last voltage.
 * DEA_E_NOT_CONVERGED when no depth gives a preload. */
dea_status dea_force_indent(struct dea_context *ctx, const struct dea_model_type *type,
                            struct dea_model *model, const struct dea_design *design, size_t stop);

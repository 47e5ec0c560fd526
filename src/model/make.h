/* What all models have in common: how they are created, and what they say of a snap-through. */
#pragma once

#include "model/model.h"

/* Allocates a zeroed model of `size` bytes, prepares it, and destroys it again when that fails.
 * *out: NULL then. settings: NULL for the defaults; prepare gets some. prepare and destroy: the
 * model's own. */
dea_status dea_model_build(
    struct dea_context *ctx, size_t size, const struct dea_device *device,
    const struct dea_model_settings *settings,
    dea_status (*prepare)(struct dea_context *ctx, const struct dea_device *device,
                          const struct dea_model_settings *settings, struct dea_model *model),
    void (*destroy)(struct dea_context *ctx, struct dea_model *model), struct dea_model **out);

/* Warns that the model of that name has gone past a limit point, from one voltage to another, to
 * another state. */
dea_status dea_model_report_passed(struct dea_context *ctx, const char *name, double from_V,
                                   double to_V, const struct dea_event *passed);

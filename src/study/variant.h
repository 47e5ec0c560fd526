/* One of several computations that a study sets beside each other. */
#pragma once

#include "model/model.h"
#include "result/result.h"

/* Which computation: of a device, so computed, through voltages in their order. */
struct dea_variant_run {
  const char *study, *name;
  const struct dea_device *device;
  struct dea_model_settings settings;
  const double *voltages_V; // [voltage_count]
  size_t voltage_count;
};

/* Makes a model of the device, takes it through the voltages and adds what it has as a variant of
 * the result, with size, time and the profile at the last point. A failure ends the variant's
 * curve, which then says why, and is returned; the variant is there all the same. */
dea_status dea_variant_run(struct dea_context *ctx, const struct dea_model_type *type,
                           const struct dea_variant_run *run, struct dea_result *result);

/* The same from the model's sweep in the result, without computing it again: its points, its end
 * and the last profile of the model. model: that of the sweep. The time is NAN. */
dea_status dea_variant_of_sweep(struct dea_context *ctx, const struct dea_model_type *type,
                                const struct dea_model *model, const char *study, const char *name,
                                struct dea_result *result);

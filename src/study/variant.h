/* One of several computations that a study sets beside each other. */
#pragma once

#include "study/study.h"

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
dea_status dea_variant_run(struct dea_context *ctx, const struct dea_study_job *job,
                           const struct dea_variant_run *run);

/* The same from the sweep of the job's model in the result, without computing it again: its points,
 * its end and the last profile of the model. The time is NAN. */
dea_status dea_variant_of_sweep(struct dea_context *ctx, const struct dea_study_job *job,
                                const char *study, const char *name);
/* Size and refinement of the mesh of the job's model; nothing where it has none. */
void dea_variant_set_size(const struct dea_study_job *job, double refinement,
                          struct dea_variant *variant);
/* Its profile at the last point of the variant, where it stands; nothing where it has none. */
dea_status dea_variant_add_profile(struct dea_context *ctx, const struct dea_study_job *job,
                                   struct dea_variant *variant);

/* Where study "loading" ends, for other studies. */
#pragma once

#include "study/study.h"

/* What a line of it has brought to its last value. */
struct dea_loaded {
  struct dea_control control;
  double value; // of the design's key, SI
};

/* Whether a design asks for it. */
bool dea_loading_asked(const struct dea_design *design);
/* Gives the job a model at the end of the line at a voltage, the caller's to destroy, and where it
 * is. On failure there is none. */
dea_status dea_loading_end(struct dea_context *ctx, struct dea_study_job *job, double voltage_V,
                           struct dea_load_point *at, struct dea_loaded *loaded);

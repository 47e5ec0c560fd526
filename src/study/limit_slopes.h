/* Of the study "sensitivity": what moves the voltages at which the film comes to an end. */
#pragma once

#include "study/study.h"

/* Adds the model's tables "limits" and "limit_slopes": loss of tension, breakdown and pull-in, each
 * where the result's curves have come to it, or where the result has none, up to the highest
 * voltage of the design. */
dea_status dea_limit_slopes_add(struct dea_context *ctx, const struct dea_study_job *job);

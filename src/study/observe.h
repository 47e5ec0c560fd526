/* Monitors and channels of a device in the tables of a result. */
#ifndef DEA_STUDY_OBSERVE_H
#define DEA_STUDY_OBSERVE_H

#include "model/model.h"
#include "result/figure.h"
#include "result/result.h"

/* Adds a row for each monitor and channel at the last point solved to the model's tables "monitors"
 * and "channels", which are made by the first. Nothing for a device that has none, and for a model
 * that knows none. */
dea_status dea_study_observe(struct dea_context *ctx, const struct dea_model_type *type,
                             struct dea_model *model, double voltage_V, struct dea_result *result);

/* Figures of these tables, for the study sweep. */
enum { DEA_OBSERVE_FIGURES = 3 };
extern const struct dea_figure dea_observe_figures[DEA_OBSERVE_FIGURES];

#endif

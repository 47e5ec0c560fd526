/* Parts of summary.json: what studies of several computations say. */
#ifndef DEA_OUTPUT_SUMMARY_STUDIES_H
#define DEA_OUTPUT_SUMMARY_STUDIES_H

#include "base/json.h"
#include "result/result.h"

/* All points of a curve (NULL: none) as objects in a list. NULL when memory is short. */
json_t *dea_points_json(const struct dea_curve *curve);

/* Adds `transient` of a model to its object where the result has that study. */
dea_status dea_summary_put_transient(struct dea_context *ctx, const struct dea_result *result,
                                     const char *model, json_t *object);
/* Adds `convergence` and `designs` of a model to its object where the result has those studies. */
dea_status dea_summary_put_studies(struct dea_context *ctx, const struct dea_result *result,
                                   const char *model, json_t *object);

#endif

/* Parts of summary.json: what studies of several computations say. */
#ifndef DEA_OUTPUT_SUMMARY_STUDIES_H
#define DEA_OUTPUT_SUMMARY_STUDIES_H

#include "output/json.h"
#include "result/result.h"

/* A load point as an object. NULL when memory is short. */
json_t *dea_point_json(const struct dea_load_point *point);

/* Adds `transient` of a model, the same way. */
dea_status dea_summary_put_transient(struct dea_context *ctx, const struct dea_result *result,
                                     const char *model, json_t *object);
/* Adds `convergence` and `designs` of a model to its object where the result has those studies. */
dea_status dea_summary_put_studies(struct dea_context *ctx, const struct dea_result *result,
                                   const char *model, json_t *object);

#endif

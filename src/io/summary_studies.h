/* Parts of summary.json: what studies say. */
#pragma once

#include "base/json.h"
#include "result/result.h"

/* All points of a curve (NULL: none) as objects in a list. NULL when memory is short. */
json_t *dea_points_json(const struct dea_context *ctx, const struct dea_curve *curve);

/* Adds the tables that studies made of a model, and the points of curves that are listed, to the
 * model's object. */
void dea_summary_add_studies(const struct dea_context *ctx, const struct dea_result *result,
                             const char *model, json_t *object);

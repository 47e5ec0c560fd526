/* MODEL_state.h5: the state of a model after a point of a sweep. */
#ifndef DEA_OUTPUT_STATE_FILE_H
#define DEA_OUTPUT_STATE_FILE_H

#include "model/model.h"

enum { DEA_STATE_SCHEMA = 1 };

/* points: of the sweep that the state stands after. Of marks (what the state belongs to) the
 * SHA-256 is kept. */
dea_status dea_state_file_write(struct dea_context *ctx, const struct dea_model_type *type,
                                struct dea_model *model, size_t points, const char *path);
/* Brings a model, made for the same device, to the state of a file. DEA_E_ARGUMENT with what
 * differs when it was left by another version or belongs to another mesh, other materials or the
 * like; DEA_E_IO when it cannot be read. */
dea_status dea_state_file_read(struct dea_context *ctx, const struct dea_model_type *type,
                               struct dea_model *model, const char *path);
/* Number of points only. */
dea_status dea_state_file_points(struct dea_context *ctx, const char *path, size_t *points);

#endif

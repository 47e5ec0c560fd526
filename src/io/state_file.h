/* MODEL_state.h5: the state of a model after a point of a sweep. */
#pragma once

#include "result/state.h"

enum { DEA_STATE_SCHEMA = 3 };

/* Points and events of the sweep up to a state. */
struct dea_state_reach {
  size_t points, events;
};

/* Of marks (what the state belongs to) the
 * SHA-256 is kept. */
dea_status dea_state_file_write(struct dea_context *ctx, const char *model,
                                const struct dea_state *state, struct dea_state_reach reach,
                                const char *path);
/* Reads the arrays of `wanted`. DEA_E_ARGUMENT with what differs when the state was left by another
 * version or belongs to another mesh, other materials or the like; DEA_E_IO when it cannot be read.
 * Values of out: owned by the caller (dea_state_free_values), also after a failure. */
dea_status dea_state_file_read(struct dea_context *ctx, const char *model,
                               const struct dea_state *wanted, const char *path,
                               struct dea_state *out);
/* How far it is only. */
dea_status dea_state_file_reach(struct dea_context *ctx, const char *path,
                                struct dea_state_reach *reach);

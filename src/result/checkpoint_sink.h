/* Who keeps a sweep as it goes, so that what is there outlives its end. */
#pragma once

#include "result/result.h"
#include "result/state.h"

/* Plain data only: who keeps them asks no model. A failure ends the sweep. */
struct dea_checkpoint_sink {
  void *user;
  /* Before the first solve of a curve that has points: the state of that model to go on from.
   * wanted: the arrays and marks that it has to have. Values of out: owned by the caller
   * (dea_state_free_values), also after a failure. */
  dea_status (*restore)(struct dea_context *ctx, void *user, const char *model,
                        const struct dea_state *wanted, struct dea_state *out);
  /* Set where there is no going on from that state, so that nothing of it may be written over. */
  bool *refused;
  /* After a point was added to a curve of the result. fields, state: at that point, lent; NULL:
   * not wanted, or the model has none. */
  dea_status (*point)(struct dea_context *ctx, void *user, const struct dea_result *result,
                      const struct dea_curve *curve, const struct dea_field_mesh *fields,
                      const struct dea_state *state);
};

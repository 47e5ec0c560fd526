/* What a run keeps while it goes: results.h5 and the state of the model after every point, and the
 * fields that the design asks for. So an end at any time costs one point, and the run can go on. */
#pragma once

#include "result/checkpoint_sink.h"

/* The name of the folder of fields within a run folder. */
#define DEA_FIELD_FOLDER "fields"

struct dea_keep {
  const char *directory; // lent; NULL: nothing is kept
  bool refused; // a model could not go on from its state: the folder is another run's then and has
                // to stay as it is
  /* For the services of a run. Models that are quick (without fields or a state) leave nothing on
   * the way; a model whose curve has points starts from its state in the folder. */
  struct dea_checkpoint_sink sink;
};

/* For a run into a folder that exists. keep: stays where it is while the sink is used. */
void dea_checkpoint_begin(struct dea_keep *keep, const char *directory);

/* Brings the sweeps of models that left a state in the folder, up to the point of that state, into
 * a result that has its design: they go on from there. DEA_E_IO when there is no such run or it
 * cannot be read, DEA_E_DESIGN when its voltages up to there are not those of the design, with the
 * place of the voltages. */
dea_status dea_checkpoint_restore(struct dea_context *ctx, const char *directory,
                                  struct dea_result *result);

/* Shapes of modes that a result has, as fields for ParaView: fields/MODEL_modal_0000.vtu, one for
 * each voltage; and what it has of electrodes with a sheet resistance, fields/MODEL_transient_...
 * of points in time. */
dea_status dea_checkpoint_shapes(struct dea_context *ctx, const struct dea_result *result,
                                 const char *directory);

/* Removes what a model has kept in a folder: its state, and the fields of a sweep of that many
 * points. */
void dea_checkpoint_forget(struct dea_context *ctx, const char *directory, const char *model,
                           size_t count);

/* The lowest frequency of a model, for tests of its gradients. Include after context_fixture.h. */
#pragma once

#include "model/model.h"
#include "testing.h"

/* Of a model at its last point [Hz]. */
static double frequency_of(const struct dea_model_type *type, struct dea_model *model,
                           const struct dea_load_point *point)
{
  struct dea_load_point mode;
  struct dea_field_mesh *shapes;
  if (type->modes(ctx, model, point, 1, &mode, &shapes) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  dea_field_mesh_destroy(ctx, shapes);
  return mode.frequency_Hz;
}

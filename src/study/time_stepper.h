/* Steps in time of a model, each as long as its estimated error allows (docs/theory/time.md). */
#pragma once

#include "model/model.h"

struct dea_stepper {
  double next_s, longest_s; // next step, adapted; any step
  double shortest_s;        // step below which the error is given up
  double failing_s;         // the same of a step that fails
  double tolerance;         // of the error of a step
  /* What is asked for at the end of a step, `to_s`, into *step; last: that is the stepper's end. */
  void (*set)(void *user, double to_s, bool last, struct dea_time_step *step);
  void *user;
};

/* One accepted step from *time_s, where it ends, at most to end_s. *last: it has come there. */
dea_status dea_stepper_step(struct dea_context *ctx, struct dea_stepper *stepper,
                            const struct dea_model_type *type, struct dea_model *model,
                            double end_s, double *time_s, bool *last, struct dea_load_point *out);

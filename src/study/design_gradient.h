/* Slopes of a model's answers by the numbers of a design (docs/theory/gradients.md). */
#pragma once

#include "study/critical.h"
#include "study/numbers.h"

/* What is asked of a model that stands at a voltage. All lent. */
struct dea_design_gradient {
  const struct dea_model_type *type;
  struct dea_model *model; // of this design and device, at its last point
  const struct dea_design *design;
  const struct dea_device *device;
  double voltage_V;
  const struct dea_pressed *pressed;       // the tip of the model; NULL: it has none
  const struct dea_design_number *numbers; // [number_count]
  size_t number_count;
  struct dea_gradient_request of; // of what; its changes are those of the numbers
};

/* slopes [number_count][dea_gradient_width], SI of the quantity by SI of the number: NAN
 * where the model knows none, or its mesh cannot follow. */
dea_status dea_design_gradient_find(struct dea_context *ctx, const struct dea_design_gradient *ask,
                                    double *slopes);

/* slopes [number_count] of a critical voltage that was found of the device; model, voltage and
 * what slopes are of are not looked at. NAN as above, and by "voltage". */
dea_status dea_design_gradient_critical(struct dea_context *ctx,
                                        const struct dea_design_gradient *ask,
                                        const struct dea_critical *critical, double *slopes);

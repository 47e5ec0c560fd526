/* One load line of study "force": a model that a tip is pressed into goes through voltages, of
 * which those that lie between others on a smooth line are interpolated. */
#pragma once

#include "model/model.h"
#include "result/result.h"

/* What is asked. All lent. */
struct dea_force_line {
  const struct dea_model_type *type;
  struct dea_model *model;         // pressed, at 0 V
  const struct dea_device *device; // whose monitors are read; NULL: none
  const struct dea_state *pressed; // what it is there; NULL: it cannot go back to that
  const double *voltages_V;        // [count]
  size_t count;
  double tolerance; // of what the force changes by; 0: every voltage is computed
};

/* Adds the points of all voltages to a curve, interpolated ones among them
 * (docs/theory/loads.md, "Voltages between computed ones"). Where it fails, as the model's `solve`
 * or DEA_E_INTERRUPTED, those before are added, when interrupted only computed ones. */
dea_status dea_force_line_compute(struct dea_context *ctx, const struct dea_force_line *asked,
                                  struct dea_curve *curve);

/* Study "frequency": amplitude and phase of the displacements that a small ripple of the voltage
 * makes about a bias. */
#include "study/study.h"

#include <math.h>
#include <stdio.h>

/* One bias: its equilibrium, then all frequencies. */
static dea_status take_bias(struct dea_context *ctx, const struct dea_model_type *type,
                            struct dea_model *model, const struct dea_design *design, double bias_V,
                            struct dea_curve *curve)
{
  size_t count = (size_t)design->compute.frequency.points.si;
  double from = design->compute.frequency.from_Hz.si, to = design->compute.frequency.to_Hz.si;
  const struct dea_ripple ripple = {
      .amplitude_V = design->compute.frequency.ripple_V.si,
      .damping_ratio = design->compute.frequency.damping.si,
      .damping_mass_per_s = design->compute.frequency.damping_mass_per_s.si,
      .damping_stiffness_s = design->compute.frequency.damping_stiffness_s.si};
  struct dea_load_point at;
  DEA_TRY(ctx, type->solve(ctx, model, bias_V, &at));
  double *frequency_Hz = dea_alloc(ctx, count, sizeof *frequency_Hz);
  struct dea_load_point *points = dea_alloc(ctx, count, sizeof *points);
  dea_status status = frequency_Hz != NULL && points != NULL ? DEA_OK : DEA_E_MEMORY;
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    frequency_Hz[i] = from * pow(to / from, (double)i / (double)(count - 1));
  }
  if (status == DEA_OK) {
    status = type->respond(ctx, model, &at, &ripple, frequency_Hz, count, points);
  }
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    status = dea_curve_add_point(ctx, curve, &points[i]);
  }
  dea_free(ctx, frequency_Hz);
  dea_free(ctx, points);
  return status;
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  (void)model; // it stays where the sweep has brought it
  const struct dea_design *design = result->design;
  size_t total = design->compute.frequency.bias_count;
  struct dea_model *own;
  struct dea_curve *curve;
  char what[DEA_NAME_SIZE + 16];
  if (type->respond == NULL) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_place){0},
                                 "model %s has no mass: no study of its frequency response",
                                 type->name));
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, type->name, "frequency", &curve));
  snprintf(what, sizeof what, "%s frequency", type->name);
  dea_status status = type->create(ctx, result->device, &own);
  for (size_t i = 0; i < total && status == DEA_OK; i++) {
    status = take_bias(ctx, type, own, design, design->compute.frequency.biases_V[i].si, curve);
    if (status == DEA_OK) {
      dea_progress(ctx, what, i + 1, total);
    }
  }
  type->destroy(ctx, own);
  DEA_TRY(ctx, dea_curve_end(ctx, curve, status));
  return DEA_OK;
}

static bool asked(const struct dea_design *design)
{
  return design->compute.frequency.bias_count > 0;
}

const struct dea_study dea_study_frequency = {
    .name = "frequency", .asked = asked, .needs = "compute.frequency.bias", .run = run};

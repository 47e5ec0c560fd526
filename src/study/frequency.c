/* Study "frequency": amplitude and phase of the displacements that a small AC excitation of the
 * voltage makes about a bias. */
#include "study/study.h"

#include <math.h>

/* All frequencies at one bias. */
static dea_status take(struct dea_context *ctx, const struct dea_model_type *type,
                       struct dea_model *model, const struct dea_load_point *at, size_t stop,
                       struct dea_result *result, struct dea_curve *curve)
{
  (void)stop;
  const struct dea_design *design = result->design;
  size_t count = (size_t)design->compute.frequency.points.si;
  double from = design->compute.frequency.from_Hz.si, to = design->compute.frequency.to_Hz.si;
  const struct dea_ac_excitation excitation = {
      .amplitude_V = design->compute.frequency.ripple_V.si,
      .damping_ratio = design->compute.frequency.damping.si,
      .damping_mass_per_s = design->compute.frequency.damping_mass_per_s.si,
      .damping_stiffness_s = design->compute.frequency.damping_stiffness_s.si};
  double *frequency_Hz = dea_alloc(ctx, count, sizeof *frequency_Hz);
  struct dea_load_point *points = dea_alloc(ctx, count, sizeof *points);
  dea_status status = frequency_Hz != NULL && points != NULL ? DEA_OK : DEA_E_MEMORY;
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    frequency_Hz[i] = from * pow(to / from, (double)i / (double)(count - 1));
  }
  if (status == DEA_OK) {
    status = dea_model_respond(ctx, type, model, at, &excitation, frequency_Hz, count, points);
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
  (void)model; // none
  const struct dea_design *design = result->design;
  double biases_V[DEA_DESIGN_STOPS_MAX];
  for (size_t i = 0; i < design->compute.frequency.bias_count; i++) {
    biases_V[i] = design->compute.frequency.biases_V[i].si;
  }
  DEA_TRY(ctx, dea_study_stop_by_stop(ctx, type, result, "frequency", type->respond != NULL,
                                      biases_V, design->compute.frequency.bias_count, take));
  return DEA_OK;
}

static bool asked(const struct dea_design *design)
{
  return design->compute.frequency.bias_count > 0;
}

const struct dea_study dea_study_frequency = {.name = "frequency",
                                              .asked = asked,
                                              .needs = "compute.frequency.bias",
                                              .own_models = true,
                                              .run = run};

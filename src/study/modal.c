/* Study "modal": frequencies and shapes of small vibrations about voltages. */
#include "study/study.h"

#include <stdio.h>

/* The modes at one voltage. */
static dea_status take(struct dea_context *ctx, const struct dea_model_type *type,
                       struct dea_model *model, const struct dea_load_point *at, size_t stop,
                       struct dea_result *result, struct dea_curve *curve)
{
  size_t count = (size_t)result->design->compute.modal.count.si;
  struct dea_load_point points[DEA_DESIGN_MODES_MAX];
  struct dea_field_mesh *shapes;
  char name[DEA_NAME_SIZE];
  DEA_TRY(ctx, dea_model_modes(ctx, type, model, at, count, points, &shapes));
  snprintf(name, sizeof name, "%.50s" DEA_SHAPES_SUFFIX, type->name);
  DEA_TRY(ctx, dea_result_add_surface(ctx, result, name, stop, at->voltage_V, shapes));
  for (size_t k = 0; k < count; k++) {
    DEA_TRY(ctx, dea_curve_add_point(ctx, curve, &points[k]));
  }
  return DEA_OK;
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  (void)model; // none
  const struct dea_design *design = result->design;
  double voltages_V[DEA_DESIGN_STOPS_MAX];
  size_t count = dea_study_stops(design, design->compute.modal.voltages_V,
                                 design->compute.modal.voltage_count, true, voltages_V);
  DEA_TRY(ctx, dea_study_stop_by_stop(ctx, type, result, "modal", type->modes != NULL, voltages_V,
                                      count, take));
  return DEA_OK;
}

static bool asked(const struct dea_design *design)
{
  return design->compute.modal.asked;
}

const struct dea_study dea_study_modal = {
    .name = "modal", .asked = asked, .own_models = true, .run = run};

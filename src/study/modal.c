/* Study "modal": frequencies and shapes of small vibrations about voltages. */
#include "study/study.h"

#include <stdio.h>

/* One voltage: its equilibrium, then its modes. */
static dea_status take_modes(struct dea_context *ctx, const struct dea_model_type *type,
                             struct dea_model *model, double voltage_V, size_t number,
                             struct dea_result *result, struct dea_curve *curve)
{
  size_t count = (size_t)result->design->compute.modal.count.si;
  struct dea_load_point at, points[DEA_DESIGN_MODES_MAX];
  struct dea_field_mesh *shapes;
  char name[DEA_NAME_SIZE];
  DEA_TRY(ctx, type->solve(ctx, model, voltage_V, &at));
  DEA_TRY(ctx, type->modes(ctx, model, &at, count, points, &shapes));
  snprintf(name, sizeof name, "%.50s" DEA_SHAPES_SUFFIX, type->name);
  DEA_TRY(ctx, dea_result_add_surface(ctx, result, name, number, voltage_V, shapes));
  for (size_t k = 0; k < count; k++) {
    DEA_TRY(ctx, dea_curve_add_point(ctx, curve, &points[k]));
  }
  return DEA_OK;
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  (void)model; // it stays where the sweep has brought it
  const struct dea_design *design = result->design;
  double voltages_V[DEA_DESIGN_STOPS_MAX];
  struct dea_model *own;
  struct dea_curve *curve;
  char what[DEA_NAME_SIZE + 8];
  if (type->modes == NULL) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_place){0},
                                 "model %s has no mass: no study of its vibrations", type->name));
    return DEA_OK;
  }
  size_t total = dea_study_stops(design, design->compute.modal.voltages_V,
                                 design->compute.modal.voltage_count, true, voltages_V);
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, type->name, "modal", &curve));
  snprintf(what, sizeof what, "%s modal", type->name);
  dea_status status = type->create(ctx, result->device, &own);
  for (size_t i = 0; i < total && status == DEA_OK; i++) {
    status = take_modes(ctx, type, own, voltages_V[i], i, result, curve);
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
  return design->compute.modal.asked;
}

const struct dea_study dea_study_modal = {.name = "modal", .asked = asked, .run = run};

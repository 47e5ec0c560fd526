#include "model/make.h"

dea_status dea_model_build(
    struct dea_context *ctx, size_t size, const struct dea_device *device,
    const struct dea_model_settings *settings,
    dea_status (*prepare)(struct dea_context *ctx, const struct dea_device *device,
                          const struct dea_model_settings *settings, struct dea_model *model),
    void (*destroy)(struct dea_context *ctx, struct dea_model *model), struct dea_model **out)
{
  static const struct dea_model_settings usual = {0};
  *out = NULL;
  struct dea_model *model = dea_alloc(ctx, 1, size);
  DEA_TRY_MEMORY(model != NULL);
  DEA_TRY_ELSE(ctx, prepare(ctx, device, settings != NULL ? settings : &usual, model),
               destroy(ctx, model));
  *out = model;
  return DEA_OK;
}

dea_status dea_model_report_passed(struct dea_context *ctx, const char *name, double from_V,
                                   double to_V, const struct dea_event *passed)
{
  return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                         "model %s: from %.6g to %.6g kV it snaps past a limit point, %s at %.6g "
                         "kV, to another state",
                         name, 1e-3 * from_V, 1e-3 * to_V,
                         passed->kind == DEA_EVENT_PULL_IN ? "pull-in or snapping through"
                                                           : "snapping back",
                         1e-3 * passed->point.voltage_V);
}

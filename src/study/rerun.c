#include "study/rerun.h"

/* Statuses after which the work cannot go on. */
static bool is_fatal(dea_status status)
{
  return status == DEA_E_MEMORY || status == DEA_E_INTERRUPTED || status == DEA_E_TOOL;
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      const struct dea_design_bytes *file, const struct dea_device_param *params,
                      size_t count, const double *p, const char *const names[], size_t name_count,
                      struct dea_result **out)
{
  struct dea_design *design;
  struct dea_device *device;
  *out = NULL;
  dea_status status = dea_device_params_build(ctx, file, params, count, p, &design, &device);
  status = status == DEA_OK ? dea_result_create(ctx, design, device, out) : status;
  if (status == DEA_OK) {
    (*out)->surface_bytes_max = 0; // nobody looks at them
    status = dea_study_run(ctx, type, names, name_count, *out);
  }
  if (*out != NULL) {
    (*out)->design = NULL; // both end here
    (*out)->device = NULL;
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  if (status != DEA_OK && !is_fatal(status)) { // what there is of its curves counts
    dea_context_clear(ctx);
    status = DEA_OK;
  }
  return status;
}

const struct dea_rerun dea_rerun_designs = {.find = dea_device_param_find,
                                            .read_std = dea_device_param_std,
                                            .show = dea_device_param_show,
                                            .run = run};

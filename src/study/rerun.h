/* What study "uncertainty" asks of who runs it: numbers of the design by their keys, and studies of
 * the same design with other numbers. It is handed over by who runs it, as a study that read
 * designs itself would tie the reader of designs, which knows all studies, to itself. */
#pragma once

#include "study/device_param.h"
#include "study/study.h"

struct dea_rerun {
  dea_status (*find)(struct dea_context *ctx, const struct dea_device_param_source *source,
                     const struct dea_label *name, struct dea_device_param *out,
                     bool *good); // dea_device_param_find
  dea_status (*read_std)(struct dea_context *ctx, const struct dea_device_param *param,
                         const struct dea_label *text, double *std,
                         bool *good); // dea_device_param_std
  void (*show)(const struct dea_device_param *param, double value,
               char out[80]); // dea_device_param_show
  /* Studies names [name_count] of the design with p [count] in place of its values. *out: their
   * curves, as far as they came; without design and device; owned by the caller, NULL where the
   * device cannot be built or memory is short. DEA_OK also where a study failed for a reason of
   * that device. */
  dea_status (*run)(struct dea_context *ctx, const struct dea_model_type *type,
                    const struct dea_design_bytes *file, const struct dea_device_param *params,
                    size_t count, const double *p, const char *const names[], size_t name_count,
                    struct dea_result **out);
};

/* For the services of a run. */
extern const struct dea_rerun dea_rerun_designs;

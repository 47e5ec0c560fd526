/* A design, its device and an empty result for a study, made from a text; after the header whose
 * context it is made with. */
#pragma once

#include "design_text.h"
#include "result/result.h"

struct run {
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
};

static inline struct run run_begin(const char *text, const struct dea_override *sets, size_t count)
{
  struct run run;
  dea_status status = read_and_build(ctx, text, sets, count, &run.design, &run.device);
  if (status != DEA_OK) {
    print_findings(ctx);
  }
  assert_int_equal(status, DEA_OK);
  assert_int_equal(dea_result_create(ctx, run.design, run.device, &run.result), DEA_OK);
  return run;
}

static inline void run_end(struct run *run)
{
  dea_result_destroy(ctx, run->result);
  dea_device_destroy(ctx, run->device);
  dea_design_destroy(ctx, run->design);
}

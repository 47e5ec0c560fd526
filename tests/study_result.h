/* A design, its device and an empty result for a study, made from a text; after the header whose
 * context it is made with. */
#pragma once

#include "design_text.h"
#include "result/result.h"

static struct dea_design *design;
static struct dea_device *device;
static struct dea_result *result;

static inline void set_up_result(const char *text, const struct dea_override *sets, size_t count)
{
  dea_status status = read_and_build(ctx, text, sets, count, &design, &device);
  if (status != DEA_OK) {
    print_findings(ctx);
  }
  assert_int_equal(status, DEA_OK);
  assert_int_equal(dea_result_create(ctx, design, device, &result), DEA_OK);
}

static inline void tear_down_result(void)
{
  dea_result_destroy(ctx, result);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

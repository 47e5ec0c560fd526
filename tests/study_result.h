/* The one design, device and result of a test; after the header whose context they are made with.
 */
#pragma once

#include "study_run.h"

static struct dea_design *design;
static struct dea_device *device;
static struct dea_result *result;

static inline void set_up_result(const char *text, const struct dea_override *sets, size_t count)
{
  const struct run run = run_begin(text, sets, count);
  design = run.design;
  device = run.device;
  result = run.result;
}

static inline void tear_down_result(void)
{
  run_end(&(struct run){design, device, result});
}

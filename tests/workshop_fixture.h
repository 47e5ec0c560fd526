/* One workshop at a time, made from the text of a design; TESTS(workshop_set_up,
 * workshop_tear_down). */
#pragma once

#include "design_text.h"
#include "fabricate/workshop.h"

static struct dea_context *ctx;
static struct dea_design *design;
static struct dea_device *device;
static struct dea_workshop *workshop;

static inline void workshop_clear(void)
{
  dea_workshop_destroy(ctx, workshop);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  workshop = NULL;
  device = NULL;
  design = NULL;
  dea_finding_clear(ctx);
}

static inline dea_status workshop_make(const char *text, const struct dea_override *sets,
                                       size_t count)
{
  workshop_clear();
  dea_status status = read_and_build(ctx, text, sets, count, &design, &device);
  return status == DEA_OK ? dea_workshop_create(ctx, design, device, &workshop) : status;
}

static inline const struct dea_part *workshop_find(const char *name)
{
  for (size_t i = 0; i < workshop->count; i++) {
    if (strcmp(workshop->part[i].name, name) == 0) {
      return &workshop->part[i];
    }
  }
  return NULL;
}

static inline int workshop_set_up(void **state)
{
  return dea_context_create(NULL, &ctx) == DEA_OK ? 0 : -1;
}

static inline int workshop_tear_down(void **state)
{
  workshop_clear();
  dea_context_destroy(ctx);
  return 0;
}

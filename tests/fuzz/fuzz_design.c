/* Fuzz target: reading a design and building its device. */
#include "device/device.h"
#include "study/design_file.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  // One context for all inputs: reading the unit table takes longer than reading a design.
  static struct dea_context *ctx;
  struct dea_design *design = NULL;
  struct dea_device *device = NULL;
  if (ctx == NULL && dea_context_create(NULL, &ctx) != DEA_OK) {
    return 0;
  }
  dea_status status =
      dea_design_read_memory(ctx, "fuzz.yaml", (const char *)data, size, NULL, 0, &design);
  if (status == DEA_OK) {
    status = dea_device_build(ctx, design, &device);
  }
  if (status == DEA_E_DESIGN && dea_finding_count(ctx, DEA_ERROR) == 0) {
    __builtin_trap(); // an error that nobody is told about
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return 0;
}

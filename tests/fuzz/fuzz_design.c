/* Fuzz target: reading a design and building its device. */
#include "fuzz.h"

#include "device/device.h"
#include "study/design_file.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx = fuzz_begin();
  struct dea_design *design = NULL;
  struct dea_device *device = NULL;
  dea_status status =
      dea_design_read_memory(ctx, "fuzz.yaml", (const char *)data, size, NULL, 0, &design);
  status = status == DEA_OK ? dea_device_build(ctx, design, &device) : status;
  fuzz_check_findings(ctx, status);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  return 0;
}

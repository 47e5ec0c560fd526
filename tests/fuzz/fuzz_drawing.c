/* Fuzz target: DXF and SVG files, and their layers as regions. */
#include "fuzz.h"

#include "geometry/drawing.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static void read_as(struct dea_context *ctx, bool svg, const char *bytes, size_t size)
{
  static const struct dea_drawing_settings settings = {.vertices_max = 2000};
  struct dea_drawing *drawing = NULL;
  dea_status status = (svg ? dea_drawing_read_svg : dea_drawing_read_dxf)(ctx, "fuzz", bytes, size,
                                                                          &settings, &drawing);
  for (size_t i = 0; status == DEA_OK && i < drawing->layer_count && i < 10; i++) {
    struct dea_region region = {.ctx = ctx};
    const struct dea_location here = {"", 0, 0};
    dea_finding_clear(ctx);
    if (dea_drawing_region(drawing, drawing->layer[i], here, &region) == DEA_OK &&
        !(dea_region_area_m2(&region) > 0)) {
      __builtin_trap(); // a region without an area
    } else if (region.contour_count == 0 && dea_finding_count(ctx, DEA_ERROR) == 0) {
      __builtin_trap(); // an error that nobody is told about
    }
    dea_region_free(&region);
  }
  fuzz_check_findings(ctx, status);
  dea_drawing_destroy(drawing);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx;
  if (dea_context_create(NULL, &ctx) != DEA_OK) { // one each: names of layers stay in it
    return 0;
  }
  char *bytes = malloc(size + 1);
  if (bytes != NULL) {
    memcpy(bytes, data, size);
    bytes[size] = '\0';
    read_as(ctx, false, bytes, size);
    read_as(ctx, true, bytes, size);
  }
  free(bytes);
  dea_context_destroy(ctx);
  return 0;
}

#include "fabricate/cairo_canvas.h"

#include "base/module.h"

dea_status dea_canvas_open(struct dea_context *ctx, const struct dea_canvas_type **out)
{
  const void *type = NULL;
  DEA_TRY(ctx,
          dea_module_open(ctx, "dea_cairo_module.so", "dea_cairo_module", "what draws PDF files",
                          "it is built when libcairo2-dev is installed", &type));
  *out = type;
  return DEA_OK;
}

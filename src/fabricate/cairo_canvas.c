#include "fabricate/cairo_canvas.h"

#include "base/module.h"

static const char module_file[] = "dea_cairo_module.so";

bool dea_canvas_find(char *out, size_t size)
{
  return dea_module_find(module_file, out, size);
}

dea_status dea_canvas_open(struct dea_context *ctx, const struct dea_canvas_type **out)
{
  const void *type = NULL;
  DEA_TRY(ctx, dea_module_open(ctx, module_file, "dea_cairo_module", "what draws PDF files",
                               "it is built when libcairo2-dev is installed", &type));
  *out = type;
  return DEA_OK;
}

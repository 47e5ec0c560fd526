#include "base/file.h"
#include "geometry/drawing.h"

dea_status dea_drawing_read(struct dea_context *ctx, const char *file,
                            const struct dea_drawing_settings *settings, struct dea_drawing **out)
{
  char *bytes;
  size_t length;
  *out = NULL;
  bool svg = dea_path_ends_with(file, ".svg");
  if (!svg && !dea_path_ends_with(file, ".dxf")) {
    return dea_fail(ctx, DEA_E_DESIGN, "'%s' is neither a .dxf nor an .svg file", file);
  }
  DEA_TRY(ctx, dea_file_read(ctx, file, DEA_DRAWING_BYTES_MAX, &bytes, &length));
  dea_status status = svg ? dea_drawing_read_svg(ctx, file, bytes, length, settings, out)
                          : dea_drawing_read_dxf(ctx, file, bytes, length, settings, out);
  dea_free(ctx, bytes);
  return status;
}

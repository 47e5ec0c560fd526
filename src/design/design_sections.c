#include "design/design_sections.h"

#include "base/file.h"
#include "design/variants.h"

dea_status dea_design_read_memory_with(struct dea_context *ctx,
                                       const struct dea_design_sections *sections, const char *name,
                                       const char *bytes, size_t length,
                                       const struct dea_override *overrides, size_t override_count,
                                       struct dea_design **out)
{
  const struct dea_design_source source = {sections, name,      bytes,
                                           length,   overrides, override_count};
  DEA_TRY(ctx, dea_design_read_source(ctx, &source, NULL, out));
  dea_status status = dea_design_read_variants(ctx, &source, *out);
  if (status != DEA_OK) {
    dea_design_destroy(ctx, *out);
    *out = NULL;
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}

dea_status dea_design_read_with(struct dea_context *ctx, const struct dea_design_sections *sections,
                                const char *file, const struct dea_override *overrides,
                                size_t override_count, struct dea_design **out)
{
  char *bytes;
  size_t length;
  *out = NULL;
  DEA_TRY(ctx, dea_file_read(ctx, file, DEA_YAML_SIZE_MAX, &bytes, &length));
  dea_status status = dea_design_read_memory_with(ctx, sections, file, bytes, length, overrides,
                                                  override_count, out);
  dea_free(ctx, bytes);
  return status;
}

/* design.yaml: the design file as it was. */
#include "base/write_file.h"
#include "io/export.h"

static dea_status write(struct dea_context *ctx, const struct dea_result *result,
                        const char *directory)
{
  const char *input = result->provenance.input;
  return DEA_CHAIN(ctx, input != NULL ? dea_text_file_write(ctx, directory, "design.yaml", input)
                                      : DEA_OK);
}

const struct dea_export dea_export_design = {.file = "design.yaml", .write = write};

/* summary.json: the result for scripts. */
#include "base/write_file.h"
#include "io/export.h"
#include "io/summary.h"

static dea_status write(struct dea_context *ctx, const struct dea_result *result,
                        const char *directory)
{
  char *text;
  DEA_TRY(ctx, dea_summary_text(ctx, result, &text));
  dea_status status = dea_text_file_write(ctx, directory, "summary.json", text);
  dea_free(ctx, text);
  return status;
}

const struct dea_export dea_export_summary = {.file = "summary.json", .write = write};

/* results.h5: everything in one file. */
#include "base/write_file.h"
#include "io/export.h"
#include "io/results_h5.h"

static dea_status write(struct dea_context *ctx, const struct dea_result *result,
                        const char *directory)
{
  char *path = dea_path_join(ctx, directory, "results.h5");
  DEA_TRY_MEMORY(path != NULL);
  dea_status status = dea_results_h5_write(ctx, result, path);
  dea_free(ctx, path);
  return status;
}

const struct dea_export dea_export_results_h5 = {.file = "results.h5", .write = write};

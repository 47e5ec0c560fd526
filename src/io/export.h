/* What a run folder gets of a result beside figures and fields: one file export_<name>.c and one
 * line in export_list.h each. */
#pragma once

#include "io/export_list.h"
#include "result/result.h"

struct dea_export {
  /* Name of the one file that it writes: one of that name is not written over without --force, and
   * goes before a new run. NULL for tables, whose names are those of what the result holds. */
  const char *file;
  /* Writes into the run folder, each file as a whole. */
  dea_status (*write)(struct dea_context *ctx, const struct dea_result *result,
                      const char *directory);
};

#define DEA_EXPORT_DECLARE(name) extern const struct dea_export dea_export_##name;
DEA_EXPORT_LIST(DEA_EXPORT_DECLARE)
#undef DEA_EXPORT_DECLARE

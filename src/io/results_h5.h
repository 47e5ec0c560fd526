/* results.h5: everything of a run in one file, written and read. Schema in docs/formats.md. */
#pragma once

#include "result/result.h"

enum { DEA_RESULTS_H5_SCHEMA = 1 };

/* Writes the file as a whole or not at all. */
dea_status dea_results_h5_write(struct dea_context *ctx, const struct dea_result *result,
                                const char *path);

/* What a run folder holds. result->design and result->device are NULL. */
struct dea_run {
  struct dea_result *result; // owned
  char title[DEA_TITLE_SIZE];
  char design_file[1024];
  bool svg, pdf, png; // formats of figures that the design asked for
  double width_m;     // of figures
};

/* Reads results.h5 back, bit by bit what was written; path: the file or the run folder that has it.
 * DEA_E_IO when there is none or it is damaged, DEA_E_UNSUPPORTED for a newer schema. out: owned by
 * the caller, NULL on failure. */
dea_status dea_run_read(struct dea_context *ctx, const char *path, struct dea_run **out);
void dea_run_destroy(struct dea_context *ctx, struct dea_run *run);

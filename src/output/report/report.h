/* The report: runs as one self-contained HTML file (docs/report.md). */
#ifndef DEA_OUTPUT_REPORT_REPORT_H
#define DEA_OUTPUT_REPORT_REPORT_H

#include "base/context.h"

enum { DEA_REPORT_RUNS_MAX = 8 };

struct dea_report_options {
  const char *command;     // command line of the report, for its last line; NULL: none
  double finger_N_per_m;   // stiffness of a fingertip against which a load line is set; 0: none
  const char *measurement; // set beside the runs: CSV or folder (output/measured.h); NULL: none
};

/* Reads the runs (folders, or results.h5 files) and writes one page of them as a whole or not at
 * all. What a run does not have is left out; a run whose design cannot be built any more (a
 * material that is gone) has no drawing, and the page says why. path: of the file. DEA_E_ARGUMENT
 * for more than DEA_REPORT_RUNS_MAX runs or none, DEA_E_IO as dea_run_read or dea_measured_read.
 * Findings of the context are those of the last run afterwards: they stand in the page. */
dea_status dea_report_write(struct dea_context *ctx, const char *const runs[], size_t count,
                            const struct dea_report_options *options, const char *path);

#endif

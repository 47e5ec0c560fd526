/* The report of runs: reads them, computes what the page shows beyond what they have, writes. */
#pragma once

#include "report/report.h"

/* Reads the runs (folders, or results.h5 files) and writes one page of them as dea_report_write
 * does. Nothing is written into the runs: study operating-map of model lumped, where a run of a
 * disc lacks it, is made for the page. A run whose design cannot be built any more (a
 * material that is gone) has no drawing, and the page says why. DEA_E_ARGUMENT for more than
 * DEA_REPORT_RUNS_MAX runs or none, DEA_E_IO as dea_run_read or dea_measured_read. */
dea_status dea_job_report(struct dea_context *ctx, const char *const runs[], size_t count,
                          const struct dea_report_options *options, const char *path);

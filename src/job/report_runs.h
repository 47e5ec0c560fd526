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

// Its parts, for who shows runs otherwise:

/* Reads runs [count], zero-initialised: results, designs, models reduced. DEA_E_IO as dea_run_read.
 * To be closed after a failure, too; paths: lent until then. */
dea_status dea_report_runs_open(struct dea_context *ctx, const char *const paths[], size_t count,
                                struct dea_report_run runs[]);
void dea_report_runs_close(struct dea_context *ctx, struct dea_report_run runs[], size_t count);
/* Lends the runs of its design what the folder of a dea sweep of the plan sparse-grid has. bytes:
 * owned by the caller, NULL where none was read. DEA_E_IO: it has nothing; DEA_E_DESIGN: none of
 * the runs is of that design. */
dea_status dea_report_runs_explore(struct dea_context *ctx, const char *folder,
                                   struct dea_report_run runs[], size_t count, char **bytes);

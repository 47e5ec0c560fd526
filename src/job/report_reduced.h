/* What a report shows of a run's model reduced. */
#pragma once

#include "report/report.h"

/* Sets `reduced` (owned by the run), blocked_N and blocked_V of a run by that model whose design
 * names a file of dea reduce-order that is there; of others `reduced` stays NULL. */
dea_status dea_report_reduced(struct dea_context *ctx, struct dea_report_run *io);

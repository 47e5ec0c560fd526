/* Runs in the studio, drawn by sections of the report. */
#pragma once

#include "base/text.h"

#include <jansson.h>

enum { DEA_STUDIO_RUNS_MAX = 6 };

enum dea_studio_view {
  DEA_STUDIO_CURVES, // figures of one run, with their limits, or of several beside each other
  DEA_STUDIO_FILM,   // the film of the first in space, as a page of its own
  DEA_STUDIO_SLIDERS // the explorer of the first, as a page of its own
};

/* Adds HTML whose numbers the page's script finds. folder: that has runs [name], at most
 * DEA_STUDIO_RUNS_MAX, also ones that go on; measured: a table beside them, NULL: none; sweeps
 * [{name}]: folders of sweeps over numbers of designs. One thread at a time. DEA_E_IO as
 * dea_run_read, or of the table after findings. */
dea_status dea_studio_show(struct dea_context *ctx, const char *folder, const json_t *runs,
                           const char *measured, const json_t *sweeps, enum dea_studio_view view,
                           struct dea_text *out);

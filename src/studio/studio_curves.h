/* Curves of runs in the studio, as the report draws them. */
#pragma once

#include "base/text.h"

enum { DEA_STUDIO_RUNS_MAX = 6 };

/* Adds the figures of one run, with their limits, or of several beside each other, as HTML whose
 * numbers the page's script finds. paths [count]: folders of runs, also of ones that go on.
 * measured: table beside them; NULL: none. film: the film of the first in space instead, as a page.
 * One thread at a time. DEA_E_IO as dea_run_read, or of the table after findings. */
dea_status dea_studio_curves(struct dea_context *ctx, const char *const paths[], size_t count,
                             const char *measured, bool film, struct dea_text *out);

/* summary.json: the result of a run for scripts. Schema in docs/formats.md. */
#pragma once

#include "result/result.h"

enum { DEA_SUMMARY_SCHEMA = 1 };

/* JSON text of a result with a final newline, numbers of 17 digits, the order of keys fixed: what
 * summary.json holds and `dea run --json` prints; the context's notes and warnings with it. Numbers
 * that are not finite are left out. out: owned by the caller (dea_free), NULL on failure. */
dea_status dea_summary_text(struct dea_context *ctx, const struct dea_result *result, char **out);

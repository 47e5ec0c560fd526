/* Inside of the module that knows libmatio. */
#pragma once

#include "import/mat.h"

#include <matio.h>

/* Silences libmatio; before every use of it. */
void dea_matio_quiet(void);

dea_status dea_matio_write(struct dea_context *ctx, const char *file,
                           const struct dea_mat_variable *variables, size_t count,
                           enum dea_mat_version version);
/* Whether a file of version 5 holds as much as its variables say; DEA_E_IO. */
dea_status dea_matio_check(struct dea_context *ctx, const char *file);
dea_status dea_matio_read(struct dea_context *ctx, const char *file, struct dea_table *out);

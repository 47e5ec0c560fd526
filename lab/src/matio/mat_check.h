#pragma once

#include "import/mat.h"

#include <matio.h>

/* Whether a file of version 5 holds as much as its variables say; DEA_E_IO. */
dea_status dea_matio_check(struct dea_context *ctx, const char *file);

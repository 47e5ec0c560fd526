/* The kinds of files that people write, told by the first key of each. */
#pragma once

#include "base/yaml.h"

/* DEA_OK for a file whose first key is `own` ("dea", "dea_fit", ...) or nobody's. For one of
 * another kind a finding at its first key, which names the command that it is for, and
 * DEA_E_DESIGN. */
dea_status dea_file_kind_check(struct dea_context *ctx, const struct dea_yaml *document,
                               const char *own);

/* Names of models in a design or on the command line. */
#pragma once

#include "base/text.h"
#include "cli/cli.h"
#include "model/model.h"

/* Model of that name, or NULL after a finding at `place` that names those that there are. */
const struct dea_model_type *cli_model_find(struct dea_cli *cli, const char *name,
                                            struct dea_location location);
/* Value of `compute.compare` that names design files after their names without folder and ending:
 * paths count from here. */
void cli_designs_text(const char *const files[], size_t count, struct dea_text *out);

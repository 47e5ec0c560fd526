/* Tables of studies on the terminal. */
#pragma once

#include "result/result.h"

/* Prints the tables of a model that are for the screen. */
dea_status cli_print_tables(struct dea_context *ctx, const struct dea_result *result,
                            const char *model);

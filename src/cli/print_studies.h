/* Tables of studies for people, on stdout. */
#ifndef DEA_CLI_PRINT_STUDIES_H
#define DEA_CLI_PRINT_STUDIES_H

#include "result/result.h"

/* Meshes, estimated errors and the verdict of a model's study of convergence; nothing when there is
 * none. */
dea_status cli_print_convergence(struct dea_context *ctx, const struct dea_result *result,
                                 const char *model);

/* The last point of each design of a model's study compare-design; nothing when there is none. */
void cli_print_designs(const struct dea_result *result, const char *model);

/* Study transient: cycles, creep and balance of energy of a model. Nothing without it. */
dea_status cli_print_transient(struct dea_context *ctx, const struct dea_result *result,
                               const char *model);

#endif

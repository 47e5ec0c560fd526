/* The files of a fit of life tests. */
#pragma once

#include "base/json.h"
#include "identify/life_fit.h"
#include "plot/plot.h"

json_t *dea_life_fit_json(const struct dea_life_fit *fit, const char *command);
/* As dea_fit_folder. */
dea_status dea_life_fit_folder(struct dea_context *ctx, const struct dea_life_file *file,
                               const char *directory, bool force);
/* Writes fit.csv, a row a specimen, fit.json and, where there is a law, figure fit. */
dea_status dea_life_fit_write(struct dea_context *ctx, const struct dea_life_fit *fit,
                              const char *command, const struct dea_plot_format *format,
                              const char *directory);

/* The files of a fit of breakdown tests. */
#pragma once

#include "base/json.h"
#include "identify/breakdown_fit.h"
#include "plot/plot.h"

json_t *dea_breakdown_fit_json(const struct dea_breakdown_fit *fit, const char *command);
/* As dea_fit_folder. */
dea_status dea_breakdown_fit_folder(struct dea_context *ctx, const struct dea_breakdown_file *file,
                                    const char *directory, bool force);
/* Writes NAME.yaml, the catalogue's material with this law of breakdown, fit.csv, fit.json and
 * figure fit: the share of broken films over the field, by Kaplan and Meier and by the law with its
 * band of two standard uncertainties. */
dea_status dea_breakdown_fit_write(struct dea_context *ctx, const struct dea_breakdown_fit *fit,
                                   const char *command, const struct dea_plot_format *format,
                                   const char *directory);

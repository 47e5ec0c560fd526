/* The files of a fit of a material: the material, CSV, JSON and figures. */
#pragma once

#include "base/json.h"
#include "identify/fit.h"
#include "plot/plot.h"

/* Adds "yeoh.yaml": the material as the catalogue reads it. What is not fitted comes from the
 * catalogue's material that the fit file names. */
dea_status dea_fit_material_add(struct dea_context *ctx, const struct dea_fit *fit,
                                struct dea_text *out);
/* All of it; command: NULL for none. */
json_t *dea_fit_json(const struct dea_fit *fit, const char *command);

/* Makes the folder and takes the files of an earlier fit out of it; DEA_E_IO when it has one and
 * force is not set. */
dea_status dea_fit_folder(struct dea_context *ctx, const struct dea_fit_file *file,
                          const char *directory, bool force);
/* Writes NAME.yaml, fit.csv, fit.json and the figures. */
dea_status dea_fit_write(struct dea_context *ctx, const struct dea_fit *fit, const char *command,
                         const struct dea_plot_format *format, const char *directory);

/* Files of a fit of a device: design, CSV, JSON and figures. */
#pragma once

#include "base/json.h"
#include "identify/device_fit.h"
#include "plot/plot.h"

/* All of it; command: NULL for none. */
json_t *dea_device_fit_json(const struct dea_device_fit *fit, const char *command);
/* Makes the folder and takes the files of an earlier fit out of it; DEA_E_IO when it has one and
 * force is not set. */
dea_status dea_device_fit_folder(struct dea_context *ctx, const struct dea_device_file *file,
                                 const char *directory, bool force);
/* Writes NAME.yaml, fit.csv, fit.json and the figures. */
dea_status dea_device_fit_write(struct dea_context *ctx, const struct dea_device_fit *fit,
                                const char *command, const struct dea_plot_format *format,
                                const char *directory);

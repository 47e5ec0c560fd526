/* The files of a fit: NAME.yaml, fit.csv, fit.json and figures. */
#pragma once

#include "base/json.h"
#include "identify/breakdown_fit.h"
#include "identify/device_fit.h"
#include "identify/life_fit.h"
#include "plot/plot.h"

/* Where a fit is written to, and as what. force: in the place of an earlier fit, without which that
 * is DEA_E_IO. */
struct dea_fit_folder {
  const char *path;
  bool force;
  const char *command; // NULL: none
  const struct dea_plot_format *format;
};

/* fit.json; command: NULL for none. */
json_t *dea_fit_json(const struct dea_fit *fit, const char *command);
json_t *dea_device_fit_json(const struct dea_device_fit *fit, const char *command);
json_t *dea_breakdown_fit_json(const struct dea_breakdown_fit *fit, const char *command);
json_t *dea_life_fit_json(const struct dea_life_fit *fit, const char *command);

/* All files. NAME.yaml is the material as the catalogue reads it, with what was not fitted as the
 * material has it that the fit file names; of a device its design; of lives there is none. Figures
 * of the last two show the share that has failed, by Kaplan and Meier and by the law with its band
 * of two standard uncertainties. */
dea_status dea_fit_write(struct dea_context *ctx, const struct dea_fit *fit,
                         const struct dea_fit_folder *to);
dea_status dea_device_fit_write(struct dea_context *ctx, const struct dea_device_fit *fit,
                                const struct dea_fit_folder *to);
dea_status dea_breakdown_fit_write(struct dea_context *ctx, const struct dea_breakdown_fit *fit,
                                   const struct dea_fit_folder *to);
dea_status dea_life_fit_write(struct dea_context *ctx, const struct dea_life_fit *fit,
                              const struct dea_fit_folder *to);

/* Figures of a fit of a material and of a device. */
#pragma once

#include "identify/device_fit.h"
#include "identify/fit.h"
#include "plot/plot.h"

/* fit: stress over stretch; fit_time: over time; with bands of two standard uncertainties, and the
 * residuals below. */
dea_status dea_fit_draw(struct dea_context *ctx, const struct dea_fit *fit,
                        const struct dea_plot_format *format, const char *directory);
/* fit_KEY, and of transients fit_time_KEY, for each quantity that was measured: measurements with
 * the model, its band of two standard uncertainties and the design's answer over the voltage, and
 * the residuals below. */
dea_status dea_device_fit_draw(struct dea_context *ctx, const struct dea_device_fit *fit,
                               const struct dea_plot_format *format, const char *directory);

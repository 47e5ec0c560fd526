/* The figure of a fit of Weibull's law: how many have broken or failed, and the law. */
#pragma once

#include "identify/weibull.h"
#include "plot/plot.h"

/* All lent. Labels are gnuplot's enhanced text. */
struct dea_weibull_picture {
  const char *caption, *x_label, *y_label, *points; // points: key entry
  bool logarithmic;                                 // the values
  double factor;                                    // SI -> unit of the label
  size_t rows;
  const double *values; // [rows], on the reference
  const bool *survived; // [rows]
  const struct dea_weibull_fit *fit;
};

/* Writes figure "fit" into the folder: the share by Kaplan and Meier in the middle of each step,
 * survivors as marks at the foot, the law from 0.1 to 99.9 % with a band of two standard
 * uncertainties. Drawn as format says. */
dea_status dea_weibull_draw(struct dea_context *ctx, const struct dea_weibull_picture *picture,
                            const struct dea_plot_format *format, const char *directory);

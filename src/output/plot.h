/* A plot as gnuplot draws it (NAME.gp and NAME.dat). */
#ifndef DEA_OUTPUT_PLOT_H
#define DEA_OUTPUT_PLOT_H

#include "result/plot.h"

struct dea_plot_format {
  bool svg, pdf, png;
  double width_m;
};

/* Writes NAME.gp and NAME.dat into directory. */
dea_status dea_plot_write(struct dea_context *ctx, const struct dea_plot *plot,
                          const struct dea_plot_format *format, const char *directory);

#endif

/* Options on figures that more than one command takes. */
#ifndef DEA_CLI_FIGURE_OPTIONS_H
#define DEA_CLI_FIGURE_OPTIONS_H

#include "output/plot.h"

/* Reads "svg,pdf,png" in any order; false when a word is none of these. */
bool cli_read_formats(const char *text, struct dea_plot_format *format);
/* Reads a width in mm, 40 to 400; false otherwise. */
bool cli_read_width(const char *text, struct dea_plot_format *format);

#endif

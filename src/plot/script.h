/* What all gnuplot scripts begin with. */
#pragma once

#include "plot/plot.h"

/* The family of all figures, which packages.txt installs: the same in all formats. */
#define DEA_SCRIPT_FONT "DejaVu Sans"

/* The settings that a user may want to change, and those that hold for all figures. */
void dea_script_head(struct dea_text *gp, const char *name, const char *caption,
                     const struct dea_plot_format *format, double width_mm, double height_mm);
/* Opens the loop over the formats: terminal, sizes of signs and the file that is drawn into. The
 * caller closes it with "}". */
void dea_script_terminals(struct dea_text *gp);
/* Writes NAME.dat and NAME.gp; frees both texts. */
dea_status dea_script_write(const char *directory, const char *name, struct dea_text *gp,
                            struct dea_text *dat);

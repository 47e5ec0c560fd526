/* What gnuplot leaves out of its pictures. */
#pragma once

#include "plot/plot.h"

/* Completes NAME.svg and NAME.png in folder `pictures`, where they are there. DEA_E_TOOL where one
 * of the formats that were asked for is missing or empty. scripts: folder of NAME.gp, whose first
 * line has the caption. */
dea_status dea_picture_finish(struct dea_context *ctx, const char *pictures, const char *scripts,
                              const char *name, const struct dea_plot_format *format);

/* An SVG of gnuplot with the caption (plain text) as its title, a list of fonts to fall back on,
 * and facets that overlap a little, so that no seams show between them. *out: owned by the caller
 * (dea_free). */
dea_status dea_svg_finish(struct dea_context *ctx, const char *svg, const char *caption,
                          char **out);
/* A PNG file with its resolution, 300 dots an inch, so that documents show it in the size that was
 * asked for. One that has a resolution, or bytes that are no PNG, come back as they are. *out with
 * *out_length bytes: owned by the caller (dea_free). */
dea_status dea_png_finish(struct dea_context *ctx, const char *bytes, size_t length, char **out,
                          size_t *out_length);

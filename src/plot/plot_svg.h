/* A figure (plot/plot.h) as SVG within a page: colours by class, so that light, dark and print
 * each have theirs. */
#pragma once

#include "plot/plot.h"

/* Adds a <figure> with the plot, its caption and its numbers for the page's script; number: of the
 * figure on the page, for its ids. Nothing for a plot that shows nothing. */
void dea_plot_add_svg(struct dea_text *out, const struct dea_plot *plot, int number);

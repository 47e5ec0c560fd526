/* Drawing the figures of a run: those of figure_list.h, each a `const struct dea_figure`, and
 * those of the studies. */
#pragma once

#include "plot/plot.h"
#include "result/figure.h"

/* The i-th of all figures, those of the list and then those of the studies; NULL beyond the last.
 * Static storage. */
const struct dea_figure *dea_figure_get(size_t i);
enum { DEA_FIGURES_MAX = 64 };
/* Names of all figures, of those that are plots only if so wanted; returns their number. */
size_t dea_figure_names(bool plots, const char *out[DEA_FIGURES_MAX]);

/* names: figures wanted (NULL for all but those on request); one that does not exist is
 * DEA_E_ARGUMENT with the nearest name. Without any format only the scripts and data are written.
 */
struct dea_figure_options {
  const char *const *names;
  size_t name_count;
  struct dea_plot_format format;
  double voltage_V; // that figures of one state show, or the nearest there is; NAN: the last
};

/* Writes NAME.gp, NAME.dat and the pictures of every figure that has something to show. A figure
 * asked for by name that has nothing to show gives a note; no folder is left where none has.
 * drawn: their number; NULL where it is not wanted. */
dea_status dea_figures_write(struct dea_context *ctx, const struct dea_result *result,
                             const char *directory, const struct dea_figure_options *options,
                             size_t *drawn);

/* Range of colours for displacements between two values, and the palette: from dark blue over grey
 * to light yellow around 0 when both signs matter, else from dark to light: lightness rises all the
 * way, so that the sign is there in grey too. Unit of the colours: um. */
void dea_figure_add_palette(struct dea_text *gp, double low_m, double high_m);

/* What the figures of several curves beside one reference share. */
#ifndef DEA_OUTPUT_COMPARE_SET_PARTS_H
#define DEA_OUTPUT_COMPARE_SET_PARTS_H

#include "output/compare_set.h"

enum {
  DEA_SET_FIGURES_MAX = DEA_LOAD_POINT_COLUMNS * DEA_DESIGN_MODELS_MAX + DEA_MEASURED_COLUMNS + 1,
  DEA_SET_FIGURE_SIZE = 64
};

/* What is drawn so far. */
struct dea_set_figures {
  struct dea_context *ctx;
  const struct dea_compare_set *set;
  const struct dea_plot_format *format;
  const char *directory;
  char names[DEA_SET_FIGURES_MAX][DEA_SET_FIGURE_SIZE];
  size_t count;
};

/* A new plot of that name, to be filled and given to finish. */
dea_status dea_set_figure_begin(struct dea_set_figures *f, const char *name, const char *what,
                                struct dea_plot **plot);
/* Writes a plot that was filled with that status, if it shows anything, and destroys it. */
dea_status dea_set_figure_finish(struct dea_set_figures *f, struct dea_plot *plot,
                                 dea_status status);
/* Vertical range: that of the panel's series with their bands, and a little more. */
void dea_set_range(struct dea_panel *panel);
/* Puts the key above the panel in as many columns as its titles leave room for. */
void dea_set_key_above(const struct dea_set_figures *f, struct dea_panel *panel);

/* compare_history_KEY of each quantity. */
dea_status dea_set_draw_histories(struct dea_set_figures *f);

#endif

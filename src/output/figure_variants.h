/* What figures of several designs have in common: a colour a design; lines for the first model that
 * has something to show, lines with markers for the others. */
#ifndef DEA_OUTPUT_FIGURE_VARIANTS_H
#define DEA_OUTPUT_FIGURE_VARIANTS_H

#include "output/figure.h"

/* One curve of such a figure. */
struct dea_figure_variant {
  const struct dea_variant *variant; // lent
  struct dea_series look;            // without title
};

/* Variants of a study in the order of models and designs, at most `max`; returns their number.
 * profiles: only models that have profiles. */
size_t dea_figure_variants(const struct dea_result *result, const char *study, bool profiles,
                           struct dea_figure_variant out[], size_t max);
/* Adds y = factor * (member + shift) of each against V, as dea_figure_add. */
dea_status dea_figure_add_variants(struct dea_context *ctx, struct dea_panel *panel,
                                   const struct dea_figure_variant list[], size_t count, int column,
                                   double factor, double shift);
/* Adds key entries above the panel: of designs by their colours, with the voltage of their profiles
 * if asked, and of models by their markers where there are several. For a panel that has series. */
dea_status dea_figure_add_variant_key(struct dea_context *ctx, struct dea_panel *panel,
                                      const struct dea_figure_variant list[], size_t count,
                                      bool voltages);

#endif

/* Figures of a result, and what they are made of. Those of a study stand in its file, the others in
 * folder figures. */
#pragma once

#include "plot/plot.h"
#include "result/result.h"

struct dea_figure_options; // figures/run_figures.h

struct dea_figure {
  const char *name; // of its files: "displacement"
  const char *caption;
  const char *study; // that it belongs to; NULL: none
  bool on_request;   // drawn only when it is asked for by name
  /* Fills the plot; leaves it without series when the result has nothing to show. */
  dea_status (*build)(struct dea_context *ctx, const struct dea_result *result,
                      struct dea_plot *plot);
  /* In its place for a figure that is no plot of series: writes its script and data. *drawn: false
   * when the result has nothing to show. */
  dea_status (*write)(struct dea_context *ctx, const struct dea_figure *figure,
                      const struct dea_result *result, const struct dea_figure_options *options,
                      const char *directory, bool *drawn);
  const void *view; // what `write` knows of it
};

/* One of a study. */
#define DEA_STUDY_FIGURE(its_name, its_study, its_build, text)                                     \
  {                                                                                                \
    .name = its_name, .study = its_study, .build = its_build, .caption = text                      \
  }

// Parts for the figures --------------------------------------------------------------------------

/* Curve to draw against voltage: the model's sweep, or its path when it has none (or the other way
 * round with prefer_path); NULL when neither has points. */
const struct dea_curve *dea_figure_curve(const struct dea_result *result, const char *model,
                                         bool prefer_path);
/* Adds y = factor * (member + shift) against V in kV, as look says (title, style, colour,
 * marker); what is not to be trusted is dashed, what is a bound dotted and said to be one; a
 * grey band is the estimated error where that is known, one in the curve's colour its standard
 * uncertainty. Adds nothing when the curve has no such number. */
dea_status dea_figure_add(struct dea_context *ctx, struct dea_panel *panel,
                          const struct dea_curve *curve, int column, double factor, double shift,
                          const struct dea_series *look);
/* Whether the column of a curve is a bound and no prediction. */
bool dea_figure_is_bound(const struct dea_curve *curve, int column);
/* Whether that is to be left out: beside what other models predict a bound of many times the size
 * would set the axes. */
bool dea_figure_leaves_out(const struct dea_result *result, const struct dea_curve *curve,
                           int column);
/* Look of the m-th of several curves with that name. */
struct dea_series dea_figure_style(const char *name, size_t m);
/* Look of a model, the same in all figures; m, its number among those shown, counts only for names
 * that are not known. */
struct dea_series dea_figure_model_style(const char *model, size_t m);
/* Adds that column of all models, in the units of figures. */
dea_status dea_figure_add_models(struct dea_context *ctx, struct dea_panel *panel,
                                 const struct dea_result *result, int column, bool prefer_path);
/* Says what the two halves of a profile are, where they differ: model 3d joins two sections. */
void dea_figure_sides(struct dea_panel *panel, const struct dea_profile_record *record);
/* Adds an entry of the key alone, a grey line of that style; of its series only a point shows, at
 * x, y, which lies on a curve that is there. */
dea_status dea_figure_add_entry(struct dea_context *ctx, struct dea_panel *panel,
                                enum dea_series_style style, const char *title, double x, double y);
/* Marks the events of all paths on their curves, with a key entry a kind. column, factor, shift: as
 * in dea_figure_add. whole_path: also those beyond the voltage axis as it is and on unstable
 * branches. */
dea_status dea_figure_add_events(struct dea_context *ctx, struct dea_panel *panel,
                                 const struct dea_result *result, int column, double factor,
                                 double shift, bool whole_path);
/* Display unit with its proper signs: "um" -> "\302\265m". */
enum { DEA_COLUMN_UNIT_SIZE = 32 };
void dea_figure_unit(const char *unit, char out[DEA_COLUMN_UNIT_SIZE]);
/* "true field (V/\302\265m)": header and unit of a column as a label. */
void dea_figure_label(const struct dea_column *column, char *out, size_t size);

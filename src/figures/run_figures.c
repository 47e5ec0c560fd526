#include "figures/run_figures.h"

#include "base/write_file.h"
#include "figures/figure_list.h"
#include "plot/gnuplot.h"
#include "study/figures.h"

#include <string.h>
#include <unistd.h>

#define FIGURE_DECLARE(name) extern const struct dea_figure dea_figure_##name;
DEA_FIGURE_LIST(FIGURE_DECLARE)
#undef FIGURE_DECLARE

static const struct dea_figure *const figures[] = {
#define FIGURE_ROW(name) &dea_figure_##name,
    DEA_FIGURE_LIST(FIGURE_ROW)
#undef FIGURE_ROW
};

const struct dea_figure *dea_figure_get(size_t i)
{
  size_t count = sizeof figures / sizeof figures[0];
  return i < count ? figures[i] : dea_study_figure(i - count);
}

size_t dea_figure_names(bool plots, const char *out[DEA_FIGURES_MAX])
{
  const struct dea_figure *figure;
  size_t count = 0;
  for (size_t i = 0; (figure = dea_figure_get(i)) != NULL && count < DEA_FIGURES_MAX; i++) {
    if (!plots || figure->build != NULL) {
      out[count++] = figure->name;
    }
  }
  return count;
}

static dea_status check_names(struct dea_context *ctx, const struct dea_figure_options *options)
{
  const char *names[DEA_FIGURES_MAX];
  size_t count = dea_figure_names(false, names);
  for (size_t i = 0; options->names != NULL && i < options->name_count; i++) {
    bool known = false;
    for (size_t f = 0; f < count; f++) {
      known = known || strcmp(names[f], options->names[i]) == 0;
    }
    if (!known) {
      const char *nearest = dea_nearest_name(options->names[i], names, count);
      struct dea_text all = {.ctx = ctx};
      for (size_t f = 0; nearest == NULL && f < count; f++) {
        dea_text_add(&all, "%s%s", f > 0 ? ", " : "", names[f]);
      }
      dea_status status =
          dea_fail(ctx, DEA_E_ARGUMENT, "there is no figure '%s'; %s%s%s", options->names[i],
                   nearest != NULL ? "did you mean '" : "there are ",
                   nearest != NULL ? nearest : dea_text_get(&all), nearest != NULL ? "'?" : "");
      dea_text_free(&all);
      return status;
    }
  }
  return DEA_OK;
}

static bool is_wanted(const struct dea_figure_options *options, const struct dea_figure *figure)
{
  for (size_t i = 0; options->names != NULL && i < options->name_count; i++) {
    if (strcmp(options->names[i], figure->name) == 0) {
      return true;
    }
  }
  return options->names == NULL && !figure->on_request;
}

static dea_status write_plot(struct dea_context *ctx, const struct dea_result *result,
                             const char *directory, const struct dea_figure_options *options,
                             const struct dea_figure *figure, bool *drawn)
{
  struct dea_plot *plot;
  DEA_TRY(ctx, dea_plot_create(ctx, figure->name, figure->caption, &plot));
  dea_status status = figure->build(ctx, result, plot);
  *drawn = status == DEA_OK && dea_plot_shows(plot);
  if (*drawn) {
    status = dea_plot_write(ctx, plot, &options->format, directory);
  }
  dea_plot_destroy(ctx, plot);
  return status;
}

/* Writes script and data of one figure; *drawn tells whether there was something to show. */
static dea_status write_one(struct dea_context *ctx, const struct dea_result *result,
                            const char *directory, const struct dea_figure_options *options,
                            const struct dea_figure *figure, bool *drawn)
{
  dea_status status = figure->write != NULL
                          ? figure->write(ctx, result, options, directory, drawn)
                          : write_plot(ctx, result, directory, options, figure, drawn);
  if (status == DEA_OK && !*drawn && options->names != NULL) {
    status = dea_finding_add(ctx, DEA_NOTE, (struct dea_location){"", 0, 0},
                             "the result has nothing to show in figure '%s'", figure->name);
  }
  return status;
}

dea_status dea_figures_write(struct dea_context *ctx, const struct dea_result *result,
                             const char *directory, const struct dea_figure_options *options,
                             size_t *drawn)
{
  const char *names[DEA_FIGURES_MAX];
  size_t count = 0;
  DEA_TRY(ctx, check_names(ctx, options));
  const bool was_there = dea_path_exists(directory);
  DEA_TRY(ctx, dea_folder_make(ctx, directory));
  const struct dea_figure *figure;
  for (size_t f = 0; (figure = dea_figure_get(f)) != NULL && count < DEA_FIGURES_MAX; f++) {
    bool shows = false;
    if (is_wanted(options, figure)) {
      DEA_TRY(ctx, write_one(ctx, result, directory, options, figure, &shows));
    }
    if (shows) {
      names[count++] = figure->name;
    }
  }
  if (drawn != NULL) {
    *drawn = count;
  }
  if (count == 0 && !was_there) {
    rmdir(directory); // one with something in it stays
  }
  if (count > 0 && (options->format.svg || options->format.pdf || options->format.png)) {
    DEA_TRY(ctx, dea_gnuplot_draw(ctx, directory, names, count));
  }
  return DEA_OK;
}

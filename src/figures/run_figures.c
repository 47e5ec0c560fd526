#include "figures/run_figures.h"

#include "base/write_file.h"
#include "figures/figure_list.h"
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
      char hint[DEA_HINT_SIZE];
      dea_name_hint_list(options->names[i], names, count, NULL, "; there are ", hint);
      return dea_fail(ctx, DEA_E_ARGUMENT, "there is no figure '%s'%s", options->names[i], hint);
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

/* Writes script and data of one figure, if it has something to show. */
static dea_status write_one(struct dea_plot_folder *folder, const struct dea_result *result,
                            const struct dea_figure_options *options,
                            const struct dea_figure *figure)
{
  struct dea_context *ctx = folder->ctx;
  const size_t before = folder->count;
  if (figure->write != NULL) {
    bool drawn = false;
    DEA_TRY(ctx, figure->write(ctx, figure, result, options, folder->path, &drawn));
    DEA_TRY(ctx, drawn ? dea_plot_folder_name(folder, figure->name) : DEA_OK);
  } else {
    struct dea_plot *plot;
    DEA_TRY(ctx, dea_plot_create(ctx, figure->name, figure->caption, &plot));
    DEA_TRY(ctx, dea_plot_folder_add(folder, plot, figure->build(ctx, result, plot)));
  }
  return folder->count > before || options->names == NULL
             ? DEA_OK
             : dea_finding_add(ctx, DEA_NOTE, (struct dea_location){"", 0, 0},
                               "the result has nothing to show in figure '%s'", figure->name);
}

dea_status dea_figures_write(struct dea_context *ctx, const struct dea_result *result,
                             const char *directory, const struct dea_figure_options *options,
                             size_t *drawn)
{
  struct dea_plot_folder folder = {.ctx = ctx, .format = &options->format, .path = directory};
  DEA_TRY(ctx, check_names(ctx, options));
  const bool was_there = dea_path_exists(directory);
  DEA_TRY(ctx, dea_folder_create(ctx, directory));
  const struct dea_figure *figure;
  dea_status status = DEA_OK;
  for (size_t f = 0; (figure = dea_figure_get(f)) != NULL && status == DEA_OK; f++) {
    status = is_wanted(options, figure) ? write_one(&folder, result, options, figure) : DEA_OK;
  }
  if (drawn != NULL) {
    *drawn = folder.count;
  }
  if (folder.count == 0 && !was_there && status == DEA_OK) {
    rmdir(directory); // one with something in it stays
  }
  return dea_plot_folder_draw(&folder, status);
}

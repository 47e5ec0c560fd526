#define _XOPEN_SOURCE 700 // lstat, realpath
#include "job/run_folder.h"

#include "base/write_file.h"
#include "figures/run_figures.h"
#include "io/checkpoint.h"
#include "io/csv.h"
#include "io/results_h5.h"
#include "io/summary.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Files of every run beside tables, figures and fields: one of that name is not written over
 * without
 * --force, and goes before a new run. */
static const char *const exports[] = {"design.yaml", "summary.json", "results.h5"};
enum { EXPORT_COUNT = sizeof exports / sizeof exports[0] };

/* A folder of results that is a link would have files removed and written elsewhere. */
static dea_status refuse_link(struct dea_context *ctx, const char *directory, const char *name)
{
  struct stat info;
  char path[DEA_PATH_SIZE];
  DEA_TRY(ctx, dea_path_build(ctx, directory, name, path));
  bool link = lstat(path, &info) == 0 && S_ISLNK(info.st_mode);
  return !link ? DEA_OK
               : dea_fail(ctx, DEA_E_IO,
                          "%s/%s is a link to another place, which --force does not follow",
                          directory, name);
}

dea_status dea_run_folder_prepare(struct dea_context *ctx, const char *directory, bool force)
{
  // Also a user's own file of such a name would be lost.
  for (size_t i = EXPORT_COUNT; i-- > 0 && !force;) {
    DEA_TRY(ctx, dea_path_refuse(ctx, directory, exports[i]));
  }
  if (!force) {
    DEA_TRY(ctx, dea_path_refuse(ctx, directory, DEA_FIGURE_FOLDER));
    DEA_TRY(ctx, dea_path_refuse(ctx, directory, DEA_FIELD_FOLDER));
  }
  DEA_TRY(ctx, refuse_link(ctx, directory, DEA_FIGURE_FOLDER));
  DEA_TRY(ctx, refuse_link(ctx, directory, DEA_FIELD_FOLDER));
  DEA_TRY(ctx, dea_folder_create(ctx, directory));
  if (access(directory, W_OK) != 0) {
    return dea_fail(ctx, DEA_E_IO, "the folder %s cannot be written to", directory);
  }
  return DEA_OK;
}

bool dea_run_folder_is_of(struct dea_context *ctx, const char *directory,
                          const struct dea_design *design)
{
  struct dea_run *old = NULL;
  bool same = dea_run_read(ctx, directory, &old) == DEA_OK;
  if (same) {
    char *was = realpath(old->design_file, NULL), *is = realpath(design->file, NULL);
    same = was != NULL && is != NULL && strcmp(was, is) == 0 &&
           strcmp(old->title, design->title.text) == 0;
    free(was);
    free(is);
  }
  dea_run_destroy(ctx, old);
  dea_context_clear(ctx);
  return same;
}

static dea_status move_all(struct dea_context *ctx, const char *from, const char *to);

static dea_status move(struct dea_context *ctx, void *user, const char *name, const char *old)
{
  const char *const *to = user;
  char new[DEA_PATH_SIZE];
  DEA_TRY(ctx, dea_path_build(ctx, *to, name, new));
  if (rename(old, new) == 0) {
    return DEA_OK;
  }
  return dea_path_is_folder(old) && dea_path_is_folder(new)
             ? move_all(ctx, old, new)
             : dea_fail(ctx, DEA_E_IO, "cannot move %s to %s: %s", old, new, strerror(errno));
}

/* All that is in a folder into another one, and folders that are in both likewise. */
static dea_status move_all(struct dea_context *ctx, const char *from, const char *to)
{
  dea_status status = dea_folder_visit(ctx, from, move, &to);
  rmdir(from);
  return status;
}

dea_status dea_run_folder_replace(struct dea_context *ctx, const char *directory, const char *by)
{
  dea_run_folder_clear(ctx, directory);
  return move_all(ctx, by, directory);
}

static void forget_figures(struct dea_context *ctx, const char *directory)
{
  static const char *const outcomes[] = {"gp", "dat", "svg", "pdf", "png", "gif"};
  const struct dea_figure *figure;
  for (size_t f = 0; (figure = dea_figure_get(f)) != NULL; f++) {
    for (size_t e = 0; e < sizeof outcomes / sizeof outcomes[0]; e++) {
      char name[128];
      snprintf(name, sizeof name, DEA_FIGURE_FOLDER "/%s.%s", figure->name, outcomes[e]);
      dea_path_forget(ctx, directory, name);
    }
  }
  char folder[DEA_PATH_SIZE];
  if (dea_path_build(ctx, directory, DEA_FIGURE_FOLDER, folder) == DEA_OK) {
    rmdir(folder); // one with other files in it stays
  }
}

/* MODEL_KIND.csv, MODEL_KIND_events.csv and the like. */
static void forget_table(struct dea_context *ctx, const char *directory,
                         const struct dea_curve *curve, const char *outcome)
{
  char name[2 * DEA_NAME_SIZE + 32];
  snprintf(name, sizeof name, "%s_%s%s.csv", curve->model, curve->kind, outcome);
  dea_path_forget(ctx, directory, name);
}

void dea_run_folder_clear(struct dea_context *ctx, const char *directory)
{
  char name[DEA_RESULT_TABLE_FILE_SIZE];
  struct dea_run *old;
  if (dea_run_read(ctx, directory, &old) == DEA_OK) {
    const struct dea_result *result = old->result;
    for (size_t i = 0; i < result->curve_count; i++) {
      const struct dea_curve *curve = &result->curves[i];
      forget_table(ctx, directory, curve, "");
      forget_table(ctx, directory, curve, "_events");
      snprintf(name, sizeof name, "%s_profiles.csv", curve->model);
      dea_path_forget(ctx, directory, name);
      dea_checkpoint_forget(ctx, directory, curve->model, curve->count);
      snprintf(name, sizeof name, "%s_%s", curve->model, curve->kind); // shapes of modes
      dea_checkpoint_forget(ctx, directory, name, curve->count);
    }
    for (size_t i = 0; i < result->variant_count; i++) {
      forget_table(ctx, directory, &result->variants[i].curve, "");
      forget_table(ctx, directory, &result->variants[i].curve, "_profiles");
    }
    for (size_t i = 0; i < result->table_count; i++) {
      dea_csv_table_name(&result->tables[i], name);
      dea_path_forget(ctx, directory, name);
    }
    dea_run_destroy(ctx, old);
  }
  dea_context_clear(ctx);
  forget_figures(ctx, directory);
  for (size_t i = 0; i < EXPORT_COUNT; i++) {
    dea_path_forget(ctx, directory, exports[i]);
  }
}

static dea_status write_exports(struct dea_context *ctx, const struct dea_result *result,
                                const char *directory)
{
  const char *input = result->provenance.input;
  char *summary;
  DEA_TRY(ctx, dea_csv_write(ctx, result, directory));
  DEA_TRY(ctx, input != NULL ? dea_text_file_write(ctx, directory, exports[0], input) : DEA_OK);
  DEA_TRY(ctx, dea_summary_text(ctx, result, &summary));
  dea_status status = dea_text_file_write(ctx, directory, exports[1], summary);
  dea_free(ctx, summary);
  DEA_TRY(ctx, status);
  char path[DEA_PATH_SIZE];
  DEA_TRY(ctx, dea_path_build(ctx, directory, exports[2], path));
  return DEA_CHAIN(ctx, dea_results_h5_write(ctx, result, path));
}

static dea_status write_figures(struct dea_context *ctx, const struct dea_result *result,
                                const char *directory)
{
  const struct dea_design *design = result->design;
  struct dea_figure_options options = {.format = {.width_m = 0.085}, .voltage_V = NAN};
  if (design != NULL) {
    options.format.svg = design->report.svg;
    options.format.pdf = design->report.pdf;
    options.format.png = design->report.png;
    double width_m = design->report.width_m.si;
    options.format.width_m = width_m > 0.0 ? width_m : options.format.width_m;
  }
  char folder[DEA_PATH_SIZE];
  DEA_TRY(ctx, dea_path_build(ctx, directory, DEA_FIGURE_FOLDER, folder));
  return DEA_CHAIN(ctx, dea_figures_write(ctx, result, folder, &options, NULL));
}

dea_status dea_run_folder_write(struct dea_context *ctx, const struct dea_result *result,
                                const char *directory, const struct dea_run_folder_options *options)
{
  const struct dea_run_folder_options standard = {.force = false};
  const struct dea_run_folder_options *o = options != NULL ? options : &standard;
  if (!o->started) {
    DEA_TRY(ctx, dea_run_folder_prepare(ctx, directory, o->force));
    if (o->force) {
      dea_run_folder_clear(ctx, directory);
    }
  }
  DEA_TRY(ctx, write_exports(ctx, result, directory));
  DEA_TRY(ctx, dea_checkpoint_shapes(ctx, result, directory));
  return DEA_CHAIN(ctx, !o->no_figures ? write_figures(ctx, result, directory) : DEA_OK);
}

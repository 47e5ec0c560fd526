#include "output/run_folder.h"

#include "base/write_file.h"
#include "output/checkpoint.h"
#include "output/csv.h"
#include "output/figure.h"
#include "output/results_h5.h"
#include "output/summary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static dea_status exists(struct dea_context *ctx, const char *directory, const char *name,
                         bool *there)
{
  char *path = dea_path_join(ctx, directory, name);
  if (path == NULL) {
    return DEA_E_MEMORY;
  }
  *there = dea_path_exists(path);
  dea_free(ctx, path);
  return DEA_OK;
}

dea_status dea_run_folder_prepare(struct dea_context *ctx, const char *directory, bool force)
{
  // Also a user's own file of such a name would be lost.
  static const char *const names[] = {"results.h5", "summary.json", "design.yaml",
                                      DEA_FIGURE_FOLDER, DEA_FIELD_FOLDER};
  for (size_t i = 0; i < sizeof names / sizeof names[0] && !force; i++) {
    bool there;
    DEA_TRY(ctx, exists(ctx, directory, names[i], &there));
    if (there) {
      return dea_fail(ctx, DEA_E_IO,
                      "%s/%s is there already; choose another folder with -o, or replace what is "
                      "there with --force",
                      directory, names[i]);
    }
  }
  DEA_TRY(ctx, dea_folder_make(ctx, directory));
  if (access(directory, W_OK) != 0) {
    return dea_fail(ctx, DEA_E_IO, "the folder %s cannot be written to", directory);
  }
  return DEA_OK;
}

/* Removes a file of that name; one that is not there or cannot be removed is left to the writer. */
static void forget(struct dea_context *ctx, const char *directory, const char *name)
{
  char *path = dea_path_join(ctx, directory, name);
  if (path != NULL) {
    unlink(path);
  }
  dea_free(ctx, path);
}

static void forget_figures(struct dea_context *ctx, const char *directory)
{
  static const char *const endings[] = {"gp", "dat", "svg", "pdf", "png", "gif"};
  size_t count;
  const struct dea_figure *const *figures = dea_figure_all(&count);
  for (size_t f = 0; f < count; f++) {
    for (size_t e = 0; e < sizeof endings / sizeof endings[0]; e++) {
      char name[128];
      snprintf(name, sizeof name, DEA_FIGURE_FOLDER "/%s.%s", figures[f]->name, endings[e]);
      forget(ctx, directory, name);
    }
  }
}

void dea_run_folder_clear(struct dea_context *ctx, const char *directory)
{
  struct dea_run *old;
  if (dea_run_read(ctx, directory, &old) == DEA_OK) {
    for (size_t i = 0; i < old->result->curve_count; i++) {
      const struct dea_curve *curve = &old->result->curves[i];
      char name[2 * DEA_NAME_SIZE + 32];
      snprintf(name, sizeof name, "%s_%s.csv", curve->model, curve->kind);
      forget(ctx, directory, name);
      snprintf(name, sizeof name, "%s_%s_events.csv", curve->model, curve->kind);
      forget(ctx, directory, name);
      snprintf(name, sizeof name, "%s_profiles.csv", curve->model);
      forget(ctx, directory, name);
      dea_checkpoint_forget(ctx, directory, curve->model, curve->count);
      snprintf(name, sizeof name, "%s_%s", curve->model, curve->kind); // shapes of modes
      dea_checkpoint_forget(ctx, directory, name, curve->count);
    }
    for (size_t i = 0; i < old->result->variant_count; i++) {
      const struct dea_curve *curve = &old->result->variants[i].curve;
      char name[2 * DEA_NAME_SIZE + 32];
      snprintf(name, sizeof name, "%s_%s.csv", curve->model, curve->kind);
      forget(ctx, directory, name);
      snprintf(name, sizeof name, "%s_%s_profiles.csv", curve->model, curve->kind);
      forget(ctx, directory, name);
    }
    for (size_t i = 0; i < old->result->table_count; i++) {
      char name[DEA_RESULT_TABLE_FILE_SIZE];
      dea_csv_table_name(&old->result->tables[i], name);
      forget(ctx, directory, name);
    }
    dea_run_destroy(ctx, old);
  }
  dea_context_clear(ctx);
  forget_figures(ctx, directory);
  forget(ctx, directory, "summary.json");
  forget(ctx, directory, "design.yaml");
  forget(ctx, directory, "results.h5");
}

/* Whether a variant is the first of its model and study. */
static bool first_of_study(const struct dea_result *result, size_t i)
{
  const struct dea_curve *curve = &result->variants[i].curve;
  for (size_t k = 0; k < i; k++) {
    if (dea_variant_is(&result->variants[k], curve->model, curve->kind)) {
      return false;
    }
  }
  return true;
}

static dea_status write_tables(struct dea_context *ctx, const struct dea_result *result,
                               const char *directory)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  for (size_t i = 0; i < result->curve_count; i++) {
    DEA_TRY(ctx, dea_csv_write_curve(ctx, &result->curves[i], directory));
    DEA_TRY(ctx, dea_csv_write_events(ctx, &result->curves[i], directory));
  }
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    DEA_TRY(ctx, dea_csv_write_profiles(ctx, result, models[m], directory));
  }
  for (size_t i = 0; i < result->variant_count; i++) {
    if (first_of_study(result, i)) {
      const struct dea_curve *curve = &result->variants[i].curve;
      DEA_TRY(ctx, dea_csv_write_variants(ctx, result, curve->model, curve->kind, directory));
      DEA_TRY(ctx,
              dea_csv_write_variant_profiles(ctx, result, curve->model, curve->kind, directory));
    }
  }
  for (size_t i = 0; i < result->table_count; i++) {
    DEA_TRY(ctx, dea_csv_write_table(ctx, &result->tables[i], directory));
  }
  return DEA_OK;
}

static dea_status write_text(struct dea_context *ctx, const char *directory, const char *name,
                             const char *text)
{
  char *path = dea_path_join(ctx, directory, name);
  if (path == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = dea_file_write(ctx, path, text, strlen(text));
  dea_free(ctx, path);
  return status;
}

static dea_status write_summary(struct dea_context *ctx, const struct dea_result *result,
                                const char *directory)
{
  char *text;
  DEA_TRY(ctx, dea_summary_text(ctx, result, &text));
  dea_status status = write_text(ctx, directory, "summary.json", text);
  dea_free(ctx, text);
  return status;
}

static dea_status write_store(struct dea_context *ctx, const struct dea_result *result,
                              const char *directory)
{
  char *path = dea_path_join(ctx, directory, "results.h5");
  if (path == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = dea_results_h5_write(ctx, result, path);
  dea_free(ctx, path);
  return status;
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
  char *folder = dea_path_join(ctx, directory, DEA_FIGURE_FOLDER);
  if (folder == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = dea_figures_write(ctx, result, folder, &options);
  dea_free(ctx, folder);
  return status;
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
  DEA_TRY(ctx, write_tables(ctx, result, directory));
  DEA_TRY(ctx, dea_checkpoint_shapes(ctx, result, directory));
  if (result->provenance.input != NULL) {
    DEA_TRY(ctx, write_text(ctx, directory, "design.yaml", result->provenance.input));
  }
  DEA_TRY(ctx, write_summary(ctx, result, directory));
  DEA_TRY(ctx, write_store(ctx, result, directory));
  if (!o->no_figures) {
    DEA_TRY(ctx, write_figures(ctx, result, directory));
  }
  return DEA_OK;
}

#include "job/job.h"

#include "base/clock.h"
#include "base/write_file.h"
#include "job/run_folder.h"
#include "result/provenance.h"
#include "study/study.h"
#include "study/uncertainty.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char results_file[] = "results.h5";

static bool has_folder(const struct dea_job *job)
{
  return job->folder != NULL && job->folder[0] != '\0';
}

static const char *working_folder(const struct dea_job *job)
{
  return job->part != NULL ? job->part : job->folder;
}

/* FOLDER.part where results are replaced, or where a run that did so is resumed. */
static dea_status choose_part(struct dea_context *ctx, struct dea_job *job)
{
  struct dea_text part = {.ctx = ctx};
  dea_text_add(&part, "%.*s.part", (int)dea_path_length(job->folder), job->folder);
  const bool failed = part.failed;
  if (!failed && ((job->force && dea_folder_has(job->folder, results_file)) ||
                  (job->resume && dea_path_is_folder(part.data)))) {
    job->part = part.data;
  } else {
    dea_text_free(&part);
  }
  return failed ? DEA_E_MEMORY : DEA_OK;
}

/* Makes the folder ready, and what is to be kept in it while the run goes. */
static dea_status open_folder(struct dea_context *ctx, struct dea_job *job,
                              struct dea_result *result)
{
  if (!has_folder(job)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, choose_part(ctx, job));
  DEA_TRY(ctx, job->resume ? dea_checkpoint_restore(ctx, working_folder(job), result) : DEA_OK);
  job->made = !dea_path_exists(job->folder);
  DEA_TRY(ctx, dea_run_folder_prepare(ctx, job->folder, job->force || job->resume));
  DEA_TRY(ctx, dea_folder_lock(ctx, job->folder, &job->lock));
  DEA_TRY(ctx, job->part != NULL ? dea_run_folder_prepare(ctx, job->part, true) : DEA_OK);
  if (job->force) {
    dea_run_folder_clear(ctx, working_folder(job));
  }
  dea_checkpoint_begin(&job->keep, working_folder(job));
  return DEA_OK;
}

/* Where a design names a model; its file: who runs it has. */
static struct dea_location place_of(const struct dea_design *design, const char *model)
{
  for (size_t i = 0; i < design->compute.model_count; i++) {
    if (strcmp(design->compute.models[i].text, model) == 0) {
      return design->compute.models[i].location;
    }
  }
  return (struct dea_location){design->file, 0, 0};
}

static dea_status check_model(struct dea_context *ctx, const struct dea_model_type *type,
                              const struct dea_result *result)
{
  if (!type->any_layout && dea_device_require_disc(ctx, result->device) != DEA_OK) {
    char why[400];
    snprintf(why, sizeof why, "model %s: %.300s", type->name, dea_context_message(ctx));
    dea_context_clear(ctx);
    return dea_refuse(ctx, place_of(result->design, type->name), why);
  }
  return dea_model_check(ctx, type, result->design, result->device);
}

/* Whether each model takes the design, or some model, where what the others lack is said by their
 * runs. */
static dea_status check_models(struct dea_context *ctx, const struct dea_job *job, bool each,
                               const struct dea_result *result)
{
  size_t able = 0;
  const size_t errors = dea_finding_trial_begin(ctx);
  for (size_t i = 0; i < job->model_count && !each; i++) {
    able += check_model(ctx, job->models[i], result) == DEA_OK;
  }
  dea_finding_trial_end(ctx, errors);
  if (able > 0) {
    dea_context_clear(ctx);
    return DEA_OK;
  }
  dea_status first = DEA_OK;
  for (size_t i = 0; i < job->model_count; i++) {
    dea_status status = check_model(ctx, job->models[i], result);
    first = first == DEA_OK ? status : first;
  }
  return first;
}

/* Whether the devices of all designs that this one is compared with can be built, and are taken by
 * some model. */
static dea_status check_variants(struct dea_context *ctx, const struct dea_job *job,
                                 const struct dea_design *design)
{
  dea_status first = DEA_OK;
  for (size_t i = 0; i < design->compute.compare_count; i++) {
    const struct dea_design *variant = design->compute.compare[i].design;
    struct dea_device *device = NULL;
    dea_status status = variant != NULL ? dea_device_build(ctx, variant, &device) : DEA_OK;
    if (device != NULL) {
      status =
          check_models(ctx, job, false, &(struct dea_result){.design = variant, .device = device});
    }
    dea_device_destroy(ctx, device);
    first = first == DEA_OK ? status : first;
  }
  return first;
}

dea_status dea_job_models(struct dea_context *ctx, const struct dea_design *design,
                          struct dea_job *job)
{
  job->model_count = 0;
  for (size_t i = 0; i < design->compute.model_count; i++) {
    const struct dea_label *label = &design->compute.models[i];
    const struct dea_model_type *type;
    DEA_TRY(ctx, dea_model_seek(ctx, label->text, label->location, &type));
    job->models[job->model_count] = type;
    job->model_count += type != NULL ? 1U : 0U;
  }
  return job->model_count == design->compute.model_count
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DESIGN, "a model is not known");
}

dea_status dea_job_check(struct dea_context *ctx, const struct dea_job *job, bool each,
                         const struct dea_result *result)
{
  const bool built = result->device != NULL;
  dea_status first = DEA_OK;
  char message[1024] = "";
  for (int step = 0; step < (built ? 5 : 2); step++) {
    dea_status status = step == 0
                            ? dea_study_check(ctx, job->studies, job->study_count, result->design)
                        : step == 1 ? check_variants(ctx, job, result->design)
                        : step == 2 ? check_models(ctx, job, each, result)
                        : step == 3 ? dea_study_check_models(ctx, job->models, job->model_count,
                                                             job->studies, job->study_count, result)
                                    : dea_uncertainty_check(ctx, result->design, result->device);
    if (status != DEA_OK && first == DEA_OK) {
      first = status;
      snprintf(message, sizeof message, "%s", dea_context_message(ctx));
    }
  }
  return first == DEA_OK ? DEA_OK : dea_fail(ctx, first, "%s", message);
}

/* Adds what has computed a model's results to where they come from. */
static dea_status name_libraries(struct dea_context *ctx, const struct dea_model_type *type,
                                 struct dea_result *result)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t i = 0; i < count && type->libraries != NULL; i++) {
    if (strcmp(models[i], type->name) == 0) {
      char text[sizeof result->provenance.libraries];
      DEA_TRY(ctx, type->libraries(ctx, text, sizeof text));
      dea_provenance_add_libraries(text, &result->provenance);
    }
  }
  return DEA_OK;
}

dea_status dea_job_run(struct dea_context *ctx, struct dea_job *job, struct dea_result *result,
                       bool *began)
{
  const struct dea_solver_counters before = *dea_context_counters(ctx);
  dea_status first = DEA_OK;
  char message[1024] = "";
  *began = false;
  DEA_TRY(ctx, dea_job_check(ctx, job, false, result));
  DEA_TRY(ctx, job->status = open_folder(ctx, job, result));
  *began = true;
  const struct dea_study_services services = {job->keep.directory != NULL ? &job->keep.sink : NULL,
                                              dea_study_run};
  const double began_s = dea_clock_s();
  for (size_t i = 0; i < job->model_count && first != DEA_E_INTERRUPTED && !job->keep.refused;
       i++) {
    dea_status status =
        dea_study_run_with(ctx, job->models[i], job->studies, job->study_count, &services, result);
    if (status != DEA_OK && first == DEA_OK) {
      first = status;
      snprintf(message, sizeof message, "%s: %s", job->models[i]->name, dea_context_message(ctx));
    }
    DEA_TRY(ctx, name_libraries(ctx, job->models[i], result));
  }
  result->provenance.wall_s = dea_clock_s() - began_s;
#define COUNTED(member, label)                                                                     \
  result->provenance.solver.member = dea_context_counters(ctx)->member - before.member;
  DEA_SOLVER_COUNTERS(COUNTED)
#undef COUNTED
  job->status = first;
  return first == DEA_OK ? DEA_OK : dea_fail(ctx, first, "%s", message);
}

static bool has_results(const struct dea_result *result)
{
  size_t points = 0;
  for (size_t i = 0; i < result->curve_count; i++) {
    points += result->curves[i].count;
  }
  return points + result->variant_count + result->table_count > 0;
}

const char *dea_job_folder(const struct dea_job *job, const struct dea_result *result)
{
  if (!has_folder(job) || (job->status != DEA_OK && !has_results(result))) {
    return NULL;
  }
  return job->status == DEA_E_INTERRUPTED ? working_folder(job) : job->folder;
}

/* Removes what a failed run has left, but neither a folder that was there nor files of others. */
static void discard(struct dea_context *ctx, const struct dea_job *job)
{
  if (job->part != NULL || job->made) {
    dea_run_folder_clear(ctx, working_folder(job));
    rmdir(working_folder(job)); // that of the lock goes in dea_job_end
  }
}

dea_status dea_job_write(struct dea_context *ctx, struct dea_job *job,
                         const struct dea_result *result)
{
  if (!has_folder(job) || job->keep.refused) {
    return DEA_OK;
  }
  if (dea_job_folder(job, result) == NULL) {
    discard(ctx, job);
    return DEA_OK;
  }
  const struct dea_run_folder_options options = {.started = true, .no_figures = job->no_figures};
  const dea_status status = dea_run_folder_write(ctx, result, working_folder(job), &options);
  if (status != DEA_OK && status != DEA_E_TOOL) { // without gnuplot the data are there
    job->status = job->status == DEA_OK ? status : job->status;
    if (!dea_folder_has(working_folder(job), results_file)) {
      char message[1024];
      snprintf(message, sizeof message, "%s", dea_context_message(ctx));
      discard(ctx, job);
      return dea_fail(ctx, status, "%s", message);
    }
  } else if (job->part != NULL && job->status != DEA_E_INTERRUPTED) {
    DEA_TRY(ctx, dea_run_folder_replace(ctx, job->folder, job->part));
  }
  return DEA_CHAIN(ctx, status);
}

void dea_job_end(struct dea_context *ctx, struct dea_job *job)
{
  dea_folder_unlock(ctx, job->lock);
  job->lock = NULL;
  if (job->made && job->status != DEA_OK) {
    rmdir(job->folder); // of a failed run: one with files in it stays
  }
  dea_free(ctx, job->part);
  job->part = NULL;
}

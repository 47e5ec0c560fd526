#define _POSIX_C_SOURCE 200809L // clock_gettime
#include "job/job.h"

#include "output/run_folder.h"
#include "result/provenance.h"
#include "study/rerun.h"
#include "study/uncertainty.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

static bool has_folder(const struct dea_job *job)
{
  return job->folder != NULL && job->folder[0] != '\0';
}

/* Makes the folder ready, and what is to be kept in it while the run goes. */
static dea_status open_folder(struct dea_context *ctx, struct dea_job *job,
                              struct dea_result *result)
{
  if (!has_folder(job)) {
    return DEA_OK;
  }
  if (job->resume) {
    DEA_TRY(ctx, dea_checkpoint_restore(ctx, job->folder, result));
  }
  DEA_TRY(ctx, dea_run_folder_prepare(ctx, job->folder, job->force || job->resume));
  DEA_TRY(ctx, dea_folder_lock(ctx, job->folder, &job->lock));
  if (job->force) {
    dea_run_folder_clear(ctx, job->folder);
  }
  DEA_TRY(ctx, dea_checkpoint_create(ctx, job->folder, &job->keep));
  result->checkpoint = dea_checkpoint_get_sink(job->keep);
  return DEA_OK;
}

static dea_status check_model(struct dea_context *ctx, const struct dea_model_type *type,
                              const struct dea_result *result)
{
  if (type->of_layouts == NULL) {
    DEA_TRY(ctx, dea_device_check(ctx, result->device));
  }
  DEA_TRY(ctx, dea_model_check(ctx, type, result->design, result->device));
  return DEA_OK;
}

/* Whether some model takes the design; what each lacks is said where none does, else by its run. */
static dea_status check_models(struct dea_context *ctx, const struct dea_job *job,
                               const struct dea_result *result)
{
  size_t able = 0;
  const size_t errors = dea_finding_trial_begin(ctx);
  for (size_t i = 0; i < job->model_count; i++) {
    able += check_model(ctx, job->models[i], result) == DEA_OK;
  }
  dea_finding_trial_end(ctx, errors);
  dea_context_clear(ctx);
  dea_status first = DEA_OK;
  for (size_t i = 0; i < job->model_count && able == 0; i++) {
    dea_status status = check_model(ctx, job->models[i], result);
    first = first == DEA_OK ? status : first;
  }
  return first;
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
  struct timespec start, end;
  dea_status first = DEA_OK;
  char message[1024] = "";
  *began = false;
  DEA_TRY(ctx, dea_study_check(ctx, job->studies, job->study_count, result->design));
  DEA_TRY(ctx, check_models(ctx, job, result));
  DEA_TRY(ctx, dea_study_check_models(ctx, job->models, job->model_count, job->studies,
                                      job->study_count, result));
  DEA_TRY(ctx, dea_uncertainty_check(ctx, result->design, result->device, &dea_rerun_designs));
  DEA_TRY(ctx, open_folder(ctx, job, result));
  *began = true;
  result->rerun = &dea_rerun_designs;
  result->processes = job->processes;
  clock_gettime(CLOCK_MONOTONIC, &start);
  for (size_t i = 0;
       i < job->model_count && first != DEA_E_INTERRUPTED && !dea_checkpoint_refused(job->keep);
       i++) {
    dea_status status = dea_study_run(ctx, job->models[i], job->studies, job->study_count, result);
    if (status != DEA_OK && first == DEA_OK) {
      first = status;
      snprintf(message, sizeof message, "%s: %s", job->models[i]->name, dea_context_message(ctx));
    }
    DEA_TRY(ctx, name_libraries(ctx, job->models[i], result));
  }
  clock_gettime(CLOCK_MONOTONIC, &end);
  result->provenance.wall_s =
      (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
  return first == DEA_OK ? DEA_OK : dea_fail(ctx, first, "%s", message);
}

dea_status dea_job_write(struct dea_context *ctx, const struct dea_job *job,
                         const struct dea_result *result)
{
  if (!has_folder(job) || dea_checkpoint_refused(job->keep)) {
    return DEA_OK;
  }
  const struct dea_run_folder_options options = {.started = true, .no_figures = job->no_figures};
  DEA_TRY(ctx, dea_run_folder_write(ctx, result, job->folder, &options));
  return DEA_OK;
}

void dea_job_end(struct dea_context *ctx, struct dea_job *job)
{
  dea_checkpoint_destroy(ctx, job->keep);
  job->keep = NULL;
  dea_folder_unlock(ctx, job->lock);
  job->lock = NULL;
}

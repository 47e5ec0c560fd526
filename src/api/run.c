/* dea_run: design -> models -> studies -> result. */
#include "api/api.h"

#include "job/job.h"
#include "result/provenance.h"

#include <stdio.h>

dea_status api_model_find(dea_context *ctx, const char *name, const struct dea_model_type **out)
{
  *out = dea_model_find(name);
  if (*out == NULL) {
    size_t count;
    const struct dea_model_type *const *all = dea_model_all(&count);
    const char *known[16];
    for (size_t i = 0; i < count && i < sizeof known / sizeof known[0]; i++) {
      known[i] = all[i]->name;
    }
    return api_unknown(ctx, "model", name, known, count);
  }
  return DEA_OK;
}

/* The models that are asked for, or those of the design. */
static dea_status choose_models(dea_context *ctx, const dea_run_options *options,
                                const struct dea_design *design, struct dea_job *job)
{
  bool given = options->model_count > 0;
  size_t count = given ? options->model_count : design->compute.model_count;
  if (count > DEA_DESIGN_MODELS_MAX) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT, "%zu models are too many", count);
  }
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx->inner,
            api_model_find(ctx, given ? options->models[i] : design->compute.models[i].text,
                           &job->models[i]));
    for (size_t k = 0; k < i; k++) {
      if (job->models[k] == job->models[i]) {
        return dea_fail(ctx->inner, DEA_E_ARGUMENT, "the model '%s' is given twice",
                        job->models[i]->name);
      }
    }
  }
  job->model_count = count;
  return DEA_OK;
}

/* What is built for a run; all owned by the caller, also after a failure. */
static dea_status prepare(dea_context *ctx, const dea_design *design,
                          struct dea_result_handle *contents)
{
  struct dea_context *inner = ctx->inner;
  DEA_TRY(inner, api_design_build(inner, design, &contents->design, &contents->device));
  DEA_TRY(inner, dea_result_create(inner, contents->design, contents->device, &contents->inner));
  return dea_provenance_fill(inner, design->bytes, design->length, design->settings.at,
                             design->settings.count, NULL, &contents->inner->provenance);
}

/* Studies, and the folder. The status of the studies comes before that of the folder. */
static dea_status compute(dea_context *ctx, struct dea_job *job, struct dea_result *result,
                          bool *began)
{
  char message[1024];
  dea_status status = dea_job_run(ctx->inner, job, result, began);
  snprintf(message, sizeof message, "%s", dea_context_message(ctx->inner));
  dea_status written = *began ? dea_job_write(ctx->inner, job, result) : DEA_OK;
  dea_job_end(ctx->inner, job);
  if (status != DEA_OK && *began) {
    dea_fail(ctx->inner, status, "%s", message); // not what the writer said
  }
  return status != DEA_OK ? status : written;
}

dea_status dea_run(dea_context *ctx, const dea_design *design, const dea_run_options *options,
                   dea_result **out)
{
  struct dea_context *inner = api_begin(ctx);
  struct dea_result_handle contents = {.ctx = ctx};
  const dea_run_options all = api_run_options(options);
  struct dea_job job = {.studies = all.study_count > 0 ? all.studies : NULL,
                        .study_count = all.study_count,
                        .folder = all.folder,
                        .force = all.replace != 0,
                        .resume = all.resume != 0,
                        .no_figures = all.no_figures != 0};
  bool began = false;
  *out = NULL;
  ctx->running = true;
  dea_status status = prepare(ctx, design, &contents);
  status = status == DEA_OK ? choose_models(ctx, &all, contents.design, &job) : status;
  status = status == DEA_OK ? compute(ctx, &job, contents.inner, &began) : status;
  ctx->running = false;
  if (!began) {
    dea_result_destroy(inner, contents.inner);
    dea_device_destroy(inner, contents.device);
    dea_design_destroy(inner, contents.design);
    return dea_fail_chain(inner, status, __func__, __FILE__, __LINE__);
  }
  dea_status made = api_result_create(ctx, contents, out);
  return made != DEA_OK ? made : status;
}

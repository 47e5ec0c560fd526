/* A run from its start to its folder: what `dea run` and dea_run have in common. */
#pragma once

#include "base/folder_lock.h"
#include "io/checkpoint.h"
#include "result/result.h"

/* What is to be run. All lent. */
struct dea_job {
  const struct dea_model_type *models[DEA_DESIGN_MODELS_MAX];
  size_t model_count;
  const char *const *studies; // [study_count]; NULL: those that the design asks for
  size_t study_count;
  const char *folder; // run folder; NULL or "": none
  bool force;         // replace the results in it, once this job has its own
  bool resume;        // go on from them
  bool no_figures;
  char *part;        // of a job that has begun: folder beside that of the results that it replaces;
                     // NULL: none; owned
  bool made;         // the folder was not there before
  dea_status status; // what dea_job_run gave
  struct dea_keep keep;         // of a job that has begun
  struct dea_folder_lock *lock; // of the folder, until the job ends
};

/* Models of a job: all that a design names. DEA_E_DESIGN after findings where one is not known; the
 * others are there also then. */
dea_status dea_job_models(struct dea_context *ctx, const struct dea_design *design,
                          struct dea_job *job);
/* What a run refuses before it computes, as findings: studies, the designs that it is compared
 * with, models, uncertainties. each: every model has to take the design, else one of them. result:
 * design and device alone are looked at; without a device (NULL) less is. */
dea_status dea_job_check(struct dea_context *ctx, const struct dea_job *job, bool each,
                         const struct dea_result *result);
/* Checks that, makes the folder ready and runs every model. The first failure of a study comes
 * back after all had their turn (an interrupt ends it at once), with the model's name before its
 * message; the result has what was computed. *began: false when nothing could run. */
dea_status dea_job_run(struct dea_context *ctx, struct dea_job *job, struct dea_result *result,
                       bool *began);
/* Writes the folder, if there is one, after dea_job_run has begun. Results that were there are
 * replaced when all is written; they stay where the run was interrupted, which leaves what it has
 * in FOLDER.part, to be resumed. A failed run that has computed nothing leaves
 * no folder. */
dea_status dea_job_write(struct dea_context *ctx, struct dea_job *job,
                         const struct dea_result *result);
/* The folder that has the results after dea_job_write; NULL: none. Lent. */
const char *dea_job_folder(const struct dea_job *job, const struct dea_result *result);
/* Frees what the job has made. */
void dea_job_end(struct dea_context *ctx, struct dea_job *job);

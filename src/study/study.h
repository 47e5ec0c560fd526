/* Studies: what is asked of a model. They speak to the model interface only and fill a result.
 *
 * A study is one file and one line in study_list.h. */
#ifndef DEA_STUDY_STUDY_H
#define DEA_STUDY_STUDY_H

#include "result/result.h"

struct dea_study {
  const char *name;
  /* Runs with a model made for it and adds its curves to the result. Partial results stay in the
   * result when it fails; the curve then says why it stopped. */
  dea_status (*run)(struct dea_context *ctx, const struct dea_model_type *type,
                    struct dea_model *model, struct dea_result *result);
};

/* Runs every study of the result's design with one model. Returns the first failure, after all
 * studies had their turn (an interrupt ends it at once). */
dea_status dea_study_run(struct dea_context *ctx, const struct dea_model_type *type,
                         struct dea_result *result);

#endif

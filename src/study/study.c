#include "study/study.h"

#include "study/study_list.h"

#define STUDY_DECLARE(name) extern const struct dea_study name;
DEA_STUDY_LIST(STUDY_DECLARE)
#undef STUDY_DECLARE

static const struct dea_study *const studies[] = {
#define STUDY_ROW(name) &name,
    DEA_STUDY_LIST(STUDY_ROW)
#undef STUDY_ROW
};

dea_status dea_study_run(struct dea_context *ctx, const struct dea_model_type *type,
                         struct dea_result *result)
{
  struct dea_model *model;
  DEA_TRY(ctx, type->create(ctx, result->device, &model));
  dea_status first = DEA_OK;
  for (size_t i = 0; i < sizeof studies / sizeof studies[0]; i++) {
    dea_status status = studies[i]->run(ctx, type, model, result);
    first = first == DEA_OK ? status : first;
    if (status == DEA_E_INTERRUPTED || status == DEA_E_MEMORY) {
      break;
    }
  }
  type->destroy(ctx, model);
  return first;
}

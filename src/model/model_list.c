#include "model/model_list.h"

#include "model/model.h"

#include <string.h>

#define MODEL_DECLARE(name) extern const struct dea_model_type name;
DEA_MODEL_LIST(MODEL_DECLARE)
#undef MODEL_DECLARE

static const struct dea_model_type *const models[] = {
#define MODEL_ROW(name) &name,
    DEA_MODEL_LIST(MODEL_ROW)
#undef MODEL_ROW
};

const struct dea_model_type *const *dea_model_all(size_t *count)
{
  *count = sizeof models / sizeof models[0];
  return models;
}

const struct dea_model_type *dea_model_find(const char *name)
{
  for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
    if (strcmp(models[i]->name, name) == 0) {
      return models[i];
    }
  }
  return NULL;
}

dea_status dea_model_seek(struct dea_context *ctx, const char *name, struct dea_location place,
                          const struct dea_model_type **out)
{
  *out = dea_model_find(name);
  if (*out != NULL) {
    return DEA_OK;
  }
  const char *names[sizeof models / sizeof models[0]];
  for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
    names[i] = models[i]->name;
  }
  char known[DEA_HINT_SIZE], hint[DEA_HINT_SIZE];
  return dea_finding_add(ctx, DEA_ERROR, place,
                         "there is no model '%.60s' in this version; there are: %s%s", name,
                         dea_names_list(names, sizeof names / sizeof names[0], known),
                         dea_name_hint(name, names, sizeof names / sizeof names[0], hint));
}

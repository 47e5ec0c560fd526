#include "cli/models.h"

#include "base/text.h"

const struct dea_model_type *cli_model_find(struct dea_cli *cli, const char *name,
                                            struct dea_place place)
{
  const struct dea_model_type *type = dea_model_find(name);
  if (type == NULL) {
    size_t count;
    const struct dea_model_type *const *all = dea_model_all(&count);
    struct dea_text known = {.ctx = cli->ctx};
    for (size_t i = 0; i < count; i++) {
      dea_text_add(&known, "%s%s", i > 0 ? ", " : "", all[i]->name);
    }
    dea_finding_add(cli->ctx, DEA_ERROR, place,
                    "there is no model '%.60s' in this version; there are: %s", name,
                    dea_text_get(&known));
    dea_text_free(&known);
  }
  return type;
}

dea_status cli_models_check(struct dea_cli *cli, const struct dea_design *design)
{
  bool bad = false;
  for (size_t i = 0; i < design->compute.model_count; i++) {
    const struct dea_label *label = &design->compute.models[i];
    bad = cli_model_find(cli, label->text, label->place) == NULL || bad;
  }
  return bad ? dea_fail(cli->ctx, DEA_E_DESIGN, "a model is not known") : DEA_OK;
}

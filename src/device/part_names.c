#include "device/part_names.h"

#include "base/text.h"
#include "device/layout.h"

#include <string.h>

static const char *name_of(const struct dea_part_names *names, size_t i)
{
  return ((const struct dea_label *)(const void *)(names->first + i * names->stride))->text;
}

static dea_status not_there(struct dea_context *ctx, const struct dea_part_names *names,
                            const char *name, struct dea_location location)
{
  struct dea_text list = {.ctx = ctx};
  const char **all = dea_alloc(ctx, names->count, sizeof *all);
  DEA_TRY_MEMORY(all != NULL);
  for (size_t i = 0; i < names->count; i++) {
    all[i] = name_of(names, i);
    if (list.length < 300) {
      dea_text_add(&list, "%s'%.60s'", i > 0 ? ", " : "", all[i]);
    }
  }
  const char *near = dea_nearest_name(name, all, names->count);
  dea_status status =
      near != NULL
          ? dea_finding_add(ctx, DEA_ERROR, location, "there is no %s '%.60s'; did you mean '%s'?",
                            names->what, name, near)
          : dea_finding_add(ctx, DEA_ERROR, location, "there is no %s '%.60s'; there %s %s",
                            names->what, name, names->count == 1 ? "is" : "are",
                            names->count > 0 ? dea_text_get(&list) : "none");
  dea_text_free(&list);
  dea_free(ctx, all);
  return status;
}

dea_status dea_part_find(struct dea_context *ctx, const struct dea_part_names *names,
                         const char *name, struct dea_location location, size_t *out)
{
  for (*out = 0; *out < names->count; ++*out) {
    if (strcmp(name_of(names, *out), name) == 0) {
      return DEA_OK;
    }
  }
  *out = DEA_LAYOUT_NONE;
  return not_there(ctx, names, name, location);
}

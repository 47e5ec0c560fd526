#include "cli/models.h"

#include "base/file.h"
#include "device/device.h"

#include <string.h>
#include <unistd.h>

const struct dea_model_type *cli_model_find(struct dea_cli *cli, const char *name,
                                            struct dea_location location)
{
  const struct dea_model_type *type;
  dea_model_seek(cli->ctx, name, location, &type);
  return type;
}

dea_status cli_models_check(struct dea_cli *cli, const struct dea_design *design)
{
  bool bad = false;
  for (size_t i = 0; i < design->compute.model_count; i++) {
    const struct dea_label *label = &design->compute.models[i];
    const struct dea_model_type *type = cli_model_find(cli, label->text, label->location);
    bad = type == NULL || bad;
    if (type != NULL && design->parts != NULL && type->of_layouts == NULL) {
      dea_finding_add(cli->ctx, DEA_ERROR, label->location,
                      "the model '%.60s' knows only a disc in a round frame; a design with 'plies' "
                      "is computed by 3d",
                      label->text);
      bad = true;
    }
  }
  return bad ? dea_fail(cli->ctx, DEA_E_DESIGN, "a model is not known, or not for this device")
             : DEA_OK;
}

dea_status cli_variants_check(struct dea_cli *cli, const struct dea_design *design)
{
  dea_status first = DEA_OK;
  for (size_t i = 0; i < design->compute.compare_count; i++) {
    const struct dea_design *variant = design->compute.compare[i].design;
    struct dea_device *device = NULL;
    dea_status status = variant != NULL ? dea_device_build(cli->ctx, variant, &device) : DEA_OK;
    dea_device_destroy(cli->ctx, device);
    first = first == DEA_OK ? status : first;
  }
  return first;
}

/* Text in YAML's double quotes. */
static void add_quoted(struct dea_text *out, const char *text, size_t length)
{
  dea_text_add(out, "\"");
  for (size_t i = 0; i < length; i++) {
    dea_text_add(out, "%s%c", text[i] == '"' || text[i] == '\\' ? "\\" : "", text[i]);
  }
  dea_text_add(out, "\"");
}

void cli_designs_text(const char *const files[], size_t count, struct dea_text *out)
{
  char here[4096];
  if (getcwd(here, sizeof here) == NULL) {
    here[0] = '\0';
  }
  for (size_t i = 0; i < count; i++) {
    size_t length;
    const char *name = dea_path_stem(files[i], &length);
    struct dea_text path = {.ctx = out->ctx};
    dea_text_add(&path, "%s%s%s", files[i][0] == '/' ? "" : here, files[i][0] == '/' ? "" : "/",
                 files[i]);
    dea_text_add(out, "%s{name: ", i == 0 ? "[" : ", ");
    add_quoted(out, name, length);
    dea_text_add(out, ", file: ");
    add_quoted(out, dea_text_get(&path), strlen(dea_text_get(&path)));
    dea_text_add(out, "}%s", i + 1 == count ? "]" : "");
    out->failed = out->failed || path.failed;
    dea_text_free(&path);
  }
}

#include "cli/models.h"

#include "base/file.h"
#include "base/yaml_write.h"

#include <string.h>
#include <unistd.h>

const struct dea_model_type *cli_model_find(struct dea_cli *cli, const char *name,
                                            struct dea_location location)
{
  const struct dea_model_type *type;
  dea_model_seek(cli->ctx, name, location, &type);
  return type;
}

/* Text in YAML's double quotes. */
static void add_quoted(struct dea_text *out, const char *text, size_t length)
{
  dea_text_add(out, "\"");
  dea_yaml_add_quoted(out, text, length);
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

#include "job/design_of_run.h"

#include "study/design_file.h"

#include <string.h>

enum { OVERRIDES_MAX = 256 };

/* "key=value" a line -> overrides that lend from text, which is cut. */
static size_t split_overrides(char *text, struct dea_override *out)
{
  size_t count = 0;
  for (char *line = text; line != NULL && *line != '\0' && count < OVERRIDES_MAX;) {
    char *end = strchr(line, '\n'), *equals = strchr(line, '=');
    if (end != NULL) {
      *end = '\0';
    }
    if (equals != NULL && (end == NULL || equals < end)) {
      *equals = '\0';
      out[count++] = (struct dea_override){line, equals + 1};
    }
    line = end != NULL ? end + 1 : NULL;
  }
  return count;
}

dea_status dea_design_of_run(struct dea_context *ctx, const struct dea_run *run,
                             struct dea_design **design, struct dea_device **device)
{
  const struct dea_provenance *p = &run->result->provenance;
  struct dea_override overrides[OVERRIDES_MAX];
  const char *given = p->overrides != NULL ? p->overrides : "";
  const char *input = p->input != NULL ? p->input : "";
  *design = NULL;
  *device = NULL;
  char *text = dea_copy_text(ctx, given, strlen(given));
  const char *name = dea_intern(ctx, run->design_file);
  dea_status status = text == NULL || name == NULL ? DEA_E_MEMORY : DEA_OK;
  size_t count = text != NULL ? split_overrides(text, overrides) : 0;
  if (status == DEA_OK) {
    status = dea_design_read_memory(ctx, name, input, strlen(input), overrides, count, design);
  }
  status = status == DEA_OK ? dea_device_build(ctx, *design, device) : status;
  dea_free(ctx, text);
  return status;
}

#include "study/design_file.h"

#include "design/design_sections.h"
#include "model/model.h"
#include "study/study.h"

static dea_status check_model(struct dea_context *ctx, const struct dea_label *name)
{
  const struct dea_model_type *type;
  return dea_model_seek(ctx, name->text, name->location, &type);
}

/* Sections of the studies that have one, and the models. items: room for DEA_DESIGN_SECTIONS_MAX.
 */
static struct dea_design_sections sections_of(const struct dea_design_section **items)
{
  struct dea_design_sections out = {items, 0, check_model};
  size_t count;
  const struct dea_study *const *studies = dea_study_all(&count);
  for (size_t i = 0; i < count; i++) {
    if (studies[i]->keys != NULL && out.count < DEA_DESIGN_SECTIONS_MAX) {
      items[out.count++] = studies[i]->keys;
    }
  }
  return out;
}

void dea_design_file_schema(struct dea_design_schema *out)
{
  const struct dea_design_section *items[DEA_DESIGN_SECTIONS_MAX];
  const struct dea_design_sections sections = sections_of(items);
  dea_design_schema_fill(&sections, out);
}

dea_status dea_design_read(struct dea_context *ctx, const char *file,
                           const struct dea_override *overrides, size_t override_count,
                           struct dea_design **out)
{
  const struct dea_design_section *items[DEA_DESIGN_SECTIONS_MAX];
  const struct dea_design_sections sections = sections_of(items);
  return dea_design_read_with(ctx, &sections, file, overrides, override_count, out);
}

dea_status dea_design_read_memory(struct dea_context *ctx, const char *name, const char *bytes,
                                  size_t length, const struct dea_override *overrides,
                                  size_t override_count, struct dea_design **out)
{
  const struct dea_design_section *items[DEA_DESIGN_SECTIONS_MAX];
  const struct dea_design_sections sections = sections_of(items);
  return dea_design_read_memory_with(ctx, &sections, name, bytes, length, overrides, override_count,
                                     out);
}

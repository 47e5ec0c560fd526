#include "design/variants.h"

#include "base/file.h"

#include <string.h>

/* Place of what is wrong with a variant. The command line has none of its own (a line counts from
 * 1): there it is the design file that was named. */
static struct dea_location place_of(struct dea_context *ctx,
                                    const struct dea_design_variant *variant,
                                    const struct dea_location *own)
{
  const char *file = own->line == 0 && variant->file.origin != DEA_ABSENT
                         ? dea_intern(ctx, variant->file.text)
                         : NULL;
  return file != NULL ? (struct dea_location){file, 0, 0} : *own;
}

/* Another design, which compares itself with none. */
static dea_status read_other(struct dea_context *ctx, const struct dea_design_source *source,
                             struct dea_design_variant *variant)
{
  DEA_TRY(ctx, dea_design_read_source(ctx, source, variant->set, &variant->design));
  variant->design->compute.compare_count = 0;
  return DEA_OK;
}

static dea_status read_other_file(struct dea_context *ctx, const struct dea_design_source *source,
                                  struct dea_design_variant *variant)
{
  char *bytes = NULL, *path = dea_path_beside(ctx, source->name, variant->file.text);
  struct dea_design_source other = *source;
  DEA_TRY_MEMORY(path != NULL);
  dea_status status = dea_file_read(ctx, path, DEA_YAML_SIZE_MAX, &bytes, &other.length);
  if (status == DEA_E_IO) {
    const bool in_file = variant->file.location.line > 0; // else said as of a first file
    status = dea_finding_add(ctx, DEA_ERROR,
                             in_file ? variant->file.location : (struct dea_location){"", 0, 0},
                             "%s", dea_context_message(ctx));
    status = status == DEA_OK ? DEA_E_DESIGN : status;
  } else if (status == DEA_OK) {
    other.name = path;
    other.bytes = bytes;
    status = read_other(ctx, &other, variant);
  }
  dea_free(ctx, bytes);
  dea_free(ctx, path);
  return status;
}

static dea_status check_name(struct dea_context *ctx, const struct dea_design *design, size_t i)
{
  const struct dea_label *name = &design->compute.compare[i].name;
  const struct dea_location place = place_of(ctx, &design->compute.compare[i], &name->location);
  if (strlen(name->text) >= DEA_NAME_SIZE || strchr(name->text, '/') != NULL) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, place, "name: at most %d characters, and no '/'",
                                 DEA_NAME_SIZE - 1));
  }
  for (size_t k = 0; k < i && name->text[0] != '\0'; k++) {
    if (strcmp(design->compute.compare[k].name.text, name->text) == 0) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, place,
                                   "the name '%.60s' stands twice among the designs", name->text));
    }
  }
  return DEA_OK;
}

dea_status dea_design_read_variants(struct dea_context *ctx, const struct dea_design_source *source,
                                    struct dea_design *design)
{
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  for (size_t i = 0; i < design->compute.compare_count; i++) {
    struct dea_design_variant *variant = &design->compute.compare[i];
    DEA_TRY(ctx, check_name(ctx, design, i));
    dea_status status = DEA_OK;
    if (variant->file.origin != DEA_ABSENT) {
      status = read_other_file(ctx, source, variant);
    } else if (variant->set != NULL) {
      status = read_other(ctx, source, variant);
    }
    if (status != DEA_OK && status != DEA_E_DESIGN) {
      return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
    }
  }
  size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  if (found > 0) {
    return dea_fail(ctx, DEA_E_DESIGN, "the designs that '%s' compares have %zu error%s",
                    source->name, found, found > 1 ? "s" : "");
  }
  return DEA_OK;
}

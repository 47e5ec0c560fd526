#include "identify/fit_head.h"

#include "base/file.h"
#include "base/file_kind.h"
#include "result/provenance.h"

#include <string.h>

static dea_status check_name(struct dea_context *ctx, const struct dea_label *name)
{
  return strlen(name->text) < DEA_NAME_SIZE && strpbrk(name->text, "/\\ \t:#'\"") == NULL
             ? DEA_OK
             : dea_finding_add(ctx, DEA_ERROR, name->location,
                               "'%.80s' cannot be the name of a file: letters, digits and -, at "
                               "most %d",
                               name->text, DEA_NAME_SIZE - 1);
}

dea_status dea_fit_names_check(struct dea_context *ctx, const void *items, size_t count,
                               size_t size, const char *what)
{
  const char *bytes = items;
  for (size_t i = 0; i < count; i++) {
    const struct dea_label *name = (const void *)(bytes + i * size);
    for (size_t k = 0; k < i; k++) {
      const struct dea_label *other = (const void *)(bytes + k * size);
      if (name->text[0] != '\0' && strcmp(other->text, name->text) == 0) {
        DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, name->location,
                                     "the name '%.60s' is taken by the %s in line %zu", name->text,
                                     what, other->location.line));
      }
    }
  }
  return DEA_OK;
}

static dea_status read_bytes(struct dea_context *ctx, const char *bytes, size_t length,
                             const struct dea_fit_form *form, struct dea_fit_head *head)
{
  const struct dea_record *record = &form->record;
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  dea_sha256_hex(bytes, length, head->sha256);
  DEA_TRY(ctx, dea_yaml_parse(ctx, head->file, bytes, length, &head->document));
  struct dea_reader reader = {ctx, head->document, NULL};
  DEA_TRY(ctx, dea_file_kind_check(ctx, head->document, record->fields[0].key));
  DEA_TRY(ctx, dea_schema_read(&reader, record, dea_yaml_root(head->document), "", head));
  if (dea_finding_count(ctx, DEA_ERROR) == errors) {
    DEA_TRY(ctx, form->check != NULL ? form->check(ctx, head) : DEA_OK);
    DEA_TRY(ctx, check_name(ctx, &head->name));
  }
  size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  return found == 0 ? DEA_OK
                    : dea_fail(ctx, DEA_E_DESIGN, "the %s '%s' has %zu error%s", record->name,
                               head->file, found, found > 1 ? "s" : "");
}

dea_status dea_fit_file_has(struct dea_context *ctx, const char *file, const char *key, bool *out)
{
  char *bytes;
  size_t length;
  struct dea_yaml *document = NULL;
  *out = false;
  DEA_TRY(ctx, dea_file_read(ctx, file, DEA_YAML_SIZE_MAX, &bytes, &length));
  dea_status status = dea_yaml_parse(ctx, file, bytes, length, &document);
  if (status == DEA_OK) {
    const struct dea_node *root = dea_yaml_root(document);
    *out = root->kind == DEA_NODE_SECTION && dea_node_find(root, key) != NULL;
    dea_yaml_destroy(ctx, document);
  }
  dea_free(ctx, bytes);
  return status;
}

dea_status dea_fit_head_read(struct dea_context *ctx, const char *file,
                             const struct dea_fit_form *form, void **out)
{
  char *bytes;
  size_t length;
  *out = NULL;
  DEA_TRY(ctx, dea_file_read(ctx, file, DEA_YAML_SIZE_MAX, &bytes, &length));
  struct dea_fit_head *head = dea_alloc(ctx, 1, form->size);
  dea_status status = head != NULL ? DEA_OK : DEA_E_MEMORY;
  if (status == DEA_OK) {
    head->file = dea_intern(ctx, file);
    status = head->file != NULL ? read_bytes(ctx, bytes, length, form, head) : DEA_E_MEMORY;
  }
  dea_free(ctx, bytes);
  DEA_TRY_ELSE(ctx, status, dea_fit_head_destroy(ctx, head));
  *out = head;
  return DEA_OK;
}

void dea_fit_head_destroy(struct dea_context *ctx, void *fit)
{
  struct dea_fit_head *head = fit;
  if (head != NULL) {
    dea_yaml_destroy(ctx, head->document);
    dea_free(ctx, head);
  }
}

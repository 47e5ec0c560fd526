#include "base/file_kind.h"

#include <string.h>

static const struct {
  const char *key, *name, *use;
} kinds[] = {
    {"dea", "a design", "it is for 'dea run'"},
    {"dea-protocol", "a protocol", "it is for 'dea drive', and its key 'design' names the design"},
    {"dea_fit", "a fit", "it is for 'dea fit'"},
    {"dea_explore", "a file of many designs",
     "it is for 'dea sweep' or 'dea optimise', and its key 'design' names the design"},
    {"dea_material", "a material",
     "a design names it as its film's material, and 'dea materials' shows it"},
};

enum { KINDS = sizeof kinds / sizeof kinds[0] };

dea_status dea_file_kind_check(struct dea_context *ctx, const struct dea_yaml *document,
                               const char *own)
{
  const struct dea_node *root = dea_yaml_root(document);
  const char *wanted = "";
  for (size_t i = 0; i < KINDS; i++) {
    wanted = strcmp(kinds[i].key, own) == 0 ? kinds[i].name : wanted;
  }
  for (size_t i = 0; i < KINDS && root->kind == DEA_NODE_SECTION; i++) {
    const struct dea_node *node = dea_node_find(root, kinds[i].key);
    if (node != NULL && strcmp(kinds[i].key, own) != 0) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, node->key_place, "this is %s, not %s: %s",
                                   kinds[i].name, wanted, kinds[i].use));
      return dea_fail(ctx, DEA_E_DESIGN, "this is %s, not %s", kinds[i].name, wanted);
    }
  }
  return DEA_OK;
}

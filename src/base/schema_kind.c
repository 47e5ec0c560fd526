/* Sections whose keys depend on the kind that they name. */
#include "base/schema_value.h"

#include <string.h>

dea_status dea_schema_kind(const struct dea_reader *reader, const struct dea_node *node,
                           const char *what, const char *const names[], size_t count, size_t *index)
{
  const struct dea_node *kind = dea_node_find(node, "kind");
  const char *noun = strchr(what, ' ');
  char list[DEA_HINT_SIZE];
  noun = noun != NULL ? noun + 1 : what;
  for (*index = 0; *index < count; ++*index) {
    if (kind != NULL && strcmp(kind->text, names[*index]) == 0) {
      return DEA_OK;
    }
  }
  if (kind == NULL || kind->kind != DEA_NODE_VALUE || kind->empty) {
    return dea_schema_error(reader,
                            kind != NULL        ? kind->location
                            : node->key != NULL ? node->key_place
                                                : node->location,
                            "%s needs its kind: %s", what, dea_names_list(names, count, list));
  }
  dea_name_hint_list(kind->text, names, count, " All are: ", "; there are: ", list);
  return dea_schema_error(reader, kind->location, "there is no %s '%.60s'%s", noun, kind->text,
                          list);
}

#include "base/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void dea_json_add(json_t *object, const char *key, double value)
{
  if (isfinite(value)) {
    json_object_set_new(object, key, json_real(value));
  }
}

json_t *dea_json_number(double value)
{
  return isfinite(value) ? json_real(value) : json_null();
}

json_t *dea_json_add_list(json_t *object, const char *key)
{
  json_t *list = json_array();
  json_object_set_new(object, key, list);
  return list;
}

json_t *dea_json_append(json_t *list)
{
  json_t *object = json_object();
  json_array_append_new(list, object);
  return object;
}

void dea_json_add_count(json_t *object, const char *key, size_t count)
{
  json_object_set_new(object, key, json_integer((json_int_t)count));
}

void dea_json_add_text(json_t *object, const char *key, const char *text)
{
  json_t *value = json_string(text != NULL ? text : "");
  // Text that is not UTF-8 is not JSON; a file name may be any bytes.
  json_object_set_new(object, key, value != NULL ? value : json_string("(not UTF-8)"));
}

dea_status dea_json_text(struct dea_context *ctx, json_t *root, char **out)
{
  *out = NULL;
  char *dumped = root != NULL ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) : NULL;
  json_decref(root);
  if (dumped == NULL) {
    return dea_fail(ctx, DEA_E_MEMORY, "out of memory while writing JSON");
  }
  size_t length = strlen(dumped);
  char *text = dea_alloc(ctx, length + 2, 1);
  if (text != NULL) {
    memcpy(text, dumped, length); // NOLINT(bugprone-not-null-terminated-result): zeroed memory
    text[length] = '\n';
  }
  free(dumped);
  *out = text;
  return text != NULL ? DEA_OK : DEA_E_MEMORY;
}

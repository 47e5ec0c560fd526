/* Small things on jansson that the writers share. */
#pragma once

#include "base/context.h"

#include <jansson.h>

/* Sets a number unless it is not finite (JSON has no such number). */
void dea_json_add(json_t *object, const char *key, double value);
void dea_json_add_count(json_t *object, const char *key, size_t count);
/* Sets a new list, and adds a new object to a list; lent. */
json_t *dea_json_add_list(json_t *object, const char *key);
json_t *dea_json_append(json_t *list);
/* A number, or null where it is not finite. */
json_t *dea_json_number(double value);
/* Sets a text; NULL gives "". */
void dea_json_add_text(json_t *object, const char *key, const char *text);
/* Text of root with a final newline; takes root. out: owned by the caller (dea_free). */
dea_status dea_json_text(struct dea_context *ctx, json_t *root, char **out);

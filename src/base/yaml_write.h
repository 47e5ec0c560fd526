/* A YAML tree as text. */
#pragma once

#include "base/text.h"
#include "base/yaml.h"

/* Adds a document that dea_yaml_parse reads as the same tree; comments are not in the tree. */
void dea_yaml_write(const struct dea_node *root, struct dea_text *out);
/* Adds a text [length] as it stands between double quotes, without them. */
void dea_yaml_add_quoted(struct dea_text *out, const char *text, size_t length);

/* What is wrong with a text of YAML, for yaml.c. Not for others. */
#pragma once

#include "base/context.h"

#include <yaml.h>

/* Text to be read. */
struct dea_yaml_text {
  const char *name;  // for places
  const char *bytes; // [length]
  size_t length;
  const struct dea_location *fixed; // place of everything in it, or NULL
};

/* A finding at a place of the text, and DEA_E_DESIGN. */
dea_status dea_yaml_refuse(struct dea_context *ctx, const struct dea_yaml_text *text,
                           yaml_mark_t mark, const char *message);
/* The same with what the parser has failed at, in words of who wrote the file. */
dea_status dea_yaml_problem(struct dea_context *ctx, const struct dea_yaml_text *text,
                            const yaml_parser_t *parser);

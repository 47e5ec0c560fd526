/* What yaml.c asks of a text before it builds a tree of it. Not for others. */
#pragma once

#include "base/context.h"

/* Text to be read. */
struct dea_yaml_text {
  const char *name;  // for places
  const char *bytes; // [length]
  size_t length;
  const struct dea_location *fixed; // place of everything in it, or NULL
};

/* One pass over the events of the text, in time that grows with its length only. Refuses what is
 * not YAML or not UTF-8, what is empty, a second document, anchors, aliases, tags, nesting deeper
 * than DEA_YAML_DEPTH_MAX and more than DEA_YAML_NODES_MAX values: DEA_E_DESIGN after a finding.
 * libyaml alone takes minutes for a few megabytes of "[", since each token costs it the depth. */
dea_status dea_yaml_check(struct dea_context *ctx, const struct dea_yaml_text *text);

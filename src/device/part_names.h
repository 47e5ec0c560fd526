/* Parts of a design by name. */
#pragma once

#include "base/value.h"

/* Names of parts of one kind: labels in a list of structs. */
struct dea_part_names {
  const char *what;  // "shape"
  const char *first; // the label of the first one
  size_t count, stride;
};
#define DEA_PART_NAMES(what, items, count)                                                         \
  {                                                                                                \
    what, (const char *)&(items)->name, count, sizeof *(items)                                     \
  }

/* Number of the part with a name; DEA_LAYOUT_NONE after a finding at `location` that says which is
 * nearest, or which there are. */
dea_status dea_part_find(struct dea_context *ctx, const struct dea_part_names *names,
                         const char *name, struct dea_location location, size_t *out);

/* Reading of one design: its text, with changes, by the schema. */
#ifndef DEA_DESIGN_READ_H
#define DEA_DESIGN_READ_H

#include "design/design.h"

/* A design file's text with what the command line overrides. */
struct dea_design_source {
  const struct dea_design_sections *sections;
  const char *name, *bytes;
  size_t length;
  const struct dea_override *overrides; // [override_count]
  size_t override_count;
};

/* Reads a design with the values of a section in the place of its own (keys may be dotted; NULL: no
 * changes). The designs that it compares itself with are not read. changes: outlives the design. */
dea_status dea_design_read_source(struct dea_context *ctx, const struct dea_design_source *source,
                                  const struct dea_node *changes, struct dea_design **out);

#endif

/* Reading of designs that are made from a file by changes. Not installed. */
#ifndef DEA_DESIGN_VARIANTS_H
#define DEA_DESIGN_VARIANTS_H

#include "design/design.h"

/* A design file's text with what the command line overrides. */
struct dea_design_source {
  const char *name, *bytes;
  size_t length;
  const struct dea_override *overrides; // [override_count]
  size_t override_count;
};

/* Reads a design as dea_design_read_memory does, with the values of a section in the place of its
 * own (keys may be dotted; NULL: no changes) and without its `compute.compare`. changes: outlives
 * the design. */
dea_status dea_design_read_changed(struct dea_context *ctx, const struct dea_design_source *source,
                                   const struct dea_node *changes, struct dea_design **out);

/* Reads the designs that a design compares itself with. DEA_E_DESIGN after all were tried. */
dea_status dea_design_read_variants(struct dea_context *ctx, const struct dea_design_source *source,
                                    struct dea_design *design);

#endif

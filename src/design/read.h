/* Reading of one design: its text, with changes, by the schema. */
#pragma once

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

/* Moves the materials that stand in one line at `material` of film, electrodes, fibres and plies to
 * the list `materials`, under the name "film.material" or "plies.NAME.material". Findings for what
 * is wrong in them; DEA_E_MEMORY. */
dea_status dea_material_lines_expand(struct dea_context *ctx, struct dea_yaml *yaml);

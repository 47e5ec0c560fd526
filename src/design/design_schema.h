/* The schema of a design file: the table, and the struct that it fills. */
#pragma once

#include "base/schema.h"
#include "design/design.h"
#include "design/schema_parts.h"

enum { DEA_FIGURE_SVG, DEA_FIGURE_PDF, DEA_FIGURE_PNG, DEA_FIGURE_COUNT };

/* A design as the table reads it, before what is derived from several values. */
struct dea_design_raw {
  struct dea_design design;
  struct dea_quantity version;
  struct dea_quantity from_V, to_V, step_V;
  struct dea_choice back; // 1: the sweep returns
  struct dea_quantity voltages_V[DEA_DESIGN_VOLTAGES_MAX];
  size_t voltage_count;
  struct dea_choice figures[DEA_FIGURE_COUNT];
  size_t figure_count;
  struct dea_quantity fields_at_V[DEA_DESIGN_FIELDS_MAX];
  size_t fields_at_count;
  struct dea_parts parts; // of the general form, until the design has them
  const struct dea_node *shapes[DEA_PARTS_SHAPES_MAX]; // of several kinds: dea_parts_read
  size_t shape_count;
};

/* Parts of the table that have a file of their own; base as below. */
extern const struct dea_record dea_fabrication_record, dea_fabrication_general_record;

/* Row of a length with its film state (INPLANE), or of the stretched film (STRETCHED). */
#define DEA_LENGTH_ROW(its_kind, name, at, sample, text, ...)                                      \
  DEA_FIELD_ROW(its_kind, name, at, .unit = "m", .example = sample, .doc = text, __VA_ARGS__)

enum { DEA_DESIGN_TOP_MAX = 40, DEA_DESIGN_COMPUTE_MAX = 32 };

/* The table of one form of a design file; record's base: a struct dea_design_raw. */
struct dea_design_form {
  struct dea_record record, compute_record;
  struct dea_field top[DEA_DESIGN_TOP_MAX], compute[DEA_DESIGN_COMPUTE_MAX];
};
/* Tables of a design file with sections of studies: of the short form, which describes a disc in a
 * frame, and of the general one, which lists parts. They point to each other: not to be copied. */
struct dea_design_schema {
  struct dea_design_form disc, general;
  struct dea_shape_schema shapes;
};
void dea_design_schema_fill(const struct dea_design_sections *sections,
                            struct dea_design_schema *out);

/* Moves the materials that stand in one line at `material` of film, electrodes, fibres and plies to
 * the list `materials`, under the name "film.material" or "plies.NAME.material". Findings for what
 * is wrong in them; DEA_E_MEMORY. */
dea_status dea_material_lines_expand(struct dea_context *ctx, struct dea_yaml *yaml);

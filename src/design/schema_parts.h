/* Tables of the general form of a design, and the lists that they fill. */
#pragma once

#include "base/schema.h"
#include "design/parts.h"

/* A kind of shape: those of the geometry, whose tables are made of its parameters, and those that
 * are made of other shapes. */
enum { DEA_SHAPE_KINDS_MAX = 24, DEA_SHAPE_FIELDS_MAX = DEA_SHAPE_PARAMETERS_MAX + 3 };
struct dea_shape_schema {
  struct dea_record record[DEA_SHAPE_KINDS_MAX];
  const struct dea_record *kinds[DEA_SHAPE_KINDS_MAX + 1]; // [count], ended by NULL
  enum dea_parts_build make[DEA_SHAPE_KINDS_MAX];
  const struct dea_shape_type *type[DEA_SHAPE_KINDS_MAX];
  struct dea_field field[DEA_SHAPE_KINDS_MAX][DEA_SHAPE_FIELDS_MAX];
  size_t count;
};
/* Its parts point to each other: not to be copied. */
void dea_shape_schema_fill(struct dea_shape_schema *out);

/* Rows of the general form that the short one lacks: offsets count from a struct dea_design_raw.
 * The kinds of `shapes` are for dea_design_schema_fill. */
extern const struct dea_field dea_parts_fields[];
extern const size_t dea_parts_field_count;

/* Completes the lists that the tables have filled by the shapes [count], whose keys go with their
 * kinds (NULL: was no section), points, tables and waveforms; beside: path of the design file;
 * relative paths start from its folder. */
dea_status dea_parts_read(const struct dea_reader *reader, const struct dea_shape_schema *schema,
                          const char *beside, const struct dea_node *const *shapes, size_t count,
                          struct dea_parts *parts);
/* Each name that is taken by one before it is a finding. what: "ply". items: [count] of that size,
 * with a struct dea_label at offset. */
dea_status dea_check_names(struct dea_context *ctx, const char *what, const void *items,
                           size_t count, size_t size, size_t offset);

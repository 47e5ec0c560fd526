/* Tables of the general form of a design, and the lists that they fill. */
#pragma once

#include "base/schema.h"
#include "design/parts.h"

/* The parts as the tables read them. */
struct dea_parts_raw {
  const struct dea_node *shapes[DEA_PARTS_SHAPES_MAX]; // of several kinds: dea_parts_read
  struct dea_parts_ply plies[DEA_PARTS_PLIES_MAX];
  struct dea_parts_electrode electrodes[DEA_PARTS_ELECTRODES_MAX];
  struct dea_parts_channel channels[DEA_PARTS_CHANNELS_MAX];
  struct dea_parts_support supports[DEA_PARTS_SUPPORTS_MAX];
  struct dea_parts_body bodies[DEA_PARTS_BODIES_MAX];
  struct dea_parts_spring springs[DEA_PARTS_SPRINGS_MAX];
  struct dea_parts_pressure pressures[DEA_PARTS_PRESSURES_MAX];
  struct dea_parts_contact contacts[DEA_PARTS_CONTACTS_MAX];
  struct dea_parts_monitor monitors[DEA_PARTS_MONITORS_MAX];
  size_t shape_count, ply_count, electrode_count, channel_count, support_count, body_count;
  size_t spring_count, pressure_count, contact_count, monitor_count;
};

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

/* Makes the lists of what was read, with the shapes, points, tables and waveforms; beside: the
 * design file, from whose folder paths count. out: owned by the caller, also after a failure. */
dea_status dea_parts_read(const struct dea_reader *reader, const struct dea_shape_schema *schema,
                          const char *beside, const struct dea_parts_raw *raw,
                          struct dea_parts **out);

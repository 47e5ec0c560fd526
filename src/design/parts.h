/* The general form of a design: the parts of a device as they stand in the file, with their places
 * (docs/theory/devices.md). Names are resolved when the device is made (device/generator_parts.c).
 */
#pragma once

#include "base/arena.h"
#include "base/value.h"
#include "geometry/shape.h"
#include "waveform/waveform.h"

enum {
  DEA_PARTS_SHAPES_MAX = 1000,
  DEA_PARTS_PLIES_MAX = 100,
  DEA_PARTS_ELECTRODES_MAX = 200,
  DEA_PARTS_CHANNELS_MAX = 63,
  DEA_PARTS_SUPPORTS_MAX = 100,
  DEA_PARTS_BODIES_MAX = 50,
  DEA_PARTS_SPRINGS_MAX = 100,
  DEA_PARTS_PRESSURES_MAX = 50,
  DEA_PARTS_CONTACTS_MAX = 50,
  DEA_PARTS_MONITORS_MAX = 100,
  DEA_PARTS_OF_MAX = 64,
};

/* How a shape is made. */
enum dea_parts_build {
  DEA_MAKE_PRIMITIVE, // of `type`
  DEA_MAKE_UNION,
  DEA_MAKE_DIFFERENCE,
  DEA_MAKE_INTERSECTION,
  DEA_MAKE_ARRAY,
  DEA_MAKE_POLAR,
  DEA_MAKE_COPY,
  DEA_MAKE_DRAWING,
};

struct dea_parts_shape {
  struct dea_label name, kind;
  enum dea_parts_build make;
  const struct dea_shape_type *type; // of a primitive
  struct dea_quantity value[DEA_SHAPE_PARAMETERS_MAX];
  const struct dea_node *points; // as written
  const double (*point_m)[2];    // [point_count]
  size_t point_count;
  const char *of[DEA_PARTS_OF_MAX]; // [of_count] names of shapes
  struct dea_location of_place[DEA_PARTS_OF_MAX];
  size_t of_count;
  struct dea_quantity count_x, count_y, pitch_x, pitch_y; // array
  struct dea_quantity count, angle_rad;                   // polar: angle from one to the next
  struct dea_quantity x, y;       // polar: the centre; copy: shift after turn and reflection
  struct dea_quantity mirror_rad; // copy: direction of the mirror, through `about`; absent: none
  struct dea_quantity about_m[2]; // copy: what it is turned about
  size_t about_count;
  struct dea_label file, layer; // drawing
  struct dea_choice unit;       // of the drawing's lengths, in dea_parts_units; absent: the file's
};

/* Units of drawings and their lengths [m]. */
extern const char *const dea_parts_units[];
extern const double dea_parts_unit_m[];

struct dea_parts_ply {
  struct dea_label name, shape, material;
  struct dea_label law, permittivity, breakdown, viscosity; // ids of sets, "" = the first
  struct dea_quantity thickness_m;                          // free of stress, of each layer
  struct dea_quantity pre_stretch[2];
  size_t pre_stretch_count; // 1: the same along both axes
  struct dea_quantity angle_rad;
  struct dea_quantity elements; // absent: what the model takes
  struct dea_quantity layers;
};

enum dea_parts_side { DEA_SIDE_BOTTOM, DEA_SIDE_TOP };

struct dea_parts_electrode {
  struct dea_label name, ply, shape, channel;
  struct dea_choice side;       // enum dea_parts_side
  struct dea_quantity lead_rad; // absent: no lead
  struct dea_quantity sheet_resistance_ohm;
};

struct dea_parts_channel {
  struct dea_label name;
  struct dea_quantity ratio, voltage_V;
  const struct dea_node *section; // of its waveform; lent by the document; NULL: none
  struct dea_waveform *waveform;  // owned by the parts; NULL: none
};

enum dea_parts_hold { DEA_HOLD_CLAMPED, DEA_HOLD_HINGED, DEA_HOLD_X, DEA_HOLD_Y, DEA_HOLD_Z };
enum { DEA_HOLDS_MAX = 3, DEA_DIRECTIONS = 6 };

struct dea_parts_support {
  struct dea_label edge, shape, within; // of the first two one is absent
  struct dea_choice hold[DEA_HOLDS_MAX];
  size_t hold_count;
  struct dea_quantity move_m[3], force_N[3]; // absent: 0
};

struct dea_parts_body {
  struct dea_label name, shape;
  struct dea_choice free[DEA_DIRECTIONS]; // x, y, z, turn_x, turn_y, turn_z
  size_t free_count;
  bool free_given;
  struct dea_quantity mass_kg;
  struct dea_quantity force[DEA_DIRECTIONS]; // [N, N m]
  struct dea_quantity move[DEA_DIRECTIONS];  // [m, rad]; absent: not moved
};

struct dea_parts_spring {
  struct dea_label body;
  struct dea_choice direction; // x, y, z, turn_x, turn_y, turn_z
  struct dea_quantity stiffness_N_per_m, stiffness_N_m_per_rad;
  const struct dea_node *table; // as written
  const double (*row)[2];       // [row_count] place [m, rad] and force [N, N m]
  size_t row_count;
  struct dea_quantity free_at_m, free_at_rad;
};

struct dea_parts_pressure {
  struct dea_label name, ply, shape;
  struct dea_choice side; // enum dea_parts_side
  struct dea_quantity pressure_Pa, gas_m3, ambient_Pa, liquid_m3;
};

struct dea_parts_contact {
  struct dea_label name, ply, shape, with;
  struct dea_choice side; // enum dea_parts_side
  struct dea_quantity gap_m;
};

struct dea_parts_monitor {
  struct dea_label name, ply, shape, body, pressure, contact;
  struct dea_quantity at_m[2], from_m[2], to_m[2];
  size_t at_count, from_count, to_count; // 0 or 2
};

struct dea_parts {
  struct dea_arena memory; // of shapes, points and rows
  struct dea_parts_shape *shapes;
  struct dea_parts_ply *plies; // from bottom to top; owned, and the lists that follow too
  struct dea_parts_electrode *electrodes;
  struct dea_parts_channel *channels;
  struct dea_parts_support *supports;
  struct dea_parts_body *bodies;
  struct dea_parts_spring *springs;
  struct dea_parts_pressure *pressures;
  struct dea_parts_contact *contacts;
  struct dea_parts_monitor *monitors;
  size_t shape_count, ply_count, electrode_count, channel_count, support_count, body_count;
  size_t spring_count, pressure_count, contact_count, monitor_count;
  struct dea_location place; // of the key `plies`
};

/* Whether a channel has a waveform of its own; of NULL: false. */
bool dea_parts_in_time(const struct dea_parts *parts);

/* Frees what is in the parts, which then are empty. */
void dea_parts_clear(struct dea_context *ctx, struct dea_parts *parts);
/* NULL is fine. */
void dea_parts_destroy(struct dea_context *ctx, struct dea_parts *parts);

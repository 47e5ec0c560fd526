/* The layout of a device: what lies where (docs/theory/devices.md). It is what is drawn, meshed,
 * and cut, whatever made it: one of the generators (generator.h).
 *
 * All lengths are lengths of the flat film as it is stretched when parts are bonded to it; z goes
 * up through the plies. A layout is constant once made. */
#pragma once

#include "base/arena.h"
#include "geometry/region.h"
#include "geometry/symmetry.h"
#include "material/material.h"

#include <stdint.h>

#define DEA_LAYOUT_NONE SIZE_MAX // in place of a number of a part

enum { DEA_LAYOUT_CHANNELS_MAX = 64 }; // ground counted

/* A named part of the plane. */
struct dea_layout_region {
  const char *name;
  struct dea_region region; // with its holes, arcs exact
  struct dea_location location;
};

/* What a template knows of a ply beside its material. */
enum dea_ply_kind {
  DEA_PLY_SHEET,
  DEA_PLY_ELECTRODE, // it wrinkles with the film that it lies on
  DEA_PLY_GLUE,
  DEA_PLY_JOINT, // between a film that is a surface and what lies on it (docs/theory/membrane.md)
};

/* A sheet of one material in a region. In the list from bottom to top; where the one below it in
 * the list is not there, it lies on what is there. */
struct dea_layout_ply {
  const char *name;
  struct dea_material material;
  size_t region;
  double thickness_m;             // in the flat state, of all layers together
  double thickness_unstretched_m; // thickness_m times both pre-stretches
  double pre_stretch[2];          // from free of stress to the flat state, along its own two axes
  double angle_rad;               // of the first of them from the x axis
  size_t elements;                // through the thickness; 0: what the model takes
  size_t layers; // equally thick, with electrodes of the two channels by turns between; 0: 1
  enum dea_ply_kind kind;
  size_t joins; // of a bond: the ply that is a surface
  /* In the workshop: "" of one that is not cut, such as ink or glue that a template adds; else name
   * of its files where that does not follow from the ply's; NULL: it does. */
  const char *part;
  bool on_tabs; // its pieces are cut in one with a holder at the frame, until they are bonded
  struct dea_location location;
};

/* Without thickness and stiffness, on a face of a ply; a ply that lies there feels it too. */
struct dea_layout_electrode {
  const char *name;
  size_t region, ply;
  bool top;        // the face
  size_t channel;  // 0: ground
  bool lead;       // it has a lead to a pad on the frame, which no model sees
  double lead_rad; // direction of that from the electrode's centroid
  double
      sheet_resistance_ohm; // of a square of it, deformed or not; 0: ideal, also a lead of others
  struct dea_location location;
};

/* Its voltage: ratio times the voltage of the sweep, and one of its own. */
struct dea_layout_channel {
  const char *name; // of 0: "ground"
  double ratio, own_V;
  struct dea_location location;
  const char *waveform; // kind of that of a source of its own, which in time stands for the ratio's
                        // part; static; NULL: none
};

/* Nodes of all plies that are held at a shift, or bear a dead force. */
struct dea_layout_support {
  size_t region;  // in it, its boundary counts
  bool edge;      // only on the region's boundary
  size_t within;  // only what is in this region too; DEA_LAYOUT_NONE: no such limit
  int components; // that are held, bits 1, 2, 4: along x, y, z
  bool hinged;    // only the nodes at the bottom: the edge may turn
  size_t plies;   // only up to the top of the ply before this one in the list; 0: all plies
  double move_m[3];
  double force_N[3]; // in all, spread evenly over the plies' sides along the edge, or their volume
  struct dea_location location;
};

/* All that lies in a region moves as one. Components: bits 1, 2, 4 shift, 8, 16, 32 turn. */
struct dea_layout_body {
  const char *name;
  size_t region;
  int free;  // components that may move
  int moved; // components that are held at the next two instead
  double shift_m[3], turn_rad[3];
  double mass_kg; // beside that of its plies, at the centroid of the region
  double force_N[3], moment_N_m[3];
  struct dea_location location;
};

/* Pulls back a component of a body against the outside. */
struct dea_layout_spring {
  size_t body;
  int component;            // 0 to 2: shift along x, y, z; 3 to 5: turn about them
  double free_at;           // place [m or rad] at which it has no force
  double stiffness;         // [N/m or N m/rad] of a linear one
  size_t count;             // 0: linear; points of a table of force against place, from free_at on
  const double *at, *force; // [count], at rising; force that pulls back
  struct dea_location location;
};

enum dea_enclosure { DEA_OPEN, DEA_GAS, DEA_LIQUID };

/* Pressure that follows a face of a ply, > 0 into the ply: given, or that of what it encloses. */
struct dea_layout_pressure {
  const char *name;
  size_t region, ply;
  bool top;
  enum dea_enclosure encloses;
  double pressure_Pa; // of gas over what is outside, and of the flat film
  double volume_m3;   // of gas below the flat film; of a liquid what is added to that
  double ambient_Pa;  // outside of gas
  struct dea_location location;
};

/* A face of a ply that may touch a rigid plane at a distance, or a face of another ply. */
struct dea_layout_contact {
  const char *name;
  size_t region, ply;
  bool top;
  double gap_m; // of the flat face from the plane
  size_t with;  // the other ply; DEA_LAYOUT_NONE: a plane
  struct dea_location location;
};

enum dea_layout_monitor_kind {
  DEA_MONITOR_POINT,  // of a ply
  DEA_MONITOR_LINE,   // two points: their distance
  DEA_MONITOR_RADIUS, // a point, seen from another one that stays: outwards
  DEA_MONITOR_REGION, // of a ply's middle surface
  DEA_MONITOR_BODY,
  DEA_MONITOR_VOLUME,  // below a face with a pressure
  DEA_MONITOR_CONTACT, // of a face with what it touches
};

/* Where in a ply a point is. */
enum dea_monitor_level {
  DEA_LEVEL_FACES,  // the mean of the lower and the upper face
  DEA_LEVEL_MIDDLE, // the middle plane
  DEA_LEVEL_TOP,    // the upper face
};

/* What results are reported of. */
struct dea_layout_monitor {
  const char *name;
  enum dea_layout_monitor_kind kind;
  double at_m[2][2]; // a point, or the two of a line, or a point and the centre of its radius
  size_t ply;        // of these and of a region
  enum dea_monitor_level level; // of these
  size_t region, body, pressure, contact;
  struct dea_location location;
};

struct dea_layout {
  struct dea_context *ctx;
  struct dea_arena memory; // of all but the contours of regions
  struct dea_layout_region *regions;
  struct dea_layout_ply *plies; // from bottom to top
  struct dea_layout_electrode *electrodes;
  struct dea_layout_channel *channels; // [0]: ground
  struct dea_layout_support *supports;
  struct dea_layout_body *bodies;
  struct dea_layout_spring *springs;
  struct dea_layout_pressure *pressures;
  struct dea_layout_contact *contacts;
  struct dea_layout_monitor *monitors; // [monitor_count + disc_monitor_count]
  size_t region_count, ply_count, electrode_count, channel_count, support_count, body_count;
  size_t spring_count, pressure_count, contact_count, monitor_count;
  size_t disc_monitor_count; // those that a disc brings: columns of load points, without others
  bool polar; // directions of laws count from the radius, not from x: of the short form
  double gravity_m_per_s2[3];   // acceleration of free fall; 0: without weight
  struct dea_symmetry symmetry; // of all of it
  bool symmetry_found;          // it was looked for
};

static inline size_t dea_ply_layers(const struct dea_layout_ply *ply)
{
  return ply->layers > 1 ? ply->layers : 1;
}
/* Thickness of one of them before the pre-stretch, and after it. */
static inline double dea_ply_layer_m(const struct dea_layout_ply *ply)
{
  return ply->thickness_unstretched_m / (double)dea_ply_layers(ply);
}
static inline double dea_ply_stretched_layer_m(const struct dea_layout_ply *ply)
{
  return ply->thickness_m / (double)dea_ply_layers(ply);
}

/* Whether an electrode has a sheet resistance. */
bool dea_layout_has_sheet_resistance(const struct dea_layout *layout);
/* Whether a ply is between electrodes of two channels somewhere. */
bool dea_layout_is_dielectric(const struct dea_layout *layout, size_t ply);
/* The first ply of which that holds; NULL: there is none. */
const struct dea_layout_ply *dea_layout_film(const struct dea_layout *layout);
/* The next pair of electrodes of different channels on the upper and on the lower face of a ply,
 * from *at on, which starts at 0; false: there is no more. */
bool dea_layout_next_pair(const struct dea_layout *layout, size_t ply, size_t *at,
                          const struct dea_layout_electrode *pair[2]);
/* Number of a body, or channel of that name; DEA_LAYOUT_NONE. */
size_t dea_layout_find_body(const struct dea_layout *layout, const char *name);
size_t dea_layout_find_channel(const struct dea_layout *layout, const char *name);
/* DEA_E_DESIGN where the material of a ply has no density, which weight and inertia need. */
dea_status dea_layout_check_densities(struct dea_context *ctx, const struct dea_layout *layout);
/* Whether it has a force. */
bool dea_support_pulls(const struct dea_layout_support *support);
/* Whether it holds a whole boundary in all directions, as a frame does. */
bool dea_support_is_frame(const struct dea_layout_support *support);
/* {x min, y min, x max, y max} of all plies. */
void dea_layout_box_m(const struct dea_layout *layout, double out[4]);
/* Mirrors and rotations that plies, electrodes with their channels, supports, bodies, pressures,
 * and regions of monitors share, into `symmetry`; a generator calls it last. DEA_E_MEMORY. */
dea_status dea_layout_find_symmetry(struct dea_context *ctx, struct dea_layout *layout);

/* An empty one with ground for its only channel. The lists are made by the generator in `memory`.
 * out: owned by the caller. */
dea_status dea_layout_create(struct dea_context *ctx, struct dea_layout **out);
/* NULL is fine. */
void dea_layout_destroy(struct dea_context *ctx, struct dea_layout *layout);

/* Loads on a solid (docs/theory/loads.md). Dead ones are added to nodal forces, as
 * dea_solid_force lends them; the others are objects in the memory given whose dea_solid_load goes
 * to dea_solid_add_load and that outlive the solid. Surfaces are lent and outlive the objects. */
#pragma once

#include "model/solid/load/indenter.h"
#include "model/solid/load/load.h"
#include "model/solid/mesh/surface.h"

/* ---- dead loads; force: [node_count][3] [N], added to ---- */

/* Force per reference area in a fixed direction. A total force over a patch: that over
 * dea_surface_area. */
void dea_load_traction(const struct dea_surface *surface, const double traction_Pa[3],
                       double *force);

/* ---- spring of one component of a node, or of a rigid body, against the outside ---- */

struct dea_spring;
/* It pulls back by F(x - place), x: the component of the displacement over unit_m. */
struct dea_spring_options {
  size_t node;      // of a body: the first of its nodes for its shift, the second for its turn
  int component;    // 0, 1, 2 along the global axes
  double unit_m;    // 0: 1 m, so that x is in m, F in N; of a turn length_m: rad, N m
  double place;     // of x where a linear spring is free, and where a table has its 0
  double stiffness; // F by x of a linear spring, 0 or more
  /* A table in place of that: F through these points by a monotone cubic, straight on beyond its
   * ends. Its energy is the integral, so F may fall, as that of a bistable spring does. Copied. */
  size_t count;        // 0: linear; 2 or more
  const double *at;    // [count] rising
  const double *force; // [count]
};
/* DEA_E_ARGUMENT for numbers that cannot be. */
dea_status dea_spring_create(struct dea_context *ctx, const struct dea_spring_options *options,
                             struct dea_arena *memory, struct dea_spring **out);
/* Where the next solve brings `place`. */
void dea_spring_move(struct dea_spring *spring, double place);
/* F at x, with the place as it is. */
double dea_spring_force(const struct dea_spring *spring, double x);
struct dea_solid_load dea_spring_load(struct dea_spring *spring);

/* ---- pressure that follows the surface ---- */

struct dea_pressure;
/* The boundary of the surface must be held, or stay in planes through origin_m: symmetry planes, or
 * one on which it slides. At first 0 Pa. flat: it is a part of a flat face at rest, at the height
 * of the origin, whose boundary is free to move: its forces along z are exact, and those in the
 * plane but for p times what the boundary has risen, per length of it. */
dea_status dea_pressure_create(struct dea_context *ctx, const struct dea_surface *surface,
                               const double origin_m[3], bool flat, struct dea_arena *memory,
                               struct dea_pressure **out);
/* The surface closes a volume V in, V0 while the surface is flat. Gas has there the pressure p0
 * over pa, which is outside, and elsewhere (p0 + pa) V0/V - pa; p0 is what dea_pressure_set sets. A
 * liquid has whatever pressure keeps V - V0 at what dea_pressure_set sets [m^3]; in the iterations
 * it gives way by the stiffness. Of a pressure on a flat face. */
struct dea_enclosed {
  bool liquid;
  double volume_m3;           // V0 of gas; of a liquid what errors are relative to at least
  double ambient_Pa;          // pa, of gas
  double stiffness_Pa_per_m3; // of liquid
};
void dea_pressure_enclose(struct dea_pressure *pressure, const struct dea_enclosed *enclosed);
/* V - V0 at displacements u, and the pressure there; one that is given is the last goal, or how far
 * a solve came, whatever u. */
double dea_pressure_volume_m3(const struct dea_pressure *pressure, const double *u);
double dea_pressure_at_Pa(struct dea_pressure *pressure, const double *u);
/* Adds the slopes of that volume by u [node_count][3]. */
void dea_pressure_volume_slope(const struct dea_pressure *pressure, const double *u, double *slope);
/* A liquid gives way so many times less, with the pressure that it has at u: for slopes and modes,
 * where the stiffness stands for what is rigid. */
void dea_pressure_stiffen(struct dea_pressure *pressure, const double *u, double times);
/* Of the same face moved: a liquid has the pressure that the other one has come to, and gives way
 * as it does. For slopes at one state. */
void dea_pressure_hold(struct dea_pressure *pressure, const struct dea_pressure *other);
/* Pressure that the next solve goes to, positive into the body. */
void dea_pressure_set(struct dea_pressure *pressure, double pressure_Pa);
struct dea_solid_load dea_pressure_load(struct dea_pressure *pressure);

/* ---- contact with a rigid tip or another surface, without friction ---- */

struct dea_contact;
struct dea_contact_options {
  struct dea_indenter tip; // of another surface the radius alone: a length to compare gaps with
  double place_m[3];       // of the tip at first, see dea_indenter_distance
  /* In place of the tip: faces of the same grid, lent, one in the column of each face of the
   * surface, which face it. Each point of the surface stays with the face that it is opposite at
   * rest, drawn out beyond its edges where it slides: dea_contact_slide. NULL: the tip. */
  const struct dea_surface *other;
  /* Penalty: the answer does not depend on it, the number of rounds does. Some ten times the
   * stiffness per area behind the surface is good: a modulus over an element's size. */
  double stiffness_Pa_per_m;
  double tolerance; // of the pressure, relative, in the mean over the contact; 0: 1e-3
};
/* DEA_E_ARGUMENT for a tip that cannot be. */
dea_status dea_contact_create(struct dea_context *ctx, const struct dea_surface *surface,
                              const struct dea_contact_options *options, struct dea_arena *memory,
                              struct dea_contact **out);
/* Where the next solve brings the tip. */
void dea_contact_move(struct dea_contact *contact, const double place_m[3]);
/* Of the surface on the tip, or on the other surface, at the last equilibrium, u: its
 * displacements. */
void dea_contact_force(const struct dea_contact *contact, const double *u, double force_N[3]);
/* Reference area of the surface that touches [m^2]. */
double dea_contact_area(const struct dea_contact *contact);
/* How far what touches another surface has slid along it, at most, over the size of its face. */
double dea_contact_slide(const struct dea_contact *contact, const double *u);
/* Adds `factor` times the slopes of a component of that force: by u [node_count][3], and by the
 * pressures, the multipliers of the load, of those that there are. */
void dea_contact_force_slope(const struct dea_contact *contact, const double *u, int component,
                             double factor, double *by_u, double *by_pressure);
/* Of the same surface moved: what has a pressure in the other contact stays in touch, of any sign
 * that its pressure comes to have, and without a penalty. For slopes at one state. */
void dea_contact_hold(struct dea_contact *contact, const struct dea_contact *other);
/* Multipliers: contact pressures per reference area [face_count][points], at the nodes of each
 * face of the surface in their order. */
struct dea_solid_load dea_contact_load(struct dea_contact *contact);

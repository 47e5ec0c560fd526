/* A solid made of layered hexahedra: assembly, equilibrium at a voltage, count of unstable modes.
 *
 * The energy of hex.h is gone down (docs/theory/branches.md): while the tangent K has a negative
 * pivot of its LDL^T, an equal tension in all directions is added to it. Incompressibility is
 * brought in by multipliers that follow on the way, until J - 1 has no projection left.
 *
 * PETSc must be initialised (dea_solid_start). Under mpirun all ranks make the same calls with the
 * same arguments and get the same answers; the work is split among them. */
#pragma once

#include "model/solid/assembly/ranks.h"
#include "model/solid/assembly/solver_settings.h"
#include "model/solid/load/load.h"
#include "model/solid/mesh/grid.h"

struct dea_solid;

/* Where the field comes from: V/h in every active element, or a potential as a fourth unknown of
 * every node (docs/theory/coupled.md). */
enum dea_solid_field_kind { DEA_SOLID_FIELD_THIN, DEA_SOLID_FIELD_COUPLED };

/* Nodes that move as one: u_n = t + (R(w) - 1)(X_n - X_0), with a shift t and a rotation vector w
 * (docs/theory/bodies.md). Made with two nodes of the grid that have no elements
 * (dea_grid_add_nodes): the displacement of the first is t, that of the second length_m w. What is
 * asked of nodes can be asked of these: displacements, forces (of the second: moment over
 * length_m), reactions, springs; the functions dea_solid_body_... say it in their own units. */
struct dea_solid_body {
  size_t node;     // the first of the two, at X_0
  int held;        // components that are held as bits: 1, 2, 4 of t, 8, 16, 32 of w
  double length_m; // of the body; 0: the largest distance of its nodes from X_0
};

struct dea_solid_options {
  int order_z;
  enum dea_solid_field_kind field;
  size_t part_material_count;
  const struct dea_part_material *part_materials; // copied
  /* Part material of an element (NULL: the first of all), and whether it lies between electrodes
   * (NULL: none does; with a coupled field: for what fields and extremes report by V/h). */
  int (*part_material_of)(const void *self, int region, int ply);
  bool (*active)(const void *self, int region, int ply);
  /* Channels (docs/theory/devices.md) at the top and the bottom of an active element, each 0
   * (ground) to channel_count; NULL: the one channel at its top, ground at its bottom. Not for a
   * coupled field. share: [channel_count] of the voltage of a solve that a channel gets beside its
   * own; NULL: 1 each; copied. */
  void (*channels)(const void *self, int region, int ply, int *top, int *bottom);
  size_t channel_count; // 0: one
  const double *share;
  /* Components of a node that are held, as bits 1, 2, 4. */
  int (*held)(const void *self, const double X[3]);
  /* Local axes of a node as the rows of the orthonormal Q, which `held` then speaks of: for a
   * mirror plane that is not x = 0 or y = 0. false: the global axes. NULL: they are those of all
   * nodes. */
  bool (*frame)(const void *self, const double X[3], double Q[9]);
  /* Of a coupled field: whether a node is on an electrode, and the share of the voltage that this
   * one is at (0 on the ground). */
  bool (*electrode)(const void *self, const double X[3], double *share);
  /* Rigid bodies, copied; `held` and `frame` are not asked for their own nodes. body_of:
   * [node_count] one more than the place of the body that a node follows, 0: none. A follower may
   * be held only where its body cannot move it (a plane of symmetry). */
  size_t body_count;
  const struct dea_solid_body *bodies;
  const int *body_of;
  const double *point_mass_kg; // [node_count] beside the mass of elements, copied; NULL: none
  const struct dea_solid_load *loads; // [load_count] as by dea_solid_add_load
  size_t load_count;
  const void *self;
  const struct dea_solid_settings *settings; // copied; NULL: dea_solid_settings_default
};

/* How a solve went. */
struct dea_solid_report {
  int iterations;              // steps with a tangent of their own
  int factorisations, shifted; // shifted: of the factorisations
  int unstable_modes;          // negative pivots of the unshifted tangent at the end
  bool snapped;                // an unstable equilibrium on the way was left (branch.h)
  double energy_J, residual;   // residual: relative to the sum of element forces
  double theta_max;            // largest projected J - 1 left
  double load_error;           // largest constraint violation of a load over the one it allows
  double load_factor;          // share of the increment that was reached; 1 unless the solve failed
};

/* grid: lent, outlives the solid. out: owned by the caller, NULL on failure. */
dea_status dea_solid_create(struct dea_context *ctx, const struct dea_grid *grid,
                            const struct dea_solid_options *options, struct dea_solid **out);
void dea_solid_destroy(struct dea_context *ctx, struct dea_solid *solid);

/* The settings of the solves to come, lent; what is written there has passed
 * dea_solid_settings_check. */
struct dea_solid_settings *dea_solid_settings_of(struct dea_solid *solid);

/* Voltage of the last equilibrium. */
double dea_solid_voltage(const struct dea_solid *solid);

/* Own voltages [channels and ground] that the next solve brings the channels to, beside their
 * shares of its voltage; lent, at first 0; that of ground, [0], stays 0. */
double *dea_solid_own_voltages(struct dea_solid *solid);

/* Displacements [node_count][3], lent; they may be written to set a start. What the options hold
 * stays where it is. */
double *dea_solid_displacement(struct dea_solid *solid);

/* Dead loads on the nodes [node_count][3] [N] that the next solve goes to, lent; at first 0. */
double *dea_solid_force(struct dea_solid *solid);

/* Holds components (bits 1, 2, 4) of a node; the next solve moves them to these displacements.
 * Components are those of the node's local axes. */
dea_status dea_solid_prescribe(struct dea_context *ctx, struct dea_solid *solid, size_t node,
                               int components, const double displacement_m[3]);
/* Frees components of a node. */
dea_status dea_solid_release(struct dea_context *ctx, struct dea_solid *solid, size_t node,
                             int components);
/* Forces of the supports on the nodes at the last equilibrium [node_count][3] [N], along the global
 * axes; 0 along what is free. Lent. */
const double *dea_solid_reaction(const struct dea_solid *solid);

/* Holds components (bits as in struct dea_solid_body) of a body; the next solve moves them to this
 * shift and rotation vector, on a straight line of both. */
dea_status dea_solid_body_prescribe(struct dea_context *ctx, struct dea_solid *solid, size_t body,
                                    int components, const double shift_m[3],
                                    const double turn_rad[3]);
dea_status dea_solid_body_release(struct dea_context *ctx, struct dea_solid *solid, size_t body,
                                  int components);
/* Dead force at X_0 that the next solve goes to, and what does the work moment . dw: a moment while
 * turns are small. In place of what was there. */
void dea_solid_body_push(struct dea_solid *solid, size_t body, const double force_N[3],
                         const double moment_N_m[3]);
/* Where a body is. */
void dea_solid_body_place(const struct dea_solid *solid, size_t body, double shift_m[3],
                          double turn_rad[3]);
/* Force and moment about X_0 + t of what holds a body, at the last equilibrium, along the global
 * axes. */
void dea_solid_body_reaction(const struct dea_solid *solid, size_t body, double force_N[3],
                             double moment_N_m[3]);
/* The motion of a body's unknowns, direction [dofs], that this force (component 0 to 2) or moment
 * (3 to 5) is the work of. false: a moment where the body may turn, and so the motion changes. */
bool dea_solid_body_force_direction(const struct dea_solid *solid, size_t body, size_t component,
                                    double *direction);

/* Adds a load for all solves to come; copied. */
dea_status dea_solid_add_load(struct dea_context *ctx, struct dea_solid *solid,
                              const struct dea_solid_load *load);

/* out = M v with the consistent mass of the part materials' densities, [node_count][3] both and not
 * the same memory, what is held included: the forces that accelerations v take, or momenta. All
 * ranks call it and get the whole. */
dea_status dea_solid_mass_apply(struct dea_context *ctx, const struct dea_solid *solid,
                                const double *v, double *out);

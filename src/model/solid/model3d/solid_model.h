/* What the files of the model "3d" share: its struct, and what one of them needs of another. */
#pragma once

#include "model/solid/actuator/layout_mesh.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/equilibrium/solve_incremental.h"
#include "model/solid/load/loads.h"
#include "model/solid/model3d/buckling_branch.h"
#include "model/solid/model3d/indent.h"
#include "model/solid/model3d/plies.h"
#include "model/solid/model3d/solid_observe.h"
#include "model/solid_module.h"

/* What a state belongs to beside the solid's mesh and materials. */
struct dea_model_marks {
  double *out; // NULL: only counted
  size_t count;
};

/* A dead force along the slope of a coordinate by the displacements. */
struct dea_model_pull {
  struct dea_control coordinate;
  double *slope; // [dofs]; NULL: there was none yet
  double force;
};

/* The way to a voltage, and where it ends. Zeroed at first but for the model. */
struct dea_step_outcome {
  struct dea_model *model;  // whose it is
  double from_V, from_area; // where the last way began, and the film's area there
  struct dea_event limit;   // where the last way came to its end
  bool limited;             // it is known
  struct dea_event passed;  // a limit point that the last way has gone past to another state
  struct dea_solid_saved_state
      at_limit;                    // there, of `passed` where that is known; state NULL: none was
  bool has_passed;                 // it is known
  bool grew;                       // the film has at once, on the last step
  double tension[3], tension_V[3]; // smallest of the film [N/m], at the last points looked at
  double area;                     // largest area stretch at the last of them
  struct dea_solid_extremes film;  // of the films where they were evaluated last
  double *film_at[2]; // there and where the solid is: displacements, voltages; NULL: nowhere yet
  struct dea_arena memory; // of these
};

/* Where the solid is: its last equilibrium, and the way to the next one. */
struct dea_solver_state {
  struct dea_step_outcome outcome; // of the last solve
  struct dea_solid_report report;
  double voltage_V, rest_energy_J;
  bool as_made;                    // at rest, where making the model has led, and moved nowhere yet
  bool left_a_state;               // a state was left on the way to here: there are several
  struct dea_circuit_step *driven; // NULL: no history in time
  double stored_J;                 // of the film when that began
  double *soft;                    // [soft_count][3 node_count] softest modes; owned
  size_t soft_count;
};

/* Where the film's extremes are at an equilibrium: those of a changed device are taken there. */
struct dea_gradient_places {
  struct dea_film_place at[DEA_FILM_EXTREMES];
  bool known[DEA_FILM_EXTREMES];
};

struct dea_model {
  struct dea_solid_head head; // first
  struct dea_solver_state at;
  const struct dea_device *device;
  const struct dea_layout *layout; // of the mesh
  bool disc;                       // on a mesh of blocks
  struct dea_model_settings settings;
  struct dea_adapt_pass *passes; // [pass_count] that led to its mesh; NULL: none
  size_t pass_count;
  struct dea_arena memory; // of all arrays
  struct dea_layout_mesh mesh;
  struct dea_plies plies;
  struct dea_film_band band;       // where the film is
  struct dea_indent *indent;       // NULL: no probe
  double *profile;                 // what the last one lends from
  struct dea_solid_body *bodies;   // [body_count]
  double (*push)[6];               // [body_count] dead force and moment
  struct dea_pressure **pressures; // [pressure_count]
  struct dea_contact **contacts;   // [contact_count], NULL where none of it is meshed
  struct dea_solid *solid;
  struct dea_observer *observer;
  int *follows;           // [nodes] body that a node moves with, counted from 1; 0: none
  int *on_side;           // [nodes of the mesh] components that the sides of a sector hold
  double copies;          // of the sector in the device
  bool *on;               // [nodes of the plane mesh] for who marks them
  size_t mesh_node_count; // without those of bodies
  double pressure_factor; // on all pressures
  double *rest;           // u [3 node_count] where it was released, and multipliers there
  bool rest_is_one_of;    // several states there
  bool slid;              // dea_solid_contacts_check has warned
  struct dea_model_moved *controls;  // [body_count] components that moves have set
  struct dea_model_pull pull;        // the force conjugate to a coordinate
  struct dea_model_variant *variant; // a changed device is under the solid; NULL: its own
  double (*answers)[2];              // of the last response, as in model/model.h
  struct dea_model_marks marks;      // of saved states, made by the first
};

/* Components of a body, as bits, that are where a control has brought them, and that have its force
 * or moment, in place of what the design says. */
struct dea_model_moved {
  int place, force;
};

/* What a changed device takes the place of. Mesh, part materials and loads of the changed device
 * are those of a solid of its own, of which nothing is solved. */
struct dea_model_variant {
  struct dea_model own;             // as it was
  struct dea_solid_problem problem; // as it was
  struct dea_solid *solid;          // of the changed device; NULL: there is none
  double *force, *own_V;            // [dofs], [channels] as they were
  double *rest;                     // [dofs] u at rest, room
  double *u, *shift;         // [dofs] u as it was, and how much farther the changed device is moved
  bool is_moved;             // by that, from u
  enum dea_observed *motion; // [monitor_count of the question]
  struct dea_indent *indent; // of the changed device or tip; NULL: none
  struct dea_gradient_places places;
  const struct dea_gradient_request *ask;
};

/* A height of what may bend, and the two nodes in whose middle it is. */
struct dea_model_place {
  size_t node[2];
  double z_m;
};

// solid_loads.c: weight, bodies, supports, loads, and the way to rest
bool dea_solid_has_weight(const struct dea_layout *l);
/* Before anything that takes densities: a disc says where the film's is taken for another one. */
dea_status dea_solid_check_densities(struct dea_context *ctx, const struct dea_model *model);
dea_status dea_solid_bodies_add(struct dea_context *ctx, struct dea_model *model,
                                double **point_mass);
/* Contacts of the mesh, and as loads for the solid to be made with, *loads [*count]. */
dea_status dea_solid_contacts_create(struct dea_context *ctx, struct dea_model *model,
                                     struct dea_solid_load **loads, size_t *count);
/* Warns, once, of faces that have slid too far along what they touch. */
dea_status dea_solid_contacts_check(struct dea_context *ctx, struct dea_model *model);
dea_status dea_solid_loads_add(struct dea_context *ctx, struct dea_model *model);
/* To the state of the loads at 0 V. */
dea_status dea_solid_loads_release(struct dea_context *ctx, struct dea_model *model);
/* All pressures at once, times a factor. */
void dea_solid_pressures_set(const struct dea_model *model, double factor);
/* The force and moment on a body, or the sector's part of them. */
void dea_solid_body_load(const struct dea_model *model, size_t body, const double push[6]);
dea_status dea_solid_bodies_load(struct dea_context *ctx, struct dea_model *model);
/* Weight and forces of supports as the dead loads; those of bodies come to them. */
dea_status dea_solid_dead_loads_set(struct dea_context *ctx, const struct dea_model *model);
/* Liquids are as good as rigid, or again as soft as iterations need them. */
void dea_solid_liquids_stiffen(const struct dea_model *model, bool stiff);
/* Supports only; moved: with their own shifts. */
dea_status dea_solid_supports_hold(struct dea_context *ctx, struct dea_model *model, bool moved);

// solid_report.c: points, and what is told when one is there
/* Of a disc; NAN of what is none. */
double dea_solid_model_centre_z(const struct dea_model *model, const double *u);
/* The highest place with sign 1, the lowest with -1. */
struct dea_model_place dea_solid_model_height(const struct dea_model *model, double sign);
/* What of a point the displacements say by themselves. */
void dea_solid_model_describe(const struct dea_model *model, double voltage_V,
                              struct dea_load_point *out);
dea_status dea_solid_model_report(struct dea_context *ctx, struct dea_model *model,
                                  double voltage_V, struct dea_load_point *out);
/* Another state was left on the way; what is back at rest has nothing of that. */
void dea_solid_model_note_states(struct dea_model *model, bool left);
/* After each load step that came to its voltage. */
dea_status dea_solid_model_arrived(struct dea_context *ctx, struct dea_model *model,
                                   double voltage_V);

// step_outcome.c: to a voltage, and why it ends
/* To a voltage from that of the last equilibrium, from_V. Where that fails the message is the
 * verdict: pull-in or snap-back (DEA_E_NO_EQUILIBRIUM), loss of tension (DEA_E_SLACK), an inverted
 * element, the end of a law, or that it is ours; what arrived before stays. */
dea_status dea_step_outcome_go(struct dea_context *ctx, struct dea_step_outcome *outcome,
                               double from_V, double voltage_V, struct dea_solid_report *report);
/* The same to the other controls that the solid is asked for, at its voltage. *fraction: of the way
 * to the limit point that it has passed, or at which it ends (DEA_E_NO_EQUILIBRIUM); NAN: none. */
dea_status dea_step_outcome_move(struct dea_context *ctx, struct dea_step_outcome *outcome,
                                 struct dea_solid_report *report, double *fraction);
/* A longer way is gone in such load steps. */
double dea_step_outcome_longest_V(const struct dea_step_outcome *outcome);
void dea_step_outcome_free(struct dea_step_outcome *outcome);
/* As `solve` of struct dea_model_type. */
dea_status dea_solid_model_solve(struct dea_context *ctx, struct dea_model *model, double voltage_V,
                                 struct dea_load_point *out);
/* Equilibria are looked for from where a history in time has come to, or the model's making: before
 * other ways than dea_solid_model_solve. */
void dea_solid_model_end_history(struct dea_context *ctx, struct dea_model *model);

// solid_make.c: from a device to its solid at rest
/* The mesh of its device, like: with the elements of that one; NULL: its own. */
dea_status dea_solid_model_mesh(struct dea_context *ctx, struct dea_model *model,
                                const struct dea_layout_mesh *like);
/* Part materials, loads, the solid and its observer on that mesh. */
dea_status dea_solid_model_assemble(struct dea_context *ctx, struct dea_model *model);
dea_status dea_solid_model_prepare(struct dea_context *ctx, const struct dea_device *device,
                                   const struct dea_model_settings *settings,
                                   struct dea_model *model);
void dea_solid_model_destroy(struct dea_context *ctx, struct dea_model *model);

// circuit_step.c: in time, together with the supply's circuit (docs/theory/time.md)
/* From the model's last equilibrium, at rest there for long and charged to its voltage. model:
 * lent, and its solid in time, until *out is destroyed; of time->own_sources as well.
 * DEA_E_UNSUPPORTED for channels with a voltage or a source of their own in a circuit that is not
 * ideal. */
dea_status dea_circuit_step_create(struct dea_context *ctx, const struct dea_model *model,
                                   const struct dea_time_options *time,
                                   struct dea_circuit_step **out);
void dea_circuit_step_destroy(struct dea_context *ctx, struct dea_circuit_step *driven);

/* advance and accept of struct dea_model_type. */
dea_status dea_circuit_step_advance(struct dea_context *ctx, struct dea_circuit_step *driven,
                                    const struct dea_time_step *step,
                                    struct dea_solid_report *report, double *error);
void dea_circuit_step_accept(struct dea_circuit_step *driven);

/* Time, voltages, charge, current, energies and works of the last advance into *point; its
 * stored_energy_J and energy_J count from the start. */
void dea_circuit_step_point(const struct dea_circuit_step *driven, struct dea_load_point *point);

/* Sum of charges times voltages after the last advance, or at the start [J]. */
double dea_circuit_step_charged_J(const struct dea_circuit_step *driven);
/* Mean current from the source of each channel into the film in the last step, [channel_count + 1]
 * with ground, 0 of a jump; lent. NULL: currents of channels are not found. */
const double *dea_circuit_step_currents_A(const struct dea_circuit_step *driven);

// motions.c: as in struct dea_model_type
dea_status dea_solid_model_modes(struct dea_context *ctx, struct dea_model *model,
                                 const struct dea_load_point *at, size_t count,
                                 struct dea_load_point *points, struct dea_field_mesh **shapes);
dea_status dea_solid_model_respond(struct dea_context *ctx, struct dea_model *model,
                                   const struct dea_load_point *at,
                                   const struct dea_ac_excitation *excitation,
                                   const double *frequency_Hz, size_t count,
                                   struct dea_load_point *points);
/* The film's middle surface whose displacement is a motion v [3 nodes], and whose other fields are
 * not to be read. out: owned by the caller, NULL on failure. */
dea_status dea_solid_model_surface(struct dea_context *ctx, const struct dea_model *model,
                                   const double *v, struct dea_field_mesh **out);
/* All copies of the sector in the place of *mesh; that of a disc says how it is to be unfolded. */
dea_status dea_solid_model_whole(struct dea_context *ctx, const struct dea_model *model,
                                 struct dea_field_mesh **mesh);

// adapt.c: as in struct dea_model_type
dea_status dea_solid_model_create(struct dea_context *ctx, const struct dea_device *device,
                                  const struct dea_model_settings *settings,
                                  struct dea_model **out);
dea_status dea_solid_model_errors(struct dea_context *ctx, struct dea_model *model, double *error);

// compliance.c
struct dea_adjoint;
/* dR/dV at the unknowns as they are, added to rate [dofs], and of the energy there the first and
 * the second slope (NULL: not wanted), by central differences: residuals and energy are of second
 * degree in the voltage, so that any step is exact but for films that wrinkle freely. */
dea_status dea_solid_model_rate(struct dea_context *ctx, struct dea_solid *solid,
                                struct dea_adjoint *adjoint, double voltage_V, double step_V,
                                double *rate, double by_energy[2]);

// compliance.c, solid_controls.c: as in struct dea_model_type
dea_status dea_solid_model_compliance(struct dea_context *ctx, struct dea_model *model,
                                      const struct dea_control *coordinate, int with,
                                      struct dea_compliance *out);
dea_status dea_solid_model_move(struct dea_context *ctx, struct dea_model *model,
                                const struct dea_control *control, double value,
                                struct dea_load_point *out);
/* The slope of a coordinate by the displacements, which does not depend on them, into model->pull.
 */
dea_status dea_solid_model_find_coordinate(struct dea_context *ctx, struct dea_model *model,
                                           const struct dea_control *control);
/* What the next solve or step in time goes to. */
dea_status dea_solid_model_set_control(struct dea_context *ctx, struct dea_model *model,
                                       const struct dea_control *control, double value);

// solid_variant.c: changed devices under the solid, for gradient.c
/* Keeps what a changed device takes the place of, in memory of the caller's. */
dea_status dea_variant_begin(struct dea_context *ctx, struct dea_model *model,
                             const struct dea_gradient_request *ask, struct dea_arena *memory);
/* Puts mesh, part materials and loads of one side of a change under the solid, whose unknowns stay.
 * DEA_E_ARGUMENT and DEA_E_UNSUPPORTED where the mesh cannot follow. */
dea_status dea_variant_enter(struct dea_context *ctx, struct dea_model *model,
                             const struct dea_design_change *change, int side);
/* The own device, with what its tip holds by multipliers alone, without their penalties. */
dea_status dea_variant_hold_tip(struct dea_context *ctx, struct dea_model *model);
/* And back from both, also after a failure. */
void dea_variant_leave(struct dea_context *ctx, struct dea_model *model);
/* out [dofs], pressures [elements][pressures], 0 before: slope of a column of load points by the
 * unknowns at the equilibrium, behind the pressures by the multipliers of loads; *known false: the
 * model has none. */
dea_status dea_variant_slope(struct dea_context *ctx, struct dea_model *model, int column,
                             double *out, double *pressures, bool *known);
/* The same of the motion of monitor i of the question, out [dofs]; of a force on a body in its
 * place the motion that it does work along, direction [dofs], 0 before. false: not known. */
bool dea_variant_monitor_slope(const struct dea_model *model, size_t i, double *out,
                               double *direction);
/* The motions of all that are asked for at the unknowns as they are, out [monitor_count] of the
 * question. */
dea_status dea_variant_monitors(struct dea_context *ctx, struct dea_model *model, double *out);
/* Quantities of the changed device at these unknowns; energy_J: of the solid there. */
dea_status dea_variant_point(struct dea_context *ctx, struct dea_model *model, double voltage_V,
                             double energy_J, struct dea_load_point *out);

// gradient.c: as in struct dea_model_type
dea_status dea_solid_model_gradient(struct dea_context *ctx, struct dea_model *model,
                                    const struct dea_gradient_request *ask, double *out);

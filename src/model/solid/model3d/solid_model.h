/* What the files of the model "3d" share: its struct, and what one of them needs of another. */
#pragma once

#include "model/solid/actuator/layout_mesh.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/load/loads.h"
#include "model/solid/model3d/adapt.h"
#include "model/solid/model3d/buckling_branch.h"
#include "model/solid/model3d/gradient.h"
#include "model/solid/model3d/indent.h"
#include "model/solid/model3d/plies.h"
#include "model/solid/model3d/solid_observe.h"
#include "model/solid/model3d/solver_state.h"

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

struct dea_model {
  struct dea_solver_state at; // first (solver_state.h)
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
  struct dea_spring **springs;     // [spring_count]
  struct dea_pressure **pressures; // [pressure_count]
  struct dea_surface **surfaces;   // [pressure_count]
  struct dea_contact **contacts;   // [contact_count], NULL where none of it is meshed
  struct dea_surface *(
      *touching)[2]; // [contact_count] its face, and the other one's; NULL: a plane
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
  double *answers;                   // of the last response, as in model/model.h
  double *answer;                    // [monitor_count][DEA_OBSERVED_MOTIONS] work of it
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
dea_status dea_solid_model_report(struct dea_context *ctx, void *self, double voltage_V,
                                  struct dea_load_point *out);
/* Another state was left on the way; what is back at rest has nothing of that. */
void dea_solid_model_note_states(struct dea_model *model, bool left);
dea_status dea_solid_model_arrived(struct dea_context *ctx, void *self, double voltage_V);

// solid_make.c: from a device to its solid at rest
dea_status dea_solid_model_assemble(struct dea_context *ctx, struct dea_model *model);
void dea_solid_model_check_mesh(struct dea_model *model);
void dea_solid_model_find_band(struct dea_model *model);
void dea_solid_model_free_parts(struct dea_context *ctx, struct dea_model *model);
dea_status dea_solid_model_prepare(struct dea_context *ctx, const struct dea_device *device,
                                   const struct dea_model_settings *settings,
                                   struct dea_model *model);
void dea_solid_model_destroy(struct dea_context *ctx, struct dea_model *model);

// solid_controls.c: as in struct dea_model_type
dea_status dea_solid_model_compliance(struct dea_context *ctx, struct dea_model *model,
                                      const struct dea_control *coordinate, int with,
                                      struct dea_compliance *out);
dea_status dea_solid_model_move(struct dea_context *ctx, struct dea_model *model,
                                const struct dea_control *control, double value,
                                struct dea_load_point *out);
dea_status dea_solid_model_advance(struct dea_context *ctx, struct dea_model *model,
                                   const struct dea_time_step *step, struct dea_load_point *out,
                                   double *error);

// solid_variant.c: slopes by changed devices under the solid
dea_status dea_solid_model_gradient(struct dea_context *ctx, struct dea_model *model,
                                    const struct dea_gradient_request *ask, double *out);

/* Model "3d" behind the common interface: a device as a solid, on a sector or as a whole. It is the
 * whole of the loadable module that model/solid_module.c opens. */
#include "base/module.h"
#include "model/film.h"
#include "model/make.h"
#include "model/solid/actuator/disc_mesh.h"
#include "model/solid/adapter/adapt.h"
#include "model/solid/adapter/buckling_branch.h"
#include "model/solid/adapter/dead_force.h"
#include "model/solid/adapter/gradient.h"
#include "model/solid/adapter/indent.h"
#include "model/solid/adapter/motions.h"
#include "model/solid/adapter/plies.h"
#include "model/solid/adapter/solid_fields.h"
#include "model/solid/adapter/solid_observe.h"
#include "model/solid/adapter/solver_state.h"
#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/charge_control.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/load/loads.h"
#include "model/solid/recovery/line_profile.h"
#include "result/columns.h"
#include "result/copies.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double field_step_V_per_m = 10e6; // a longer way is gone in such steps of V/H0
static const double no_motion[3] = {0};
enum { resolved = 6 }; // elements through the film from which a coupled field is (coupled.md)

/* What a state belongs to beside the solid's mesh and materials. */
struct marks {
  double *out; // NULL: only counted
  size_t count;
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
  struct dea_solid *solid;
  struct dea_observer *observer;
  int *follows;             // [nodes] body that a node moves with, counted from 1; 0: none
  int *on_side;             // [nodes of the mesh] components that the sides of a sector hold
  double copies;            // of the sector in the device
  bool *on;                 // [nodes of the plane mesh] for who marks them
  size_t mesh_node_count;   // without those of bodies
  double pressure_factor;   // on all pressures
  double *rest;             // u [3 node_count] where it was released, and multipliers there
  bool rest_is_one_of;      // several states there
  struct dea_control moved; // of the last move
  struct moved *controls;   // [body_count] components that moves have set
  struct variant *variant;  // a changed device is under the solid; NULL: its own
  double *answers;          // of the last response, as in model/model.h
  double *answer;           // [monitor_count][DEA_OBSERVED_MOTIONS] work of it
  struct marks marks;       // of saved states, made by the first
};

/* Components of a body, as bits, that are where a control has brought them, and that have its force
 * or moment, in place of what the design says. */
struct moved {
  int place, force;
};

/* What a changed device takes the place of. Mesh, part materials and loads of the changed device
 * are those of a solid of its own, of which nothing is solved. */
struct variant {
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
  const struct dea_gradient_ask *ask;
};

// Weight ------------------------------------------------------------------------------------------

static bool has_weight(const struct dea_layout *l)
{
  const double *g = l->gravity_m_per_s2;
  return g[0] != 0 || g[1] != 0 || g[2] != 0;
}

/* Before anything that takes densities: a disc says where the film's is taken for another one. */
static dea_status check_mass(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_device *d = model->device;
  const bool electrodes = d->electrode_thickness_m > 0 && !(d->electrode.density_kg_per_m3 > 0);
  const bool glue = d->fibre_count > 0 && d->bond_thickness_m > 0;
  const char *const unknown[2] = {electrodes ? "electrodes" : NULL, glue ? "glue" : NULL};
  DEA_TRY(ctx, dea_device_check_densities(ctx, d));
  for (int i = 0; i < 2; i++) {
    if (unknown[i] != NULL) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                   "model 3d: the density of the %s is unknown; that of the film, "
                                   "%.4g kg/m^3, is taken",
                                   unknown[i], d->film.density_kg_per_m3));
    }
  }
  return DEA_OK;
}

// Bodies -----------------------------------------------------------------------------------------

enum { ALL_COMPONENTS = 63 };

/* Numbers of the nodes that move with a body into follows [all nodes], counted from 1. */
static dea_status mark_body(struct dea_context *ctx, struct dea_model *model, size_t i,
                            size_t *found)
{
  const struct dea_layout_body *body = &model->layout->bodies[i];
  dea_layout_mesh_mark(&model->mesh, body->region, false, DEA_LAYOUT_NONE, model->on);
  *found = 0;
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    if (model->on[model->mesh.grid->column[n]]) {
      model->follows[n] = (int)i + 1;
      ++*found;
    }
  }
  if (*found == 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, body->location,
                                 "body '%s': no ply is in its shape '%s'", body->name,
                                 model->layout->regions[body->region].name));
    return dea_fail(ctx, DEA_E_DESIGN, "nothing moves with the body '%s'", body->name);
  }
  return DEA_OK;
}

/* The body's nodes at the centroid of its region, in the middle of what moves with it. */
static dea_status add_body(struct dea_context *ctx, struct dea_model *model, size_t i)
{
  const struct dea_layout_body *body = &model->layout->bodies[i];
  struct dea_grid *grid = model->mesh.grid;
  double X[6], low = INFINITY, high = -INFINITY, length = 0;
  int keeps = dea_layout_sector_keeps(&model->mesh.sector);
  dea_region_centroid_m(&model->layout->regions[body->region].region, X);
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    if (model->follows[n] == (int)i + 1) {
      low = fmin(low, grid->X[3 * n + 2]);
      high = fmax(high, grid->X[3 * n + 2]);
      length = fmax(length, hypot(grid->X[3 * n] - X[0], grid->X[3 * n + 1] - X[1]));
    }
  }
  X[2] = 0.5 * (low + high);
  memcpy(X + 3, X, 3 * sizeof *X);
  DEA_TRY(ctx, dea_grid_add_nodes(ctx, grid, 2, X, &model->bodies[i].node));
  model->bodies[i].held = ALL_COMPONENTS & ~((body->free | body->moved) & keeps);
  // unknowns of a turn stay in the same unit when slopes are taken
  model->bodies[i].length_m =
      model->variant != NULL ? model->variant->own.bodies[i].length_m : length;
  return DEA_OK;
}

static dea_status add_bodies(struct dea_context *ctx, struct dea_model *model, double **point_mass)
{
  const struct dea_layout *l = model->layout;
  size_t capacity = model->mesh_node_count + 2 * l->body_count;
  model->on = dea_arena_alloc(&model->memory, model->mesh.plane->node_count, sizeof *model->on);
  model->follows = dea_arena_alloc(&model->memory, capacity, sizeof *model->follows);
  *point_mass = dea_arena_alloc(&model->memory, capacity, sizeof **point_mass);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  for (size_t i = 0; i < l->body_count; i++) {
    size_t found;
    DEA_TRY(ctx, mark_body(ctx, model, i, &found));
    for (size_t n = 0; n < model->mesh_node_count; n++) {
      if (model->follows[n] == (int)i + 1) {
        (*point_mass)[n] = l->bodies[i].mass_kg / model->copies / (double)found;
      }
    }
  }
  for (size_t i = 0; i < l->body_count; i++) {
    DEA_TRY(ctx, add_body(ctx, model, i));
  }
  return DEA_OK;
}

// Supports and loads -----------------------------------------------------------------------------

/* What is near enough to a face to lie on it. */
static double near_face(const struct dea_model *model)
{
  return 1e-6 * model->layout->plies[model->plies.film].thickness_m;
}

/* Holds the nodes of a support that no body moves, where they are or at its shift. */
static dea_status hold(struct dea_context *ctx, struct dea_model *model,
                       const struct dea_layout_support *support, bool moved)
{
  bool *on = model->on;
  const int *follows = model->follows;
  const struct dea_grid *grid = model->mesh.grid;
  size_t held = 0;
  const size_t plies = support->plies;
  double up_to_m = plies > 0 ? model->mesh.face_m[plies - 1][1] + near_face(model) : INFINITY;
  dea_layout_mesh_mark(&model->mesh, support->region, support->edge, support->within, on);
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    bool lowest = n == 0 || grid->column[n] != grid->column[n - 1];
    bool here = on[grid->column[n]] && follows[n] == 0 && (!support->hinged || lowest);
    if (here && grid->X[3 * n + 2] <= up_to_m) {
      double Q[9], move_m[3] = {0};
      dea_layout_sector_holds(&model->mesh.sector, grid->X + 3 * n, model->mesh.near_m, Q);
      for (int k = 0; k < 9 && moved; k++) {
        move_m[k / 3] += Q[k] * support->move_m[k % 3];
      }
      DEA_TRY(ctx, dea_solid_prescribe(ctx, model->solid, n, support->components, move_m));
      held++;
    }
  }
  if (held == 0 &&
      !dea_layout_mesh_marks_copy(&model->mesh, support->region, support->edge, support->within)) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, support->location,
                                 "this support holds nothing: no ply is there"));
    return dea_fail(ctx, DEA_E_DESIGN, "a support holds nothing");
  }
  return DEA_OK;
}

static dea_status add_spring(struct dea_context *ctx, struct dea_model *model, size_t i)
{
  const struct dea_layout_spring *spring = &model->layout->springs[i];
  const struct dea_solid_body *body = &model->bodies[spring->body];
  bool turns = spring->component >= 3;
  double *force = dea_arena_alloc(&model->memory, spring->count, sizeof *force);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  for (size_t k = 0; k < spring->count; k++) {
    force[k] = spring->force[k] / model->copies;
  }
  const struct dea_spring_options options = {
      .node = body->node + (turns ? 1 : 0),
      .component = spring->component % 3,
      .unit_m = turns ? body->length_m : 0,
      .place = spring->free_at,
      .stiffness = spring->stiffness / model->copies,
      .count = spring->count,
      .at = spring->at,
      .force = force,
  };
  DEA_TRY(ctx, dea_spring_create(ctx, &options, &model->springs[i]));
  const struct dea_solid_load load = dea_spring_load(model->springs[i]);
  DEA_TRY(ctx, dea_solid_add_load(ctx, model->solid, &load));
  return DEA_OK;
}

/* What a liquid's volume is exact to, over the root of the third power of its face's area. */
static const double least_volume = 1e-3;

/* Who a surface is asked for. */
struct face_of {
  const struct dea_model *model;
  const struct dea_layout_pressure *pressure;
  double height_m; // of the face, z
};

static bool is_loaded(const void *self, int region, int ply, const double middle[3])
{
  const struct face_of *of = self;
  const struct dea_layout_mesh *mesh = &of->model->mesh;
  size_t group = mesh->group[of->pressure->region];
  // between the elements through a ply there are faces too
  bool outermost = fabs(middle[2] - of->height_m) <
                   1e-6 * of->model->layout->plies[of->pressure->ply].thickness_m;
  return (size_t)ply == of->pressure->ply && outermost && group != DEA_LAYOUT_NONE &&
         mesh->plane->within[(size_t)region * mesh->plane->group_count + group] != 0;
}

/* What the sector has of an enclosed volume, below a face of that area. In the iterations a liquid
 * gives way some hundred times less than the film: 8 T/(pi R^4) of a tension T about mu h. */
static void enclose(struct dea_model *model, size_t i, double area_m2)
{
  static const double stiff = 300;
  const struct dea_layout_pressure *pressure = &model->layout->pressures[i];
  const double copies = model->copies, whole_m2 = copies * area_m2;
  double modulus_N_per_m = 0;
  for (size_t k = 0; k < model->layout->ply_count; k++) {
    modulus_N_per_m += dea_part_material_modulus(&model->plies.part_materials[k]) *
                       model->layout->plies[k].thickness_m;
  }
  const struct dea_enclosed enclosed = {
      .liquid = pressure->encloses == DEA_LIQUID,
      .volume_m3 = (pressure->encloses == DEA_GAS ? pressure->volume_m3
                                                  : least_volume * pow(whole_m2, 1.5)) /
                   copies,
      .ambient_Pa = pressure->ambient_Pa,
      .stiffness_Pa_per_m3 =
          copies * stiff * 8 * acos(-1.0) * modulus_N_per_m / (whole_m2 * whole_m2)};
  if (pressure->encloses != DEA_OPEN) {
    dea_pressure_enclose(model->pressures[i], &enclosed);
  }
}

/* Of a sector without a face in it: none. */
static dea_status add_pressure(struct dea_context *ctx, struct dea_model *model, size_t i)
{
  const struct dea_layout_pressure *pressure = &model->layout->pressures[i];
  const struct face_of of = {model, pressure,
                             model->mesh.face_m[pressure->ply][pressure->top ? 1 : 0]};
  struct dea_surface **surface = &model->surfaces[i];
  if (model->mesh.group[pressure->region] == DEA_LAYOUT_NONE) {
    return DEA_OK;
  }
  DEA_TRY(ctx,
          dea_surface_create(ctx, model->mesh.grid, pressure->top ? DEA_FACE_TOP : DEA_FACE_BOTTOM,
                             is_loaded, &of, surface));
  double height_m = model->mesh.grid->X[3 * (*surface)->nodes[0] + 2];
  DEA_TRY(ctx, dea_pressure_create_flat(ctx, *surface, height_m, &model->pressures[i]));
  enclose(model, i, dea_surface_area(*surface));
  const struct dea_solid_load load = dea_pressure_load(model->pressures[i]);
  DEA_TRY(ctx, dea_solid_add_load(ctx, model->solid, &load));
  return DEA_OK;
}

/* All pressures at once, times a factor. */
static void set_pressures(const struct dea_model *model, double factor)
{
  for (size_t i = 0; i < model->layout->pressure_count; i++) {
    if (model->pressures[i] != NULL) {
      const struct dea_layout_pressure *pressure = &model->layout->pressures[i];
      dea_pressure_set(model->pressures[i], factor * (pressure->encloses == DEA_LIQUID
                                                          ? pressure->volume_m3 / model->copies
                                                          : pressure->pressure_Pa));
    }
  }
}

/* The force and moment on a body, or the sector's part of them. */
static void push_body(const struct dea_model *model, size_t body, const double push[6])
{
  double part[6];
  for (int k = 0; k < 6; k++) {
    part[k] = push[k] / model->copies;
  }
  dea_solid_body_push(model->solid, body, part, part + 3);
}

static dea_status load_bodies(struct dea_context *ctx, struct dea_model *model)
{
  for (size_t i = 0; i < model->layout->body_count; i++) {
    const struct dea_layout_body *body = &model->layout->bodies[i];
    memcpy(model->push[i], body->force_N, sizeof body->force_N);
    memcpy(model->push[i] + 3, body->moment_N_m, sizeof body->moment_N_m);
    push_body(model, i, model->push[i]);
    if (body->moved != 0) {
      DEA_TRY(ctx, dea_solid_body_prescribe(ctx, model->solid, i, body->moved, body->shift_m,
                                            body->turn_rad));
    }
  }
  return DEA_OK;
}

/* The weight of plies and bodies as the dead loads, none without it. */
static dea_status set_weight(struct dea_context *ctx, const struct dea_model *model)
{
  size_t count = 3 * model->mesh.grid->node_count;
  double *force = dea_solid_force(model->solid);
  if (!has_weight(model->layout)) {
    memset(force, 0, count * sizeof *force);
    return DEA_OK;
  }
  DEA_TRY(ctx, check_mass(ctx, model));
  double *fall = dea_solid_alloc(ctx, count, sizeof *fall);
  if (fall == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < 3 * model->mesh_node_count; i++) {
    fall[i] = model->layout->gravity_m_per_s2[i % 3];
  }
  dea_status status = dea_solid_mass_apply(ctx, model->solid, fall, force);
  dea_free(ctx, fall);
  return status;
}

/* Weight and forces of supports as the dead loads; those of bodies come to them. */
static dea_status set_dead_loads(struct dea_context *ctx, const struct dea_model *model)
{
  DEA_TRY(ctx, set_weight(ctx, model));
  for (size_t i = 0; i < model->layout->support_count; i++) {
    const struct dea_layout_support *support = &model->layout->supports[i];
    if (dea_support_pulls(support)) {
      DEA_TRY(ctx, dea_dead_force_add(ctx, &model->mesh, support, model->on,
                                      dea_solid_force(model->solid)));
    }
  }
  return DEA_OK;
}

static dea_status add_loads(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_layout *l = model->layout;
  model->springs = dea_arena_alloc(&model->memory, l->spring_count, sizeof *model->springs);
  model->pressures = dea_arena_alloc(&model->memory, l->pressure_count, sizeof *model->pressures);
  model->surfaces = dea_arena_alloc(&model->memory, l->pressure_count, sizeof *model->surfaces);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  for (size_t i = 0; i < l->spring_count; i++) {
    DEA_TRY(ctx, add_spring(ctx, model, i));
  }
  for (size_t i = 0; i < l->pressure_count; i++) {
    DEA_TRY(ctx, add_pressure(ctx, model, i));
  }
  return DEA_OK;
}

// Release ----------------------------------------------------------------------------------------

enum { ALL = 7 }; // components of a node

static int free_components(const struct dea_model *model, size_t body)
{
  return ALL_COMPONENTS & ~model->bodies[body].held;
}

/* The flat state, everything held in it. */
static dea_status hold_all(struct dea_context *ctx, struct dea_model *model)
{
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    if (model->follows[n] == 0) {
      DEA_TRY(ctx, dea_solid_prescribe(ctx, model->solid, n, ALL & ~model->on_side[n], no_motion));
    }
  }
  for (size_t i = 0; i < model->layout->body_count; i++) {
    DEA_TRY(ctx, dea_solid_body_prescribe(ctx, model->solid, i, free_components(model, i),
                                          no_motion, no_motion));
  }
  return DEA_OK;
}

/* Supports only; moved: with their own shifts. */
static dea_status hold_supports(struct dea_context *ctx, struct dea_model *model, bool moved)
{
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    if (model->follows[n] == 0) {
      DEA_TRY(ctx, dea_solid_release(ctx, model->solid, n, ALL & ~model->on_side[n]));
    }
  }
  for (size_t i = 0; i < model->layout->body_count; i++) {
    DEA_TRY(ctx, dea_solid_body_release(ctx, model->solid, i, free_components(model, i)));
  }
  for (size_t i = 0; i < model->layout->support_count; i++) {
    DEA_TRY(ctx, hold(ctx, model, &model->layout->supports[i], moved));
  }
  return DEA_OK;
}

/* Lowest stiffness at the equilibrium where the solid is, per volume; NAN: it cannot be had. */
static double lowest_stiffness(struct dea_context *ctx, struct dea_model *model)
{
  double value;
  if (dea_solid_modes_lowest(ctx, model->solid, DEA_MODES_BY_VOLUME, 1, &value, NULL) != DEA_OK) {
    dea_context_clear(ctx);
    return NAN;
  }
  return value;
}

/* The pressures have a limit where the stiffness goes to 0 with them: near it as the root of what
 * is missing, so that at the last equilibrium that was found it is far below that at half of the
 * pressure, where the solid is left. */
static dea_status explain_pressure(struct dea_context *ctx, struct dea_model *model,
                                   dea_status status)
{
  static const double falls = 0.25, least = 1e-3; // of the stiffness; step, of the pressure found
  const struct dea_layout_pressure *pressure = &model->layout->pressures[0];
  char why[160];
  double way = model->at.report.way;
  snprintf(why, sizeof why, "%s", dea_context_message(ctx));
  set_pressures(model, fmin(1, 1.1 * way)); // closer to where it ends
  if (dea_load_steps_solve_within(ctx, model->solid, 0, 10 * least, &model->at.report) == DEA_OK) {
    return dea_fail(ctx, status, "%s", why);
  }
  way += model->at.report.way * (fmin(1, 1.1 * way) - way);
  const double low = lowest_stiffness(ctx, model);
  set_pressures(model, 0.5 * way);
  const double half = dea_load_steps_solve(ctx, model->solid, 0, &model->at.report) == DEA_OK
                          ? lowest_stiffness(ctx, model)
                          : NAN;
  if (!(low < falls * half)) {
    return dea_fail(ctx, status, "%s", why);
  }
  return dea_fail(ctx, status,
                  "a limit of the pressure: the film bears no more than about %.4g Pa of %.4g Pa, "
                  "where its lowest stiffness falls towards 0 (%.2g of that at half of it)",
                  way * pressure->pressure_Pa, pressure->pressure_Pa, low / half);
}

/* Whether a part is moved in its plane, and a film has no tension to begin with. */
static bool is_twisted_slack(const struct dea_layout *l)
{
  bool moved = false, slack = false;
  for (size_t i = 0; i < l->body_count; i++) {
    const struct dea_layout_body *body = &l->bodies[i];
    moved = moved || body->shift_m[0] != 0 || body->shift_m[1] != 0 || body->turn_rad[2] != 0;
  }
  for (size_t i = 0; i < l->support_count; i++) {
    moved = moved || l->supports[i].move_m[0] != 0 || l->supports[i].move_m[1] != 0;
  }
  for (size_t i = 0; i < l->ply_count; i++) {
    const double *stretch = l->plies[i].pre_stretch;
    slack = slack || (l->plies[i].material.law != NULL && fmin(stretch[0], stretch[1]) <= 1);
  }
  return moved && slack;
}

/* Why there is no state of the loads, where that is known. */
static dea_status explain_loads(struct dea_context *ctx, struct dea_model *model, dea_status status)
{
  const struct dea_layout *l = model->layout;
  char why[200];
  if (dea_solid_may_shorten(status) && is_twisted_slack(l)) {
    snprintf(why, sizeof why, "%s", dea_context_message(ctx));
    return dea_fail(
        ctx, status,
        "a film without tension wrinkles when it is twisted or shifted in its plane, and "
        "no state is found beyond %.3g %% of that: give its ply a pre_stretch above 1 "
        "(%s)",
        100 * model->at.report.way, why);
  }
  const bool alone =
      l->pressure_count == 1 && l->body_count == 0 && l->pressures[0].encloses == DEA_OPEN;
  return dea_solid_may_shorten(status) && alone ? explain_pressure(ctx, model, status) : status;
}

/* With supports and loads as they are, at 0 V. */
static dea_status go_to_loads(struct dea_context *ctx, struct dea_model *model)
{
  DEA_TRY(ctx, hold_supports(ctx, model, true));
  for (size_t k = 1; k < model->layout->channel_count; k++) {
    dea_solid_own_voltages(model->solid)[k] = model->layout->channels[k].own_V;
  }
  set_pressures(model, 1);
  DEA_TRY(ctx, set_dead_loads(ctx, model));
  DEA_TRY(ctx, load_bodies(ctx, model));
  const bool twisted = is_twisted_slack(model->layout);
  dea_solid_accept_unstable(model->solid, twisted); // of its many wrinkles none is followed
  const dea_status status = dea_load_steps_solve(ctx, model->solid, 0, &model->at.report);
  DEA_TRY(ctx, explain_loads(ctx, model, status));
  const int modes = model->at.report.unstable_modes;
  dea_solid_accept_unstable(model->solid, twisted && modes > 0);
  return !twisted || modes == 0
             ? DEA_OK
             : dea_finding_add(
                   ctx, DEA_WARNING, (struct dea_location){0},
                   "model 3d: a film without tension that is twisted or shifted in its plane "
                   "wrinkles, here in %d mode%s of the mesh, and has no state of its own: the "
                   "numbers are those of one that is kept from it. A pre_stretch above 1 keeps it "
                   "taut, a smaller motion or a thicker ply flat",
                   modes, modes == 1 ? "" : "s");
}

/* From the flat state, in which everything is held, to that of the loads at 0 V
 * (docs/theory/devices.md). What held the film and is no support goes away on the way as dead
 * forces, under which the flat state is an equilibrium, fall to nothing. */
static dea_status release(struct dea_context *ctx, struct dea_model *model)
{
  size_t values = 3 * model->mesh.grid->node_count;
  double *force = dea_solid_force(model->solid);
  memset(force, 0, values * sizeof *force);
  DEA_TRY(ctx, hold_all(ctx, model));
  DEA_TRY(ctx, dea_load_steps_solve(ctx, model->solid, 0, &model->at.report));
  memcpy(force, dea_solid_reaction(model->solid), values * sizeof *force);
  DEA_TRY(ctx, hold_supports(ctx, model, false));
  DEA_TRY(ctx, dea_load_steps_solve(ctx, model->solid, 0, &model->at.report));
  DEA_TRY(ctx, go_to_loads(ctx, model));
  return DEA_OK;
}

/* From the flat state straight to that of a disc, whose film is at rest there but for what its
 * weight and stiff electrodes do: these were laid on the unstretched film and draw it together, to
 * a third, which is farther than Newton's method goes at once; then by the release. */
static dea_status find_rest(struct dea_context *ctx, struct dea_model *model)
{
  char why[200];
  dea_status status = model->disc ? go_to_loads(ctx, model) : release(ctx, model);
  if (model->disc && dea_solid_may_shorten(status)) {
    dea_context_clear(ctx);
    dea_solid_forget(model->solid);
    status = release(ctx, model);
  }
  if (model->disc && status == DEA_E_NOT_CONVERGED) {
    snprintf(why, sizeof why, "%s", dea_context_message(ctx));
    return dea_fail(ctx, status,
                    "the solver did not converge: the film at rest is not found (%s); let go by "
                    "%.3g %% from the flat state it is; please report the design",
                    why, 100 * model->at.report.way);
  }
  DEA_TRY(ctx, status);
  model->at.left_a_state = model->at.report.snapped;
  return DEA_OK;
}

// The model --------------------------------------------------------------------------------------

/* Elements through the film, the least of several. */
static int least_through(const struct dea_model *model)
{
  const int usual = model->settings.elements_z > 1 ? model->settings.elements_z : 1;
  int least = model->disc ? usual : INT_MAX;
  for (size_t i = 0; i < model->layout->ply_count && !model->disc; i++) {
    const int own = (int)model->layout->plies[i].elements;
    least = model->mesh.dielectric[i] && (own > 0 ? own : usual) < least ? (own > 0 ? own : usual)
                                                                         : least;
  }
  return least;
}

/* What of a coupled field the mesh does not resolve. */
static dea_status say_coupled(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_device *d = model->device;
  const int through = least_through(model);
  if (through < resolved) {
    return dea_finding_add(
        ctx, DEA_WARNING, (struct dea_location){0},
        "model 3d: %d element%s through the film do%s not resolve the coupled field at "
        "the electrode's edge: capacitance comes out too large (by 0.8 %% with one), "
        "and what a fibre tip there loses against V/h is not to be trusted, not even "
        "in its sign; compute.solid.elements_z: %d resolves it "
        "(docs/theory/coupled.md)",
        through, through > 1 ? "s" : "", through > 1 ? "" : "es", resolved);
  }
  if (d->fibre_count > 0 &&
      fabs(d->electrode_radius_m - d->fibre_tip_radius_m) < d->film_thickness_m) {
    return dea_finding_add(
        ctx, DEA_WARNING, (struct dea_location){0},
        "model 3d: the fibres begin where the electrode ends: there the coupled field's part in "
        "their lift converges with the root of the element's size only, so that %d elements "
        "through the film show about half of it at small voltage, and at larger ones no limit is "
        "known; capacitance and what is not at that edge are resolved (docs/theory/coupled.md)",
        through);
  }
  return DEA_OK;
}

/* What a film without bending leaves out. */
static dea_status say_membrane(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_device *d = model->device;
  DEA_TRY(ctx, dea_finding_add(
                   ctx, DEA_NOTE, (struct dea_location){0},
                   "model 3d with a membrane film is a preview: %s"
                   "it has no bending of the film and no shape of its wrinkles "
                   "(compute.solid.film: solid)",
                   d->fibre_count > 0 ? "10 to 20 % off the solid film at the fibre tip; " : ""));
  if (model->disc && d->pre_stretch <= 1) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                                 "a membrane film without pre-stretch is slack under any voltage: "
                                 "nothing will move, where a solid film buckles "
                                 "(compute.solid.film: solid)"));
  }
  return DEA_OK;
}

/* What is about to be solved, and what it cannot show. */
static dea_status say_mesh(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_grid *grid = model->mesh.grid;
  const bool whole = model->mesh.sector.fold == 0;
  char what[200];
  snprintf(what, sizeof what, "%sthe whole %s", model->disc ? "" : "a free mesh of ",
           model->disc ? "disc" : "device");
  if (!whole && model->disc) {
    snprintf(what, sizeof what,
             "one sector of the actuator; it is blind to motions that break its symmetry "
             "(compute.solid.domain: disc)");
  } else if (!whole) {
    snprintf(what, sizeof what,
             "a free mesh of one of %g mirrored sectors of the device; it is blind to motions that "
             "break this symmetry (compute.solid.domain: whole)",
             model->copies);
  }
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                               "model 3d: %zu elements, %zu unknowns, %s", grid->element_count,
                               3 * grid->node_count, what));
  if (model->settings.order > grid->order) {
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                            "model 3d: compute.solid.order: %d is not there for devices made "
                            "of `plies`: their free mesh has elements of order %d in the plane "
                            "(compute.solid.refinement makes it finer)",
                            model->settings.order, grid->order));
  }
  if (model->settings.field == DEA_FIELD_COUPLED) {
    DEA_TRY(ctx, say_coupled(ctx, model));
  }
  if (model->mesh.membrane) {
    DEA_TRY(ctx, say_membrane(ctx, model));
  }
  return DEA_OK;
}

/* Of a disc; NAN of what is none. */
static double centre_z(const struct dea_model *model, const double *u)
{
  return dea_observer_column(model->observer, dea_point_column_find("centre_z_m"), u);
}

/* Where the weight alone brings the film of a disc. */
static dea_status say_sag(struct dea_context *ctx, const struct dea_model *model)
{
  const double centre_z_m = centre_z(model, dea_solid_displacement(model->solid));
  if (!isnan(centre_z_m) && has_weight(model->layout)) {
    DEA_TRY(ctx,
            dea_finding_add(
                ctx, DEA_NOTE, (struct dea_location){0},
                "model 3d: with its weight the centre is at z = %.4g um without voltage, "
                "where the sweep starts (gravity: fibres_%s)",
                1e6 * centre_z_m, model->device->gravity == DEA_GRAVITY_FIBRES_UP ? "up" : "down"));
  }
  return DEA_OK;
}

static dea_status make_solid(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_layout *l = model->layout;
  const bool coupled = model->settings.field == DEA_FIELD_COUPLED;
  double *point_mass, *share = dea_arena_alloc(&model->memory, l->channel_count, sizeof *share);
  model->bodies = dea_arena_alloc(&model->memory, l->body_count, sizeof *model->bodies);
  model->push = dea_arena_alloc(&model->memory, l->body_count, sizeof *model->push);
  model->controls = dea_arena_alloc(&model->memory, l->body_count, sizeof *model->controls);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  model->mesh_node_count = model->mesh.grid->node_count;
  DEA_TRY(ctx, add_bodies(ctx, model, &point_mass));
  model->on_side = dea_arena_alloc(&model->memory, model->mesh_node_count, sizeof *model->on_side);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    model->on_side[n] = dea_plies_held(&model->mesh, model->mesh.grid->X + 3 * n);
  }
  for (size_t k = 1; k < l->channel_count; k++) {
    share[k - 1] = l->channels[k].ratio;
  }
  const struct dea_solid_options options = {
      .order_z = model->settings.order_z > 0 ? model->settings.order_z : 2,
      .part_material_count = l->ply_count,
      .part_materials = model->plies.part_materials,
      .part_material_of = dea_plies_part_material,
      .active = dea_plies_active,
      .field = coupled ? DEA_SOLID_FIELD_COUPLED : DEA_SOLID_FIELD_THIN,
      .electrode = dea_plies_electrode,
      .channels = coupled ? NULL : dea_plies_channels,
      .channel_count = l->channel_count > 1 ? l->channel_count - 1 : 1,
      .share = share,
      .held = dea_plies_held,
      .frame = dea_plies_frame,
      .body_count = l->body_count,
      .bodies = model->bodies,
      .body_of = l->body_count > 0 ? model->follows : NULL,
      .point_mass_kg = l->body_count > 0 ? point_mass : NULL,
      .self = &model->mesh,
  };
  DEA_TRY(ctx, dea_solid_create(ctx, model->mesh.grid, &options, &model->solid));
  DEA_TRY(ctx, add_loads(ctx, model));
  return DEA_OK;
}

static dea_status keep_rest(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_solid *s = model->solid;
  size_t values = s->problem.dofs, pressures = dea_solid_pressure_count(s);
  model->at.rest_energy_J = model->at.report.energy_J;
  model->at.as_made = !model->at.report.snapped;
  model->rest_is_one_of = model->at.left_a_state;
  model->rest = dea_arena_alloc(&model->memory, values + pressures, sizeof *model->rest);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  memcpy(model->rest, s->state.u, values * sizeof *model->rest);
  memcpy(model->rest + values, s->state.multiplier, pressures * sizeof *model->rest);
  return DEA_OK;
}

/* A mesh of its own, or that of another model. */
static dea_status make_mesh(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_model *from = model->settings.mesh_from;
  if (model->device->disc) {
    struct dea_film film;
    DEA_TRY(ctx, dea_film_create(ctx, model->device, &film)); // laws and permittivity are there
  }
  if (model->settings.film == DEA_FILM_MEMBRANE && model->settings.field == DEA_FIELD_COUPLED) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "compute.solid.field: coupled needs a film with a thickness; take "
                    "compute.solid.film: solid");
  }
  if (from == NULL) {
    DEA_TRY(ctx, dea_device_mesh_create(ctx, model->device, &model->settings, &model->mesh));
  } else {
    DEA_TRY(ctx, dea_device_mesh_follow(ctx, model->device, &model->settings, &from->mesh,
                                        &model->mesh));
  }
  return DEA_OK;
}

/* What belongs to the mesh: its layout, and where on it things are. */
static void look_at_mesh_places(struct dea_model *model)
{
  const struct dea_layout_mesh *mesh = &model->mesh;
  model->layout = mesh->layout;
  model->disc = mesh->plate.order > 0;
}

static void find_band(struct dea_model *model)
{
  const size_t film = model->plies.film;
  const double *face_m = model->mesh.face_m[film];
  model->band =
      (struct dea_film_band){0.5 * (face_m[0] + face_m[1]), model->layout->plies[film].thickness_m};
}

static dea_status prepare(struct dea_context *ctx, const struct dea_device *device,
                          const struct dea_model_settings *settings, struct dea_model *model)
{
  model->device = device;
  model->settings = *settings;
  model->memory.ctx = ctx;
  model->pressure_factor = 1;
  DEA_TRY(ctx, dea_solid_start(ctx));
  DEA_TRY(ctx, dea_solid_agree(ctx, make_mesh(ctx, model))); // gmsh may be ended on one rank alone
  look_at_mesh_places(model);
  model->answer =
      dea_arena_alloc(&model->memory, model->layout->monitor_count * DEA_OBSERVED_MOTIONS + 1,
                      sizeof *model->answer);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  model->copies = (double)dea_layout_sector_copies(&model->mesh.sector);
  DEA_TRY(ctx, say_mesh(ctx, model));
  DEA_TRY(ctx, dea_plies_create(ctx, &model->mesh, &model->memory, &model->plies));
  find_band(model);
  DEA_TRY(ctx, make_solid(ctx, model));
  DEA_TRY(ctx, dea_observer_create(ctx, &model->mesh, model->pressures, &model->observer));
  DEA_TRY(ctx, find_rest(ctx, model));
  DEA_TRY(ctx, keep_rest(ctx, model));
  DEA_TRY(ctx, say_sag(ctx, model));
  return DEA_OK;
}

/* Loads, mesh and arrays. */
static void free_parts(struct dea_context *ctx, struct dea_model *model)
{
  for (size_t i = 0; model->springs != NULL && i < model->layout->spring_count; i++) {
    dea_spring_destroy(ctx, model->springs[i]);
  }
  for (size_t i = 0; model->pressures != NULL && i < model->layout->pressure_count; i++) {
    dea_pressure_destroy(ctx, model->pressures[i]);
  }
  for (size_t i = 0; model->surfaces != NULL && i < model->layout->pressure_count; i++) {
    dea_surface_destroy(ctx, model->surfaces[i]);
  }
  dea_layout_mesh_free(ctx, &model->mesh);
  dea_arena_free(&model->memory);
}

static void destroy(struct dea_context *ctx, struct dea_model *model)
{
  if (model == NULL) {
    return;
  }
  dea_observer_destroy(ctx, model->observer);
  dea_solver_state_free(ctx, &model->at);
  dea_free(ctx, model->answers);
  dea_free(ctx, model->passes);
  dea_solid_destroy(ctx, model->solid);
  dea_indent_destroy(ctx, model->indent);
  dea_free(ctx, model->profile);
  free_parts(ctx, model);
  dea_free(ctx, model);
}

/* A height of what may bend, and the two nodes in whose middle it is. */
struct place {
  size_t node[2];
  double z_m;
};

/* The next one from *n on: of a disc's film each node; else the middle between the lowest and the
 * highest face of a place, as the faces of a flat film move as it thins, which is no bending. Nodes
 * above each other have consecutive numbers. false: there is no more. */
static bool next_place(const struct dea_model *model, size_t *n, struct place *out)
{
  const double *u = dea_solid_displacement(model->solid), *X = model->mesh.grid->X;
  const int *column = model->mesh.grid->column;
  while (model->disc && *n < model->mesh_node_count &&
         !dea_film_band_has(&model->band, X[3 * *n + 2])) {
    ++*n;
  }
  if (*n >= model->mesh_node_count) {
    return false;
  }
  size_t low = *n, high = *n, of = *n;
  for (++*n; !model->disc && *n < model->mesh_node_count && column[*n] == column[of]; ++*n) {
    low = X[3 * *n + 2] < X[3 * low + 2] ? *n : low;
    high = X[3 * *n + 2] > X[3 * high + 2] ? *n : high;
  }
  *out = (struct place){{low, high}, 0.5 * (u[3 * low + 2] + u[3 * high + 2])};
  return true;
}

/* The highest one with sign 1, the lowest with -1. */
static struct place find_height(const struct dea_model *model, double sign)
{
  struct place here, out = {{0, 0}, -sign * INFINITY};
  for (size_t n = 0; next_place(model, &n, &here);) {
    out = sign * here.z_m > sign * out.z_m ? here : out;
  }
  return out;
}

/* What of a point the displacements say by themselves. */
static void describe(const struct dea_model *model, double voltage_V, struct dea_load_point *out)
{
  *out = dea_load_point_empty();
  out->voltage_V = voltage_V;
  out->highest_z_m = find_height(model, 1).z_m;
  out->lowest_z_m = find_height(model, -1).z_m;
  out->nominal_field_V_per_m = voltage_V / model->plies.thinnest_m;
  out->energy_J = model->copies * (model->at.report.energy_J - model->at.rest_energy_J);
  dea_observer_describe(model->observer, dea_solid_displacement(model->solid), out);
  if (model->indent != NULL) {
    out->tip_depth_m = model->indent->depth_m;
    out->force_N = dea_indent_force(model->indent, dea_solid_displacement(model->solid));
  }
}

static dea_status report(struct dea_context *ctx, void *self, double voltage_V,
                         struct dea_load_point *out)
{
  struct dea_model *model = self;
  struct dea_solid_extremes extremes;
  double capacitance_F;
  const bool charged = dea_charge_is_held(model->solid);
  dea_status status = dea_solid_extremes(model->solid, model->plies.films, &extremes);
  if (status == DEA_OK) {
    status = dea_solid_capacitance(ctx, model->solid, &capacitance_F);
  }
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "the film cannot be evaluated at %g V", voltage_V);
  }
  if (charged) {
    voltage_V += dea_charge_now(model->solid).lift_V;
    capacitance_F = dea_charge_now(model->solid).capacitance_F;
  }
  describe(model, voltage_V, out);
  out->true_field_V_per_m = extremes.true_field_V_per_m;
  out->breakdown_margin = extremes.breakdown_margin;
  out->breakdown_probability = extremes.breakdown_probability;
  out->min_tension_N_per_m =
      isinf(extremes.min_tension_N_per_m) ? NAN : extremes.min_tension_N_per_m; // without a film
  out->locking_share = extremes.reach.locking_share;
  out->range_share = extremes.reach.range_share;
  out->compression_ratio = model->copies * extremes.compression_ratio;
  out->told |= (unsigned)model->at.left_a_state << DEA_FLAG_STATES;
  out->told |= (unsigned)model->mesh.membrane << DEA_FLAG_PREVIEW;
  out->capacitance_F = model->copies * capacitance_F;
  out->unstable_modes = model->at.report.unstable_modes;
  out->stable = out->unstable_modes == 0;
  DEA_TRY(ctx, dea_observer_errors(ctx, model->observer, model->solid, out));
  return DEA_OK;
}

/* Whether it is back where it was released, to a thousandth of the film's thickness. */
static bool is_at_rest(const struct dea_model *model)
{
  const double *u = dea_solid_displacement(model->solid);
  double most = 0;
  for (size_t i = 0; i < 3 * model->mesh.grid->node_count; i++) {
    most = fmax(most, fabs(u[i] - model->rest[i]));
  }
  return model->at.voltage_V == 0 &&
         most <= 1e-3 * model->layout->plies[model->plies.film].thickness_m;
}

/* Another state was left on the way; what is back at rest has nothing of that. */
static void note_states(struct dea_model *model, bool left)
{
  model->at.left_a_state =
      is_at_rest(model) ? model->rest_is_one_of : model->at.left_a_state || left;
}

/* Height that tells the side that the film is on. */
static double middle_z(const struct dea_model *model)
{
  const double centre_m = centre_z(model, dea_solid_displacement(model->solid));
  const double high_m = find_height(model, 1).z_m, low_m = find_height(model, -1).z_m;
  return !isnan(centre_m) ? centre_m : (fabs(high_m) > fabs(low_m) ? high_m : low_m);
}

/* To the side that the design asks for, where there is a state. */
static dea_status take_side(struct dea_context *ctx, struct dea_model *model)
{
  bool moved;
  double before_m = middle_z(model);
  if (model->indent != NULL || model->at.voltage_V == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx,
          dea_buckling_branch_take(ctx, model->solid, model->mesh.grid, &model->band,
                                   model->settings.buckling_branch, &model->at.report, &moved));
  if (moved) {
    model->at.left_a_state = true;
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                            "model 3d: at %.4g kV the centre goes over from %.4g to %.4g um "
                            "(compute.solid.buckling_branch)",
                            1e-3 * model->at.voltage_V, 1e6 * before_m, 1e6 * middle_z(model)));
  }
  return DEA_OK;
}

static dea_status arrived(struct dea_context *ctx, void *self, double voltage_V)
{
  struct dea_model *model = self;
  model->at.voltage_V = voltage_V;
  note_states(model, model->at.report.snapped || model->at.outcome.leapt);
  DEA_TRY(ctx, take_side(ctx, model));
  return DEA_OK;
}

// Controls beside the voltage ---------------------------------------------------------------------

static dea_status check_control(struct dea_context *ctx, const struct dea_model *model,
                                const struct dea_control *control, double value)
{
  const struct dea_layout *l = model->layout;
  bool pressure = control->kind == DEA_CONTROL_PRESSURE;
  if (control->kind == DEA_CONTROL_CHARGE) {
    return isfinite(value) ? DEA_OK : dea_fail(ctx, DEA_E_ARGUMENT, "a charge has to be a number");
  }
  if (pressure
          ? l->pressure_count == 0
          : control->body >= l->body_count || control->component < 0 || control->component > 5) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the device has no such %s to be moved",
                    pressure ? "pressure" : "body");
  }
  int keeps = dea_layout_sector_keeps(&model->mesh.sector);
  if (!pressure && ((keeps >> control->component) & 1) == 0) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "a sector of the device cannot show this motion, which breaks its symmetry "
                    "(compute.solid.domain: whole)");
  }
  return isfinite(value) ? DEA_OK : dea_fail(ctx, DEA_E_ARGUMENT, "a control has to be a number");
}

static double where_control_is(const struct dea_model *model, const struct dea_control *control)
{
  double place[6];
  if (control->kind == DEA_CONTROL_PRESSURE) {
    return model->pressure_factor;
  }
  if (control->kind == DEA_CONTROL_CHARGE) { // at first of a film at 0 V
    return dea_charge_is_held(model->solid) ? model->copies * dea_charge_now(model->solid).charge_C
                                            : 0;
  }
  dea_solid_body_place(model->solid, control->body, place, place + 3);
  return control->kind == DEA_CONTROL_PLACE ? place[control->component]
                                            : model->push[control->body][control->component];
}

/* What the next solve goes to. */
static dea_status set_control(struct dea_context *ctx, struct dea_model *model,
                              const struct dea_control *control, double value)
{
  size_t body = control->body;
  double place[6] = {0};
  switch (control->kind) {
  case DEA_CONTROL_PLACE:
    place[control->component] = value;
    model->controls[body].place |= 1 << control->component;
    DEA_TRY(ctx, dea_solid_body_prescribe(ctx, model->solid, body, 1 << control->component, place,
                                          place + 3));
    break;
  case DEA_CONTROL_FORCE:
    model->push[body][control->component] = value;
    model->controls[body].force |= 1 << control->component;
    push_body(model, body, model->push[body]);
    break;
  case DEA_CONTROL_PRESSURE:
    model->pressure_factor = value;
    set_pressures(model, value);
    break;
  case DEA_CONTROL_CHARGE:
    DEA_TRY(ctx, dea_charge_hold(ctx, model->solid, value / model->copies));
    break;
  }
  return DEA_OK;
}

static bool is_same(const struct dea_control *a, const struct dea_control *b)
{
  return a->kind == b->kind && a->body == b->body && a->component == b->component;
}

/* After the way of a control that succeeded; from: the state before. */
static dea_status look_at_move(struct dea_context *ctx, struct dea_model *model,
                               const struct dea_control *control, double from_value, double value,
                               const struct dea_solid_saved_state *from)
{
  struct dea_step_outcome *outcome = &model->at.outcome;
  bool force = control->kind == DEA_CONTROL_FORCE, turns = control->component >= 3;
  double share;
  if (!is_same(control, &model->moved)) {
    outcome->rate[1] = 0;
  }
  model->moved = *control;
  DEA_TRY(ctx, dea_step_outcome_watch(ctx, outcome, value - from_value, from, &share));
  note_states(model, !isnan(share));
  if (isnan(share)) {
    return DEA_OK;
  }
  double limit = from_value + share * (value - from_value);
  outcome->passed.point.force_N = force && !turns ? limit : NAN;
  return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                         "model 3d: at %.4g kV it leaps past a limit point at %.6g %s to another "
                         "state",
                         1e-3 * model->at.voltage_V, force ? 1e3 * limit : limit,
                         !force  ? "of the control"
                         : turns ? "mN m"
                                 : "mN");
}

/* To what the control has been set to. */
static dea_status follow_control(struct dea_context *ctx, struct dea_model *model,
                                 const struct dea_control *control, double from_value, double value)
{
  struct dea_solid_saved_state from;
  dea_status status = dea_solid_save_state(ctx, model->solid, &from);
  if (status == DEA_OK) {
    status = dea_solid_reach(ctx, model->solid, model->at.voltage_V, &model->at.report);
  }
  if (status == DEA_OK && !model->at.report.snapped) {
    status = look_at_move(ctx, model, control, from_value, value, &from);
  }
  dea_solid_saved_state_free(&from);
  return status;
}

/* A limit point of the control at a value. */
static dea_status fail_at_limit(struct dea_context *ctx, const struct dea_model *model,
                                const struct dea_control *control, double value)
{
  const bool turns = control->component >= 3;
  double scale = 1e3, largest = 0;
  const char *name = turns ? "moment limit" : "force limit", *unit = turns ? "mN m" : "mN";
  if (control->kind == DEA_CONTROL_PRESSURE) {
    for (size_t i = 0; i < model->layout->pressure_count; i++) {
      largest = fmax(largest, fabs(model->layout->pressures[i].pressure_Pa));
    }
    scale = 1e-3 * largest;
    name = "pressure limit";
    unit = "kPa";
  } else if (control->kind == DEA_CONTROL_CHARGE) {
    scale = 1e6;
    name = "charge limit";
    unit = "uC";
  } else if (control->kind == DEA_CONTROL_PLACE) {
    scale = turns ? 1 : 1e3;
    name = "limit point";
    unit = turns ? "rad" : "mm";
  }
  return dea_fail(ctx, DEA_E_NO_EQUILIBRIUM,
                  "%s at %.5g %s and %.4g kV: beyond it there is no stable equilibrium", name,
                  scale * value, unit, 1e-3 * model->at.voltage_V);
}

static dea_status move(struct dea_context *ctx, struct dea_model *model,
                       const struct dea_control *control, double value, struct dea_load_point *out)
{
  char why[200];
  DEA_TRY(ctx, check_control(ctx, model, control, value));
  dea_solver_state_end_history(ctx, &model->at);
  double from = where_control_is(model, control);
  DEA_TRY(ctx, set_control(ctx, model, control, value));
  dea_status status = follow_control(ctx, model, control, from, value);
  if (status != DEA_OK) {
    double reached = from + model->at.report.way * (value - from);
    snprintf(why, sizeof why, "%s", dea_context_message(ctx));
    DEA_TRY(ctx, set_control(ctx, model, control, reached));
    if (status == DEA_E_NO_EQUILIBRIUM) {
      return fail_at_limit(ctx, model, control, from + model->at.report.limit * (value - from));
    }
    return dea_fail(ctx, status, "stopped %.3g of the way to the next value (%s)",
                    model->at.report.way, why);
  }
  if (model->at.report.snapped) {
    note_states(model, true);
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "model 3d: a state at %.4g kV is unstable (buckling or snapping) "
                                 "under this load; it goes on from the stable one below it",
                                 1e-3 * model->at.voltage_V));
  }
  DEA_TRY(ctx, report(ctx, model, model->at.voltage_V, out));
  return DEA_OK;
}

/* A step in time, in which a control may move. */
static dea_status advance(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_time_step *step, struct dea_load_point *out,
                          double *error)
{
  if (step->control != NULL) {
    DEA_TRY(ctx, check_control(ctx, model, step->control, step->value));
    DEA_TRY(ctx, set_control(ctx, model, step->control, step->value));
  }
  DEA_TRY(ctx, dea_solver_state_advance(ctx, model, step, out, error));
  return DEA_OK;
}

// Slopes (docs/theory/gradients.md) ---------------------------------------------------------------

static bool same_hold(const struct dea_layout_support *a, const struct dea_layout_support *b)
{
  return a->region == b->region && a->edge == b->edge && a->within == b->within &&
         a->components == b->components && a->hinged == b->hinged;
}

static bool same_place(const struct dea_layout_body *a, const struct dea_layout_body *b)
{
  return a->region == b->region && a->free == b->free && a->moved == b->moved;
}

/* What is held where, but not how far it is moved. */
static bool same_supports(const struct dea_layout *a, const struct dea_layout *b)
{
  bool same = a->support_count == b->support_count && a->body_count == b->body_count &&
              a->channel_count == b->channel_count;
  for (size_t i = 0; same && i < a->support_count; i++) {
    same = same_hold(&a->supports[i], &b->supports[i]);
  }
  for (size_t i = 0; same && i < a->body_count; i++) {
    same = same_place(&a->bodies[i], &b->bodies[i]);
  }
  return same;
}

/* Whether nodes are held and follow bodies as before: unknowns at which slopes are taken stay. */
static dea_status check_held(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_model *own = &model->variant->own;
  const struct dea_solid_problem *a = &own->solid->problem, *b = &model->solid->problem;
  const bool same =
      a->dofs == b->dofs && memcmp(a->held, b->held, a->dofs) == 0 &&
      memcmp(own->follows, model->follows, model->mesh_node_count * sizeof *model->follows) == 0;
  return same ? DEA_OK
              : dea_fail(ctx, DEA_E_ARGUMENT,
                         "the mesh cannot follow: supports and bodies would hold other nodes");
}

/* Loads stand where a solve would bring them. */
static void place_loads(const struct dea_solid_problem *p)
{
  for (size_t i = 0; i < p->load_count; i++) {
    if (p->loads[i].parameter_count > 0) {
      memcpy(p->loads[i].now, p->loads[i].goal, p->loads[i].parameter_count * sizeof(double));
    }
  }
}

/* What controls have moved has their values, whatever the changed device says of it. */
static void keep_controls(struct dea_model *model)
{
  const struct dea_model *own = &model->variant->own;
  const struct dea_solid *from = own->solid;
  struct dea_solid *to = model->solid;
  for (size_t i = 0; i < model->layout->body_count; i++) {
    for (size_t k = 0; k < 6; k++) {
      const size_t at = 3 * to->problem.bodies[i].node + k;
      if ((own->controls[i].place >> k) & 1) {
        to->problem.held[at] = from->problem.held[at];
        to->state.u_goal[at] = from->state.u_goal[at];
      }
      if ((own->controls[i].force >> k) & 1) {
        model->push[i][k] = own->push[i][k];
      }
    }
    push_body(model, i, model->push[i]);
  }
  set_pressures(model, own->pressure_factor);
  place_loads(&to->problem);
}

/* Mesh, part materials and loads of a changed device, with a solid that has them. */
static dea_status make_variant(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_model *own = &model->variant->own;
  DEA_TRY(ctx,
          dea_device_mesh_follow(ctx, model->device, &model->settings, &own->mesh, &model->mesh));
  look_at_mesh_places(model);
  if (!same_supports(model->layout, own->layout)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the mesh cannot follow a change of what is held");
  }
  DEA_TRY(ctx, dea_plies_create(ctx, &model->mesh, &model->memory, &model->plies));
  find_band(model);
  DEA_TRY(ctx, make_solid(ctx, model));
  DEA_TRY(ctx, set_dead_loads(ctx, model));
  DEA_TRY(ctx, hold_supports(ctx, model, true));
  DEA_TRY(ctx, load_bodies(ctx, model));
  keep_controls(model);
  if (own->indent != NULL) { // in the place of the tip that stands for it
    const struct dea_solid_load tip = dea_contact_load(own->indent->contact);
    DEA_TRY(ctx, dea_solid_add_load(ctx, model->solid, &tip));
  }
  for (size_t i = 0; i < model->layout->pressure_count; i++) {
    if (model->pressures[i] != NULL && own->pressures[i] != NULL) {
      dea_pressure_hold(model->pressures[i], own->pressures[i]);
    }
  }
  DEA_TRY(ctx, check_held(ctx, model));
  DEA_TRY(ctx, dea_observer_create(ctx, &model->mesh, model->pressures, &model->observer));
  return DEA_OK;
}

/* Supports and bodies to where the changed device has them: these are no unknowns, which stay. */
static void move_held(struct variant *v)
{
  struct dea_solid *s = v->own.solid;
  const size_t dofs = s->problem.dofs;
  for (size_t i = 0; i < dofs; i++) {
    const bool moves = s->problem.held[i] == DEA_PRESCRIBED;
    v->shift[i] = moves ? v->solid->state.u_goal[i] - s->state.u_goal[i] : 0;
  }
  dea_solid_frame_vector(s, true, v->shift);
  memcpy(v->u, s->state.u, dofs * sizeof *v->u);
  for (size_t i = 0; i < dofs; i++) {
    s->state.u[i] += v->shift[i];
  }
  v->is_moved = true;
}

/* A tip that is pressed in holds what it touches, on the device that is there now. */
static dea_status enter_tip(struct dea_context *ctx, struct dea_model *model,
                            const struct dea_pressed *pressed)
{
  struct variant *v = model->variant;
  const struct dea_pressed own = {model->indent->probe, model->indent->depth_m};
  DEA_TRY(ctx,
          dea_indent_create_variant(ctx, &model->mesh, model->solid,
                                    pressed != NULL ? pressed : &own, v->own.indent, &v->indent));
  model->indent = v->indent;
  return DEA_OK;
}

/* Mesh, part materials, and loads of a changed device under the solid. */
static dea_status enter_device(struct dea_context *ctx, struct dea_model *model,
                               const struct dea_device *device)
{
  struct variant *v = model->variant;
  struct dea_solid *s = v->own.solid;
  model->device = device;
  model->layout = NULL;
  model->memory = (struct dea_arena){.ctx = ctx};
  model->mesh = (struct dea_layout_mesh){.memory = {.ctx = ctx}};
  model->solid = NULL;
  model->observer = NULL;
  model->springs = NULL;
  model->pressures = NULL;
  model->surfaces = NULL;
  dea_status status = make_variant(ctx, model);
  v->solid = model->solid;
  model->solid = s;
  DEA_TRY(ctx, status);
  s->problem.grid = v->solid->problem.grid;
  s->problem.part_materials = v->solid->problem.part_materials;
  s->problem.share = v->solid->problem.share;
  s->problem.point_mass = v->solid->problem.point_mass;
  s->problem.loads = v->solid->problem.loads;
  s->problem.load_count = v->solid->problem.load_count;
  memcpy(s->state.force, v->solid->state.force_goal, s->problem.dofs * sizeof *s->state.force);
  for (size_t k = 1; k < model->layout->channel_count; k++) {
    s->state.own_V[k] = model->layout->channels[k].own_V;
  }
  move_held(v);
  return DEA_OK;
}

static dea_status enter(struct dea_context *ctx, void *self, const struct dea_design_change *change,
                        int side)
{
  struct dea_model *model = self;
  const struct dea_device *device = change->device[side];
  if (device == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "there is no device with a number a little beside it");
  }
  if (device != model->variant->own.device) {
    DEA_TRY(ctx, enter_device(ctx, model, device));
  }
  if (model->indent != NULL) {
    DEA_TRY(ctx, enter_tip(ctx, model, change->pressed[side]));
  }
  return DEA_OK;
}

static dea_status hold_tip(struct dea_context *ctx, void *self)
{
  return enter_tip(ctx, self, NULL);
}

static void leave(struct dea_context *ctx, void *self)
{
  struct dea_model *model = self;
  struct variant *v = model->variant;
  struct dea_solid *s = v->own.solid;
  dea_indent_end_variant(ctx, s, v->own.indent, v->indent);
  v->indent = NULL;
  if (model->device != v->own.device) {
    dea_observer_destroy(ctx, model->observer);
    dea_solid_destroy(ctx, v->solid);
    v->solid = NULL;
    free_parts(ctx, model);
  }
  *model = v->own;
  s->problem = v->problem;
  if (v->is_moved) {
    memcpy(s->state.u, v->u, s->problem.dofs * sizeof *s->state.u);
    memset(v->shift, 0, s->problem.dofs * sizeof *v->shift);
  }
  v->is_moved = false;
  memcpy(s->state.force, v->force, s->problem.dofs * sizeof *s->state.force);
  memcpy(s->state.own_V, v->own_V, (s->problem.channel_count + 1) * sizeof *s->state.own_V);
}

static struct dea_gradient_film film_of(const struct dea_model *model)
{
  return (struct dea_gradient_film){
      .solid = model->solid, .films = model->plies.films, .copies = model->copies};
}

static dea_status slope(struct dea_context *ctx, void *self, int column, double *out,
                        double *pressures, bool *known)
{
  struct dea_model *model = self;
  const char *key = dea_point_columns[column].key;
  const struct dea_gradient_film film = film_of(model);
  *known = true;
  if (strcmp(key, "highest_z_m") == 0 || strcmp(key, "lowest_z_m") == 0) {
    const struct place place = find_height(model, strcmp(key, "highest_z_m") == 0 ? 1 : -1);
    out[3 * place.node[0] + 2] += 0.5;
    out[3 * place.node[1] + 2] += 0.5;
  } else if (strcmp(key, "force_N") == 0 && model->indent != NULL) { // the last load
    dea_indent_force_slope(model->indent, dea_solid_displacement(model->solid), out,
                           pressures + dea_solid_pressure_count(model->solid));
  } else if (strcmp(key, "tip_depth_m") == 0) { // of no unknown
    *known = model->indent != NULL;
  } else if (!dea_observer_column_gradient(model->observer, model->solid, column, out)) {
    DEA_TRY(ctx, dea_gradient_film_slope(ctx, &film, &model->variant->places, column, out,
                                         pressures, known));
  }
  return DEA_OK;
}

static dea_status monitor_slope(struct dea_context *ctx, void *self, size_t i, double *out,
                                double *way, bool *known)
{
  struct dea_model *model = self;
  const struct variant *v = model->variant;
  (void)ctx;
  *known =
      dea_observer_gradient(model->observer, model->solid, v->ask->monitors[i], v->motion[i],
                            out) ||
      dea_observer_force_way(model->observer, model->solid, v->ask->monitors[i], v->motion[i], way);
  return DEA_OK;
}

static dea_status take_monitors(struct dea_context *ctx, void *self, double *out)
{
  struct dea_model *model = self;
  const struct variant *v = model->variant;
  struct dea_observation seen;
  DEA_TRY(ctx, dea_observer_take(ctx, model->observer, model->solid, &seen));
  for (size_t i = 0; i < v->ask->monitor_count; i++) {
    out[i] = seen.monitor[v->ask->monitors[i]][v->motion[i]];
  }
  return DEA_OK;
}

/* Pressures and forces that controls have moved as the design has them, which they were at rest, or
 * as they are again. */
static void load_as_at_rest(const struct dea_model *model, bool at_rest)
{
  struct dea_solid *s = model->solid;
  set_pressures(model, at_rest ? 1 : model->pressure_factor);
  place_loads(&s->problem);
  for (size_t i = 0; i < model->layout->body_count; i++) {
    const struct dea_layout_body *body = &model->layout->bodies[i];
    const size_t first = 3 * s->problem.bodies[i].node;
    double own[6];
    memcpy(own, body->force_N, sizeof body->force_N);
    memcpy(own + 3, body->moment_N_m, sizeof body->moment_N_m);
    push_body(model, i, at_rest ? own : model->push[i]);
    for (size_t k = 0; k < 6; k++) {
      if ((model->variant->own.controls[i].force >> k) & 1) {
        s->state.force[first + k] = s->state.force_goal[first + k];
      }
    }
  }
}

static dea_status variant_point(struct dea_context *ctx, void *self, double voltage_V,
                                double energy_J, struct dea_load_point *out)
{
  struct dea_model *model = self;
  const struct variant *v = model->variant;
  const struct dea_gradient_film film = film_of(model);
  double *rest = v->rest; // room: followers of bodies are moved
  for (size_t i = 0; i < model->solid->problem.dofs; i++) {
    rest[i] = model->rest[i] + v->shift[i];
  }
  model->at.report.energy_J = energy_J;
  load_as_at_rest(model, true);
  const size_t loads = model->solid->problem.load_count;
  model->solid->problem.load_count -= model->indent != NULL ? 1 : 0; // it is not there at rest
  dea_status status =
      dea_gradient_rest_energy(model->solid, v->ask, rest, model->rest + model->solid->problem.dofs,
                               &model->at.rest_energy_J);
  model->solid->problem.load_count = loads;
  load_as_at_rest(model, false);
  describe(model, voltage_V, out);
  if (status == DEA_OK) {
    status = dea_gradient_film_at(ctx, &film, &v->places, v->ask, voltage_V, out);
  }
  return status == DEA_OK
             ? DEA_OK
             : dea_fail(ctx, status, "a changed device cannot be evaluated at %g V", voltage_V);
}

/* The motion of each monitor that its slope is of. */
static dea_status find_asked_motions(struct dea_context *ctx, struct dea_model *model)
{
  const struct variant *v = model->variant;
  struct dea_observation seen;
  if (v->ask->monitor_count > 0) {
    DEA_TRY(ctx, dea_observer_take(ctx, model->observer, model->solid, &seen));
    for (size_t i = 0; i < v->ask->monitor_count; i++) {
      v->motion[i] = v->ask->motions != NULL ? v->ask->motions[i]
                                             : dea_observed_main(seen.monitor[v->ask->monitors[i]]);
    }
  }
  return DEA_OK;
}

/* Liquids are as good as rigid, or again as soft as iterations need them. */
static void stiffen_liquids(const struct dea_model *model, bool stiff)
{
  static const double times = 1e3;
  for (size_t i = 0; i < model->layout->pressure_count; i++) {
    if (model->pressures[i] != NULL && model->layout->pressures[i].encloses == DEA_LIQUID) {
      dea_pressure_stiffen(model->pressures[i], dea_solid_displacement(model->solid),
                           stiff ? times : 1 / times);
      dea_solid_forget(model->solid);
    }
  }
}

static dea_status find_gradient(struct dea_context *ctx, struct dea_model *model,
                                const struct dea_gradient_ask *ask, double *out)
{
  struct variant *v = model->variant;
  struct dea_solid *s = model->solid;
  const struct dea_gradient_owner owner = {.solid = s,
                                           .outcome = &model->at.outcome,
                                           .model = model,
                                           .voltage_V = model->at.voltage_V,
                                           .slope = slope,
                                           .monitor_slope = monitor_slope,
                                           .monitors = take_monitors,
                                           .enter = enter,
                                           .hold = model->indent != NULL ? hold_tip : NULL,
                                           .leave = leave,
                                           .point = variant_point};
  const struct dea_gradient_film film = film_of(model);
  dea_gradient_places_find(&film, &v->places);
  memcpy(v->force, s->state.force, s->problem.dofs * sizeof *v->force);
  memcpy(v->own_V, s->state.own_V, (s->problem.channel_count + 1) * sizeof *v->own_V);
  v->problem = s->problem;
  v->ask = ask;
  v->own = *model;
  DEA_TRY(ctx, find_asked_motions(ctx, model));
  DEA_TRY(ctx, dea_gradient_find(ctx, &owner, ask, out));
  return DEA_OK;
}

static dea_status gradient(struct dea_context *ctx, struct dea_model *model,
                           const struct dea_gradient_ask *ask, double *out)
{
  struct dea_arena memory = {.ctx = ctx};
  const struct dea_solid_problem *p = &model->solid->problem;
  dea_solver_state_end_history(ctx, &model->at);
  if (dea_charge_is_held(model->solid)) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "gradients at a given charge are not supported");
  }
  if (dea_gradient_asks_mode(ask)) {
    DEA_TRY(ctx, check_mass(ctx, model));
  }
  struct variant *v = model->variant = dea_arena_alloc(&memory, 1, sizeof *v);
  double *values = dea_arena_alloc(&memory, 4 * p->dofs, sizeof *values);
  double *own_V = dea_arena_alloc(&memory, p->channel_count + 1, sizeof *own_V);
  enum dea_observed *motion = dea_arena_alloc(&memory, ask->monitor_count + 1, sizeof *motion);
  dea_status status = dea_solid_agree(ctx, dea_arena_status(&memory));
  if (status == DEA_OK) {
    v->force = values;
    v->rest = values + p->dofs;
    v->u = values + 2 * p->dofs;
    v->shift = values + 3 * p->dofs;
    v->own_V = own_V;
    v->motion = motion;
    stiffen_liquids(model, true);
    status = find_gradient(ctx, model, ask, out);
    stiffen_liquids(model, false);
  }
  model->variant = NULL;
  dea_arena_free(&memory);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

// In time ----------------------------------------------------------------------------------------

static dea_status begin(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_time_options *time, struct dea_load_point *out)
{
  const struct dea_driven_solid driven = {.solid = model->solid,
                                          .branches = model->plies.branches,
                                          .leakage_per_s = model->plies.leakage_per_s,
                                          .channels = !model->disc,
                                          .copies = model->copies,
                                          .thickness_m =
                                              model->layout->plies[model->plies.film].thickness_m};
  if (time->inertia) {
    DEA_TRY(ctx, check_mass(ctx, model));
  }
  DEA_TRY(ctx, dea_solver_state_begin(ctx, &model->at, &driven, time, out));
  return DEA_OK;
}

// Saved states -----------------------------------------------------------------------------------

static void mark(struct marks *marks, const double *values, size_t count)
{
  if (marks->out != NULL && count > 0) {
    memcpy(marks->out + marks->count, values, count * sizeof *values);
  }
  marks->count += count;
}

/* All numbers of the layout that electrodes, supports, and loads depend on. */
static void mark_layout(const struct dea_layout *l, struct marks *marks)
{
  mark(marks, l->gravity_m_per_s2, 3);
  for (size_t i = 0; i < l->channel_count; i++) {
    const double own[] = {l->channels[i].ratio, l->channels[i].own_V};
    mark(marks, own, 2);
  }
  for (size_t i = 0; i < l->electrode_count; i++) {
    const struct dea_layout_electrode *e = &l->electrodes[i];
    const double own[] = {(double)e->ply, e->top, (double)e->region, (double)e->channel};
    mark(marks, own, 4);
  }
  for (size_t i = 0; i < l->support_count; i++) {
    mark(marks, l->supports[i].move_m, 3);
    mark(marks, l->supports[i].force_N, 3);
  }
  for (size_t i = 0; i < l->body_count; i++) {
    const struct dea_layout_body *b = &l->bodies[i];
    mark(marks, &b->mass_kg, 1);
    mark(marks, b->shift_m, 3);
    mark(marks, b->turn_rad, 3);
    mark(marks, b->force_N, 3);
    mark(marks, b->moment_N_m, 3);
  }
  for (size_t i = 0; i < l->spring_count; i++) {
    const struct dea_layout_spring *s = &l->springs[i];
    const double own[] = {(double)s->body, s->component, s->free_at, s->stiffness};
    mark(marks, own, 4);
    mark(marks, s->at, s->count);
    mark(marks, s->force, s->count);
  }
  for (size_t i = 0; i < l->pressure_count; i++) {
    const struct dea_layout_pressure *p = &l->pressures[i];
    const double own[] = {(double)p->region, (double)p->ply, p->top, p->pressure_Pa};
    mark(marks, own, 4);
  }
}

static dea_status save(struct dea_context *ctx, struct dea_model *model, struct dea_state *out)
{
  DEA_TRY(ctx, dea_solver_state_save(ctx, &model->at, out));
  if (model->marks.out == NULL) {
    struct marks counted = {.out = NULL};
    mark_layout(model->layout, &counted);
    model->marks.out = dea_arena_alloc(&model->memory, counted.count, sizeof *model->marks.out);
    DEA_TRY(ctx, dea_arena_status(&model->memory));
    mark_layout(model->layout, &model->marks);
  }
  DEA_TRY(ctx, dea_state_add_mark(ctx, out, "loads", model->marks.out,
                                  model->marks.count * sizeof *model->marks.out));
  return DEA_OK;
}

static dea_status observe(struct dea_context *ctx, struct dea_model *model,
                          struct dea_observation *out)
{
  DEA_TRY(ctx, dea_observer_take(ctx, model->observer, model->solid, out));
  if (model->at.driven != NULL) {
    dea_observer_set_currents(model->observer, dea_circuit_step_currents_A(model->at.driven));
  }
  return DEA_OK;
}

/* What small motions are of. */
static dea_status find_motions(struct dea_context *ctx, const struct dea_model *model,
                               struct dea_motions *out)
{
  *out = (struct dea_motions){.solid = model->solid,
                              .grid = model->mesh.grid,
                              .observer = model->observer,
                              .branches = model->plies.branches,
                              .part_material_count = model->layout->ply_count};
  DEA_TRY(ctx, check_mass(ctx, model));
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                         "model 3d: frequencies are those in vacuo; the air that moves with a film "
                         "makes it slower, by up to a fifth%s%s",
                         model->mesh.sector.fold == 0
                             ? ""
                             : ". A sector has only those modes that have its symmetry "
                               "(compute.solid.domain: ",
                         model->mesh.sector.fold == 0 ? ""
                         : model->disc                ? "disc has all)"
                                                      : "whole has all)");
}

/* Monitors of the answer at one frequency, per volt. */
static dea_status take_answer(struct dea_context *ctx, void *user, size_t i, const double *real,
                              const double *imaginary)
{
  const struct dea_model *model = user;
  size_t width = model->layout->monitor_count * DEA_OBSERVED_MOTIONS;
  const double *parts[2] = {real, imaginary};
  for (int p = 0; p < 2; p++) {
    DEA_TRY(ctx, dea_observer_differentiate(ctx, model->observer, model->solid, parts[p],
                                            model->answer));
    for (size_t k = 0; k < width; k++) {
      model->answers[2 * (i * width + k) + (size_t)p] = model->answer[k];
    }
  }
  return DEA_OK;
}

static dea_status respond(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_load_point *at,
                          const struct dea_ac_excitation *excitation, const double *frequency_Hz,
                          size_t count, struct dea_load_point *points)
{
  struct dea_motions motions;
  size_t width = model->layout->monitor_count * DEA_OBSERVED_MOTIONS;
  double *answers = dea_resize(ctx, model->answers, 2 * count * width + 1, sizeof *answers);
  model->answers = answers != NULL ? answers : model->answers;
  if (dea_solid_any(answers == NULL)) {
    return DEA_E_MEMORY;
  }
  DEA_TRY(ctx, find_motions(ctx, model, &motions));
  motions.take = width > 0 ? take_answer : NULL;
  motions.user = model;
  stiffen_liquids(model, true);
  const dea_status status =
      dea_motions_respond(ctx, &motions, at, excitation, frequency_Hz, count, points);
  stiffen_liquids(model, false);
  DEA_TRY(ctx, status);
  for (size_t i = 0; i < 2 * count * width; i++) {
    model->answers[i] *= excitation->amplitude_V;
  }
  return DEA_OK;
}

static const double *answers(const struct dea_model *model)
{
  return model->answers;
}

/* All copies of the sector in the place of *mesh; that of a disc says how it is to be unfolded. */
static dea_status make_whole(struct dea_context *ctx, const struct dea_model *model,
                             struct dea_field_mesh **mesh)
{
  const struct dea_layout_sector *sector = &model->mesh.sector;
  struct dea_field_mesh *part = *mesh, *whole = NULL;
  if (model->disc) {
    part->fold = sector->fold;
    part->fibres = model->device->fibre_count;
  }
  if (sector->fold == 0 || model->disc) {
    return DEA_OK;
  }
  part->fold = sector->fold; // about the z axis, where the centre is for a moment
  part->symmetry_angle = sector->angle_rad;
  for (size_t i = 0; i < 2 * part->point_count; i++) {
    part->X[3 * (i / 2) + i % 2] -= sector->centre_m[i % 2];
  }
  dea_status status = dea_field_mesh_whole(ctx, part, &whole);
  dea_field_mesh_destroy(ctx, part);
  *mesh = whole;
  DEA_TRY(ctx, status);
  for (size_t i = 0; i < 2 * whole->point_count; i++) {
    whole->X[3 * (i / 2) + i % 2] += sector->centre_m[i % 2];
  }
  return DEA_OK;
}

static dea_status modes(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_load_point *at, size_t count,
                        struct dea_load_point *points, struct dea_field_mesh **shapes)
{
  struct dea_motions motions;
  *shapes = NULL;
  DEA_TRY(ctx, find_motions(ctx, model, &motions));
  stiffen_liquids(model, true);
  const dea_status status =
      dea_motions_modes(ctx, &motions, (int)model->plies.film, at, count, points, shapes);
  stiffen_liquids(model, false);
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, make_whole(ctx, model, shapes));
  return DEA_OK;
}

static dea_status fields(struct dea_context *ctx, struct dea_model *model,
                         enum dea_fields_part part, struct dea_field_mesh **out)
{
  DEA_TRY(ctx, part == DEA_FIELDS_VOLUME
                   ? dea_solid_volume(ctx, model->solid, out)
                   : dea_solid_surface(ctx, model->solid, (int)model->plies.film, out));
  DEA_TRY(ctx, make_whole(ctx, model, out));
  return DEA_OK;
}

/* Of a disc: along the first fibre's axis and halfway between it and the next. Of others: none. */
static dea_status profile(struct dea_context *ctx, struct dea_model *model, struct dea_profile *out)
{
  const struct dea_fibre_disc *p = &model->mesh.plate;
  struct dea_field_mesh *surface;
  *out = (struct dea_profile){0};
  if (!model->disc) {
    return DEA_OK;
  }
  dea_free(ctx, model->profile);
  model->profile = NULL;
  DEA_TRY(ctx, dea_solid_surface(ctx, model->solid, (int)model->plies.film, &surface));
  dea_status status = dea_line_profile(ctx, surface, 0, dea_fibre_disc_angle(p) / p->sectors,
                                       model->device->pre_stretch, &model->profile, out);
  dea_field_mesh_destroy(ctx, surface);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

// Other ways to a state ---------------------------------------------------------------------------

static dea_status indent(struct dea_context *ctx, struct dea_model *model,
                         const struct dea_probe *probe, double depth_m, struct dea_load_point *out)
{
  dea_solver_state_end_history(ctx, &model->at);
  if (model->indent == NULL) {
    DEA_TRY(ctx, dea_indent_create(ctx, &model->mesh, model->solid, probe, &model->indent));
  }
  dea_status status = dea_indent_move(ctx, model->indent, model->solid, model->at.voltage_V,
                                      depth_m, &model->at.report);
  if (status != DEA_OK) {
    char why[200];
    snprintf(why, sizeof why, "%s", dea_context_message(ctx));
    return dea_fail(ctx, status,
                    "the probe stopped at a depth of %.4g mm on its way to %.4g mm (%s)",
                    1e3 * model->indent->depth_m, 1e3 * depth_m, why);
  }
  DEA_TRY(ctx, report(ctx, model, model->at.voltage_V, out));
  return DEA_OK;
}

/* Of a disc to a stretch of its electrode too. */
static dea_status long_path(struct dea_context *ctx, struct dea_model *model,
                            const struct dea_path_options *options, dea_point_sink points,
                            dea_event_sink events, void *user)
{
  struct dea_solver_state_end end = {0};
  double *weight = NULL;
  if (model->disc) {
    weight = dea_solid_alloc(ctx, model->solid->problem.dofs, sizeof *weight);
    if (weight == NULL) {
      return DEA_E_MEMORY;
    }
    dea_observer_column_gradient(model->observer, model->solid,
                                 dea_point_column_find("electrode_edge_u_m"), weight);
    end.weight = weight;
    end.value =
        (options->max_stretch / model->device->pre_stretch - 1) * model->device->electrode_radius_m;
  }
  dea_status status = dea_solver_state_path(ctx, &model->at, options, &end, points, events, user);
  dea_free(ctx, weight);
  DEA_TRY(ctx, status);
  return DEA_OK;
}

static dea_status push(struct dea_context *ctx, struct dea_model *model, const struct dea_push *way,
                       struct dea_load_point *out, bool *found)
{
  double *fold = dea_solid_alloc(ctx, 3 * model->mesh.grid->node_count, sizeof *fold);
  if (fold == NULL) {
    return DEA_E_MEMORY;
  }
  dea_buckling_branch_fold(model->solid, model->mesh.grid, &model->band, way->side, fold);
  dea_status status = dea_solver_state_push(ctx, &model->at, way, fold, out, found);
  dea_free(ctx, fold);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

static dea_status carry(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_model *from, struct dea_load_point *out, bool *found)
{
  DEA_TRY(ctx, dea_solver_state_transfer(ctx, &model->at, &from->at, out, found));
  return DEA_OK;
}

static void size(const struct dea_model *model, struct dea_model_size *out)
{
  *out = (struct dea_model_size){.elements = model->mesh.grid->element_count,
                                 .nodes = model->mesh.grid->node_count,
                                 .unknowns = 3 * model->mesh.grid->node_count};
}

static const struct dea_adapt_pass *passes(const struct dea_model *model, size_t *count)
{
  *count = model->pass_count;
  return model->passes;
}

// Estimated errors -------------------------------------------------------------------------------

/* Whether the mesh is all that a point's error is of; a membrane has one too. */
static bool has_error(const struct dea_load_point *point)
{
  struct dea_load_point solid = *point;
  solid.told &= ~(1u << DEA_FLAG_PREVIEW);
  return dea_load_point_trusted(&solid);
}

/* Of the main motion of a monitor at a point without a doubt; otherwise, and of a body that is held
 * along it, NAN. part: of each element, may be NULL. */
static dea_status find_error(struct dea_context *ctx, struct dea_model *model, size_t monitor,
                             const double *values, double *weight, double *error, double *part)
{
  const struct dea_layout_monitor *m = &model->layout->monitors[monitor];
  enum dea_observed motion = dea_observed_main(values);
  *error = NAN;
  if (m->kind == DEA_MONITOR_BODY) {
    size_t node = model->bodies[m->body].node;
    if ((model->solid->problem.held[3 * node + (size_t)motion]) != 0) {
      return DEA_OK;
    }
  }
  dea_observer_gradient(model->observer, model->solid, monitor, motion, weight);
  struct dea_solid_quantity one = {.weight = weight};
  one.probe_count = dea_observer_probes(model->observer, model->solid, monitor, motion, one.probes);
  dea_status status = dea_solid_errors(ctx, model->solid, &one, 1, error, part);
  return status == DEA_E_DOMAIN ? DEA_OK : status; // at the end of a law none is known
}

static dea_status errors(struct dea_context *ctx, struct dea_model *model, double *error)
{
  struct dea_load_point point;
  struct dea_observation seen;
  DEA_TRY(ctx, report(ctx, model, model->at.voltage_V, &point));
  DEA_TRY(ctx, dea_observer_take(ctx, model->observer, model->solid, &seen));
  for (size_t i = 0; i < seen.monitor_count; i++) {
    error[i] = NAN;
  }
  if (!has_error(&point)) {
    return DEA_OK;
  }
  double *weight = dea_solid_alloc(ctx, 3 * model->mesh.grid->node_count, sizeof *weight);
  dea_status status = weight == NULL ? DEA_E_MEMORY : DEA_OK;
  for (size_t i = 0; i < seen.monitor_count && status == DEA_OK; i++) {
    status = find_error(ctx, model, i, seen.monitor[i], weight, &error[i], NULL);
  }
  dea_free(ctx, weight);
  return status;
}

// Adaptive refinement ----------------------------------------------------------------------------

/* One mesh after the other, each finer where the error of the last one came from. */
struct adaptation {
  const struct dea_device *device;
  struct dea_model_settings settings; // with the sizes of the present mesh
  size_t monitor;                     // of the layout
  struct dea_adapt_pass *pass;        // [settings.adapt.passes], owned
  size_t count;
  double (*now)[3], (*next)[3]; // sizes of this mesh and the next one, owned
  size_t next_count;
};

static dea_status make(struct dea_context *ctx, const struct dea_device *device,
                       const struct dea_model_settings *settings, struct dea_model **out)
{
  DEA_TRY(ctx, dea_model_make(ctx, sizeof **out, device, settings, prepare, destroy, out));
  struct dea_model *model = *out;
  const struct dea_layout_ply *film = &model->layout->plies[model->plies.film];
  model->at.outcome.owner = (struct dea_step_outcome_owner){
      .solid = model->solid,
      .films = model->plies.films,
      .model = model,
      .point = report,
      .arrived = arrived,
      .step_V = field_step_V_per_m * model->plies.thinnest_m,
      .tension_scale_N_per_m =
          dea_part_material_modulus(&model->plies.part_materials[model->plies.film]) *
          film->thickness_m,
      .flat_thickness_m = model->plies.flat_m,
      .refinement = model->settings.refinement,
      .membrane = model->mesh.membrane};
  return DEA_OK;
}

/* The error on a mesh at the voltage, and the sizes of the next one. */
static dea_status look_at_mesh(struct dea_context *ctx, struct adaptation *a,
                               struct dea_model *model, struct dea_adapt_pass *pass)
{
  struct dea_load_point point;
  struct dea_observation seen;
  const struct dea_grid *grid = model->mesh.grid;
  DEA_TRY(ctx, dea_solver_state_solve(ctx, model, a->settings.adapt.voltage_V, &point));
  DEA_TRY(ctx, dea_observer_take(ctx, model->observer, model->solid, &seen));
  const double *values = seen.monitor[a->monitor];
  enum dea_observed motion = dea_observed_main(values);
  bool ratio = motion == DEA_OBSERVED_STRETCH || motion == DEA_OBSERVED_AREA_STRETCH;
  *pass = (struct dea_adapt_pass){.elements = grid->element_count,
                                  .unknowns = 3 * grid->node_count,
                                  .value = values[motion],
                                  .error = NAN};
  double *weight = dea_alloc(ctx, 3 * grid->node_count, sizeof *weight);
  double *part = dea_alloc(ctx, grid->element_count, sizeof *part);
  double(*at)[3] = dea_resize(ctx, a->next, model->mesh.plane->quad_count, sizeof *at);
  a->next = at != NULL ? at : a->next;
  dea_status status =
      dea_solid_any(weight == NULL || part == NULL || at == NULL) ? DEA_E_MEMORY : DEA_OK;
  if (status == DEA_OK && has_error(&point)) {
    status = find_error(ctx, model, a->monitor, values, weight, &pass->error, part);
  }
  double wanted = a->settings.adapt.tolerance * fabs(pass->value - (ratio ? 1 : 0));
  if (status == DEA_OK && wanted > 0 && !isnan(pass->error)) {
    pass->within = pass->error <= wanted;
    a->next_count = model->mesh.plane->quad_count;
    status = dea_adapt_sizes(ctx, &model->mesh, part, wanted, a->next);
  } else if (status == DEA_OK) {
    pass->error = NAN; // of what does not move, too
  }
  dea_free(ctx, part);
  dea_free(ctx, weight);
  return status;
}

static dea_status find_monitor(struct dea_context *ctx, struct adaptation *a)
{
  const struct dea_layout *l = a->device->layout;
  const char *name = a->settings.adapt.monitor;
  while (a->monitor < l->monitor_count && strcmp(l->monitors[a->monitor].name, name) != 0) {
    a->monitor++;
  }
  return a->monitor < l->monitor_count
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DESIGN, "compute.solid.adapt: there is no monitor '%s'", name);
}

/* Where the error of a mesh is not known the last one is as good as any. */
static dea_status say_end(struct dea_context *ctx, const struct adaptation *a)
{
  const struct dea_adapt_pass *last = &a->pass[a->count - 1];
  if (!isnan(last->error) && last->within) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                         isnan(last->error)
                             ? "model 3d: no error of the monitor '%s' is known at %.4g kV: its "
                               "mesh stays as it is"
                             : "model 3d: the error of the monitor '%s' at %.4g kV is not yet that "
                               "of compute.solid.adapt.tolerance (compute.solid.adapt.passes)",
                         a->settings.adapt.monitor, 1e-3 * a->settings.adapt.voltage_V);
}

/* Another model, on a mesh of the present sizes, in the place of *model. */
static dea_status make_anew(struct dea_context *ctx, const struct adaptation *a,
                            struct dea_model **model)
{
  destroy(ctx, *model);
  *model = NULL;
  DEA_TRY(ctx, make(ctx, a->device, &a->settings, model));
  return DEA_OK;
}

/* To the mesh that is exact enough; *model: on it, at rest. */
static dea_status adapt(struct dea_context *ctx, struct adaptation *a, struct dea_model **model)
{
  size_t most = (size_t)a->settings.adapt.passes;
  a->pass = dea_solid_alloc(ctx, most, sizeof *a->pass);
  if (a->pass == NULL) {
    return DEA_E_MEMORY;
  }
  for (bool on = true; on;) {
    struct dea_adapt_pass *pass = &a->pass[a->count];
    DEA_TRY(ctx, look_at_mesh(ctx, a, *model, pass));
    a->count++;
    on = a->count < most && !pass->within && !isnan(pass->error);
    if (on) {
      double(*sizes)[3] = a->now;
      a->now = a->next;
      a->next = sizes;
      a->settings.sizes = (const double(*)[3])a->now;
      a->settings.size_count = a->next_count;
    }
    DEA_TRY(ctx, make_anew(ctx, a, model)); // the last one too: to be at rest
  }
  DEA_TRY(ctx, say_end(ctx, a));
  return DEA_OK;
}

static dea_status create(struct dea_context *ctx, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  static const struct dea_model_settings usual = {0};
  struct adaptation a = {.device = device, .settings = settings != NULL ? *settings : usual};
  bool asked = a.settings.adapt.monitor != NULL;
  *out = NULL;
  dea_status status = asked ? find_monitor(ctx, &a) : DEA_OK;
  if (status == DEA_OK) {
    status = make(ctx, device, &a.settings, out);
  }
  if (asked && status == DEA_OK) {
    status = adapt(ctx, &a, out);
  }
  if (status == DEA_OK) {
    (*out)->passes = a.pass;
    (*out)->pass_count = a.count;
    a.pass = NULL;
  } else if (*out != NULL) {
    destroy(ctx, *out);
    *out = NULL;
  }
  dea_free(ctx, a.pass);
  dea_free(ctx, a.now);
  dea_free(ctx, a.next);
  DEA_TRY(ctx, status);
  return DEA_OK;
}

extern DEA_MODULE_SYMBOL const struct dea_model_type dea_solid_module;

const struct dea_model_type dea_solid_module = {
    .name = "3d",
    .long_name = "3D solid",
    .any_layout = true,
    .libraries = dea_solid_libraries,
    .create = create,
    .destroy = destroy,
    .solve = dea_solver_state_solve,
    .gradient = gradient,
    .limit = dea_solver_state_limit,
    .passed = dea_solver_state_passed,
    .observe = observe,
    .errors = errors,
    .passes = passes,
    .indent = indent,
    .move = move,
    .long_path = long_path,
    .soften = dea_solver_state_soften,
    .push = push,
    .carry = carry,
    .modes = modes,
    .respond = respond,
    .answers = answers,
    .profile = profile,
    .fields = fields,
    .save = save,
    .load = dea_solver_state_load,
    .begin = begin,
    .advance = advance,
    .accept = dea_solver_state_accept,
    .size = size,
};

/* A solid from within: what is solved, how, where it is, what that takes, what is known of it. */
#pragma once

#include "base/arena.h"
#include "model/solid/assembly/ranks.h"
#include "model/solid/assembly/solid.h"
#include "model/solid/element/element.h"
#include "model/solid/mesh/grid.h"

#include <petscmat.h>

#include <string.h>

struct dea_charge;
struct dea_solid_field;
struct dea_internal_variables;
struct dea_solid_inertia;

/* held: where it is; prescribed: at its place; follows: where its body takes it */
enum { DEA_FREE, DEA_HELD, DEA_PRESCRIBED, DEA_FOLLOWS };

/* What is solved: mesh, part materials, supports, loads. Filled by dea_solid_create (the function
 * is named where it is another) and constant for the solvers; callers change supports and loads.
 *
 * Unknowns of the whole [dofs]: displacements [nodes][3], then, of a coupled field, psi [nodes]. In
 * K they stand node by node, per_node to each. */
struct dea_solid_problem {
  const struct dea_grid *grid; // lent
  int per_node;                // unknowns of a node: 3, or 4 with a potential
  size_t dofs;                 // per_node * nodes

  struct dea_element_set elements;                // all kinds at the orders of the grid
  enum dea_element_kind *kind;                    // [elements] by dea_solid_set_kinds
  const struct dea_part_material *part_materials; // [part_material_count]
  size_t part_material_count;
  int *part_material_of; // [elements] place in part materials
  int *laminate;     // [elements] the next one above in the same column, which it is bonded to, of
                     // the last the first; by dea_solid_find_laminates
  int (*between)[2]; // [elements] channels at its top and bottom; 0, 0 without electrodes
  bool *active;      // [elements] whether these are two, with a voltage in between
  size_t channel_count; // ground not counted
  double *share;        // [channel_count + 1] of the voltage that a channel gets; [0]: 0
  double *spring; // [dofs] M of docs/theory/membrane.md by dea_solid_create_springs; NULL: none
  struct dea_solid_field *field; // of a coupled field, by dea_solid_field_create; NULL: thin film
  size_t free_potentials;        // negative pivots of K that are none of a mode, by the same

  unsigned char *held; // [dofs] DEA_FREE, ..., of a node's local components; dea_solid_prescribe
                       // and dea_solid_release change it
  int *frame;          // [nodes] one more than the place in frames, 0: the global axes; NULL: all
                       // are; by dea_solid_frames_create
  double (*frames)[9]; // rows are local axes
  struct dea_solid_body *bodies; // [body_count] by dea_solid_bodies_create; NULL: none
  size_t body_count;
  int *body_of;       // [nodes] one more than the place in bodies, 0: of none; NULL: as bodies
  double *point_mass; // [nodes] masses beside those of elements [kg]; NULL: none
  struct dea_solid_load *loads; // [load_count] by dea_solid_add_load; owned
  size_t load_count;
  struct dea_charge *charge; // one of them, by dea_charge_hold; NULL: none

  double modulus_Pa;     // shear modulus of the softest element
  double length_m;       // smallest extent of the grid
  double energy_floor_J; // what rounding leaves of the energy of the undeformed solid

  size_t first_node; // rows of K on this rank: of nodes from here
  size_t end_node;   // to before this one
  size_t *own;       // [own_count] elements of this rank, by dea_solid_create_matrix
  size_t own_count;
};

/* Where the solid is. */
struct dea_solid_state {
  double voltage_V;   // by dea_solid_controls_set
  double *own_V;      // [channel_count + 1] voltage of a channel beside its share, by the same
  double *own_goal_V; // [channel_count + 1] those that the next solve goes to, by the caller
  double *lift_V; // [channel_count + 1] voltage that a given charge takes beside (charge_control.h)
  /* Of electrodes with a sheet resistance in time (model3d/sheet.h), [elements]; NULL: none. */
  double *drop_V;      // what the voltage across an element has beside, by dea_solid_controls_set
  double *drop_goal_V; // those that the next solve goes to, by the caller
  double *evenness;    // mean voltage across an element over its root mean square, which counts
  double *u;           // [dofs] displacements [m], then psi, by the solvers
  double *multiplier;  // [elements][elements.pressures] pressures [Pa], by the solvers
  double *theta;       // [elements][elements.pressures] J - 1, projected, by dea_solid_assemble;
                       // dea_solid_predict writes over it
  double bulk_factor;  // kappa is so many times that of the part materials, a power of 2; at first
                       // 1, by solvers and steps in time
  double *force;       // [dofs] dead loads [N] and charges as they stand, by dea_solid_controls_set
  double *force_goal;  // [dofs] those that the next solve goes to, by the caller
  double *u_goal;      // [nodes][3] of prescribed (local) components [m], by dea_solid_prescribe
  /* Of a step in time that is under way (motion/time.h), lent. NULL: elastic; without inertia. */
  struct dea_internal_variables *internal_variables;
  struct dea_solid_inertia *inertia;
};

/* An equilibrium and a goal. Controls: what an equilibrium is asked for at, see controls.h. Made by
 * dea_load_steps_prepare. */
struct dea_load_steps {
  struct dea_arena memory; // of the arrays
  size_t state_count;
  size_t control_count;
  double *keep;          // [state_count] last equilibrium
  double *factored;      // [state_count] state of the factor, where found.factor_before
  double *controls;      // [control_count] of it
  double *controls_from; // [control_count] start of a solve
  double *controls_goal; // [control_count] end of it
  double *at;            // [control_count] where it is
  // two equilibria one after the other between which the voltage alone has changed, by
  // dea_solid_follow; the same voltage twice: none
  double *before_last; // [state_count] displacements and pressures at the first
  double *last;        // [state_count] displacements at the second
  double before_last_V, last_V;
};

/* What loads add to the tangent beside K (rank_one.h). */
enum { DEA_RANK_ONE_MAX = 8 };
struct dea_solid_rank_one {
  size_t count;
  size_t solved_count; // of the present factor
  double stiffness[DEA_RANK_ONE_MAX];
  Vec slope[DEA_RANK_ONE_MAX];                         // S, of K's rows
  Vec solved[DEA_RANK_ONE_MAX];                        // Z
  double inverse[DEA_RANK_ONE_MAX * DEA_RANK_ONE_MAX]; // of M, [count][count]
};

/* Memory of the solvers: what stands in it is theirs from one call to the next, no longer. */
struct dea_solid_work {
  double *trial;        // [dofs] displacements that are tried
  double *g;            // [dofs] residual forces [N], 0 at held components, by dea_solid_assemble
  double *step;         // [dofs] of Newton's method [m]
  double *extrapolated; // [dofs] the first linear step of a way [m], by dea_solid_predict_tangent
  double *increment;    // [dofs] how far held components go in the next linear step [m], else 0;
                        // by dea_solid_controls_increment
  bool takes_increment; // the next assembly adds K times it to g
  double *predicted; // [own_count][elements.predicted_count] stresses at the end of the last step,
                     // by dea_solid_predict
  double (*body_slope)[27];           // [body_count] by dea_solid_bodies_prepare
  double squares;                     // sum of squared element forces in an assembly [N^2]
  struct dea_element_result *element; // of one element in an assembly
  struct dea_load_piece *piece;       // of one piece of a load in it
  Mat K;                              // tangent, by dea_solid_assemble
  struct dea_solid_rank_one rank_one; // beside K, by dea_solid_assemble
  Mat factor;                         // LDL^T of K, by dea_solid_factorise
  struct dea_fronts *fronts;          // its factor where it is positive definite (fronts.h); owned
  bool by_fronts;                     // the present factor is that
  bool no_fronts;                     // K has none
  bool takes_small_pivots;            // for one of a K that is singular but for rounding: else what
                                      // such a pivot belongs to is left out of solutions
  Vec right;                          // of K's rows
  Vec solution;                       // of K's rows
  struct dea_load_steps load_steps;
};

/* What is known of the state; by dea_solid_assemble unless it is said. */
struct dea_solid_found {
  double *reaction;      // [dofs] forces of the supports [N]
  double force_scale_N;  // root of the sum of squared element forces
  double energy_scale_J; // sum of absolute element energies
  double force_largest_N;
  double energy_largest_J; // of those two at any equilibrium, by dea_solid_keep_scales
  bool checked;            // dea_solid_check has nothing to say
  bool predicted_fits;     // work.predicted belongs to state.u, by dea_solid_predict
  bool factor_fits;        // work.factor is of K at the last equilibrium, positive definite
  bool stiff_factor_fits;  // it is so of K with the raised kappa; until the next factor
  bool factor_before;      // either is of the state before the last step to this one
  bool predicts_tangent, extrapolated; // work.extrapolated is to be found; it is there
};

struct dea_solid {
  struct dea_arena memory; // of all arrays but the loads and those of load_steps
  struct dea_solid_problem problem;
  struct dea_solid_settings settings;
  struct dea_solid_state state;
  struct dea_solid_work work;
  struct dea_solid_found found;
};

/* The solid is elsewhere, or another one: what was made of where it was is of no use any more. */
static inline void dea_solid_forget(struct dea_solid *s)
{
  s->found.factor_fits = s->found.stiff_factor_fits = s->found.predicted_fits = false;
}

/* Multipliers of the elements. */
static inline size_t dea_solid_pressure_count(const struct dea_solid *s)
{
  return s->problem.grid->element_count * (size_t)s->problem.elements.pressures;
}

/* Those, and behind them those of each load. */
static inline size_t dea_solid_multiplier_count(const struct dea_solid *s)
{
  size_t count = dea_solid_pressure_count(s);
  for (size_t i = 0; i < s->problem.load_count; i++) {
    count += s->problem.loads[i].multiplier_count;
  }
  return count;
}

/* Place of an unknown of a node. */
static inline size_t dea_solid_at(const struct dea_solid *s, int node, int i)
{
  return i < 3 ? 3 * (size_t)node + (size_t)i : 3 * s->problem.grid->node_count + (size_t)node;
}

/* The kind of an element at its orders. */
static inline const struct dea_element *dea_solid_element(const struct dea_solid *s, size_t e)
{
  return &s->problem.elements.of[s->problem.kind[e]];
}

/* What an element is of. */
static inline const struct dea_part_material *dea_solid_part_material(const struct dea_solid *s,
                                                                      size_t e)
{
  return &s->problem.part_materials[s->problem.part_material_of[e]];
}

/* kappa of an element as it is [Pa]. */
static inline double dea_solid_bulk_modulus(const struct dea_solid *s, size_t e)
{
  return s->state.bulk_factor * dea_solid_part_material(s, e)->kappa_Pa;
}

/* Whether a channel, or an element, has a voltage beside its share of the whole's. */
static inline bool dea_solid_has_own_voltages(const struct dea_solid *s)
{
  bool any = false;
  for (size_t k = 1; k <= s->problem.channel_count; k++) {
    any = any || s->state.own_V[k] != 0 || s->state.lift_V[k] != 0;
  }
  for (size_t e = 0; s->state.drop_V != NULL && e < s->problem.grid->element_count && !any; e++) {
    any = s->state.drop_V[e] != 0;
  }
  return any;
}

/* Voltage across an element from its bottom to its top, at a voltage of the whole. */
static inline double dea_solid_voltage_across(const struct dea_solid *s, size_t e, double voltage_V)
{
  const struct dea_solid_problem *p = &s->problem;
  int top = p->between[e][0], bottom = p->between[e][1];
  return (p->share[top] - p->share[bottom]) * voltage_V + s->state.own_V[top] -
         s->state.own_V[bottom] + s->state.lift_V[top] - s->state.lift_V[bottom] +
         (s->state.drop_V != NULL ? s->state.drop_V[e] : 0);
}

/* Nodes of an element; *nodes: [count] them. */
static inline int dea_solid_nodes(const struct dea_solid *s, size_t e, const int **nodes)
{
  *nodes = s->problem.grid->nodes + e * DEA_HEX_NODES_MAX;
  return dea_grid_nodes_of(s->problem.grid, e);
}

/* Values [node_count][3] at the nodes of an element; returns their number. */
static inline int dea_solid_gather(const struct dea_solid *s, size_t e, const double *values,
                                   double *out)
{
  const int *nodes;
  int count = dea_solid_nodes(s, e, &nodes);
  for (int n = 0; n < count; n++) {
    memcpy(out + 3 * n, values + 3 * nodes[n], 3 * sizeof *out);
  }
  return count;
}

/* Scalar product over all degrees of freedom. */
static inline double dea_solid_dot(const struct dea_solid *s, const double *a, const double *b)
{
  double sum = 0;
  for (size_t i = 0; i < s->problem.dofs; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

/* What the files of the solver share: the solid itself and its assembly. */
#ifndef DEA_MODEL_SOLID_ASSEMBLY_INTERNAL_H
#define DEA_MODEL_SOLID_ASSEMBLY_INTERNAL_H

#include "model/solid/assembly/solid.h"
#include "model/solid/element/membrane.h"

#include <petscmat.h>

struct dea_solid_field;
struct dea_internal_variables;
struct dea_solid_inertia;

/* An equilibrium and a goal. State: displacements and multipliers; controls: what an equilibrium is
 * asked for at, see controls.c. */
struct dea_load_steps {
  size_t state_count, control_count;
  double *keep;                               // [state_count] last equilibrium
  double *controls;                           // [control_count] of it
  double *controls_from, *controls_goal, *at; // start and end of a solve, and where it is
};

enum { DEA_FREE, DEA_HELD, DEA_PRESCRIBED }; // held: where it is; prescribed: at its place

/* Unknowns of the whole: displacements [nodes][3], then, of a coupled field, psi [nodes]. In K they
 * stand node by node, per_node to each. */
struct dea_solid {
  int rank, size;              // of the processes at it
  size_t first_node, end_node; // rows of K here
  size_t *own, own_count;      // [own_count] elements here
  const struct dea_grid *grid;
  struct dea_hex_shape shape;
  struct dea_flat_shape flat;
  double *spring; // [dofs] M of docs/theory/membrane.md, 0 off the flat elements; NULL without any
  struct dea_constituent *layers; // [layer_count]
  size_t layer_count;
  int per_node;                  // 3, or 4 with a potential
  size_t dofs;                   // per_node * nodes
  struct dea_solid_field *field; // NULL: thin film
  size_t free_potentials;        // negative pivots that are none of a mode
  int *layer;                    // [elements]
  bool *active;                  // [elements]
  unsigned char *held;           // [dofs] DEA_FREE, ..., of the node's local components
  int *frame;          // [nodes] one more than the place in frames, 0: global axes; NULL: all are
  double (*frames)[9]; // rows are local axes
  double *u, *trial, *g, *step, *force; // [dofs]
  double *multiplier, *theta;           // [elements][shape.pressures]
  double *force_goal; // [dofs] dead loads that were asked for; force: as they stand
  double *place;      // [dofs] displacements that were asked for of prescribed (local) components
  double *reaction;   // [dofs] forces of the supports at the last assembly
  double *drive;      // [dofs] how far held components go in the next linear step, else 0
  bool driven;        // whether they do
  struct dea_load_steps path;
  double voltage_V;    // of the last equilibrium
  double squares;      // of element forces at the last assembly
  double force_scale;  // root of the sum of squared element forces at the last assembly
  double energy_scale; // sum of absolute element energies there
  double force_largest, energy_largest; // of those two at any assembly
  struct dea_element_result *element;
  struct dea_solid_load *loads; // [load_count]
  size_t load_count;
  struct dea_piece *piece;
  Mat K, factor;
  Vec right, solution;
  bool checked;
  double *predicted;   // [own_count][dea_hex_predicted_count] stresses at the end of the last step
  bool predicted_fits; // they belong to s->u
  bool stay;           // at unstable equilibria
  bool factor_fits;    // factor is of K at the last equilibrium, positive definite
  double modulus_Pa;   // shear modulus of the softest layer
  double length_m;     // smallest extent of the grid
  double energy_floor; // rounding of the energy
  struct dea_internal_variables *history; // of a step in time, lent (time.h); NULL: elastic
  struct dea_solid_inertia *inertia;      // lent; NULL: none
};

#define DEA_SOLID_THETA_SMALL 1e-7 // of J - 1, projected

/* Turns PETSc's error code into a status. */
dea_status dea_solid_petsc(struct dea_context *ctx, PetscErrorCode code, const char *what);

/* K, the split of rows and elements over the ranks, and vectors. before: how the creation went up
 * to here, agreed on with the others. */
dea_status dea_solid_create_matrix(struct dea_context *ctx, struct dea_solid *s, dea_status before);

/* ---- ranks: each of these is a call that all make ---- */

/* The status and message of the first rank with a failure. ctx: NULL where no message is wanted. */
dea_status dea_solid_agree(struct dea_context *ctx, const struct dea_solid *s, dea_status status);
/* values[count] become their sums over the ranks, the same bits on each. */
void dea_solid_sum(const struct dea_solid *s, double *values, size_t count);
/* Largest value of all ranks. */
double dea_solid_largest(const struct dea_solid *s, double value);
/* This rank's part of `count` things, from *from to before *to (no call of all). */
void dea_solid_share(const struct dea_solid *s, size_t count, size_t *from, size_t *to);

/* Before the first solve: no inverted element, laws that reach the pre-stretch, supports that leave
 * no rigid motion (not asked where loads may hold). A message says where and what to do. */
dea_status dea_solid_check(struct dea_context *ctx, struct dea_solid *s);

/* All multipliers of a solid. */
size_t dea_solid_pressure_count(const struct dea_solid *s);

/* Place of an unknown of a node. */
static inline size_t dea_solid_at(const struct dea_solid *s, int node, int i)
{
  return i < 3 ? 3 * (size_t)node + (size_t)i : 3 * s->grid->node_count + (size_t)node;
}

/* What an element is of, with the step of its branches. */
struct dea_constituent dea_solid_constituent_at(const struct dea_solid *s, size_t e);

/* Scalar product over all degrees of freedom. */
double dea_solid_dot(const struct dea_solid *s, const double *a, const double *b);

/* Energy at displacements u, dead loads included. DEA_E_DOMAIN for an inverted element. */
dea_status dea_solid_energy(struct dea_solid *s, const double *u, double voltage_V, double *energy);

/* At s->u: energy and, up to the level, g and K; also theta and the scales. With s->predicted_fits
 * K has the predicted stresses. */
dea_status dea_solid_assemble(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                              enum dea_eval_order level, double *energy);

/* Nodes with local axes (see options): K and held are in their components, all else is in
 * global ones. */
dea_status dea_solid_frames_create(struct dea_context *ctx, struct dea_solid *s,
                                   const struct dea_solid_options *options);
/* K [per_node node_count] squared of some nodes, from global to local components. */
void dea_solid_frame_matrix(const struct dea_solid *s, int node_count, const int *nodes, double *K);
/* v [dofs] from global to local components, or back. */
void dea_solid_frame_vector(const struct dea_solid *s, bool back, double *v);
/* Sets held components of v [dofs], which is in global ones, to 0. */
void dea_solid_release_held(const struct dea_solid *s, double *v);

/* Makes s->spring for the flat elements, if there are any. DEA_E_UNSUPPORTED for what they cannot
 * be: anisotropic or without a law, in a coupled field. */
dea_status dea_solid_create_springs(struct dea_context *ctx, struct dea_solid *s);
/* What K gets for modes without stiffness; nothing without flat elements. */
dea_status dea_solid_add_springs(struct dea_context *ctx, struct dea_solid *s);

/* Ends what was added to A, which has to be done after a failure too: else its next zeroing fails.
 */
dea_status dea_solid_end_matrix(struct dea_context *ctx, Mat A);
/* LDL^T of A into *factor, which is analysed when it is NULL. */
dea_status dea_solid_factor(struct dea_context *ctx, Mat A, Mat *factor);
/* Factor of K; *negative: its negative pivots beyond those of free potentials. */
dea_status dea_solid_factorise(struct dea_context *ctx, struct dea_solid *s, int *negative);
/* K += amount_Pa int grad : grad of the displacements. */
dea_status dea_solid_shift(struct dea_context *ctx, struct dea_solid *s, double amount_Pa);
/* Places X [nodes][3] of an element's nodes; returns their number. */
int dea_solid_places(const struct dea_solid *s, size_t e, double *X);
/* A += amount times what is the same for the three components of the displacement, made of a matrix
 * [nodes][nodes] for each element, without the rows and columns of held components. A: K, or a
 * matrix of its pattern. */
dea_status dea_solid_add_scalar(struct dea_context *ctx, struct dea_solid *s, Mat A, double amount,
                                dea_status (*of)(const struct dea_solid *s, size_t e,
                                                 double *scalar));
/* A += factor M with the consistent mass matrix M (mass.h), as above. */
dea_status dea_solid_add_mass(struct dea_context *ctx, struct dea_solid *s, Mat A, double factor);
/* M as a matrix of K's pattern, owned by the caller. DEA_E_ARGUMENT where there is no mass. */
dea_status dea_solid_create_mass(struct dea_context *ctx, struct dea_solid *s, Mat *out);
/* Force on the unknowns [dofs] per volt at the equilibrium and fixed displacements, without what is
 * held. */
dea_status dea_solid_voltage_force(struct dea_context *ctx, struct dea_solid *s, double *force);
/* Sets modulus_Pa, length_m and energy_floor. */
void dea_solid_sizes(struct dea_solid *s);
/* out = K^-1 right with the present factor, [dofs] both, in global components. */
dea_status dea_solid_solve_linear(struct dea_context *ctx, struct dea_solid *s, const double *right,
                                  double *out);
/* Unknowns of the whole [dofs] in global components into a vector of K's rows; they are in local
 * ones after that. */
dea_status dea_solid_to_vector(struct dea_context *ctx, const struct dea_solid *s, double *values,
                               Vec vector);
/* A vector of K's rows as unknowns of the whole [dofs] in global components. */
dea_status dea_solid_from_vector(struct dea_context *ctx, const struct dea_solid *s, Vec vector,
                                 double *out);

/* Of a coupled field (field.c): electrodes; then its matrix, with row lengths as those of K.
 * Nothing to do for a thin film. */
dea_status dea_solid_field_create(struct dea_context *ctx, struct dea_solid *s,
                                  const struct dea_solid_options *options);
dea_status dea_solid_field_matrix(struct dea_context *ctx, struct dea_solid *s, const PetscInt *own,
                                  const PetscInt *others);
void dea_solid_field_destroy(struct dea_context *ctx, struct dea_solid *s);
/* c: a potential is c psi [V/m]. */
double dea_solid_field_scale(const struct dea_solid *s);
/* s->element of an element with potential: arguments as in dea_hex_evaluate; psi: of the whole. */
dea_status dea_solid_coupled_element(struct dea_solid *s, size_t e, const double *X,
                                     const double *u, const double *multiplier, const double *psi,
                                     enum dea_eval_order level);
/* Sets the potentials in u [dofs] to those that belong to its displacements: the maximum of the
 * energy over them. Nothing to do for a thin film. DEA_E_DOMAIN for an inverted element. */
dea_status dea_solid_solve_potential(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                                     double *u);

/* ---- controls: voltage, dead loads, places of held components, parameters of loads ---- */

/* Memory for states and controls of the solid as it is now. */
dea_status dea_load_steps_prepare(struct dea_context *ctx, struct dea_solid *s);
void dea_load_steps_release(struct dea_context *ctx, struct dea_load_steps *path);
/* Displacements and all multipliers, to and from one vector [state_count]. */
void dea_solid_state_get(const struct dea_solid *s, double *state);
void dea_solid_state_set(struct dea_solid *s, const double *state);
/* As they stand, and as the next solve wants them. */
void dea_solid_controls_get(struct dea_solid *s, double *controls);
void dea_solid_controls_goal(struct dea_solid *s, double voltage_V, double *controls);
/* Voltage, dead loads and parameters; the held components stay where they are. */
void dea_solid_controls_set(struct dea_solid *s, const double *controls);
/* drive: from the held components' displacements to those of the controls. false: they are there.
 */
bool dea_solid_controls_increment(struct dea_solid *s, const double *controls);

/* Before s->u goes on by share step: stresses there into s->predicted, pressures there into the
 * multipliers, each if it is wanted. */
dea_status dea_solid_predict(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                             const double *step, double share, bool stresses, bool pressures);
/* Whether the energy of the last assembly can tell a change of this size from rounding. */
bool dea_solid_resolved(const struct dea_solid *s, double change);
/* Largest theta of the last assembly. */
double dea_solid_theta_max(const struct dea_solid *s);

/* Stationary point of the energy, downhill from s->u: a minimum, or a point that has a valley on
 * all sides that a Newton step sees. Pressures follow; where they do not, report->theta_max is
 * above DEA_SOLID_THETA_SMALL. */
dea_status dea_solid_minimise(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                              struct dea_solid_report *report);
/* One linear step in which the held components go the whole of s->drive and the rest follows. */
dea_status dea_solid_prescribed_increment(struct dea_context *ctx, struct dea_solid *s,
                                          double voltage_V, struct dea_solid_report *report);
/* Equilibrium at the controls as they are, from s->u, with all multipliers settled. */
dea_status dea_solid_equilibrate(struct dea_context *ctx, struct dea_solid *s,
                                 struct dea_solid_report *report);
/* Moves the multipliers of the loads; the largest violation over what is allowed. */
double dea_solid_update_loads(struct dea_solid *s);
/* Another kappa of all layers with a law, factor (a power of 2) times the present one. */
void dea_solid_scale_bulk_modulus(struct dea_solid *s, double factor);
/* kappa so large that the solid is as good as incompressible, at the same pressures, and back;
 * s->theta has to belong to s->u. soften: back with multipliers that are the pressures by
 * themselves. */
void dea_solid_raise_bulk_modulus(struct dea_solid *s);
void dea_solid_restore_bulk_modulus(struct dea_solid *s);
void dea_solid_restore_bulk_modulus_at_pressure(struct dea_solid *s);
/* K with a kappa so large that its inertia is that of the incompressible solid, at s->u. */
dea_status dea_solid_assemble_stiff(struct dea_context *ctx, struct dea_solid *s);
/* Factor of K with a kappa so large that its inertia is that of the incompressible solid, at s->u
 * (docs/theory/branches.md). */
dea_status dea_solid_factor_stiff(struct dea_context *ctx, struct dea_solid *s, int *negative);
/* A mode v [count] with its sign so that its largest component is positive. */
void dea_mode_orient(size_t count, double *v);
/* One unstable mode at the equilibrium [3 node_count]: the lowest unless more than DEA_MODES_MAX
 * are. */
dea_status dea_solid_unstable_mode(struct dea_context *ctx, struct dea_solid *s, double *value,
                                   double *vector);
/* From an unstable equilibrium to the next one on the path of a force along its unstable mode
 * [3 node_count] of that value: it holds back at first and comes to nothing again. side: 1 or -1.
 */
dea_status dea_solid_mode_continuation(struct dea_context *ctx, struct dea_solid *s, int side,
                                       double value, const double *mode,
                                       struct dea_solid_report *report);
/* dea_solid_descend_unstable at an unstable equilibrium that *report speaks of. */
dea_status dea_solid_descend_from(struct dea_context *ctx, struct dea_solid *s, int side,
                                  struct dea_solid_report *report);
/* Volume lumped to the displacements [dofs]; 0 for potentials. */
void dea_solid_masses(const struct dea_solid *s, double *mass);
/* The multipliers take over kappa theta. */
void dea_solid_update_multipliers(struct dea_solid *s);

#endif

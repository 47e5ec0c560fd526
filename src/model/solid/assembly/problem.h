/* A solid from within. */
#ifndef DEA_MODEL_SOLID_ASSEMBLY_PROBLEM_H
#define DEA_MODEL_SOLID_ASSEMBLY_PROBLEM_H

#include "model/solid/assembly/ranks.h"
#include "model/solid/assembly/solid.h"
#include "model/solid/element/element.h"
#include "model/solid/mesh/grid.h"

#include <petscmat.h>

#include <string.h>

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
  size_t first_node, end_node; // rows of K here
  size_t *own, own_count;      // [own_count] elements here
  const struct dea_grid *grid;
  struct dea_element_set elements; // at the orders of the grid
  enum dea_element_kind *kind;     // [elements]
  double *spring; // [dofs] M of docs/theory/membrane.md; NULL without modes that need it
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
  double *multiplier, *theta;           // [elements][elements.pressures]
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
  double *predicted;   // [own_count][elements.predicted_count] stresses at the end of the last step
  bool predicted_fits; // they belong to s->u
  bool stay;           // at unstable equilibria
  bool factor_fits;    // factor is of K at the last equilibrium, positive definite
  double modulus_Pa;   // shear modulus of the softest layer
  double length_m;     // smallest extent of the grid
  double energy_floor; // rounding of the energy
  struct dea_internal_variables *history; // of a step in time, lent (time.h); NULL: elastic
  struct dea_solid_inertia *inertia;      // lent; NULL: none
};

/* All multipliers of a solid. */
static inline size_t dea_solid_pressure_count(const struct dea_solid *s)
{
  return s->grid->element_count * (size_t)s->elements.pressures;
}

/* Place of an unknown of a node. */
static inline size_t dea_solid_at(const struct dea_solid *s, int node, int i)
{
  return i < 3 ? 3 * (size_t)node + (size_t)i : 3 * s->grid->node_count + (size_t)node;
}

/* The kind of an element at its orders. */
static inline const struct dea_element *dea_solid_element(const struct dea_solid *s, size_t e)
{
  return &s->elements.of[s->kind[e]];
}

/* Nodes of an element; *nodes: [count] them. */
static inline int dea_solid_nodes(const struct dea_solid *s, size_t e, const int **nodes)
{
  *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
  return dea_grid_nodes_of(s->grid, e);
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
  for (size_t i = 0; i < s->dofs; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

#endif

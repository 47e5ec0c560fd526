#include "model/solid/assembly/assemble.h"

#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/assembly/potential.h"
#include "model/solid/assembly/rank_one.h"

#include <math.h>
#include <string.h>

/* ---- elements ---- */

/* Into work.element. predicted: stresses that the tangent takes; NULL for those that there are. */
static dea_status evaluate_element(struct dea_solid *s, size_t e, const double *u, double voltage_V,
                                   enum dea_eval_order level, const double *predicted)
{
  const struct dea_element *element = dea_solid_element(s, e);
  struct dea_solid_element_input at;
  dea_solid_element_input(s, e, u, voltage_V, &at);
  at.in.predicted = predicted;
  return element->type->evaluate(element, &at.in, level, s->work.element);
}

/* ---- inertia ---- */

/* *quadratic and *linear: the two terms; leaves M (u - u*) in inertia->force. */
static dea_status evaluate_inertia(struct dea_context *ctx, const struct dea_solid *s,
                                   const double *u, double *quadratic, double *linear)
{
  const struct dea_solid_inertia *inertia = s->state.inertia;
  size_t count = 3 * s->problem.grid->node_count;
  *quadratic = *linear = 0;
  for (size_t i = 0; i < count; i++) {
    inertia->away[i] = u[i] - inertia->around[i];
  }
  DEA_TRY(ctx, dea_solid_mass_apply(ctx, s, inertia->away, inertia->force));
  for (size_t i = 0; i < count; i++) {
    *quadratic += 0.5 * inertia->factor * inertia->away[i] * inertia->force[i];
    *linear += inertia->constant[i] * u[i];
  }
  return DEA_OK;
}

/* Adds the energy at displacements u. */
static dea_status add_inertia_energy(const struct dea_solid *s, const double *u, double *energy)
{
  double quadratic = 0, linear = 0;
  // no context: masses do not depend on the state, and have been evaluated before
  dea_status status =
      s->state.inertia != NULL ? evaluate_inertia(NULL, s, u, &quadratic, &linear) : DEA_OK;
  *energy += quadratic + linear;
  return status;
}

/* Adds energy and force at the state, and c M to K. */
static dea_status add_inertia(struct dea_context *ctx, struct dea_solid *s,
                              enum dea_eval_order level, double *energy)
{
  const struct dea_solid_inertia *inertia = s->state.inertia;
  double quadratic, linear;
  if (inertia == NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx, evaluate_inertia(ctx, s, s->state.u, &quadratic, &linear));
  *energy += quadratic + linear;
  s->found.energy_scale_J += fabs(quadratic) + fabs(linear);
  for (size_t i = 0; i < 3 * s->problem.grid->node_count; i++) {
    double force = inertia->factor * inertia->force[i] + inertia->constant[i];
    s->work.g[i] += force;
    s->work.squares += force * force;
  }
  if (level >= DEA_TANGENT) {
    DEA_TRY(ctx, dea_solid_add_mass(ctx, s, s->work.K, inertia->factor));
  }
  return DEA_OK;
}

/* ---- springs for modes without stiffness (docs/theory/membrane.md) ---- */

static const double neutral = 1e-10; // tau: stiffness that counts as none, in units of M

dea_status dea_solid_create_springs(struct dea_context *ctx, struct dea_solid *s)
{
  struct dea_solid_problem *p = &s->problem;
  for (size_t e = 0; e < p->grid->element_count; e++) {
    const struct dea_element *element = dea_solid_element(s, e);
    const int *nodes = p->grid->nodes + e * DEA_HEX_NODES_MAX;
    double X[DEA_HEX_DOFS_MAX], stiffness[DEA_HEX_NODES_MAX];
    if (element->type->neutral_stiffness == NULL) {
      continue;
    }
    if (p->spring == NULL) {
      p->spring = dea_arena_alloc(&s->memory, p->dofs, sizeof *p->spring);
      DEA_TRY(ctx, dea_arena_status(&s->memory));
    }
    dea_solid_gather(s, e, p->grid->X, X);
    dea_status status =
        element->type->neutral_stiffness(element, dea_solid_part_material(s, e), X, stiffness);
    for (int i = 0; i < 3 * element->nodes && status == DEA_OK; i++) { // dea_solid_check says where
      p->spring[3 * nodes[i / 3] + i % 3] += stiffness[i / 3];
    }
  }
  return DEA_OK;
}

/* What K gets for modes without stiffness; nothing without problem.spring. */
static dea_status add_springs(struct dea_context *ctx, struct dea_solid *s)
{
  const struct dea_solid_problem *p = &s->problem;
  if (p->spring == NULL) {
    return DEA_OK;
  }
  PetscScalar *values;
  DEA_PETSC(ctx, VecGetArray(s->work.right, &values));
  for (size_t i = 3 * p->first_node; i < 3 * p->end_node; i++) {
    values[i - 3 * p->first_node] = neutral * p->spring[i];
  }
  DEA_PETSC(ctx, VecRestoreArray(s->work.right, &values));
  DEA_PETSC(ctx, MatDiagonalSet(s->work.K, s->work.right, ADD_VALUES));
  if (p->body_count > 0) {
    DEA_TRY(ctx, dea_solid_bodies_add_diagonal(ctx, s, s->work.K, neutral, p->spring, 3));
    DEA_TRY(ctx, dea_solid_end_matrix(ctx, s->work.K));
  }
  return DEA_OK;
}

double dea_solid_springs_curvature(const struct dea_solid *s, const double *v)
{
  const struct dea_solid_problem *p = &s->problem;
  double sum = 0;
  for (size_t i = 0; i < 3 * p->grid->node_count && p->spring != NULL; i++) {
    sum += neutral * p->spring[i] * v[i] * v[i];
  }
  return sum;
}

/* ---- the whole ---- */

void dea_solid_loads_prepare(const struct dea_solid *s, const double *u)
{
  for (size_t i = 0; i < s->problem.load_count; i++) {
    const struct dea_solid_load *load = &s->problem.loads[i];
    if (load->prepare != NULL) {
      load->prepare(load->self, u);
    }
  }
}

/* Energy of this rank's elements and pieces of loads. */
static dea_status own_energy(struct dea_solid *s, const double *u, double voltage_V, double *energy)
{
  dea_solid_loads_prepare(s, u);
  for (size_t k = 0; k < s->problem.own_count; k++) {
    DEA_TRY_STATUS(evaluate_element(s, s->problem.own[k], u, voltage_V, DEA_ENERGY, NULL));
    *energy += s->work.element->energy_J;
  }
  for (size_t i = 0; i < s->problem.load_count; i++) {
    size_t from, to;
    dea_solid_share(s->problem.loads[i].piece_count, &from, &to);
    for (size_t p = from; p < to; p++) {
      dea_status status =
          s->problem.loads[i].evaluate(s->problem.loads[i].self, p, u, DEA_ENERGY, s->work.piece);
      DEA_TRY_STATUS(status);
      *energy += s->work.piece->node_count > 0 ? s->work.piece->energy_J : 0;
    }
  }
  return DEA_OK;
}

dea_status dea_solid_energy(struct dea_solid *s, double *u, double voltage_V, double *energy)
{
  *energy = 0;
  dea_solid_bodies_place(s, u);
  dea_status status = dea_solid_allreduce(NULL, own_energy(s, u, voltage_V, energy));
  if (status == DEA_OK) {
    dea_solid_sum(energy, 1);
    *energy -= dea_solid_dot(s, s->state.force, u);
    status = add_inertia_energy(s, u, energy);
  }
  return status;
}

/* Takes held components out of K: their rows and columns are those of a spring. */
static void hold(const struct dea_solid *s, const int *nodes, int dofs, double *K)
{
  int per = s->problem.per_node;
  for (int i = 0; i < dofs; i++) {
    if (s->problem.held[dea_solid_at(s, nodes[i / per], i % per)]) {
      double spring = fabs(K[i * dofs + i]);
      if (i % per == 3 && spring == 0) { // no dielectric here
        spring = fabs(K[(i - 1) * dofs + i - 1]);
      }
      for (int j = 0; j < dofs; j++) {
        K[i * dofs + j] = K[j * dofs + i] = 0;
      }
      K[i * dofs + i] = spring;
    }
  }
}

/* g += K times the increment of the held components. */
static void add_increment(struct dea_solid *s, const int *nodes, int dofs, const double *K)
{
  int per = s->problem.per_node;
  for (int j = 0; j < dofs; j++) {
    double amount = s->work.increment[dea_solid_at(s, nodes[j / per], j % per)];
    for (int i = 0; i < dofs && amount != 0; i++) {
      s->work.g[dea_solid_at(s, nodes[i / per], i % per)] += K[i * dofs + j] * amount;
    }
  }
}

/* Adds g and, with DEA_TANGENT, K of a few nodes to those of the whole. own: unknowns of a node in
 * them. K is changed. */
static dea_status scatter(struct dea_context *ctx, struct dea_solid *s, int node_count,
                          const int *nodes, int own, double *g, double *K,
                          enum dea_eval_order level)
{
  int per = s->problem.per_node, dofs = per * node_count;
  if (own < per) {
    dea_element_spread(node_count, g, level >= DEA_TANGENT ? K : NULL, s->work.element->g,
                       s->work.element->K);
    g = s->work.element->g;
    K = s->work.element->K;
  }
  for (int i = 0; i < dofs; i++) {
    size_t at = dea_solid_at(s, nodes[i / per], i % per);
    s->work.squares += g[i] * g[i]; // held or not: the reaction is a force too
    s->work.g[at] += g[i];
  }
  if (level < DEA_TANGENT) {
    return DEA_OK;
  }
  PetscInt block[DEA_JOINT_NODES_MAX];
  int joint[DEA_JOINT_NODES_MAX], all = dea_solid_bodies_nodes(s, node_count, nodes, joint);
  if (s->work.takes_increment) {
    add_increment(s, nodes, dofs, K);
  }
  if (all > node_count) {
    dea_solid_bodies_join(s, node_count, all, joint, K, s->work.element->K);
    K = s->work.element->K;
  }
  dea_solid_frame_matrix(s, all, joint, K);
  hold(s, joint, per * all, K);
  for (int n = 0; n < all; n++) {
    block[n] = joint[n];
  }
  DEA_PETSC(ctx, MatSetValuesBlocked(s->work.K, all, block, all, block, K, ADD_VALUES));
  return DEA_OK;
}

/* What an element says that has no energy: turned inside out, or beyond its law. */
static dea_status fail_element(struct dea_context *ctx, const struct dea_solid *s, size_t e,
                               dea_status status)
{
  struct dea_element_strains strains;
  double x[3];
  const bool inverted =
      status == DEA_E_DOMAIN && dea_solid_element_strains(s, e, &strains) != DEA_OK;
  dea_solid_element_middle(s, e, x);
  return dea_fail(ctx, inverted ? DEA_E_INVERTED : status,
                  "element %zu around (%.4g, %.4g, %.4g) mm %s", e, x[0], x[1], x[2],
                  inverted ? "turns inside out" : "is beyond its law's domain");
}

static dea_status add_elements(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                               enum dea_eval_order level, double *energy)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t k = 0; k < p->own_count; k++) {
    size_t e = p->own[k];
    struct dea_element_result *element = s->work.element;
    dea_status status = evaluate_element(
        s, e, s->state.u, voltage_V, level,
        s->found.predicted_fits ? s->work.predicted + k * p->elements.predicted_count : NULL);
    if (status != DEA_OK) {
      return fail_element(ctx, s, e, status);
    }
    *energy += element->energy_J;
    s->found.energy_scale_J += fabs(element->energy_J);
    memcpy(s->state.theta + e * (size_t)p->elements.pressures, element->theta,
           (size_t)p->elements.pressures * sizeof(double));
    const struct dea_element *kind = dea_solid_element(s, e);
    DEA_TRY(ctx, scatter(ctx, s, kind->nodes, p->grid->nodes + e * DEA_HEX_NODES_MAX,
                         kind->type->per_node, element->g, element->K, level));
  }
  return DEA_OK;
}

static dea_status add_loads(struct dea_context *ctx, struct dea_solid *s, enum dea_eval_order level,
                            double *energy)
{
  struct dea_load_piece *piece = s->work.piece;
  for (size_t i = 0; i < s->problem.load_count; i++) {
    size_t from, to;
    dea_solid_share(s->problem.loads[i].piece_count, &from, &to);
    for (size_t p = from; p < to; p++) {
      dea_status status =
          s->problem.loads[i].evaluate(s->problem.loads[i].self, p, s->state.u, level, piece);
      if (status != DEA_OK) {
        return dea_fail(ctx, status, "a load is not defined at these displacements");
      }
      if (piece->node_count > 0) {
        *energy += piece->energy_J;
        s->found.energy_scale_J += fabs(piece->energy_J);
        DEA_TRY(ctx,
                scatter(ctx, s, piece->node_count, piece->nodes, 3, piece->g, piece->K, level));
      }
    }
  }
  return DEA_OK;
}

/* On the way back to a state without stress the scales would fall to what rounding leaves: they
 * stay above a share of the largest ones. */
static void keep_scales(struct dea_solid *s)
{
  static const double share = 1e-3;
  s->found.force_scale_N = fmax(sqrt(s->work.squares), share * s->found.force_largest_N);
  s->found.energy_scale_J = fmax(s->found.energy_scale_J, share * s->found.energy_largest_J);
  if (s->found.force_largest_N == 0) {
    dea_solid_keep_scales(s);
  }
}

void dea_solid_keep_scales(struct dea_solid *s)
{
  s->found.force_largest_N = fmax(s->found.force_largest_N, s->found.force_scale_N);
  s->found.energy_largest_J = fmax(s->found.energy_largest_J, s->found.energy_scale_J);
}

/* Forces on followers of bodies become those on the bodies, whose rows of K get what comes of them.
 */
static dea_status move_to_bodies(struct dea_context *ctx, struct dea_solid *s,
                                 enum dea_eval_order level)
{
  if (s->problem.body_count > 0 && level >= DEA_TANGENT) {
    DEA_TRY(ctx, dea_solid_bodies_add_geometric(ctx, s, s->work.K,
                                                s->work.takes_increment ? s->work.increment : NULL,
                                                s->work.g));
    DEA_TRY(ctx, dea_solid_end_matrix(ctx, s->work.K));
  }
  dea_solid_bodies_collect(s, s->work.g);
  return DEA_OK;
}

/* Sums over the ranks, then the dead loads, which all ranks know, and what there is of inertia. */
static dea_status collect(struct dea_context *ctx, struct dea_solid *s, enum dea_eval_order level,
                          double *energy)
{
  const struct dea_solid_problem *p = &s->problem;
  double sums[3] = {*energy, s->found.energy_scale_J, s->work.squares};
  dea_solid_sum(sums, 3);
  dea_solid_sum(s->work.g, p->dofs);
  dea_solid_sum(s->state.theta, dea_solid_pressure_count(s));
  for (size_t i = 0; i < p->dofs; i++) {
    s->work.g[i] -= s->state.force[i];
    sums[2] += s->state.force[i] * s->state.force[i];
  }
  *energy = sums[0] - dea_solid_dot(s, s->state.force, s->state.u);
  s->found.energy_scale_J = sums[1];
  s->work.squares = sums[2];
  DEA_TRY(ctx, add_inertia(ctx, s, level, energy));
  keep_scales(s);
  DEA_TRY(ctx, move_to_bodies(ctx, s, level));
  memcpy(s->found.reaction, s->work.g, p->dofs * sizeof(double));
  dea_solid_release_held(s, s->work.g);
  dea_add(p->dofs, -1, s->work.g, s->found.reaction);
  return DEA_OK;
}

/* What loads add beside K at the state: stiffness and slope (rank_one.h). */
static dea_status get_rank_ones(struct dea_context *ctx, struct dea_solid *s)
{
  struct dea_solid_rank_one *r = &s->work.rank_one;
  r->count = 0;
  for (size_t i = 0; i < s->problem.load_count; i++) {
    const struct dea_solid_load *load = &s->problem.loads[i];
    if (load->whole == NULL) {
      continue;
    }
    if (r->count == DEA_RANK_ONE_MAX) {
      return dea_fail(ctx, DEA_E_UNSUPPORTED,
                      "there can be %d enclosed volumes and charges at most", DEA_RANK_ONE_MAX);
    }
    double *slope = s->work.trial;
    memset(slope, 0, s->problem.dofs * sizeof *slope);
    r->stiffness[r->count] = load->whole(load->self, s->state.u, slope);
    if (r->stiffness[r->count] == 0) {
      continue;
    }
    dea_solid_bodies_collect(s, slope);
    dea_solid_release_held(s, slope);
    if (r->slope[r->count] == NULL) {
      DEA_PETSC(ctx, VecDuplicate(s->work.right, &r->slope[r->count]));
      DEA_PETSC(ctx, VecDuplicate(s->work.right, &r->solved[r->count]));
    }
    DEA_TRY(ctx, dea_solid_to_vector(ctx, s, slope, r->slope[r->count]));
    r->count++;
  }
  return DEA_OK;
}

dea_status dea_solid_assemble(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                              enum dea_eval_order level, double *energy)
{
  *energy = s->found.energy_scale_J = s->work.squares = 0;
  dea_solid_bodies_place(s, s->state.u);
  dea_solid_bodies_prepare(s);
  memset(s->work.g, 0, s->problem.dofs * sizeof(double));
  memset(s->state.theta, 0, dea_solid_pressure_count(s) * sizeof(double));
  if (level >= DEA_TANGENT) {
    DEA_PETSC(ctx, MatZeroEntries(s->work.K));
  }
  dea_solid_loads_prepare(s, s->state.u);
  dea_status status = add_elements(ctx, s, voltage_V, level, energy);
  status = status == DEA_OK ? add_loads(ctx, s, level, energy) : status;
  if (status == DEA_OK && level >= DEA_TANGENT) {
    status = dea_solid_bodies_add_pins(ctx, s, s->work.K);
  }
  status = dea_solid_allreduce(ctx, status);
  if (level >= DEA_TANGENT) {
    DEA_TRY(ctx, status == DEA_OK ? dea_solid_end_matrix(ctx, s->work.K)
                                  : dea_solid_stop_matrix(ctx, s->work.K));
  }
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, collect(ctx, s, level, energy));
  if (level >= DEA_TANGENT) {
    DEA_TRY(ctx, add_springs(ctx, s));
    DEA_TRY(ctx, get_rank_ones(ctx, s));
  }
  return DEA_OK;
}

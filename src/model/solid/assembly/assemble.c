#include "model/solid/assembly/assemble.h"

#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/assembly/potential.h"

#include <math.h>
#include <string.h>

/* ---- elements ---- */

/* Into s->element. predicted: stresses that the tangent takes; NULL for those that there are. */
static dea_status evaluate_element(struct dea_solid *s, size_t e, const double *u, double voltage_V,
                                   enum dea_eval_order level, const double *predicted)
{
  const struct dea_element *element = dea_solid_element(s, e);
  struct dea_solid_element_place place;
  struct dea_element_input in;
  dea_solid_element_input(s, e, u, voltage_V, &place, &in);
  in.predicted = predicted;
  return element->type->evaluate(element, &in, level, s->element);
}

/* ---- inertia ---- */

/* *quadratic and *linear: the two terms; leaves M (u - u*) in inertia->force. */
static dea_status evaluate_inertia(struct dea_context *ctx, const struct dea_solid *s,
                                   const double *u, double *quadratic, double *linear)
{
  const struct dea_solid_inertia *inertia = s->inertia;
  size_t count = 3 * s->grid->node_count;
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
      s->inertia != NULL ? evaluate_inertia(NULL, s, u, &quadratic, &linear) : DEA_OK;
  *energy += quadratic + linear;
  return status;
}

/* Adds energy and force at s->u, and c M to K. */
static dea_status add_inertia(struct dea_context *ctx, struct dea_solid *s,
                              enum dea_eval_order level, double *energy)
{
  const struct dea_solid_inertia *inertia = s->inertia;
  double quadratic, linear;
  if (inertia == NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx, evaluate_inertia(ctx, s, s->u, &quadratic, &linear));
  *energy += quadratic + linear;
  s->energy_scale += fabs(quadratic) + fabs(linear);
  for (size_t i = 0; i < 3 * s->grid->node_count; i++) {
    double force = inertia->factor * inertia->force[i] + inertia->constant[i];
    s->g[i] += force;
    s->squares += force * force;
  }
  if (level >= DEA_TANGENT) {
    DEA_TRY(ctx, dea_solid_add_mass(ctx, s, s->K, inertia->factor));
  }
  return DEA_OK;
}

/* ---- springs for modes without stiffness (docs/theory/membrane.md) ---- */

static const double neutral = 1e-10; // tau: stiffness that counts as none, in units of M

dea_status dea_solid_create_springs(struct dea_context *ctx, struct dea_solid *s)
{
  for (size_t e = 0; e < s->grid->element_count; e++) {
    const struct dea_element *element = dea_solid_element(s, e);
    const int *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
    double X[DEA_HEX_DOFS_MAX], stiffness[DEA_HEX_NODES_MAX];
    if (element->type->neutral_stiffness == NULL) {
      continue;
    }
    if (s->spring == NULL) {
      s->spring = dea_alloc(ctx, s->dofs, sizeof *s->spring);
      if (s->spring == NULL) {
        return DEA_E_MEMORY;
      }
    }
    dea_solid_gather(s, e, s->grid->X, X);
    dea_status status =
        element->type->neutral_stiffness(element, &s->layers[s->layer[e]], X, stiffness);
    for (int i = 0; i < 3 * element->nodes && status == DEA_OK; i++) { // dea_solid_check says where
      s->spring[3 * nodes[i / 3] + i % 3] += stiffness[i / 3];
    }
  }
  return DEA_OK;
}

/* What K gets for modes without stiffness; nothing without s->spring. */
static dea_status add_springs(struct dea_context *ctx, struct dea_solid *s)
{
  if (s->spring == NULL) {
    return DEA_OK;
  }
  PetscScalar *values;
  DEA_PETSC(ctx, VecGetArray(s->right, &values));
  for (size_t i = 3 * s->first_node; i < 3 * s->end_node; i++) {
    values[i - 3 * s->first_node] = neutral * s->spring[i];
  }
  DEA_PETSC(ctx, VecRestoreArray(s->right, &values));
  DEA_PETSC(ctx, MatDiagonalSet(s->K, s->right, ADD_VALUES));
  return DEA_OK;
}

/* ---- the whole ---- */

/* Energy of this rank's elements and pieces of loads. */
static dea_status own_energy(struct dea_solid *s, const double *u, double voltage_V, double *energy)
{
  for (size_t k = 0; k < s->own_count; k++) {
    dea_status status = evaluate_element(s, s->own[k], u, voltage_V, DEA_ENERGY, NULL);
    if (status != DEA_OK) {
      return status;
    }
    *energy += s->element->energy_J;
  }
  for (size_t i = 0; i < s->load_count; i++) {
    size_t from, to;
    dea_solid_share(s->loads[i].piece_count, &from, &to);
    for (size_t p = from; p < to; p++) {
      dea_status status = s->loads[i].evaluate(s->loads[i].self, p, u, DEA_ENERGY, s->piece);
      if (status != DEA_OK) {
        return status;
      }
      *energy += s->piece->node_count > 0 ? s->piece->energy_J : 0;
    }
  }
  return DEA_OK;
}

dea_status dea_solid_energy(struct dea_solid *s, const double *u, double voltage_V, double *energy)
{
  *energy = 0;
  dea_status status = dea_solid_agree(NULL, own_energy(s, u, voltage_V, energy));
  if (status == DEA_OK) {
    dea_solid_sum(energy, 1);
    *energy -= dea_solid_dot(s, s->force, u);
    status = add_inertia_energy(s, u, energy);
  }
  return status;
}

/* Takes held components out of K: their rows and columns are those of a spring. */
static void hold(const struct dea_solid *s, const int *nodes, int dofs, double *K)
{
  int per = s->per_node;
  for (int i = 0; i < dofs; i++) {
    if (s->held[dea_solid_at(s, nodes[i / per], i % per)]) {
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

/* g += K times the way of the held components. */
static void add_drive(struct dea_solid *s, const int *nodes, int dofs, const double *K)
{
  int per = s->per_node;
  for (int j = 0; j < dofs; j++) {
    double way = s->drive[dea_solid_at(s, nodes[j / per], j % per)];
    for (int i = 0; i < dofs && way != 0; i++) {
      s->g[dea_solid_at(s, nodes[i / per], i % per)] += K[i * dofs + j] * way;
    }
  }
}

/* Adds g and, with DEA_TANGENT, K of a few nodes to those of the whole. own: unknowns of a node in
 * them. K is changed. */
static dea_status scatter(struct dea_context *ctx, struct dea_solid *s, int node_count,
                          const int *nodes, int own, double *g, double *K,
                          enum dea_eval_order level)
{
  int per = s->per_node, dofs = per * node_count;
  if (own < per) {
    dea_element_spread(node_count, g, level >= DEA_TANGENT ? K : NULL, s->element->g,
                       s->element->K);
    g = s->element->g;
    K = s->element->K;
  }
  for (int i = 0; i < dofs; i++) {
    size_t at = dea_solid_at(s, nodes[i / per], i % per);
    s->squares += g[i] * g[i]; // held or not: the reaction is a force too
    s->g[at] += g[i];
  }
  if (level < DEA_TANGENT) {
    return DEA_OK;
  }
  PetscInt block[DEA_HEX_NODES_MAX];
  if (s->driven) {
    add_drive(s, nodes, dofs, K);
  }
  dea_solid_frame_matrix(s, node_count, nodes, K);
  hold(s, nodes, dofs, K);
  for (int n = 0; n < node_count; n++) {
    block[n] = nodes[n];
  }
  DEA_PETSC(ctx, MatSetValuesBlocked(s->K, node_count, block, node_count, block, K, ADD_VALUES));
  return DEA_OK;
}

static dea_status add_elements(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                               enum dea_eval_order level, double *energy)
{
  for (size_t k = 0; k < s->own_count; k++) {
    size_t e = s->own[k];
    struct dea_element_result *element = s->element;
    dea_status status =
        evaluate_element(s, e, s->u, voltage_V, level,
                         s->predicted_fits ? s->predicted + k * s->elements.predicted_count : NULL);
    if (status != DEA_OK) {
      return dea_fail(ctx, status, "element %zu is inverted or beyond its law's domain", e);
    }
    *energy += element->energy_J;
    s->energy_scale += fabs(element->energy_J);
    memcpy(s->theta + e * (size_t)s->elements.pressures, element->theta,
           (size_t)s->elements.pressures * sizeof(double));
    const struct dea_element *kind = dea_solid_element(s, e);
    DEA_TRY(ctx, scatter(ctx, s, kind->nodes, s->grid->nodes + e * DEA_HEX_NODES_MAX,
                         kind->type->per_node, element->g, element->K, level));
  }
  return DEA_OK;
}

static dea_status add_loads(struct dea_context *ctx, struct dea_solid *s, enum dea_eval_order level,
                            double *energy)
{
  struct dea_piece *piece = s->piece;
  for (size_t i = 0; i < s->load_count; i++) {
    size_t from, to;
    dea_solid_share(s->loads[i].piece_count, &from, &to);
    for (size_t p = from; p < to; p++) {
      dea_status status = s->loads[i].evaluate(s->loads[i].self, p, s->u, level, piece);
      if (status != DEA_OK) {
        return dea_fail(ctx, status, "a load is not defined at these displacements");
      }
      if (piece->node_count > 0) {
        *energy += piece->energy_J;
        s->energy_scale += fabs(piece->energy_J);
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
  double force = sqrt(s->squares);
  s->force_largest = fmax(s->force_largest, force);
  s->energy_largest = fmax(s->energy_largest, s->energy_scale);
  s->force_scale = fmax(force, share * s->force_largest);
  s->energy_scale = fmax(s->energy_scale, share * s->energy_largest);
}

/* Sums over the ranks, then the dead loads, which all ranks know, and what there is of inertia. */
static dea_status collect(struct dea_context *ctx, struct dea_solid *s, enum dea_eval_order level,
                          double *energy)
{
  double sums[3] = {*energy, s->energy_scale, s->squares};
  dea_solid_sum(sums, 3);
  dea_solid_sum(s->g, s->dofs);
  dea_solid_sum(s->theta, dea_solid_pressure_count(s));
  for (size_t i = 0; i < s->dofs; i++) {
    s->g[i] -= s->force[i];
    sums[2] += s->force[i] * s->force[i];
  }
  *energy = sums[0] - dea_solid_dot(s, s->force, s->u);
  s->energy_scale = sums[1];
  s->squares = sums[2];
  DEA_TRY(ctx, add_inertia(ctx, s, level, energy));
  keep_scales(s);
  memcpy(s->reaction, s->g, s->dofs * sizeof(double));
  dea_solid_release_held(s, s->g);
  for (size_t i = 0; i < s->dofs; i++) {
    s->reaction[i] -= s->g[i];
  }
  return DEA_OK;
}

dea_status dea_solid_assemble(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                              enum dea_eval_order level, double *energy)
{
  *energy = s->energy_scale = s->squares = 0;
  memset(s->g, 0, s->dofs * sizeof(double));
  memset(s->theta, 0, dea_solid_pressure_count(s) * sizeof(double));
  if (level >= DEA_TANGENT) {
    DEA_PETSC(ctx, MatZeroEntries(s->K));
  }
  dea_status status = add_elements(ctx, s, voltage_V, level, energy);
  if (status == DEA_OK) {
    status = add_loads(ctx, s, level, energy);
  }
  status = dea_solid_agree(ctx, status);
  if (level >= DEA_TANGENT) {
    DEA_TRY(ctx, dea_solid_end_matrix(ctx, s->K));
  }
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, collect(ctx, s, level, energy));
  if (level >= DEA_TANGENT) {
    DEA_TRY(ctx, add_springs(ctx, s));
  }
  return DEA_OK;
}

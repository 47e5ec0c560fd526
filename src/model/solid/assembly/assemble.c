/* Energy, forces and tangent of the whole solid. */
#include "model/solid/assembly/internal.h"

#include "material/plane.h"
#include "model/solid/assembly/inertia.h"
#include "model/solid/element/hex_coupled.h"

#include <math.h>
#include <string.h>

size_t dea_solid_pressure_count(const struct dea_solid *s)
{
  return s->grid->element_count * (size_t)s->shape.pressures;
}

double dea_solid_dot(const struct dea_solid *s, const double *a, const double *b)
{
  double sum = 0;
  for (size_t i = 0; i < s->dofs; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

/* What an element needs from the whole. */
struct element_place {
  double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX];
  const double *multiplier;
};

static void gather(const struct dea_solid *s, size_t e, const double *u, struct element_place *out)
{
  const int *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
  for (int n = 0; n < dea_grid_nodes_of(s->grid, e, s->shape.nodes); n++) {
    memcpy(out->X + 3 * n, s->grid->X + 3 * nodes[n], 3 * sizeof(double));
    memcpy(out->u + 3 * n, u + 3 * nodes[n], 3 * sizeof(double));
  }
  out->multiplier = s->multiplier + e * (size_t)s->shape.pressures;
}

static dea_status evaluate_element(struct dea_solid *s, size_t e, const double *u, double voltage_V,
                                   enum dea_eval_order level)
{
  const struct dea_constituent at_step = dea_solid_constituent_at(s, e), *layer = &at_step;
  struct element_place at;
  gather(s, e, u, &at);
  if (s->grid->flat[e]) {
    return dea_membrane_evaluate(&s->flat, layer, at.X, at.u, s->active[e] ? voltage_V : 0, level,
                                 s->element);
  }
  if (s->field != NULL && layer->permittivity_F_per_m > 0) {
    return dea_solid_coupled_element(s, e, at.X, at.u, at.multiplier, u + 3 * s->grid->node_count,
                                     level);
  }
  dea_status status =
      dea_hex_evaluate(&s->shape, layer, at.X, at.u, at.multiplier,
                       s->field == NULL && s->active[e] ? voltage_V : 0, level, s->element);
  if (status == DEA_OK && s->field != NULL && level >= DEA_FORCE) {
    dea_hex_spread(s->shape.nodes, s->element->g, level >= DEA_TANGENT ? s->element->K : NULL,
                   s->element->g, s->element->K);
  }
  return status;
}

/* The k-th of this rank's elements at s->u; with stresses that were predicted for it, if any. */
static dea_status evaluate_own(struct dea_solid *s, size_t k, double voltage_V,
                               enum dea_eval_order level)
{
  size_t e = s->own[k];
  if (level < DEA_TANGENT || !s->predicted_fits || s->grid->flat[e]) {
    return evaluate_element(s, e, s->u, voltage_V, level);
  }
  const struct dea_constituent layer = dea_solid_constituent_at(s, e);
  struct element_place at;
  gather(s, e, s->u, &at);
  return dea_hex_evaluate_predicted(
      &s->shape, &layer, at.X, at.u, at.multiplier, s->active[e] ? voltage_V : 0,
      s->predicted + k * dea_hex_predicted_count(&s->shape), s->element);
}

/* Energy of this rank's elements and pieces of loads. */
static dea_status own_energy(struct dea_solid *s, const double *u, double voltage_V, double *energy)
{
  for (size_t k = 0; k < s->own_count; k++) {
    dea_status status = evaluate_element(s, s->own[k], u, voltage_V, DEA_ENERGY);
    if (status != DEA_OK) {
      return status;
    }
    *energy += s->element->energy_J;
  }
  for (size_t i = 0; i < s->load_count; i++) {
    size_t from, to;
    dea_solid_share(s, s->loads[i].piece_count, &from, &to);
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
  dea_status status = dea_solid_agree(NULL, s, own_energy(s, u, voltage_V, energy));
  if (status == DEA_OK) {
    dea_solid_sum(s, energy, 1);
    *energy -= dea_solid_dot(s, s->force, u);
    status = dea_solid_inertia_energy(s, u, energy);
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

/* Adds g and, with DEA_TANGENT, K of a few nodes to those of the whole. K is changed. */
static dea_status scatter(struct dea_context *ctx, struct dea_solid *s, int node_count,
                          const int *nodes, const double *g, double *K, enum dea_eval_order level)
{
  int per = s->per_node, dofs = per * node_count;
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
  DEA_TRY(ctx,
          dea_solid_petsc(
              ctx, MatSetValuesBlocked(s->K, node_count, block, node_count, block, K, ADD_VALUES),
              "MatSetValuesBlocked"));
  return DEA_OK;
}

static dea_status add_elements(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                               enum dea_eval_order level, double *energy)
{
  for (size_t k = 0; k < s->own_count; k++) {
    size_t e = s->own[k];
    struct dea_element_result *element = s->element;
    dea_status status = evaluate_own(s, k, voltage_V, level);
    if (status != DEA_OK) {
      return dea_fail(ctx, status, "element %zu is inverted or beyond its law's domain", e);
    }
    *energy += element->energy_J;
    s->energy_scale += fabs(element->energy_J);
    memcpy(s->theta + e * (size_t)s->shape.pressures, element->theta,
           (size_t)s->shape.pressures * sizeof(double));
    DEA_TRY(ctx, scatter(ctx, s, dea_grid_nodes_of(s->grid, e, s->shape.nodes),
                         s->grid->nodes + e * DEA_HEX_NODES_MAX, element->g, element->K, level));
  }
  return DEA_OK;
}

static dea_status add_loads(struct dea_context *ctx, struct dea_solid *s, enum dea_eval_order level,
                            double *energy)
{
  struct dea_piece *piece = s->piece;
  for (size_t i = 0; i < s->load_count; i++) {
    size_t from, to;
    dea_solid_share(s, s->loads[i].piece_count, &from, &to);
    for (size_t p = from; p < to; p++) {
      dea_status status = s->loads[i].evaluate(s->loads[i].self, p, s->u, level, piece);
      if (status != DEA_OK) {
        return dea_fail(ctx, status, "a load is not defined at these displacements");
      }
      if (piece->node_count > 0) {
        *energy += piece->energy_J;
        s->energy_scale += fabs(piece->energy_J);
        double *g = piece->g, *K = piece->K;
        if (s->per_node == 4) {
          g = s->element->g;
          K = s->element->K;
          dea_hex_spread(piece->node_count, piece->g, level >= DEA_TANGENT ? piece->K : NULL, g, K);
        }
        DEA_TRY(ctx, scatter(ctx, s, piece->node_count, piece->nodes, g, K, level));
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
  dea_solid_sum(s, sums, 3);
  dea_solid_sum(s, s->g, s->dofs);
  dea_solid_sum(s, s->theta, dea_solid_pressure_count(s));
  for (size_t i = 0; i < s->dofs; i++) {
    s->g[i] -= s->force[i];
    sums[2] += s->force[i] * s->force[i];
  }
  *energy = sums[0] - dea_solid_dot(s, s->force, s->u);
  s->energy_scale = sums[1];
  s->squares = sums[2];
  DEA_TRY(ctx, dea_solid_inertia_add(ctx, s, level, energy));
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
    DEA_TRY(ctx, dea_solid_petsc(ctx, MatZeroEntries(s->K), "MatZeroEntries"));
  }
  dea_status status = add_elements(ctx, s, voltage_V, level, energy);
  if (status == DEA_OK) {
    status = add_loads(ctx, s, level, energy);
  }
  status = dea_solid_agree(ctx, s, status);
  if (level >= DEA_TANGENT) {
    DEA_TRY(ctx, dea_solid_end_matrix(ctx, s->K));
  }
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, collect(ctx, s, level, energy));
  if (level >= DEA_TANGENT) {
    DEA_TRY(ctx, dea_solid_add_springs(ctx, s));
  }
  return DEA_OK;
}

/* Takes the film's extremes of one element into *out. */
static dea_status extremes_of(const struct dea_solid *s, size_t e,
                              const struct dea_material *material, double pre_stretch,
                              struct dea_solid_extremes *out)
{
  const struct dea_constituent at_step = dea_solid_constituent_at(s, e), *layer = &at_step;
  double voltage_V = s->active[e] ? s->voltage_V : 0;
  struct element_place at;
  struct dea_hex_membrane membrane;
  gather(s, e, s->u, &at);
  dea_status status = s->grid->flat[e]
                          ? dea_membrane_state(&s->flat, layer, at.X, at.u, voltage_V, &membrane)
                          : dea_hex_membrane_eval(&s->shape, layer, at.X, at.u, at.multiplier,
                                                  voltage_V, &membrane);
  for (int p = 0; status == DEA_OK && p < membrane.count; p++) {
    double field = fabs(voltage_V) / layer->thickness_m * membrane.area[p];
    double stretch = pre_stretch * sqrt(membrane.area[p]);
    out->min_tension_N_per_m = fmin(out->min_tension_N_per_m, membrane.tension[p]);
    if (s->active[e]) {
      out->true_field_V_per_m = fmax(out->true_field_V_per_m, field);
      out->breakdown_margin =
          fmin(out->breakdown_margin, 1 - field / dea_breakdown_field(material, stretch));
    }
  }
  return status;
}

dea_status dea_solid_capacitance(struct dea_context *ctx, struct dea_solid *s,
                                 double *capacitance_F)
{
  // charge: minus the derivative of the energy by V at fixed displacements; by V^2 it is C/2. The
  // step is small since a film that wrinkles gives way to V (docs/theory/membrane.md)
  double thickness = 0, energy[2] = {0, 0};
  for (size_t e = 0; e < s->grid->element_count; e++) {
    const struct dea_constituent *layer = &s->layers[s->layer[e]];
    bool counts = s->field != NULL ? layer->permittivity_F_per_m > 0 : s->active[e];
    thickness = fmax(thickness, counts ? layer->thickness_m : 0);
  }
  double step = 1e12 * thickness * thickness, square = s->voltage_V * s->voltage_V;
  const double squares[2] = {fmax(square - step, 0), square + step};
  dea_status status = DEA_OK;
  memcpy(s->trial, s->u, s->dofs * sizeof(double));
  for (int i = 0; i < 2 && status == DEA_OK; i++) {
    status = dea_solid_solve_potential(ctx, s, sqrt(squares[i]), s->trial);
    if (status == DEA_OK) {
      status = dea_solid_energy(s, s->trial, sqrt(squares[i]), &energy[i]);
    }
  }
  *capacitance_F =
      status == DEA_OK && step > 0 ? 2 * (energy[0] - energy[1]) / (squares[1] - squares[0]) : NAN;
  return status;
}

dea_status dea_solid_extremes(struct dea_solid *s, const struct dea_material *material,
                              double pre_stretch, struct dea_solid_extremes *out)
{
  dea_status status = DEA_OK;
  *out = (struct dea_solid_extremes){0, INFINITY, INFINITY};
  for (size_t k = 0; k < s->own_count && status == DEA_OK; k++) {
    size_t e = s->own[k];
    if (s->layers[s->layer[e]].permittivity_F_per_m > 0) { // the film
      status = extremes_of(s, e, material, pre_stretch, out);
    }
  }
  status = dea_solid_agree(NULL, s, status);
  if (status != DEA_OK) {
    return status;
  }
  out->true_field_V_per_m = dea_solid_largest(s, out->true_field_V_per_m);
  out->breakdown_margin = -dea_solid_largest(s, -out->breakdown_margin);
  out->min_tension_N_per_m = -dea_solid_largest(s, -out->min_tension_N_per_m);
  if (isinf(out->breakdown_margin)) { // fmin passes over what is unknown
    out->breakdown_margin = NAN;
  }
  return DEA_OK;
}

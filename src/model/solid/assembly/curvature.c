/* v . K v element by element. As one matrix, K rounds what a mode does not touch: sums of entries
 * of kappa, from which a soft mode leaves a part of 1e-7, so that its value is right to 1e-9. */
#include "model/solid/assembly/curvature.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/constraints.h"
#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/rank_one.h"

#include <string.h>

static double product(int count, const double *K, const double *v)
{
  double sum = 0;
  for (int i = 0; i < count; i++) {
    double force = 0;
    for (int j = 0; j < count; j++) {
      force += K[i * count + j] * v[j];
    }
    sum += v[i] * force;
  }
  return sum;
}

/* Adds forces of a few nodes to those of the whole. */
static void add_forces(struct dea_solid *s, int count, const int *nodes, int per, const double *g)
{
  for (int i = 0; i < per * count; i++) {
    s->work.g[dea_solid_at(s, nodes[i / per], i % per)] += g[i];
  }
}

static dea_status add_loads(struct dea_solid *s, const double *v, double *stiffness)
{
  struct dea_load_piece *piece = s->work.piece;
  dea_solid_loads_prepare(s, s->state.u);
  for (size_t l = 0; l < s->problem.load_count; l++) {
    const struct dea_solid_load *load = &s->problem.loads[l];
    size_t from, to;
    dea_solid_share(load->piece_count, &from, &to);
    for (size_t k = from; k < to; k++) {
      double own[3 * DEA_PIECE_NODES_MAX];
      DEA_TRY_STATUS(load->evaluate(load->self, k, s->state.u, DEA_TANGENT, piece));
      for (int n = 0; n < piece->node_count; n++) {
        memcpy(own + 3 * n, v + 3 * piece->nodes[n], 3 * sizeof *own);
      }
      *stiffness += product(3 * piece->node_count, piece->K, own);
      add_forces(s, piece->node_count, piece->nodes, 3, piece->g);
    }
  }
  return DEA_OK;
}

/* Of one element, added; with bodies its forces without kappa go to work.g. */
static dea_status add_motion(struct dea_solid *s, size_t e, const double *v, const double *q,
                             double *stiffness, double *mass)
{
  const struct dea_solid_problem *p = &s->problem;
  const struct dea_element *element = dea_solid_element(s, e);
  struct dea_solid_element_input at;
  double moving[DEA_HEX_DOFS_MAX], potential[DEA_HEX_NODES_MAX], element_stiffness = 0, moved = 0;
  const int *nodes;
  dea_solid_element_input(s, e, s->state.u, s->state.voltage_V, &at);
  dea_solid_gather(s, e, v, moving);
  const int count = dea_solid_nodes(s, e, &nodes);
  for (int n = 0; n < count && element->type->per_node > 3; n++) {
    potential[n] = v[dea_solid_at(s, nodes[n], 3)];
  }
  const struct dea_element_motion motion = {
      .v = moving, .potential = potential, .pressure = q + e * (size_t)p->elements.pressures};
  at.part_material.kappa_Pa *= DEA_SOLID_STIFF;
  DEA_TRY_STATUS(element->type->motion(element, &at.in, &motion, &element_stiffness, &moved));
  if (p->body_count > 0) {
    at.part_material.kappa_Pa = 0;
    DEA_TRY_STATUS(element->type->evaluate(element, &at.in, DEA_FORCE, s->work.element));
    add_forces(s, count, nodes, element->type->per_node, s->work.element->g);
  }
  *stiffness += element_stiffness;
  *mass += moved;
  return DEA_OK;
}

/* 2 q . C_u v - w q^2 / k of the constraints of loads. */
static double motion_of_constraints(const struct dea_solid *s, const double *v, const double *q)
{
  double sum = 0;
  for (size_t l = 0; l < s->problem.load_count; l++) {
    const struct dea_solid_load *load = &s->problem.loads[l];
    for (size_t i = 0; i < load->multiplier_count; i++, q++) {
      struct dea_load_constraint c;
      if (*q != 0 && load->constraint != NULL) {
        load->constraint(load->self, i, s->state.u, &c);
        for (int k = 0; k < 3 * c.node_count; k++) {
          sum += 2 * *q * c.slope[k] * v[3 * c.nodes[k / 3] + k % 3];
        }
        sum -= c.weight * *q * *q / c.stiffness;
      }
    }
  }
  return sum;
}

dea_status dea_solid_motion(struct dea_context *ctx, struct dea_solid *s, double *v,
                            const double *q, double *stiffness, double *mass)
{
  const struct dea_solid_problem *p = &s->problem;
  double sums[2] = {0};
  dea_status status = DEA_OK;
  memset(s->work.g, 0, p->dofs * sizeof *s->work.g);
  dea_solid_bodies_place(s, s->state.u);
  dea_solid_bodies_prepare(s);
  dea_solid_bodies_transfer(s, v);
  for (size_t k = 0; k < p->own_count && status == DEA_OK; k++) {
    status = add_motion(s, p->own[k], v, q, &sums[0], &sums[1]);
  }
  status = status == DEA_OK ? add_loads(s, v, &sums[0]) : status;
  DEA_TRY(ctx, dea_solid_allreduce(ctx, status));
  dea_solid_sum(sums, 2);
  dea_solid_sum(s->work.g, p->body_count > 0 ? p->dofs : 0);
  dea_add(p->dofs, -1, s->state.force, s->work.g);
  for (size_t i = 0; i < 3 * p->grid->node_count && p->point_mass != NULL; i++) {
    sums[1] += p->point_mass[i / 3] * v[i] * v[i];
  }
  *stiffness = sums[0] + dea_solid_rank_one_curvature(s, v) +
               motion_of_constraints(s, v, q + dea_solid_pressure_count(s)) +
               dea_solid_bodies_curvature(s, s->work.g, v);
  *mass = sums[1];
  return DEA_OK;
}

/* At multipliers that are the pressures. */
static dea_status add_up(struct dea_context *ctx, struct dea_solid *s,
                         const struct dea_constraints *constraints, size_t count, double *v,
                         double *q, double *out)
{
  for (size_t i = 0; i < count; i++) {
    double mass;
    dea_constraints_pressures(constraints, v + i * s->problem.dofs, q);
    DEA_TRY(ctx, dea_solid_motion(ctx, s, v + i * s->problem.dofs, q, &out[i], &mass));
    out[i] += dea_solid_springs_curvature(s, v + i * s->problem.dofs);
  }
  return DEA_OK;
}

dea_status dea_solid_curvatures(struct dea_context *ctx, struct dea_solid *s, size_t count,
                                double *v, double *out)
{
  struct dea_arena memory = {.ctx = ctx};
  struct dea_constraints constraints;
  const size_t pressures = dea_solid_pressure_count(s);
  double *own = dea_arena_alloc(&memory, pressures, sizeof *own);
  double *q = dea_arena_alloc(&memory, dea_solid_multiplier_count(s), sizeof *q);
  dea_status status = dea_constraints_find(ctx, &memory, s, &constraints);
  if (status == DEA_OK) {
    memcpy(own, s->state.multiplier, pressures * sizeof *own);
    dea_solid_update_multipliers(s);
    status = add_up(ctx, s, &constraints, count, v, q, out);
    memcpy(s->state.multiplier, own, pressures * sizeof *own);
  }
  dea_arena_free(&memory);
  return DEA_CHAIN(ctx, status);
}

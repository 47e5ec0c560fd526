/* v . K v element by element. As one matrix, K rounds what a mode does not touch: sums of entries
 * of kappa, from which a soft mode leaves a part of 1e-7, so that its value is right to 1e-9. In an
 * element the motion of its middle is taken off first, for which it has no stiffness, and what
 * kappa resists is a square,
 *
 *   v . K v = sum_e (v - v_0) . A_e (v - v_0) + kappa |b_e (v - v_0)|^2 + loads, springs, bodies,
 *
 * A without kappa at the pressures that there are, b as in element.h. */
#include "model/solid/assembly/curvature.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/rank_one.h"

#include <string.h>

/* The room for b and L of one element. */
struct capacity {
  double b[DEA_HEX_PRESSURES_MAX * DEA_HEX_DOFS_MAX];
  double L[DEA_HEX_PRESSURES_MAX * DEA_HEX_PRESSURES_MAX];
};

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

/* Displacements of an element along v from their mean: [nodes][3]. */
static void gather_shape(const struct dea_solid *s, size_t e, const double *v, double *out)
{
  const int count = dea_solid_gather(s, e, v, out);
  for (int i = 0; i < 3; i++) {
    double mean = 0;
    for (int n = 0; n < count; n++) {
      mean += out[3 * n + i] / count;
    }
    for (int n = 0; n < count; n++) {
      out[3 * n + i] -= mean;
    }
  }
}

/* Of an element that is in work.element and `room`; kappa_Pa: that of the stiff solid. */
static double of_element(const struct dea_solid *s, size_t e, double kappa_Pa,
                         const struct capacity *capacity, const double *v)
{
  const struct dea_element *element = dea_solid_element(s, e);
  const int per = element->type->per_node, nodes = element->nodes;
  const int *node;
  double shape[DEA_HEX_DOFS_MAX], all[DEA_ELEMENT_DOFS_MAX], sum = 0;
  gather_shape(s, e, v, shape);
  dea_solid_nodes(s, e, &node);
  for (int i = 0; i < per * nodes; i++) {
    const int n = i / per, k = i % per;
    all[i] = k < 3 ? shape[3 * n + k] : v[dea_solid_at(s, node[n], k)];
  }
  for (int m = 0; m < element->pressures && element->type->constraint != NULL; m++) {
    double gain = 0;
    for (int i = 0; i < 3 * nodes; i++) {
      gain += capacity->b[m * 3 * nodes + i] * shape[i];
    }
    sum += kappa_Pa * gain * gain;
  }
  return sum + product(per * nodes, s->work.element->K, all);
}

/* Adds forces of a few nodes to those of the whole. */
static void add_forces(struct dea_solid *s, int count, const int *nodes, int per, const double *g)
{
  for (int i = 0; i < per * count; i++) {
    s->work.g[dea_solid_at(s, nodes[i / per], i % per)] += g[i];
  }
}

static dea_status add_elements(struct dea_solid *s, double stiff, struct capacity *capacity,
                               size_t count, const double *v, double *out)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t k = 0; k < p->own_count; k++) {
    const size_t e = p->own[k];
    const struct dea_element *element = dea_solid_element(s, e);
    struct dea_solid_element_input at;
    dea_solid_element_input(s, e, s->state.u, s->state.voltage_V, &at);
    dea_status status = element->type->evaluate(element, &at.in, DEA_TANGENT, s->work.element);
    if (status == DEA_OK && element->type->constraint != NULL) {
      status = element->type->constraint(element, &at.in, capacity->b, capacity->L);
    }
    DEA_TRY_STATUS(status);
    for (size_t i = 0; i < count; i++) {
      out[i] += of_element(s, e, stiff * dea_solid_part_material(s, e)->kappa_Pa, capacity,
                           v + i * p->dofs);
    }
    add_forces(s, element->nodes, p->grid->nodes + e * DEA_HEX_NODES_MAX, element->type->per_node,
               s->work.element->g);
  }
  return DEA_OK;
}

static dea_status add_loads(struct dea_solid *s, size_t count, const double *v, double *out)
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
      for (size_t i = 0; i < count && piece->node_count > 0; i++) {
        for (int n = 0; n < piece->node_count; n++) {
          memcpy(own + 3 * n, v + i * s->problem.dofs + 3 * piece->nodes[n], 3 * sizeof *own);
        }
        out[i] += product(3 * piece->node_count, piece->K, own);
      }
      add_forces(s, piece->node_count, piece->nodes, 3, piece->g);
    }
  }
  return DEA_OK;
}

/* Without kappa, at the pressures that the state has. */
static dea_status add_pieces(struct dea_context *ctx, struct dea_solid *s,
                             struct capacity *capacity, size_t count, const double *v, double *out)
{
  const double stiff = DEA_SOLID_STIFF * s->state.bulk_factor;
  const size_t pressures = dea_solid_pressure_count(s);
  double *own = dea_solid_alloc(ctx, pressures + 1, sizeof *own);
  DEA_TRY_MEMORY(own != NULL);
  memcpy(own, s->state.multiplier, pressures * sizeof *own);
  dea_solid_update_multipliers(s);
  dea_solid_drop_bulk_modulus(s);
  dea_status status = add_elements(s, stiff, capacity, count, v, out);
  dea_solid_restore_dropped_bulk_modulus(s);
  memcpy(s->state.multiplier, own, pressures * sizeof *own);
  dea_free(ctx, own);
  return status == DEA_OK ? add_loads(s, count, v, out) : status;
}

dea_status dea_solid_curvatures(struct dea_context *ctx, struct dea_solid *s, size_t count,
                                const double *v, double *out)
{
  const size_t dofs = s->problem.dofs;
  struct capacity *capacity = dea_solid_alloc(ctx, 1, sizeof *capacity);
  DEA_TRY_MEMORY(capacity != NULL);
  memset(out, 0, count * sizeof *out);
  memset(s->work.g, 0, dofs * sizeof *s->work.g);
  dea_status status = dea_solid_allreduce(ctx, add_pieces(ctx, s, capacity, count, v, out));
  dea_free(ctx, capacity);
  DEA_TRY(ctx, status);
  dea_solid_sum(out, count);
  dea_solid_sum(s->work.g, dofs);
  for (size_t i = 0; i < dofs; i++) {
    s->work.g[i] -= s->state.force[i];
  }
  for (size_t i = 0; i < count; i++) {
    out[i] += dea_solid_rank_one_curvature(s, v + i * dofs) +
              dea_solid_springs_curvature(s, v + i * dofs) +
              dea_solid_bodies_curvature(s, s->work.g, v + i * dofs);
  }
  return DEA_OK;
}

/* ---- with pressures ---- */

/* Of one element, added; with bodies its forces without kappa go to work.g. */
static dea_status add_motion(struct dea_solid *s, size_t e, const double *v, const double *q,
                             double *stiffness, double *mass)
{
  const struct dea_solid_problem *p = &s->problem;
  const struct dea_element *element = dea_solid_element(s, e);
  struct dea_solid_element_input at;
  double moving[DEA_HEX_DOFS_MAX], potential[DEA_HEX_NODES_MAX], element_stiffness = 0,
         moved = 0;
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
  dea_status status = element->type->motion(element, &at.in, &motion, &element_stiffness, &moved);
  if (status == DEA_OK && p->body_count > 0) {
    at.part_material.kappa_Pa = 0;
    status = element->type->evaluate(element, &at.in, DEA_FORCE, s->work.element);
    add_forces(s, count, nodes, element->type->per_node, s->work.element->g);
  }
  *stiffness += element_stiffness;
  *mass += moved;
  return status;
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
  status = status == DEA_OK ? add_loads(s, 1, v, &sums[0]) : status;
  DEA_TRY(ctx, dea_solid_allreduce(ctx, status));
  dea_solid_sum(sums, 2);
  dea_solid_sum(s->work.g, p->body_count > 0 ? p->dofs : 0);
  for (size_t i = 0; i < 3 * p->grid->node_count && p->point_mass != NULL; i++) {
    sums[1] += p->point_mass[i / 3] * v[i] * v[i];
  }
  *stiffness = sums[0] + dea_solid_rank_one_curvature(s, v) +
               motion_of_constraints(s, v, q + dea_solid_pressure_count(s)) +
               dea_solid_bodies_curvature(s, s->work.g, v);
  *mass = sums[1];
  return DEA_OK;
}

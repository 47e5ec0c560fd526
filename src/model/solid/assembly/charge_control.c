#include "model/solid/assembly/charge_control.h"

#include "model/solid/assembly/channels.h"
#include "model/solid/assembly/elements.h"

#include <string.h>

struct dea_charge {
  struct dea_solid *solid;
  double *scratch; // [dofs]
  double *share;   // [channels + 1] of the lift: the supply's, or 1 of one channel
  size_t channel;
  bool held;
  double now_C, goal_C;
  double lift_V, capacitance_F;
};

/* What an element's voltage changes by with the lift. */
static double weight_of(const struct dea_charge *c, size_t e)
{
  const int *at = c->solid->problem.between[e];
  return c->share[at[0]] - c->share[at[1]];
}

static void lift(struct dea_charge *c, double lift_V)
{
  c->lift_V = lift_V;
  for (size_t k = 1; k <= c->solid->problem.channel_count; k++) {
    c->solid->state.lift_V[k] = lift_V * c->share[k];
  }
}

/* Q without a lift, and dQ/dV, at displacements u. */
static dea_status add_up(const struct dea_charge *c, const double *u, double sums[2])
{
  struct dea_solid *s = c->solid;
  dea_status status = DEA_OK;
  sums[0] = sums[1] = 0;
  for (size_t i = 0; i < s->problem.own_count && status == DEA_OK; i++) {
    const size_t e = s->problem.own[i];
    const double a = weight_of(c, e);
    double C = 0;
    if (s->problem.active[e] && a != 0) {
      status = dea_solid_element_capacitance(s, e, u, &C);
      sums[0] += a * C * dea_solid_voltage_across(s, e, s->state.voltage_V);
      sums[1] += a * a * C;
    }
  }
  status = dea_solid_allreduce(NULL, status);
  dea_solid_sum(sums, 2);
  return status;
}

/* V = (Q - Q_0)/C; where the film has no energy the elements say so. */
static void prepare(void *self, const double *u)
{
  struct dea_charge *c = self;
  double sums[2];
  const double last_V = c->lift_V;
  if (c->held) {
    lift(c, 0);
    const bool found = add_up(c, u, sums) == DEA_OK && sums[1] > 0;
    c->capacitance_F = found ? sums[1] : c->capacitance_F;
    lift(c, found ? (c->now_C - sums[0]) / sums[1] : last_V);
  }
}

/* H = W(u, V) + Q V, of which dH/dV = 0. */
static dea_status evaluate(const void *self, size_t piece, const double *u,
                           enum dea_eval_order level, struct dea_load_piece *out)
{
  const struct dea_charge *c = self;
  (void)piece;
  (void)u;
  out->node_count = c->held ? 1 : 0;
  out->nodes[0] = 0;
  out->energy_J = c->now_C * c->lift_V;
  memset(out->g, 0, 3 * sizeof *out->g);
  memset(out->K, 0, level >= DEA_TANGENT ? 9 * sizeof *out->K : 0);
  return DEA_OK;
}

/* Adds s = dQ/du at fixed voltages: of an element a V dC/du, with its forces -V^2/2 dC/du. */
static void add_slope(const struct dea_charge *c, const double *u, double *slope)
{
  struct dea_solid *s = c->solid;
  struct dea_solid_element_input at;
  for (size_t i = 0; i < s->problem.own_count; i++) {
    const size_t e = s->problem.own[i];
    const struct dea_element *element = dea_solid_element(s, e);
    const double a = weight_of(c, e), V = dea_solid_voltage_across(s, e, s->state.voltage_V);
    if (!s->problem.active[e] || a == 0 || V == 0) {
      continue;
    }
    dea_solid_element_input(s, e, u, s->state.voltage_V, &at);
    for (int k = 0; k < 2; k++) {
      const int *nodes;
      const int dofs = 3 * dea_solid_nodes(s, e, &nodes);
      at.in.voltage_V = k == 0 ? 0 : V;
      if (element->type->evaluate(element, &at.in, DEA_FORCE, s->work.element) != DEA_OK) {
        return;
      }
      for (int j = 0; j < dofs; j++) {
        slope[3 * (size_t)nodes[j / 3] + (size_t)(j % 3)] +=
            (k == 0 ? 2 : -2) * a / V * s->work.element->g[j];
      }
    }
  }
}

static double whole(const void *self, const double *u, double *slope)
{
  const struct dea_charge *c = self;
  if (c->held && slope != NULL) {
    memset(c->scratch, 0, c->solid->problem.dofs * sizeof *c->scratch);
    add_slope(c, u, c->scratch);
    dea_solid_sum(c->scratch, c->solid->problem.dofs);
    dea_add(c->solid->problem.dofs, 1, c->scratch, slope);
  }
  return c->held ? 1 / c->capacitance_F : 0;
}

static double along(const void *self, const double *u, const double *motion)
{
  const struct dea_charge *c = self;
  memset(c->scratch, 0, c->solid->problem.dofs * sizeof *c->scratch);
  add_slope(c, u, c->scratch);
  dea_solid_sum(c->scratch, c->solid->problem.dofs);
  return dea_solid_dot(c->solid, c->scratch, motion);
}

static dea_status refuse(struct dea_context *ctx, const struct dea_solid *s)
{
  bool wrinkles = false;
  for (size_t i = 0; i < s->problem.part_material_count; i++) {
    wrinkles = wrinkles || s->problem.part_materials[i].relaxed;
  }
  return s->problem.field != NULL
             ? dea_fail(ctx, DEA_E_UNSUPPORTED, "a charge is not given of a coupled field")
         : wrinkles ? dea_fail(ctx, DEA_E_UNSUPPORTED,
                               "a charge is not given of films that wrinkle without bending "
                               "(compute.solid.film: solid)")
                    : DEA_OK;
}

dea_status dea_charge_create(struct dea_context *ctx, struct dea_solid *solid)
{
  DEA_TRY(ctx, refuse(ctx, solid));
  struct dea_charge *c = dea_arena_alloc(&solid->memory, 1, sizeof *c);
  double *scratch = dea_arena_alloc(&solid->memory, solid->problem.dofs, sizeof *scratch);
  double *share = dea_arena_alloc(&solid->memory, solid->problem.channel_count + 1, sizeof *share);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(&solid->memory)));
  c->solid = solid;
  c->scratch = scratch;
  c->share = share;
  const struct dea_solid_load load = {.self = c,
                                      .piece_count = 1,
                                      .evaluate = evaluate,
                                      .prepare = prepare,
                                      .whole = whole,
                                      .along = along,
                                      .parameter_count = 1,
                                      .now = &c->now_C,
                                      .goal = &c->goal_C};
  DEA_TRY(ctx, dea_solid_add_load(ctx, solid, &load));
  solid->problem.charge = c;
  return DEA_OK;
}

dea_status dea_charge_hold(struct dea_context *ctx, struct dea_solid *solid, size_t channel,
                           double charge_C)
{
  double sums[2];
  DEA_TRY(ctx, solid->problem.charge == NULL ? dea_charge_create(ctx, solid) : DEA_OK);
  struct dea_charge *c = solid->problem.charge;
  if (!c->held) {
    c->channel = channel;
    for (size_t k = 1; k <= solid->problem.channel_count; k++) {
      c->share[k] = channel == 0 ? solid->problem.share[k] : k == channel;
    }
    const dea_status status = add_up(c, solid->state.u, sums);
    if (status != DEA_OK || !(sums[1] > 0)) {
      return dea_fail(ctx, status != DEA_OK ? status : DEA_E_UNSUPPORTED,
                      "no film takes a charge here");
    }
    c->now_C = sums[0];
    c->capacitance_F = sums[1];
    c->held = true;
    dea_solid_forget(solid);
  }
  c->goal_C = charge_C;
  return DEA_OK;
}

void dea_charge_release(struct dea_solid *solid)
{
  if (dea_charge_is_held(solid)) {
    lift(solid->problem.charge, 0);
    solid->problem.charge->held = false;
    dea_solid_forget(solid);
  }
}

bool dea_charge_is_held(const struct dea_solid *solid)
{
  return solid->problem.charge != NULL && solid->problem.charge->held;
}

struct dea_charge_values dea_charge_now(const struct dea_solid *solid)
{
  const struct dea_charge *c = solid->problem.charge;
  return (struct dea_charge_values){c->channel, c->now_C, c->lift_V, c->capacitance_F};
}

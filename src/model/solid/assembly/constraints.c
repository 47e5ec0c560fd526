#include "model/solid/assembly/constraints.h"

#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/incompressible.h"

#include <string.h>

dea_status dea_constraints_find(struct dea_context *ctx, struct dea_arena *memory,
                                struct dea_solid *s, struct dea_constraints *out)
{
  const size_t own = s->problem.own_count, most = (size_t)s->problem.elements.pressures;
  dea_status status = DEA_OK;
  *out = (struct dea_constraints){.s = s, .most = most};
  out->b = dea_arena_alloc(memory, own * most * DEA_HEX_DOFS_MAX, sizeof *out->b);
  out->L = dea_arena_alloc(memory, own * most * most, sizeof *out->L);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(memory)));
  for (size_t k = 0; k < own && status == DEA_OK; k++) {
    const struct dea_element *element = dea_solid_element(s, s->problem.own[k]);
    struct dea_solid_element_input at;
    if (element->type->constraint != NULL) {
      dea_solid_element_input(s, s->problem.own[k], s->state.u, s->state.voltage_V, &at);
      status = element->type->constraint(element, &at.in, out->b + k * most * DEA_HEX_DOFS_MAX,
                                         out->L + k * most * most);
    }
  }
  return dea_solid_allreduce(ctx, status);
}

struct dea_element_constraint dea_constraints_at(const struct dea_constraints *c, size_t k)
{
  const size_t e = c->s->problem.own[k];
  return (struct dea_element_constraint){
      .first = e * c->most,
      .count = c->most > 0 ? (size_t)dea_solid_element(c->s, e)->pressures : 0,
      .b = c->b + k * c->most * DEA_HEX_DOFS_MAX,
      .L = c->L + k * c->most * c->most};
}

void dea_constraints_push(const struct dea_constraints *c, const double *nu, double *out)
{
  const struct dea_solid_problem *p = &c->s->problem;
  memset(out, 0, p->dofs * sizeof *out);
  for (size_t k = 0; k < p->own_count; k++) {
    const struct dea_element_constraint at = dea_constraints_at(c, k);
    const int *nodes;
    const size_t dofs = 3 * (size_t)dea_solid_nodes(c->s, p->own[k], &nodes);
    for (size_t m = 0; m < at.count; m++) {
      for (size_t i = 0; i < dofs; i++) {
        out[3 * (size_t)nodes[i / 3] + i % 3] += nu[at.first + m] * at.b[m * dofs + i];
      }
    }
  }
  dea_solid_sum(out, p->dofs);
}

void dea_constraints_grow(const struct dea_constraints *c, const double *v, double *out)
{
  const struct dea_solid_problem *p = &c->s->problem;
  double own[DEA_HEX_DOFS_MAX] = {0};
  memset(out, 0, dea_solid_pressure_count(c->s) * sizeof *out);
  for (size_t k = 0; k < p->own_count; k++) {
    const struct dea_element_constraint at = dea_constraints_at(c, k);
    const size_t dofs = 3 * (size_t)dea_solid_gather(c->s, p->own[k], v, own);
    for (size_t m = 0; m < at.count; m++) {
      for (size_t i = 0; i < dofs; i++) {
        out[at.first + m] += at.b[m * dofs + i] * own[i];
      }
    }
  }
}

void dea_constraints_solve(const struct dea_constraints *c, bool transposed, double *x)
{
  for (size_t k = 0; k < c->s->problem.own_count; k++) {
    const struct dea_element_constraint at = dea_constraints_at(c, k);
    double *y = x + at.first;
    for (size_t i = 0; i < at.count; i++) {
      const size_t m = transposed ? at.count - 1 - i : i;
      for (size_t j = 0; j < i; j++) {
        const size_t n = transposed ? m + 1 + j : j;
        y[m] -= (transposed ? at.L[n * at.count + m] : at.L[m * at.count + n]) * y[n];
      }
      y[m] = at.L[0] > 0 ? y[m] / at.L[m * at.count + m] : 0;
    }
  }
}

void dea_constraints_pressures(const struct dea_constraints *c, const double *v, double *out)
{
  const size_t count = dea_solid_pressure_count(c->s);
  dea_constraints_grow(c, v, out);
  dea_constraints_solve(c, true, out); // L^T out = kappa b v
  for (size_t i = 0; i < count; i++) {
    out[i] *= DEA_SOLID_STIFF * dea_solid_bulk_modulus(c->s, i / c->most);
  }
  dea_solid_sum(out, count);
}

#include "model/solid/assembly/channels.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/matrix.h"

#include <math.h>
#include <string.h>

/* Steps for derivatives: of a field, whose square energies are linear in; of a voltage over the
 * largest one across an element, forces are quadratic in it. */
static const double field_step_V_per_m = 1e6, part_of_voltage = 5e-4;

/* ---- creation ---- */

dea_status dea_solid_channels_create(struct dea_context *ctx, struct dea_solid *s,
                                     const struct dea_solid_options *options)
{
  struct dea_solid_problem *p = &s->problem;
  size_t elements = p->grid->element_count, channels = options->channel_count;
  p->channel_count = channels > 0 ? channels : 1;
  if (options->channels != NULL && options->field == DEA_SOLID_FIELD_COUPLED) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "a coupled field has one channel");
  }
  p->between = dea_arena_alloc(&s->memory, elements, sizeof *p->between);
  p->active = dea_arena_alloc(&s->memory, elements, sizeof *p->active);
  dea_solid_alloc_doubles(
      &s->memory, p->channel_count + 1,
      (double **[]){&p->share, &s->state.own_V, &s->state.lift_V, &s->state.own_goal_V, NULL});
  DEA_TRY(ctx, dea_arena_status(&s->memory));
  for (size_t k = 1; k <= p->channel_count; k++) {
    p->share[k] = options->share != NULL ? options->share[k - 1] : 1;
  }
  for (size_t e = 0; e < elements; e++) {
    int region = p->grid->region[e], ply = p->grid->ply[e], *at = p->between[e];
    if (options->active != NULL && options->active(options->self, region, ply)) {
      at[0] = 1;
      if (options->channels != NULL) {
        options->channels(options->self, region, ply, &at[0], &at[1]);
      }
    }
    for (int i = 0; i < 2; i++) {
      if (at[i] < 0 || (size_t)at[i] > p->channel_count) {
        return dea_fail(ctx, DEA_E_ARGUMENT, "there is no channel %d: %zu of them", at[i],
                        p->channel_count);
      }
    }
    p->active[e] = at[0] != at[1];
  }
  return DEA_OK;
}

double *dea_solid_own_voltages(struct dea_solid *solid)
{
  return solid->state.own_goal_V;
}

void dea_solid_channel_voltages(const struct dea_solid *s, double *voltage_V)
{
  for (size_t k = 0; k <= s->problem.channel_count; k++) {
    voltage_V[k] =
        s->problem.share[k] * s->state.voltage_V + s->state.own_V[k] + s->state.lift_V[k];
  }
}

/* ---- charge ---- */

/* Twice the derivative of the energy by the square of the voltage. */
dea_status dea_solid_element_capacitance(struct dea_solid *s, size_t e, const double *u,
                                         double *capacitance_F)
{
  const struct dea_element *element = dea_solid_element(s, e);
  struct dea_solid_element_input at;
  dea_solid_element_input(s, e, u, s->state.voltage_V, &at);
  double step = field_step_V_per_m * at.part_material.thickness_m, square = at.in.voltage_V;
  square *= square;
  const double squares[2] = {fmax(square - step * step, 0), square + step * step};
  double energy[2] = {0, 0};
  for (int i = 0; i < 2; i++) {
    at.in.voltage_V = sqrt(squares[i]);
    DEA_TRY_STATUS(element->type->evaluate(element, &at.in, DEA_ENERGY, s->work.element));
    energy[i] = s->work.element->energy_J;
  }
  *capacitance_F = 2 * (energy[0] - energy[1]) / (squares[1] - squares[0]);
  return DEA_OK;
}

static dea_status refuse_coupled(struct dea_context *ctx, const struct dea_solid *s)
{
  return s->problem.field == NULL ? DEA_OK
                                  : dea_fail(ctx, DEA_E_UNSUPPORTED,
                                             "charges by channel need the field V/h, not a coupled "
                                             "one");
}

/* What is summed over elements; NULL: not that. */
struct sums {
  double *charge_C;      // [channels]
  double *capacitance_F; // [channels][channels]
  const double *per_s;   // [part materials] conductance over capacitance
  double *conductance_S;
  double *leak_A; // [channels], and behind them the power that this takes
};

/* Adds what lies between two channels to a matrix [count][count] of theirs. */
static void add_between(double value, size_t top, size_t bottom, size_t count, double *matrix)
{
  matrix[top * count + top] += value;
  matrix[bottom * count + bottom] += value;
  matrix[top * count + bottom] -= value;
  matrix[bottom * count + top] -= value;
}

static void add_element(const struct dea_solid *s, size_t e, double C, const struct sums *sums)
{
  const struct dea_solid_problem *p = &s->problem;
  size_t count = p->channel_count + 1;
  size_t top = (size_t)p->between[e][0], bottom = (size_t)p->between[e][1];
  double V = dea_solid_voltage_across(s, e, s->state.voltage_V);
  double charge = C * V * (s->state.evenness != NULL ? s->state.evenness[e] : 1);
  double per_s = sums->per_s != NULL ? sums->per_s[p->part_material_of[e]] : 0;
  if (sums->charge_C != NULL) {
    sums->charge_C[top] += charge;
    sums->charge_C[bottom] -= charge;
  }
  if (sums->capacitance_F != NULL) {
    add_between(C, top, bottom, count, sums->capacitance_F);
  }
  if (sums->conductance_S != NULL) {
    double share = p->share[top] - p->share[bottom];
    *sums->conductance_S += share * share * per_s * C;
  }
  if (sums->leak_A != NULL) {
    sums->leak_A[top] += per_s * charge;
    sums->leak_A[bottom] -= per_s * charge;
    sums->leak_A[count] += per_s * C * V * V;
  }
}

/* Adds those of this rank's elements. */
static dea_status add_own(struct dea_solid *s, const struct sums *sums)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t i = 0; i < p->own_count; i++) {
    size_t e = p->own[i];
    double C;
    if (!p->active[e]) {
      continue;
    }
    DEA_TRY_STATUS(dea_solid_element_capacitance(s, e, s->state.u, &C));
    add_element(s, e, C, sums);
  }
  return DEA_OK;
}

dea_status dea_solid_conductance(struct dea_context *ctx, struct dea_solid *s, const double *per_s,
                                 double *conductance_S)
{
  *conductance_S = 0;
  DEA_TRY(ctx, refuse_coupled(ctx, s));
  const struct sums sums = {.per_s = per_s, .conductance_S = conductance_S};
  DEA_TRY(ctx, dea_solid_allreduce(ctx, add_own(s, &sums)));
  dea_solid_sum(conductance_S, 1);
  return DEA_OK;
}

dea_status dea_solid_flows(struct dea_context *ctx, struct dea_solid *s, const double *per_s,
                           double *charge_C, double *leak_A)
{
  size_t count = s->problem.channel_count + 1;
  const struct sums sums = {.charge_C = charge_C, .per_s = per_s, .leak_A = leak_A};
  memset(charge_C, 0, count * sizeof *charge_C);
  if (leak_A != NULL) {
    memset(leak_A, 0, (count + 1) * sizeof *leak_A);
  }
  DEA_TRY(ctx, refuse_coupled(ctx, s));
  DEA_TRY(ctx, dea_solid_allreduce(ctx, add_own(s, &sums)));
  dea_solid_sum(charge_C, count);
  dea_solid_sum(leak_A, leak_A != NULL ? count + 1 : 0);
  return DEA_OK;
}

/* ---- how it follows the voltages ---- */

static double largest_voltage(const struct dea_solid *s)
{
  double most = 0;
  for (size_t e = 0; e < s->problem.grid->element_count; e++) {
    most = fmax(most, fabs(dea_solid_voltage_across(s, e, s->state.voltage_V)));
  }
  return most;
}

/* -dg/dV; g is quadratic in all voltages, so that its derivative is 0 where they are. */
dea_status dea_solid_voltage_force(struct dea_context *ctx, struct dea_solid *s, size_t channel,
                                   double *force)
{
  double energy, step_V = part_of_voltage * largest_voltage(s), there = s->state.own_V[channel];
  dea_status status = DEA_OK;
  memset(force, 0, s->problem.dofs * sizeof *force);
  for (int side = -1; side <= 1 && step_V > 0 && status == DEA_OK; side += 2) {
    double whole_V = s->state.voltage_V + (channel == 0 ? side * step_V : 0);
    s->state.own_V[channel] = there + (channel > 0 ? side * step_V : 0);
    status = dea_solid_assemble(ctx, s, whole_V, DEA_FORCE, &energy);
    for (size_t i = 0; i < s->problem.dofs; i++) {
      force[i] -= side * s->work.g[i] / (2 * step_V);
    }
  }
  s->state.own_V[channel] = there;
  DEA_TRY(ctx, status);
  return DEA_CHAIN(ctx, dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_FORCE, &energy));
}

/* Factorises the tangent at the equilibrium, of the solid as good as incompressible. */
static dea_status factorise_stable(struct dea_context *ctx, struct dea_solid *s)
{
  int negative;
  DEA_TRY(ctx, dea_solid_factor_stiff(ctx, s, &negative));
  if (negative > 0) {
    return dea_fail(ctx, DEA_E_NO_EQUILIBRIUM,
                    "how charges follow the voltages of a film that moves has no answer at an "
                    "unstable equilibrium (%d modes)",
                    negative);
  }
  return DEA_OK;
}

/* Adds what the film takes up by moving. forces: [channel_count][dofs]. */
static dea_status add_motion(struct dea_context *ctx, struct dea_solid *s, double *forces,
                             double *capacitance_F)
{
  const struct dea_solid_problem *p = &s->problem;
  size_t count = p->channel_count + 1;
  for (size_t k = 1; k < count; k++) {
    DEA_TRY(ctx, dea_solid_voltage_force(ctx, s, k, forces + (k - 1) * p->dofs));
  }
  DEA_TRY(ctx, factorise_stable(ctx, s));
  for (size_t l = 1; l < count; l++) {
    DEA_TRY(ctx, dea_solid_solve_linear(ctx, s, forces + (l - 1) * p->dofs, s->work.step));
    for (size_t k = 1; k < count; k++) {
      double moved = dea_solid_dot(s, forces + (k - 1) * p->dofs, s->work.step);
      capacitance_F[k * count + l] += moved;
      capacitance_F[k * count] -= moved; // ground takes what is over
      capacitance_F[l] -= moved;
      capacitance_F[0] += moved;
    }
  }
  return DEA_OK;
}

dea_status dea_solid_capacitances(struct dea_context *ctx, struct dea_solid *s, bool held,
                                  double *capacitance_F)
{
  size_t count = s->problem.channel_count + 1;
  memset(capacitance_F, 0, count * count * sizeof *capacitance_F);
  DEA_TRY(ctx, refuse_coupled(ctx, s));
  DEA_TRY(ctx,
          dea_solid_allreduce(ctx, add_own(s, &(struct sums){.capacitance_F = capacitance_F})));
  dea_solid_sum(capacitance_F, count * count);
  if (held) {
    return DEA_OK;
  }
  double *forces = dea_solid_alloc(ctx, s->problem.channel_count * s->problem.dofs, sizeof *forces);
  dea_status status = forces != NULL ? DEA_OK : DEA_E_MEMORY;
  status = status == DEA_OK ? add_motion(ctx, s, forces, capacitance_F) : status;
  dea_free(ctx, forces);
  return DEA_CHAIN(ctx, status);
}

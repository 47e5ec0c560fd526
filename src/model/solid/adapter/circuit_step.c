#include "model/solid/adapter/circuit_step.h"

#include "model/solid/assembly/channels.h"
#include "model/solid/assembly/film.h"
#include "model/solid/assembly/problem.h"

#include <math.h>

enum { VOLTAGES_MAX = 12 };
static const double voltage_close = 1e-8;   // of the largest voltage
static const double smallest_motion = 1e-2; // of the thickness: errors are not relative to less

/* What a step gives that the accounts do not hold, and whether another one was tried before it from
 * the same state. */
struct leap {
  bool tried;
  double step_s, lost_J;
};

struct dea_circuit_step {
  struct dea_driven_solid driven;
  struct dea_solid_time *time;
  struct dea_time_options options;
  bool leaks_evenly;    // all films have the next
  double leakage_per_s; // conductance over capacitance
  double time_s, time_next_s;
  struct leap leap;
  double lost_J, lost_next_J; // in leaps from one equilibrium to another
  struct dea_circuit_state circuit, circuit_next;
  double step_s, voltage_before_V, step_before_s; // of the step that is tried; before the last one
  double largest_m, largest_V, largest_J;         // so far
};

static double largest_motion(const struct dea_circuit_step *d)
{
  return fmax(d->largest_m, dea_solid_time_motion(d->time));
}

static dea_status find_film(struct dea_context *ctx, const struct dea_circuit_step *d,
                            struct dea_circuit_film *out)
{
  double capacitance_F = 0, conductance_S = 0, copies = d->driven.copies;
  DEA_TRY(ctx, dea_solid_capacitance(ctx, d->driven.solid, &capacitance_F));
  *out = (struct dea_circuit_film){.capacitance_F = copies * capacitance_F};
  if (d->leaks_evenly) {
    out->conductance_S = d->leakage_per_s * out->capacitance_F;
    return DEA_OK;
  }
  DEA_TRY(ctx,
          dea_solid_conductance(ctx, d->driven.solid, d->driven.leakage_per_s, &conductance_S));
  out->conductance_S = copies * conductance_S;
  return DEA_OK;
}

double dea_leakage_per_s(const struct dea_material *material,
                         const struct dea_constituent *constituent)
{
  double rho = material->resistivity_ohm_m;
  return rho > 0 ? 1 / (rho * constituent->permittivity_F_per_m) : 0; // as it is pre-stretched
}

static void find_leakage(struct dea_circuit_step *d)
{
  const struct dea_solid_problem *p = &d->driven.solid->problem;
  bool any = false;
  d->leaks_evenly = true;
  for (size_t i = 0; i < p->constituent_count; i++) {
    double per_s = d->driven.leakage_per_s[i];
    if (p->constituents[i].permittivity_F_per_m > 0) {
      d->leaks_evenly = d->leaks_evenly && (!any || per_s == d->leakage_per_s);
      d->leakage_per_s = per_s;
      any = true;
    }
  }
}

static dea_status prepare(struct dea_context *ctx, struct dea_circuit_step *d)
{
  struct dea_solid *solid = d->driven.solid;
  double voltage_V = dea_solid_voltage(solid);
  const struct dea_solid_time_options options = {.branches = d->driven.branches,
                                                 .inertia = d->options.inertia,
                                                 .spectral_radius = d->options.rho_inf};
  struct dea_circuit_film film = {.capacitance_F = 0};
  if (dea_solid_has_own_voltages(solid)) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "a history in time is of channels that share the supply's voltage: none may "
                    "have one of its own (channels[].voltage)");
  }
  find_leakage(d);
  DEA_TRY(ctx, dea_solid_time_create(ctx, solid, &options, &d->time));
  DEA_TRY(ctx, find_film(ctx, d, &film));
  d->circuit = (struct dea_circuit_state){.source_voltage_V = voltage_V,
                                          .voltage_V = voltage_V,
                                          .charge_C = film.capacitance_F * voltage_V,
                                          .current_A = film.conductance_S * voltage_V,
                                          .capacitance_F = film.capacitance_F,
                                          .conductance_S = film.conductance_S};
  d->circuit_next = d->circuit;
  d->largest_m = smallest_motion * d->driven.thickness_m;
  d->largest_V = fabs(voltage_V);
  return DEA_OK;
}

dea_status dea_circuit_step_create(struct dea_context *ctx, const struct dea_driven_solid *driven,
                                   const struct dea_time_options *time,
                                   struct dea_circuit_step **out)
{
  struct dea_circuit_step *d = dea_solid_alloc(ctx, 1, sizeof *d);
  *out = NULL;
  if (d == NULL) {
    return DEA_E_MEMORY;
  }
  d->driven = *driven;
  d->options = *time;
  dea_status status = prepare(ctx, d);
  if (status != DEA_OK) {
    dea_circuit_step_destroy(ctx, d);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = d;
  return DEA_OK;
}

void dea_circuit_step_destroy(struct dea_context *ctx, struct dea_circuit_step *d)
{
  if (d != NULL) {
    dea_solid_time_destroy(ctx, d->time);
    dea_free(ctx, d);
  }
}

/* The step at the voltage that the circuit has with the film as it then is: fixed points and, from
 * the second on, secants of the difference. */
static dea_status find_step(struct dea_context *ctx, struct dea_circuit_step *d,
                            const struct dea_time_step *step, struct dea_circuit_film *film,
                            struct dea_solid_report *report)
{
  const struct dea_circuit *circuit = &d->options.circuit;
  double slope, before = 0, off_before = 0;
  *film = (struct dea_circuit_film){.capacitance_F = d->circuit.capacitance_F,
                                    .conductance_S = d->circuit.conductance_S};
  double V = dea_circuit_voltage(circuit, &d->circuit, step, film, &slope);
  for (int i = 0; i < VOLTAGES_MAX; i++) {
    dea_status status = i > 0 ? dea_solid_time_again(ctx, d->time, V, report)
                        : step->length_s > 0
                            ? dea_solid_time_step(ctx, d->time, V, step->length_s, report)
                            : dea_solid_time_jump(ctx, d->time, V, report);
    DEA_TRY(ctx, status);
    DEA_TRY(ctx, find_film(ctx, d, film));
    double off = dea_circuit_voltage(circuit, &d->circuit, step, film, &slope) - V;
    if (fabs(off) <= voltage_close * fmax(d->largest_V, fabs(V))) {
      return DEA_OK;
    }
    double secant = i > 0 ? (off - off_before) / (V - before) : -1;
    before = V;
    off_before = off;
    V += secant < 0 ? -off / secant : off;
  }
  dea_solid_time_reject(d->time);
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "film and circuit find no common voltage");
}

/* Of the voltage: what it costs to take it as straight. Without resistance it follows from the
 * charge that the supply can give, whatever the step. */
static double voltage_error(const struct dea_circuit_step *d, double h)
{
  double before = d->step_before_s, from = d->circuit.voltage_V;
  if (!(d->options.circuit.series_resistance_ohm > 0) || !(before > 0)) {
    return 0;
  }
  double drawn = h / before * (from - d->voltage_before_V);
  return 0.25 * h / (h + before) * fabs(d->circuit_next.voltage_V - from - drawn);
}

/* The circuit's account of a step takes the voltage's mean for the charge; the film's work is known
 * better. */
static void refine_work(struct dea_circuit_step *d)
{
  const struct dea_circuit_state *from = &d->circuit;
  struct dea_circuit_state *to = &d->circuit_next;
  const double voltage_V[2] = {from->voltage_V, to->voltage_V};
  const double capacitance_F[2] = {from->capacitance_F, to->capacitance_F};
  to->supply_work_J += dea_solid_source_work(voltage_V, capacitance_F) -
                       0.5 * (voltage_V[0] + voltage_V[1]) * (to->charge_C - from->charge_C);
}

/* Work of the supply in the step that became nothing of what is counted. */
static double unaccounted(const struct dea_circuit_step *d, const struct dea_solid_energies *from,
                          const struct dea_solid_energies *to)
{
  const struct dea_circuit_state *a = &d->circuit, *b = &d->circuit_next;
  double film = to->stored + to->branches + to->kinetic + to->dissipated + to->damped -
                (from->stored + from->branches + from->kinetic + from->dissipated + from->damped);
  return b->supply_work_J - a->supply_work_J - d->driven.copies * film -
         (b->resistance_loss_J - a->resistance_loss_J) - (b->leakage_loss_J - a->leakage_loss_J);
}

/* Whether the film has leapt to another equilibrium, which no shorter step divides: seen on the
 * way, or since the accounts of a step a third as long miss about as much. */
static bool has_leapt(const struct dea_circuit_step *d, double lost_J,
                      const struct dea_solid_report *report)
{
  return !d->options.inertia &&
         (report->snapped || (d->leap.tried && d->step_s < 0.35 * d->leap.step_s &&
                              lost_J > 0.5 * d->leap.lost_J && d->leap.lost_J > 0));
}

/* The largest of the errors of displacement, voltage and account of energy, each over what was
 * largest so far. */
static double find_error(struct dea_circuit_step *d, double error_m, double lost_J,
                         const struct dea_solid_report *report)
{
  double voltage_V = fmax(d->largest_V, fabs(d->circuit_next.voltage_V));
  double energy_J = fmax(d->largest_J, fabs(d->circuit_next.supply_work_J));
  double error = error_m / largest_motion(d);
  if (voltage_V > 0) {
    error = fmax(error, voltage_error(d, d->step_s) / voltage_V);
  }
  d->lost_next_J = d->lost_J;
  if (has_leapt(d, lost_J, report)) {
    d->lost_next_J += lost_J;
  } else if (energy_J > 0) {
    error = fmax(error, fabs(lost_J) / energy_J);
  }
  if (!d->leap.tried || d->step_s < 0.35 * d->leap.step_s) {
    d->leap = (struct leap){true, d->step_s, lost_J};
  }
  return error;
}

dea_status dea_circuit_step_advance(struct dea_context *ctx, struct dea_circuit_step *d,
                                    const struct dea_time_step *step,
                                    struct dea_solid_report *report, double *error)
{
  struct dea_circuit_film film = {.capacitance_F = 0};
  double error_m;
  struct dea_solid_energies from = dea_solid_time_energies(d->time, false);
  DEA_TRY(ctx, find_step(ctx, d, step, &film, report));
  DEA_TRY(ctx, dea_solid_time_close(ctx, d->time, &error_m));
  struct dea_solid_energies to = dea_solid_time_energies(d->time, true);
  dea_circuit_advance(&d->options.circuit, &d->circuit, step, &film, &d->circuit_next);
  d->step_s = step->length_s;
  if (d->step_s > 0) {
    refine_work(d);
  }
  d->time_next_s = d->time_s + d->step_s;
  if (d->step_s > 0) {
    *error = find_error(d, error_m, unaccounted(d, &from, &to), report);
    return DEA_OK;
  }
  if (dea_circuit_is_ideal(&d->options.circuit)) {
    d->circuit_next.supply_work_J +=
        d->driven.copies * (to.stored + to.branches - from.stored - from.branches);
  }
  d->lost_next_J = d->lost_J;
  *error = 0;
  return DEA_OK;
}

void dea_circuit_step_accept(struct dea_circuit_step *d)
{
  d->largest_m = largest_motion(d);
  dea_solid_time_accept(d->time);
  d->step_before_s = d->step_s;
  d->voltage_before_V = d->circuit.voltage_V;
  d->circuit = d->circuit_next;
  d->largest_V = fmax(d->largest_V, fabs(d->circuit.voltage_V));
  d->largest_J = fmax(d->largest_J, fabs(d->circuit.supply_work_J));
  d->time_s = d->time_next_s;
  d->lost_J = d->lost_next_J;
  d->leap.tried = false;
}

void dea_circuit_step_point(const struct dea_circuit_step *d, struct dea_load_point *point)
{
  const struct dea_circuit_state *circuit = &d->circuit_next;
  const struct dea_solid_energies e = dea_solid_time_energies(d->time, true);
  double copies = d->driven.copies;
  point->time_s = d->time_next_s;
  point->source_voltage_V = circuit->source_voltage_V;
  point->voltage_V = circuit->voltage_V;
  point->charge_C = circuit->charge_C;
  point->current_A = circuit->current_A;
  point->stored_energy_J = copies * (e.stored + e.branches);
  point->kinetic_energy_J = copies * e.kinetic;
  point->dissipated_J =
      copies * e.dissipated + circuit->resistance_loss_J + circuit->leakage_loss_J;
  point->damped_J = copies * e.damped + d->lost_next_J;
  point->supply_work_J = circuit->supply_work_J;
}

/* A solid between electrodes in time: its steps together with those of the supply's circuit
 * (docs/theory/time.md). The voltage of a step is that of the circuit for the capacitance which the
 * film then has. Where channels have sources of their own all sources are ideal, and their voltages
 * those of the step. */
#include "base/arena.h"
#include "model/solid/assembly/channels.h"
#include "model/solid/assembly/charge_control.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/equilibrium/newton.h"
#include "model/solid/model3d/sheet.h"
#include "model/solid/model3d/solid_model.h"
#include "model/solid/motion/time.h"

#include <math.h>
#include <string.h>

enum { VOLTAGES_MAX = 12, SHEET_MAX = 30 };
static const double voltage_close = 1e-8;   // of the largest voltage
static const double sheet_close = 1e-6;     // the same
static const double smallest_motion = 1e-2; // of the thickness: errors are not relative to less

/* What a step gives that the accounts do not hold, and whether another one was tried before it from
 * the same state. */
struct branch_jump {
  bool tried;
  double step_s, lost_J;
};

/* Of all channels of the grid. */
struct network {
  double *voltage_V, *charge_C; // [channels]
  double *leak_A;               // [channels], and behind them the power that this takes
};

struct dea_circuit_step {
  struct dea_arena memory; // of the next four lines
  struct network network, network_next;
  double *own_V, *own_start_V; // [channels] beside their shares
  double *current_A;           // [channels] of the last step, with all copies
  bool *own_source;            // [channels] of options
  bool own;                    // any channel has a voltage of its own
  const struct dea_model *model;
  bool coupled;            // the field: currents of channels are not found
  struct dea_sheet *sheet; // NULL: all electrodes are at the voltage of their channel
  struct dea_solid_time *time;
  struct dea_time_options options;
  bool no_charge;       // of films whose charge cannot be held: its voltage is looked for
  bool leaks_evenly;    // all films have the next
  double leakage_per_s; // conductance over capacitance
  double time_s, time_next_s;
  struct branch_jump branch_jump;
  double lost_J, lost_next_J; // in jumps from one equilibrium to another
  struct dea_circuit_state circuit, circuit_next;
  double step_s, voltage_before_V, step_before_s; // of the step that is tried; before the last one
  double largest_m, largest_V, largest_J;         // so far
  double charged_J;                               // charges times voltages after the last step
};

static double largest_motion(const struct dea_circuit_step *d)
{
  return fmax(d->largest_m, dea_solid_time_motion(d->time));
}

static dea_status find_film(struct dea_context *ctx, const struct dea_circuit_step *d,
                            struct dea_circuit_film *out)
{
  double capacitance_F = 0, conductance_S = 0, copies = d->model->copies;
  DEA_TRY(ctx, dea_solid_capacitance(ctx, d->model->solid, false, &capacitance_F));
  *out = (struct dea_circuit_film){.capacitance_F = copies * capacitance_F};
  if (d->leaks_evenly) {
    out->conductance_S = d->leakage_per_s * out->capacitance_F;
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_solid_conductance(ctx, d->model->solid, d->model->plies.leakage_per_s,
                                     &conductance_S));
  out->conductance_S = copies * conductance_S;
  return DEA_OK;
}

static void find_leakage(struct dea_circuit_step *d)
{
  const struct dea_solid_problem *p = &d->model->solid->problem;
  bool any = false;
  d->leaks_evenly = true;
  for (size_t i = 0; i < p->part_material_count; i++) {
    double per_s = d->model->plies.leakage_per_s[i];
    if (p->part_materials[i].permittivity_F_per_m > 0) {
      d->leaks_evenly = d->leaks_evenly && (!any || per_s == d->leakage_per_s);
      d->leakage_per_s = per_s;
      any = true;
    }
  }
}

// Channels ---------------------------------------------------------------------------------------

static size_t channel_count(const struct dea_circuit_step *d)
{
  return d->model->solid->problem.channel_count + 1;
}

static bool any_of(const bool *flags, size_t count)
{
  bool any = false;
  for (size_t k = 0; k < count && flags != NULL; k++) {
    any = any || flags[k];
  }
  return any;
}

static dea_status allocate_network(struct dea_circuit_step *d)
{
  size_t count = channel_count(d);
  struct network *const networks[] = {&d->network, &d->network_next};
  for (size_t i = 0; i < 2; i++) {
    networks[i]->voltage_V = dea_arena_alloc(&d->memory, count, sizeof(double));
    networks[i]->charge_C = dea_arena_alloc(&d->memory, count, sizeof(double));
    networks[i]->leak_A = dea_arena_alloc(&d->memory, count + 1, sizeof(double));
  }
  d->own_V = dea_arena_alloc(&d->memory, count, sizeof *d->own_V);
  d->own_start_V = dea_arena_alloc(&d->memory, count, sizeof *d->own_start_V);
  d->current_A = dea_arena_alloc(&d->memory, count, sizeof *d->current_A);
  d->own_source = dea_arena_alloc(&d->memory, count, sizeof *d->own_source);
  return dea_arena_status(&d->memory);
}

/* As it is now. */
static dea_status find_network(struct dea_context *ctx, struct dea_circuit_step *d,
                               struct network *out)
{
  dea_solid_channel_voltages(d->model->solid, out->voltage_V);
  return dea_solid_flows(ctx, d->model->solid, d->model->plies.leakage_per_s, out->charge_C,
                         out->leak_A);
}

/* Charge that leaves a channel through the films in a step between the two networks. */
static double leaked_C(const struct dea_circuit_step *d, size_t channel)
{
  return 0.5 * d->step_s * (d->network.leak_A[channel] + d->network_next.leak_A[channel]);
}

/* What its source gives a channel in that step. */
static double given_C(const struct dea_circuit_step *d, size_t channel)
{
  return d->network_next.charge_C[channel] - d->network.charge_C[channel] + leaked_C(d, channel);
}

/* Mean currents of the step between the two networks. */
static void find_currents(struct dea_circuit_step *d)
{
  for (size_t k = 0; k < channel_count(d); k++) {
    d->current_A[k] = d->step_s > 0 ? d->model->copies * given_C(d, k) / d->step_s : 0;
  }
}

/* Of the supply that channels without a source of their own share. */
static double supply_share(const struct dea_circuit_step *d, size_t channel)
{
  return d->own_source[channel] ? 0 : d->model->solid->problem.share[channel];
}

static double supply_charge_C(const struct dea_circuit_step *d, const struct network *at)
{
  double sum = 0;
  for (size_t k = 0; k < channel_count(d); k++) {
    sum += supply_share(d, k) * at->charge_C[k];
  }
  return d->model->copies * sum;
}

/* The step's account with an ideal source on each channel; charge and current of the state are
 * those of the supply that the others share. film_J: what the film took up of the grid's sources.
 * It gets all that they give but for leaks, unless electrodes have a resistance. */
static void advance_network(struct dea_circuit_step *d, const struct dea_time_step *step,
                            double film_J)
{
  const struct network *from = &d->network, *to = &d->network_next;
  struct dea_circuit_state *next = &d->circuit_next;
  const size_t count = channel_count(d);
  double copies = d->model->copies, h = step->length_s, given_J = 0, leaked_J = 0;
  *next = d->circuit;
  next->source_voltage_V = next->voltage_V = step->source_voltage_V;
  next->charge_C = supply_charge_C(d, to);
  next->current_A = 0;
  for (size_t k = 0; k < count; k++) {
    const double V = 0.5 * (from->voltage_V[k] + to->voltage_V[k]);
    next->current_A += supply_share(d, k) * d->current_A[k];
    given_J += V * given_C(d, k);
    leaked_J += V * leaked_C(d, k);
  }
  const double leak_J = 0.5 * h * (from->leak_A[count] + to->leak_A[count]);
  next->leakage_loss_J += copies * leak_J;
  if (h > 0) {
    given_J = d->sheet != NULL ? given_J : film_J + leaked_J;
    next->supply_work_J += copies * given_J;
    next->resistance_loss_J += d->sheet != NULL ? copies * (given_J - film_J - leak_J) : 0;
  }
}

/* Where the channels go in a step: those with a source of their own to its voltage. */
static void drive_channels(struct dea_circuit_step *d, const struct dea_time_step *step)
{
  for (size_t k = 1; d->own && k < channel_count(d); k++) {
    double share_V = d->model->solid->problem.share[k] * step->source_voltage_V;
    d->own_V[k] = d->own_source[k] ? step->own_V[k] - share_V : d->own_start_V[k];
  }
  if (d->own) {
    dea_solid_time_drive(d->time, d->own_V);
  }
}

// Creation ---------------------------------------------------------------------------------------

static dea_status prepare(struct dea_context *ctx, struct dea_circuit_step *d)
{
  struct dea_solid *solid = d->model->solid;
  double voltage_V = dea_solid_voltage(solid);
  size_t count = channel_count(d);
  bool own_sources = any_of(d->options.own_sources, count);
  DEA_TRY(ctx,
          dea_sheet_create(ctx, &d->model->mesh, solid, d->model->plies.leakage_per_s, &d->sheet));
  d->own = own_sources || dea_solid_has_own_voltages(solid) || d->sheet != NULL;
  const struct dea_solid_time_options options = {.branches = d->model->plies.branches,
                                                 .inertia = d->options.inertia,
                                                 .spectral_radius = d->options.rho_inf,
                                                 .own_voltages = d->own};
  struct dea_circuit_film film = {.capacitance_F = 0};
  if (d->own && !dea_circuit_is_ideal(&d->options.circuit)) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "%s ideal sources: no series resistance and no limit of the current is known "
                    "of them",
                    d->sheet != NULL ? "electrodes with a sheet resistance have"
                                     : "channels with a voltage or a waveform of their own have");
  }
  find_leakage(d);
  DEA_TRY(ctx, dea_solid_time_create(ctx, solid, &options, &d->time));
  DEA_TRY(ctx, dea_solid_allreduce(ctx, allocate_network(d)));
  memcpy(d->own_start_V, solid->state.own_V, count * sizeof *d->own_V);
  if (own_sources) {
    memcpy(d->own_source, d->options.own_sources, count * sizeof *d->own_source);
  }
  DEA_TRY(ctx, d->coupled && !d->own ? DEA_OK : find_network(ctx, d, &d->network));
  DEA_TRY(ctx, find_film(ctx, d, &film));
  d->circuit = (struct dea_circuit_state){.source_voltage_V = voltage_V,
                                          .voltage_V = voltage_V,
                                          .charge_C = film.capacitance_F * voltage_V,
                                          .current_A = film.conductance_S * voltage_V,
                                          .capacitance_F = film.capacitance_F,
                                          .conductance_S = film.conductance_S};
  if (d->own) {
    d->circuit.charge_C = supply_charge_C(d, &d->network);
    d->circuit.current_A = 0; // a mean of no step
  }
  d->circuit_next = d->circuit;
  d->charged_J = d->own ? d->model->copies * dea_solid_time_charged_J(d->time, false)
                        : d->circuit.charge_C * voltage_V;
  d->largest_m = smallest_motion * d->model->layout->plies[d->model->plies.film].thickness_m;
  d->largest_V = fabs(voltage_V);
  return DEA_OK;
}

dea_status dea_circuit_step_create(struct dea_context *ctx, const struct dea_model *model,
                                   const struct dea_time_options *time,
                                   struct dea_circuit_step **out)
{
  struct dea_circuit_step *d = dea_solid_alloc(ctx, 1, sizeof *d);
  *out = NULL;
  DEA_TRY_MEMORY(d != NULL);
  d->memory.ctx = ctx;
  d->model = model;
  d->coupled = model->solid->problem.field != NULL;
  d->options = *time;
  DEA_TRY_ELSE(ctx, prepare(ctx, d), dea_circuit_step_destroy(ctx, d));
  *out = d;
  return DEA_OK;
}

void dea_circuit_step_destroy(struct dea_context *ctx, struct dea_circuit_step *d)
{
  if (d != NULL) {
    dea_solid_time_destroy(ctx, d->time);
    dea_sheet_destroy(ctx, d->sheet);
    dea_arena_free(&d->memory);
    dea_free(ctx, d);
  }
}

/* The step or jump to a voltage of the supply. */
static dea_status try_step(struct dea_context *ctx, struct dea_circuit_step *d, double voltage_V,
                           double length_s, struct dea_solid_report *report)
{
  return DEA_CHAIN(ctx, length_s > 0
                            ? dea_solid_time_step(ctx, d->time, voltage_V, length_s, report)
                            : dea_solid_time_jump(ctx, d->time, voltage_V, report));
}

/* Once the supply is disconnected. */
static dea_status prepare_charge(struct dea_context *ctx, struct dea_circuit_step *d)
{
  if (d->no_charge || d->model->solid->problem.charge != NULL) {
    return DEA_OK;
  }
  dea_solid_time_reject(d->time); // it is of a solid with a load less
  const dea_status status = dea_charge_create(ctx, d->model->solid);
  d->no_charge = status == DEA_E_UNSUPPORTED;
  if (d->no_charge) {
    dea_context_clear(ctx);
    return DEA_OK;
  }
  return status;
}

/* The step at the voltage that the circuit has with the film as it then is: fixed points and, from
 * the second on, secants of the difference. Of a supply that is disconnected the film has what
 * voltage its charge takes, which is no limit to it. */
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
    if (step->disconnected && !d->no_charge) {
      DEA_TRY(ctx,
              dea_charge_hold(ctx, d->model->solid, 0, film->capacitance_F * V / d->model->copies));
    }
    const dea_status status = i > 0 ? dea_solid_time_again(ctx, d->time, V, report)
                                    : try_step(ctx, d, V, step->length_s, report);
    dea_charge_release(d->model->solid);
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

/* The step with potentials of electrodes that have a sheet resistance and the capacitances that the
 * film has with them: fixed points. */
static dea_status find_sheet_step(struct dea_context *ctx, struct dea_circuit_step *d,
                                  const struct dea_time_step *step, struct dea_solid_report *report)
{
  double change_V;
  if (step->disconnected) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "electrodes with a sheet resistance have ideal sources, always connected");
  }
  for (int i = 0; i < SHEET_MAX; i++) {
    DEA_TRY(ctx, dea_sheet_solve(ctx, d->sheet, i == 0, step->length_s, step->source_voltage_V,
                                 d->own_V, &change_V));
    if (i > 0 && change_V <= sheet_close * fmax(d->largest_V, fabs(step->source_voltage_V))) {
      return DEA_OK;
    }
    DEA_TRY(ctx, i > 0 ? dea_solid_time_again(ctx, d->time, step->source_voltage_V, report)
                       : try_step(ctx, d, step->source_voltage_V, step->length_s, report));
  }
  dea_solid_time_reject(d->time);
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "film and electrodes find no common potentials");
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

/* Work of the supply and of what moves in the step that became nothing of what is counted. */
static double unaccounted(const struct dea_circuit_step *d, const struct dea_solid_energies *from,
                          const struct dea_solid_energies *to)
{
  const struct dea_circuit_state *a = &d->circuit, *b = &d->circuit_next;
  double film = to->stored + to->branches + to->kinetic + to->dissipated + to->damped -
                (from->stored + from->branches + from->kinetic + from->dissipated + from->damped);
  return b->supply_work_J - a->supply_work_J -
         d->model->copies * (film - to->motion + from->motion) -
         (b->resistance_loss_J - a->resistance_loss_J) - (b->leakage_loss_J - a->leakage_loss_J);
}

/* Whether the film has jumped to another equilibrium, which no shorter step divides: seen on the
 * way, or since the accounts of a step a third as long miss about as much. */
static bool has_jumped(const struct dea_circuit_step *d, double lost_J,
                       const struct dea_solid_report *report)
{
  return !d->options.inertia &&
         (report->snapped || (d->branch_jump.tried && d->step_s < 0.35 * d->branch_jump.step_s &&
                              lost_J > 0.5 * d->branch_jump.lost_J && d->branch_jump.lost_J > 0));
}

/* Largest work of the supply or of what moves supports and bodies so far. */
static double largest_work(const struct dea_circuit_step *d)
{
  double motion_J = d->model->copies * dea_solid_time_energies(d->time, true).motion;
  return fmax(d->largest_J, fmax(fabs(d->circuit_next.supply_work_J), fabs(motion_J)));
}

/* The largest of the errors of displacement, voltage and account of energy, each over what was
 * largest so far. */
static double find_error(struct dea_circuit_step *d, double error_m, double lost_J,
                         const struct dea_solid_report *report)
{
  double voltage_V = fmax(d->largest_V, fabs(d->circuit_next.voltage_V));
  double energy_J = largest_work(d);
  double error = error_m / largest_motion(d);
  if (voltage_V > 0) {
    error = fmax(error, voltage_error(d, d->step_s) / voltage_V);
  }
  error = d->sheet != NULL ? fmax(error, dea_sheet_error(d->sheet)) : error;
  d->lost_next_J = d->lost_J;
  if (has_jumped(d, lost_J, report)) {
    d->lost_next_J += lost_J;
  } else if (energy_J > 0 && dea_solid_resolved(d->model->solid, lost_J / d->model->copies)) {
    error = fmax(error, fabs(lost_J) / energy_J);
  }
  if (!d->branch_jump.tried || d->step_s < 0.35 * d->branch_jump.step_s) {
    d->branch_jump = (struct branch_jump){true, d->step_s, lost_J};
  }
  return error;
}

/* Charges, currents and works of the step that was closed; where they cannot be found the step is
 * dropped. */
static dea_status close_circuit(struct dea_context *ctx, struct dea_circuit_step *d,
                                const struct dea_time_step *step,
                                const struct dea_circuit_film *film)
{
  if (!d->coupled) {
    DEA_TRY_ELSE(ctx, find_network(ctx, d, &d->network_next), dea_solid_time_reject(d->time));
    find_currents(d);
  }
  const double film_J = dea_solid_time_energies(d->time, true).supply -
                        dea_solid_time_energies(d->time, false).supply;
  if (d->own) {
    advance_network(d, step, film_J);
    d->charged_J = d->model->copies * dea_solid_time_charged_J(d->time, true);
    return DEA_OK;
  }
  dea_circuit_advance(&d->options.circuit, &d->circuit, step, film, &d->circuit_next);
  struct dea_circuit_state *next = &d->circuit_next;
  if (d->step_s > 0 && !step->disconnected) { // the film's work is known better than by means
    next->supply_work_J +=
        d->model->copies * film_J -
        0.5 * (d->circuit.voltage_V + next->voltage_V) * (next->charge_C - d->circuit.charge_C);
  }
  d->charged_J = next->charge_C * next->voltage_V;
  return DEA_OK;
}

dea_status dea_circuit_step_advance(struct dea_context *ctx, struct dea_circuit_step *d,
                                    const struct dea_time_step *step,
                                    struct dea_solid_report *report, double *error)
{
  struct dea_circuit_film film = {.capacitance_F = 0};
  double error_m;
  struct dea_solid_energies from = dea_solid_time_energies(d->time, false);
  if (any_of(d->own_source, channel_count(d)) && step->own_V == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a step has to say the voltages of all sources");
  }
  DEA_TRY(ctx, step->disconnected ? prepare_charge(ctx, d) : DEA_OK);
  drive_channels(d, step);
  DEA_TRY(ctx, d->sheet != NULL ? find_sheet_step(ctx, d, step, report)
               : d->own         ? try_step(ctx, d, step->source_voltage_V, step->length_s, report)
                                : find_step(ctx, d, step, &film, report));
  DEA_TRY(ctx, dea_solid_time_close(ctx, d->time, &error_m));
  struct dea_solid_energies to = dea_solid_time_energies(d->time, true);
  d->step_s = step->length_s;
  DEA_TRY(ctx, close_circuit(ctx, d, step, &film));
  d->time_next_s = d->time_s + d->step_s;
  if (d->step_s > 0) {
    *error = find_error(d, error_m, unaccounted(d, &from, &to), report);
    return DEA_OK;
  }
  if (dea_circuit_is_ideal(&d->options.circuit) && !step->disconnected) {
    d->circuit_next.supply_work_J +=
        d->model->copies * (to.stored + to.branches - from.stored - from.branches);
  }
  d->lost_next_J = d->lost_J;
  *error = 0;
  return DEA_OK;
}

void dea_circuit_step_accept(struct dea_circuit_step *d)
{
  d->largest_m = largest_motion(d);
  d->largest_J = largest_work(d);
  dea_solid_time_accept(d->time);
  if (d->sheet != NULL) {
    dea_sheet_accept(d->sheet);
  }
  d->step_before_s = d->step_s;
  d->voltage_before_V = d->circuit.voltage_V;
  d->circuit = d->circuit_next;
  const struct network network = d->network;
  d->network = d->network_next;
  d->network_next = network;
  d->largest_V = fmax(d->largest_V, fabs(d->circuit.voltage_V));
  d->time_s = d->time_next_s;
  d->lost_J = d->lost_next_J;
  d->branch_jump.tried = false;
}

void dea_circuit_step_point(const struct dea_circuit_step *d, struct dea_load_point *point)
{
  const struct dea_circuit_state *circuit = &d->circuit_next;
  const struct dea_solid_energies e = dea_solid_time_energies(d->time, true);
  double copies = d->model->copies;
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
  if (d->own) { // of several voltages there is no one
    point->capacitance_F = NAN;
  }
  if (d->sheet != NULL) {
    point->lowest_voltage_V = dea_sheet_lowest_V(d->sheet);
  }
}

double dea_circuit_step_charged_J(const struct dea_circuit_step *driven)
{
  return driven->charged_J;
}

const double *dea_circuit_step_currents_A(const struct dea_circuit_step *driven)
{
  return driven->coupled ? NULL : driven->current_A;
}

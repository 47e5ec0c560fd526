/* Model "reduced" behind the common interface: a device in one coordinate. */
#include "model/make.h"
#include "model/reduced/reduced.h"
#include "result/columns.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>

/* In time, of the stroke: what is wanted, and from where on the model refuses. */
static const double follows = 0.03, beyond = 0.05;

/* A moment of a history: the film, and the circuit that it hangs on. */
struct moment {
  struct dea_reduced_state film;
  struct dea_circuit_state circuit;
  // Each mode beside the coordinate at rest as it follows the drive: away from it, and its rate;
  // off_m: what that makes the coordinate off by, at most so far.
  double away[DEA_REDUCED_MODES + 1][2], off_m;
};

struct dea_model {
  const struct dea_device *device;
  struct dea_reduced_order *order;
  struct dea_time_options options;
  struct moment now, trial;               // accepted; the last point
  double largest_q, largest_V, largest_J; // so far, for errors of steps
  struct dea_arena memory;                // of what observations lend
  double (*monitor)[DEA_OBSERVED_COUNT], (*body)[DEA_OBSERVED_COUNT];
  struct dea_channel_values *channel;
  double *answers;
};

static void destroy(struct dea_context *ctx, struct dea_model *model)
{
  if (model != NULL) {
    dea_reduced_order_destroy(ctx, model->order);
    dea_arena_free(&model->memory);
    dea_free(ctx, model);
  }
}

static double mass_at(const struct dea_reduced *core, const struct dea_reduced_mode *mode, double q)
{
  return dea_reduced_polynomial(mode->mass, q - core->middle);
}

/* Of a mode in time, or of what these leave, at a state. */
static double omega_at(const struct dea_reduced_order *o, int i, const struct dea_reduced_point *at)
{
  return i < o->core.mode_count
             ? sqrt(1 / (at->by_force * mass_at(&o->core, &o->core.modes[i], at->q)))
             : 2 * DEA_PI * o->left_Hz;
}

/* In which a voltage has to rise to the highest, as a ramp, so that what follow_drive estimates is
 * within that part of the stroke: a mode is then away by the stroke over omega t/2 at most. */
static double rise_s(const struct dea_reduced_order *o, double part)
{
  struct dea_reduced_point at;
  double sum = 0;
  dea_reduced_at(&o->core, 0, o->voltage_V[1], &at);
  for (int i = 0; i <= o->core.mode_count; i++) {
    const double w = omega_at(o, i, &at);
    sum += w > 0 ? pow(2 * o->share_off[i] / w, 2) : 0;
  }
  return sqrt(sum) / part;
}

/* What the model is of and how far it goes. */
static dea_status report(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_reduced_order *o = model->order;
  char name[120], fastest[120] = "";
  dea_reduced_order_name(o, model->device, name, sizeof name);
  if (o->core.mode_count > 0) {
    snprintf(fastest, sizeof fastest,
             "; with inertia within %.2g %% where the voltage takes %.2g ms or more to rise",
             100 * follows, 1e3 * rise_s(o, follows));
  }
  return DEA_CHAIN(
      ctx,
      dea_finding_add(
          ctx, DEA_NOTE, (struct dea_location){0},
          "model reduced: %s up to %.4g kV, made from model 3d in %.3g s; off by %.2g %% "
          "of the stroke and %.2g %% of the charge at samples that were left out of the "
          "fit%s",
          name, 1e-3 * o->voltage_V[1], o->made_s, 100 * o->error, 100 * o->charge_error, fastest));
}

static dea_status prepare(struct dea_context *ctx, const struct dea_device *device,
                          const struct dea_model_settings *settings, struct dea_model *model)
{
  const struct dea_layout *l = device->layout;
  model->device = device;
  model->memory.ctx = ctx;
  if (settings->reduced.file != NULL) {
    DEA_TRY(ctx,
            dea_reduced_order_read(ctx, settings->reduced.file, device, settings, &model->order));
  } else {
    DEA_TRY(ctx, dea_reduced_order_build(ctx, device, settings, &model->order));
  }
  model->monitor = dea_arena_alloc(&model->memory, l->monitor_count + 1, sizeof *model->monitor);
  model->body = dea_arena_alloc(&model->memory, l->body_count + 1, sizeof *model->body);
  model->channel = dea_arena_alloc(&model->memory, l->channel_count, sizeof *model->channel);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  return DEA_CHAIN(ctx, report(ctx, model));
}

static dea_status create(struct dea_context *ctx, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  return DEA_CHAIN(ctx,
                   dea_model_build(ctx, sizeof **out, device, settings, prepare, destroy, out));
}

// Points ------------------------------------------------------------------------------------------

/* Of the fit, and in time of the modes. */
static double error_m(const struct dea_model *model)
{
  return model->order->error * fabs(model->order->stroke) + model->trial.off_m;
}

/* Of the copies at the last point. */
static double output_at(const struct dea_model *model, const struct dea_reduced_output *output)
{
  const struct dea_reduced *core = &model->order->core;
  const struct dea_reduced_state *at = &model->trial.film;
  const double V = at->at.voltage_V;
  double sum = 0, value[6], unused;
  for (int k = 0; k < 1 + 2 * core->mode_count; k++) {
    dea_reduced_spline_at(&output->of, at->copy[k].at.force, core->even ? V * V : V, value);
    sum += dea_reduced_weight(core, k, &unused) * value[0];
  }
  return sum;
}

static void fill_point(const struct dea_model *model, struct dea_load_point *out)
{
  const struct dea_reduced_order *o = model->order;
  const struct dea_reduced_point *at = &model->trial.film.at;
  *out = dea_load_point_empty();
  out->voltage_V = at->voltage_V;
  for (size_t i = 0; i < o->output_count; i++) {
    if (o->outputs[i].column != 0) {
      dea_point_set(out, o->outputs[i].column, output_at(model, &o->outputs[i]));
    }
  }
  if (o->coordinate.column != 0) {
    dea_point_set(out, o->coordinate.column, at->q);
  }
  if (o->coordinate.column == dea_point_column_find("fibre_tip_z_m")) {
    out->fibre_tip_z_error_m = error_m(model);
  }
  out->energy_J = at->energy_J - at->force * at->q;
  out->capacitance_F = at->voltage_V != 0 ? at->charge_C / at->voltage_V : at->charge_by_voltage;
}

static dea_status solve(struct dea_context *ctx, struct dea_model *model, double voltage_V,
                        struct dea_load_point *out)
{
  const int end = dea_reduced_begin(&model->order->core, voltage_V, 0, &model->trial.film);
  if (end != DEA_REDUCED_OK) {
    return dea_reduced_fail(ctx, model->order, end, voltage_V);
  }
  fill_point(model, out);
  return DEA_OK;
}

static dea_status observe(struct dea_context *ctx, struct dea_model *model,
                          struct dea_observation *out)
{
  const struct dea_layout *l = model->device->layout;
  const struct dea_reduced_order *o = model->order;
  const struct dea_reduced_point *at = &model->trial.film.at;
  (void)ctx;
  for (size_t i = 0; i < (l->monitor_count + l->body_count) * DEA_OBSERVED_COUNT; i++) {
    const size_t monitor = i / DEA_OBSERVED_COUNT, k = i % DEA_OBSERVED_COUNT;
    double *of = monitor < l->monitor_count ? model->monitor[monitor]
                                            : model->body[monitor - l->monitor_count];
    of[k] = NAN;
  }
  for (size_t i = 0; i < o->output_count; i++) {
    const struct dea_reduced_output *output = &o->outputs[i];
    if (output->column == 0) {
      model->monitor[output->monitor][output->motion] = output_at(model, output);
    }
  }
  if (o->coordinate.column == 0) {
    model->monitor[o->coordinate.body][o->coordinate.component] = at->q;
  }
  for (size_t k = 0; k < l->channel_count; k++) { // of several channels the sum alone is known
    const bool one = l->channel_count == 2;
    model->channel[k] = (struct dea_channel_values){
        k == 0 ? 0 : l->channels[k].ratio * at->voltage_V + l->channels[k].own_V,
        one && k == 1 ? at->charge_C / l->channels[1].ratio : NAN, NAN, NAN};
  }
  *out = (struct dea_observation){.monitor_count = l->monitor_count,
                                  .body_count = l->body_count,
                                  .channel_count = l->channel_count,
                                  .monitor = (const double(*)[DEA_OBSERVED_COUNT])model->monitor,
                                  .body = (const double(*)[DEA_OBSERVED_COUNT])model->body,
                                  .channel = model->channel};
  return DEA_OK;
}

static dea_status hold(struct dea_context *ctx, const struct dea_model *model, double voltage_V,
                       double height_m, double *force_N)
{
  const struct dea_reduced_order *o = model->order;
  struct dea_reduced_point at = {0};
  if (o->coordinate.column != dea_point_column_find("fibre_tip_z_m")) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "the model's coordinate is not that of the fibre tips");
  }
  const int end = dea_reduced_held(&o->core, height_m, voltage_V, &at);
  *force_N = -at.force; // on what holds them
  return end == DEA_REDUCED_OK ? DEA_OK : dea_reduced_fail(ctx, o, end, voltage_V);
}

/* Of the fit, for its coordinate. */
static dea_status errors(struct dea_context *ctx, struct dea_model *model, double *error)
{
  const struct dea_reduced_order *o = model->order;
  (void)ctx;
  for (size_t i = 0; i < model->device->layout->monitor_count; i++) {
    const bool is_it = o->coordinate.column == 0 && o->coordinate.body == i;
    error[i] = is_it ? error_m(model) : NAN;
  }
  return DEA_OK;
}

// Small motions -----------------------------------------------------------------------------------

/* dq/dV at a frequency: (dq/dV)_0 [K/k(w) + sum s (K/(k(w) + i w c - w^2 m) - K/k(w))] with the
 * share s of each mode and k(w) = K + sum k d^2 i w tau/(1 + i w tau). */
static double complex answer(const struct dea_model *model,
                             const struct dea_ac_excitation *excitation, double omega)
{
  const struct dea_reduced *core = &model->order->core;
  const struct dea_reduced_point *at = &model->trial.film.at;
  const double x = at->q - core->middle, K = 1 / at->by_force;
  const double d = dea_reduced_polynomial(core->strain, x);
  double complex stiffness = K;
  for (int i = 0; i < core->branch_count; i++) {
    const double complex wt = I * omega * core->branch_s[i];
    stiffness += core->branch_N_per_m[i] * d * d * wt / (1 + wt);
  }
  double complex sum = 1 / stiffness;
  for (int i = 0; i < core->small_count; i++) {
    const struct dea_reduced_mode *mode = &core->modes[i];
    const double m = mass_at(core, mode, at->q);
    const double share = dea_reduced_polynomial(mode->by_q, x);
    const double c = core->damping + 2 * excitation->damping_ratio * sqrt(K * m) +
                     excitation->damping_mass_per_s * m + excitation->damping_stiffness_s * K;
    sum += share * (1 / (stiffness - omega * omega * m + I * omega * c) - 1 / stiffness);
  }
  return at->by_voltage * K * sum;
}

static dea_status respond(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_load_point *at,
                          const struct dea_ac_excitation *excitation, const double *frequency_Hz,
                          size_t count, struct dea_load_point *points)
{
  const struct dea_reduced_order *o = model->order;
  const size_t width = model->device->layout->monitor_count * DEA_OBSERVED_MOTIONS;
  const bool tip = o->coordinate.column == dea_point_column_find("fibre_tip_z_m");
  model->answers = dea_arena_alloc(&model->memory, 2 * count * width + 1, sizeof *model->answers);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  if (!(o->core.mode_count > 0)) {
    return dea_fail(ctx, DEA_E_DESIGN, "small motions need the densities of all parts");
  }
  for (size_t i = 0; i < count; i++) {
    const double complex q = answer(model, excitation, 2 * DEA_PI * frequency_Hz[i]);
    points[i] = *at;
    points[i].frequency_Hz = frequency_Hz[i];
    points[i].ripple_V = excitation->amplitude_V;
    if (tip) {
      points[i].fibre_tip_amplitude_m = excitation->amplitude_V * cabs(q);
      points[i].fibre_tip_phase_rad = carg(q);
    } else if (o->coordinate.column != 0) {
      points[i].electrode_edge_amplitude_m = excitation->amplitude_V * cabs(q);
      points[i].electrode_edge_phase_rad = carg(q);
    }
    for (size_t k = 0; k < 2 * width; k++) {
      model->answers[2 * i * width + k] = NAN;
    }
    if (o->coordinate.column == 0) {
      double *to = model->answers + 2 * (i * width + o->coordinate.body * DEA_OBSERVED_MOTIONS +
                                         (size_t)o->coordinate.component);
      to[0] = creal(q);
      to[1] = cimag(q);
    }
  }
  return DEA_OK;
}

static const double *answers(const struct dea_model *model)
{
  return model->answers;
}

// In time -----------------------------------------------------------------------------------------

/* What is stored: in film, field and branches. */
static double stored_J(const struct dea_reduced_state *s)
{
  return s->at.energy_J + s->at.charge_C * s->at.voltage_V + s->branch_J;
}

static void fill_moment(const struct dea_model *model, struct dea_load_point *out)
{
  const struct moment *m = &model->trial;
  fill_point(model, out);
  out->time_s = m->film.time_s;
  out->source_voltage_V = m->circuit.source_voltage_V;
  out->charge_C = m->circuit.charge_C;
  out->current_A = m->circuit.current_A;
  out->stored_energy_J = stored_J(&m->film);
  out->energy_J = out->stored_energy_J - out->charge_C * out->voltage_V;
  if (model->options.inertia) {
    out->kinetic_energy_J = m->film.kinetic_J;
  }
  out->dissipated_J = m->film.loss_J + m->circuit.resistance_loss_J + m->circuit.leakage_loss_J;
  out->supply_work_J = m->circuit.supply_work_J;
}

/* Film and circuit in a step: the voltage by the capacitance that the film then has, in turns. */
static int step_once(const struct dea_model *model, const struct moment *from,
                     const struct dea_time_step *step, struct moment *to)
{
  enum { TURNS = 60 };
  static const double close = 1e-12;
  const struct dea_circuit *circuit = &model->options.circuit;
  const struct moment n = *from;
  const double h = step->length_s, external = step->control != NULL ? step->value : n.film.external;
  struct dea_circuit_film film = {.capacitance_F = n.circuit.capacitance_F};
  double V = n.film.at.voltage_V, unused;
  int end = DEA_REDUCED_NOT_CONVERGED;
  bool settled = false;
  *to = n;
  for (int i = 0; i < TURNS && !settled; i++) {
    const double was = V;
    V = dea_circuit_voltage(circuit, &n.circuit, step, &film, &unused);
    end = dea_reduced_step(&model->order->core, &n.film, h, V, external, model->options.inertia,
                           model->options.rho_inf, &to->film);
    if (end != DEA_REDUCED_OK) {
      return end;
    }
    const struct dea_reduced_point *at = &to->film.at;
    film.capacitance_F = V != 0 ? at->charge_C / V : at->charge_by_voltage;
    settled = i > 0 && fabs(V - was) <= close * fabs(V);
  }
  dea_circuit_advance(circuit, &n.circuit, step, &film, &to->circuit);
  if (h == 0 && dea_circuit_is_ideal(circuit)) {
    to->circuit.supply_work_J +=
        stored_J(&to->film) - stored_J(&n.film) + (to->film.loss_J - n.film.loss_J);
  }
  return DEA_REDUCED_OK;
}

/* The modes along a straight piece of the coordinate at rest. Shares of dq/dV are means over the
 * voltages, and what modes lack moves at once: by that much of how far a mode is away, which does
 * not know its damping, the coordinate is off, taken as independent. */
static void follow_drive(const struct dea_model *model, double length_s, struct moment *to)
{
  const struct dea_reduced_order *o = model->order;
  const struct moment *from = &model->now;
  const struct dea_reduced_point *rest = &to->film.copy[0].at;
  const double by = rest->q - from->film.copy[0].at.q;
  double sum = 0;
  for (int i = 0; i <= o->core.mode_count; i++) {
    const double w = omega_at(o, i, rest);
    const double *was = from->away[i];
    if (!(length_s > 0) || !(w > 0)) {
      to->away[i][0] = was[0] - by;
    } else {
      const double v = by / length_s, c = cos(w * length_s), s = sin(w * length_s);
      to->away[i][0] = was[0] * c + (was[1] - v) / w * s;
      to->away[i][1] = v + (was[1] - v) * c - w * was[0] * s;
    }
    sum += pow(o->share_off[i] * to->away[i][0], 2);
  }
  to->off_m = fmax(from->off_m, sqrt(sum));
}

/* Where the modes follow the drive no better than this, of the stroke, it is beyond the range. */
static dea_status check_drive(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_reduced_order *o = model->order;
  const double part = model->trial.off_m / fabs(o->stroke), s = model->trial.film.time_s;
  return part <= beyond
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DOMAIN,
                        "at %.4g s the voltage has changed faster than the reduced-order model "
                        "can follow: it may be off by %.2g %% of the stroke, more than %.2g %%; "
                        "let the voltage rise more slowly or take model 3d",
                        s, 100 * part, 100 * beyond);
}

static dea_status begin(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_time_options *options, struct dea_load_point *out)
{
  struct moment *m = &model->now;
  const struct dea_reduced_order *o = model->order;
  if (options->own_sources != NULL) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "model reduced has one source");
  }
  if (options->inertia && !(o->core.mode_count > 0)) {
    return dea_fail(ctx, DEA_E_DESIGN, "inertia needs the densities of all parts");
  }
  model->options = *options;
  *m = (struct moment){.circuit = {.voltage_V = 0}};
  m->film = model->trial.film;
  const struct dea_reduced_point *at = &m->film.at;
  m->circuit.source_voltage_V = m->circuit.voltage_V = at->voltage_V;
  m->circuit.charge_C = at->charge_C;
  m->circuit.capacitance_F =
      at->voltage_V != 0 ? at->charge_C / at->voltage_V : at->charge_by_voltage;
  model->trial = *m;
  model->largest_q = 1e-6 * fabs(o->stroke);
  model->largest_V = 1e-4 * o->voltage_V[1];
  model->largest_J = 1e-6 * m->circuit.capacitance_F * o->voltage_V[1] * o->voltage_V[1];
  fill_moment(model, out);
  return DEA_OK;
}

/* Once whole and once in two halves, of which the halves count; a third of the difference. */
static int step_twice(struct dea_model *model, const struct dea_time_step *step, double *error)
{
  const struct moment *now = &model->now;
  struct moment whole, half, *to = &model->trial;
  const double V_s = now->circuit.source_voltage_V;
  struct dea_time_step first = *step, second = *step;
  first.length_s = second.length_s = 0.5 * step->length_s;
  first.source_voltage_V = 0.5 * (V_s + step->source_voltage_V);
  int end = step_once(model, now, step, &whole);
  end = end == DEA_REDUCED_OK ? step_once(model, now, &first, &half) : end;
  end = end == DEA_REDUCED_OK ? step_once(model, &half, &second, to) : end;
  if (end == DEA_REDUCED_OK) {
    to->film.time_s = now->film.time_s + step->length_s;
    *error = fabs(whole.film.at.q - to->film.at.q) / model->largest_q;
    *error = fmax(*error, fabs(whole.circuit.voltage_V - to->circuit.voltage_V) / model->largest_V);
    *error = fmax(*error, fabs(whole.film.loss_J - to->film.loss_J) / model->largest_J) / 3;
  }
  return end;
}

static dea_status advance(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_time_step *step, struct dea_load_point *out,
                          double *error)
{
  const struct moment *now = &model->now;
  *error = 0;
  model->largest_q =
      fmax(model->largest_q, fabs(model->trial.film.at.q - model->order->core.middle));
  model->largest_V = fmax(model->largest_V, fabs(model->trial.circuit.voltage_V));
  model->largest_J = fmax(model->largest_J, fabs(model->trial.circuit.supply_work_J));
  const double longest =
      dea_circuit_longest_step(&model->options.circuit, &now->circuit, step, model->largest_V);
  const bool whole = !(step->length_s > 0) || step->length_s > longest;
  const int end =
      whole ? step_once(model, now, step, &model->trial) : step_twice(model, step, error);
  if (end != DEA_REDUCED_OK) {
    return dea_reduced_fail(ctx, model->order, end, step->source_voltage_V);
  }
  if (step->length_s > longest) { // whatever the answer, it is not to be relied on
    *error = step->length_s / longest;
  }
  if (model->options.inertia) {
    follow_drive(model, step->length_s, &model->trial);
    DEA_TRY(ctx, check_drive(ctx, model));
  }
  fill_moment(model, out);
  return DEA_OK;
}

static void accept(struct dea_model *model)
{
  model->now = model->trial;
}

const struct dea_model_type dea_model_reduced = {
    .name = "reduced",
    .long_name = "reduced from 3D",
    .any_layout = true,
    .create = create,
    .destroy = destroy,
    .solve = solve,
    .observe = observe,
    .errors = errors,
    .hold = hold,
    .respond = respond,
    .answers = answers,
    .begin = begin,
    .advance = advance,
    .accept = accept,
};

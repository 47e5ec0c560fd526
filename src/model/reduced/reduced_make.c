/* Samples by model 3d and what is fitted to them. */
#include "model/reduced/reduced.h"
#include "model/reduced/reduced_fit.h"

#include "base/clock.h"
#include "result/columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

extern const struct dea_model_type dea_model_3d; // of model_list.h

enum { DEFAULT_VOLTAGES = 5 }; // at first

struct making {
  struct dea_context *ctx;
  const struct dea_model_type *type; // model 3d
  struct dea_model *model;
  const struct dea_device *device;
  struct dea_model_settings settings; // of model 3d
  struct dea_control coordinate;
  struct dea_arena memory; // of the samples
  struct dea_reduced_grid grid;
  struct dea_reduced_sample *samples;       // the grid's
  double (*monitors)[DEA_OBSERVED_MOTIONS]; // [forces][voltages][monitor_count]
  double force, highest_V, stroke;
  bool viscous, massive;
};

// Device ------------------------------------------------------------------------------------------

static bool is_even(const struct dea_layout *l)
{
  bool even = true;
  for (size_t k = 1; k < l->channel_count; k++) {
    even = even && l->channels[k].own_V == 0;
  }
  return even;
}

static bool is_viscous(const struct dea_layout *l)
{
  bool viscous = false;
  for (size_t i = 0; i < l->ply_count; i++) {
    viscous = viscous || l->plies[i].material.branch_count > 0;
  }
  return viscous;
}

// Coordinate --------------------------------------------------------------------------------------

static dea_status find_monitor(struct making *m)
{
  const struct dea_layout *l = m->device->layout;
  const char *name = m->settings.reduced.monitor;
  m->coordinate = (struct dea_control){.kind = DEA_CONTROL_CONJUGATE, .component = -1};
  if (name == NULL && l->monitor_count == 0 && m->device->disc) {
    m->coordinate.column =
        dea_point_column_find(m->device->fibre_count > 0 ? "fibre_tip_z_m" : "electrode_edge_u_m");
    return DEA_OK;
  }
  while (name != NULL && m->coordinate.body < l->monitor_count &&
         strcmp(l->monitors[m->coordinate.body].name, name) != 0) {
    m->coordinate.body++;
  }
  m->coordinate.component = m->settings.reduced.motion;
  return m->coordinate.body < l->monitor_count
             ? DEA_OK
             : dea_fail(m->ctx, DEA_E_DESIGN, "the device has no monitor%s%s%s", name ? " '" : "",
                        name ? name : "", name ? "' (compute.reduced.monitor)" : "");
}

/* The coordinate at the last point. */
static dea_status read_coordinate(struct making *m, const struct dea_load_point *point, double *out)
{
  struct dea_observation seen;
  if (m->coordinate.column != 0) {
    *out = dea_point_get(point, m->coordinate.column);
    return DEA_OK;
  }
  DEA_TRY(m->ctx, m->type->observe(m->ctx, m->model, &seen));
  const double *values = seen.monitor[m->coordinate.body];
  if (m->coordinate.component < 0) { // at the highest voltage
    m->coordinate.component = (int)dea_observed_main(values);
  }
  *out = values[m->coordinate.component];
  return DEA_OK;
}

// Range -------------------------------------------------------------------------------------------

/* Whether a state is one of several, or its law or shape is in doubt. */
static bool is_doubtful(const struct dea_load_point *point)
{
  return (dea_load_point_flags(point) & ~(1u << DEA_FLAG_PREVIEW | 1u << DEA_FLAG_BREAKDOWN)) != 0;
}

static dea_status refuse(struct making *m, const char *what)
{
  char why[200];
  snprintf(why, sizeof why, "%s", dea_context_message(m->ctx));
  return dea_fail(m->ctx, DEA_E_DOMAIN, "no reduced-order model: %s%s%s", what,
                  why[0] != '\0' ? ": " : "", why);
}

static dea_status restart(struct making *m)
{
  if (m->model != NULL) {
    m->type->destroy(m->ctx, m->model);
    m->model = NULL;
  }
  return DEA_CHAIN(m->ctx, m->type->create(m->ctx, m->device, &m->settings, &m->model));
}

/* Up to the highest voltage, or to where the state is in doubt, and the force that moves the
 * coordinate as far as the voltage does. */
static dea_status find_range(struct making *m)
{
  const size_t steps = 2 * (DEFAULT_VOLTAGES - 1);
  struct dea_load_point point;
  struct dea_compliance at[2];
  double end_V = 0;
  dea_status status = DEA_OK;
  for (size_t i = 0; i <= steps && status == DEA_OK; i++) {
    const double V = m->highest_V * (double)i / (double)steps;
    status = m->type->solve(m->ctx, m->model, V, &point);
    if (dea_status_ends(status)) {
      return dea_fail_chain(m->ctx, status, __func__, __FILE__, __LINE__);
    }
    if (status != DEA_OK || is_doubtful(&point)) {
      break;
    }
    end_V = V;
  }
  dea_context_clear(m->ctx);
  if (end_V == 0) {
    return refuse(m, "model 3d has no state above 0 V that is sure");
  }
  if (end_V < m->highest_V) {
    DEA_TRY(m->ctx, dea_finding_add(m->ctx, DEA_NOTE, (struct dea_location){0},
                                    "model reduced ends at %.4g kV: beyond it model 3d has no "
                                    "state that is sure",
                                    1e-3 * end_V));
    m->highest_V = end_V;
    DEA_TRY(m->ctx, restart(m));
    DEA_TRY(m->ctx, m->type->solve(m->ctx, m->model, end_V, &point));
  }
  double unused;
  DEA_TRY(m->ctx, read_coordinate(m, &point, &unused));
  DEA_TRY(m->ctx, m->type->compliance(m->ctx, m->model, &m->coordinate, 0, &at[1]));
  DEA_TRY(m->ctx, restart(m));
  DEA_TRY(m->ctx, m->type->solve(m->ctx, m->model, 0, &point));
  DEA_TRY(m->ctx, m->type->compliance(m->ctx, m->model, &m->coordinate, 0, &at[0]));
  m->stroke = at[1].value - at[0].value;
  if (!(m->force > 0)) {
    m->force = 2 * fabs(m->stroke) / (at[0].by_force + at[1].by_force);
  }
  return DEA_OK;
}

// Samples -----------------------------------------------------------------------------------------

static dea_status add_sample(struct making *m, size_t force, size_t voltage, double value)
{
  const size_t n = force * m->grid.voltages + voltage, middle = m->grid.forces / 2,
               count = m->device->layout->monitor_count;
  struct dea_reduced_sample *out = &m->samples[n];
  const int with =
      (m->massive ? DEA_COMPLIANCE_WITH_MODES : 0) | (m->viscous ? DEA_COMPLIANCE_WITH_FAST : 0);
  struct dea_observation seen;
  DEA_TRY(m->ctx, m->type->move(m->ctx, m->model, &m->coordinate, value, &out->point));
  if (is_doubtful(&out->point)) {
    return dea_fail(m->ctx, DEA_E_NO_EQUILIBRIUM, "the state is one of several there");
  }
  DEA_TRY(m->ctx, m->type->compliance(m->ctx, m->model, &m->coordinate, force == middle ? with : 0,
                                      &out->at));
  DEA_TRY(m->ctx, m->type->observe(m->ctx, m->model, &seen));
  for (size_t i = 0; i < count; i++) {
    memcpy(m->monitors[n * count + i], seen.monitor[i], sizeof *m->monitors);
  }
  return DEA_OK;
}

/* What a fit of every second sample is off at the others, over stroke and charge. */
static dea_status hold_out(struct making *m, double error[2])
{
  struct dea_reduced trial = {.even = m->grid.even};
  double charge = 0;
  error[0] = error[1] = 0;
  DEA_TRY(m->ctx, dea_reduced_fit_energy(&m->memory, &m->grid, 2, &trial.energy));
  for (size_t n = 0; n < m->grid.forces * m->grid.voltages; n++) {
    const struct dea_reduced_sample *s = &m->samples[n];
    struct dea_reduced_point p;
    dea_reduced_at(&trial, s->at.force, s->voltage_V, &p);
    error[0] = fmax(error[0], fabs((p.q - s->at.value) / m->stroke));
    error[1] = fmax(error[1], fabs(p.charge_C - s->at.charge_C));
    charge = fmax(charge, fabs(s->at.charge_C));
  }
  error[1] /= charge;
  return DEA_OK;
}

/* Room for a voltage between each two. */
static void spread(struct making *m)
{
  const size_t count = m->device->layout->monitor_count, was = m->grid.voltages;
  m->grid.voltages = 2 * was - 1;
  for (size_t n = m->grid.forces * was; n-- > 0;) {
    const size_t to = n / was * m->grid.voltages + n % was * 2;
    m->samples[to] = m->samples[n];
    memmove(m->monitors + to * count, m->monitors + n * count, count * sizeof *m->monitors);
  }
}

/* All forces at a voltage, in the order that `side` says: the first of them is where the model is.
 */
static dea_status sample_voltage(struct making *m, size_t i, int side)
{
  const size_t middle = m->grid.forces / 2;
  const double step = side * m->force / (double)middle;
  const double V = m->highest_V * (double)i / (double)(m->grid.voltages - 1);
  struct dea_load_point point;
  DEA_TRY(m->ctx, m->type->solve(m->ctx, m->model, V, &point));
  for (size_t k = 0; k < m->grid.forces; k++) {
    const size_t j = side < 0 ? m->grid.forces - 1 - k : k;
    const double value = k == middle ? 0 : ((double)k - (double)middle) * step;
    DEA_TRY(m->ctx, add_sample(m, j, i, value));
    m->samples[j * m->grid.voltages + i].voltage_V = V;
  }
  return DEA_OK;
}

/* Voltages upwards and, where these are not enough, those between them on the way back: from each
 * to the next at the force where it ends. */
static dea_status sample_voltages(struct making *m, double error[2])
{
  static const double enough = 5e-3;
  const bool chosen = m->settings.reduced.voltages > 0;
  struct dea_load_point point;
  int side = 1;
  m->grid.voltages = chosen ? (size_t)m->settings.reduced.voltages : DEFAULT_VOLTAGES;
  DEA_TRY(m->ctx, restart(m));
  DEA_TRY(m->ctx, m->type->solve(m->ctx, m->model, 0, &point));
  DEA_TRY(m->ctx, m->type->move(m->ctx, m->model, &m->coordinate, -m->force, &point));
  for (size_t i = 0; i < m->grid.voltages; i++, side = -side) {
    DEA_TRY(m->ctx, sample_voltage(m, i, side));
    dea_progress(m->ctx, "reduced-order samples", i + 1, m->grid.voltages);
  }
  DEA_TRY(m->ctx, hold_out(m, error));
  if (chosen || error[0] < enough) {
    return DEA_OK;
  }
  spread(m);
  for (size_t i = m->grid.voltages - 1; i-- > 0; i--, side = -side) {
    DEA_TRY(m->ctx, sample_voltage(m, i, side));
    dea_progress(m->ctx, "reduced-order samples", m->grid.voltages - i / 2, m->grid.voltages);
  }
  return DEA_CHAIN(m->ctx, hold_out(m, error));
}

/* With smaller forces where the device does not bear these, and then with smaller voltages: close
 * to where it loses its stability it bears none. */
static dea_status compute_samples(struct making *m, double error[2])
{
  enum { TRIALS = 8, OF_FORCE = 4 };
  for (int trial = 0; trial < TRIALS; trial++) {
    const dea_status status = sample_voltages(m, error);
    if (status == DEA_OK || dea_status_ends(status) || m->settings.reduced.force > 0) {
      return DEA_CHAIN(m->ctx, status);
    }
    if (trial + 1 < TRIALS) {
      dea_context_clear(m->ctx);
      m->force *= trial < OF_FORCE ? 0.5 : 1;
      m->highest_V *= trial < OF_FORCE ? 1 : 0.95;
    }
  }
  return refuse(m, "the device bears no force along the coordinate");
}

// Fits --------------------------------------------------------------------------------------------

static const char *const output_keys[] = {
    "electrode_stretch",    "centre_z_m",         "fibre_tip_z_m",      "highest_z_m",
    "lowest_z_m",           "electrode_edge_u_m", "true_field_V_per_m", "breakdown_margin",
    "min_tension_N_per_m",  "compression_ratio",  "locking_share",      "range_share",
    "breakdown_probability"};
enum { OUTPUT_KEYS = sizeof output_keys / sizeof output_keys[0] };

/* Adds an output where all samples have it, values [samples]. */
static dea_status add_output(struct making *m, struct dea_reduced_order *out,
                             const struct dea_reduced_output *of, const double *values)
{
  for (size_t n = 0; n < m->grid.forces * m->grid.voltages; n++) {
    if (!isfinite(values[n])) {
      return DEA_OK;
    }
  }
  struct dea_reduced_output *to = &out->outputs[out->output_count++];
  *to = *of;
  return DEA_CHAIN(m->ctx, dea_reduced_fit_values(&out->memory, &m->grid, values, &to->of));
}

static dea_status fit_outputs(struct making *m, struct dea_reduced_order *out)
{
  const size_t samples = m->grid.forces * m->grid.voltages,
               monitors = m->device->layout->monitor_count;
  const size_t all = OUTPUT_KEYS + monitors * DEA_OBSERVED_MOTIONS;
  double *values = dea_arena_alloc(&m->memory, samples, sizeof *values);
  out->outputs = dea_arena_alloc(&out->memory, all, sizeof *out->outputs);
  DEA_TRY(m->ctx, dea_arena_status(&m->memory));
  DEA_TRY(m->ctx, dea_arena_status(&out->memory));
  for (size_t i = 0; i < all; i++) {
    struct dea_reduced_output of = {.column = 0};
    if (i < OUTPUT_KEYS) {
      of.column = dea_point_column_find(output_keys[i]);
    } else {
      of.monitor = (i - OUTPUT_KEYS) / DEA_OBSERVED_MOTIONS;
      of.motion = (enum dea_observed)((i - OUTPUT_KEYS) % DEA_OBSERVED_MOTIONS);
    }
    for (size_t n = 0; n < samples; n++) {
      values[n] = of.column != 0 ? dea_point_get(&m->samples[n].point, of.column)
                                 : m->monitors[n * monitors + of.monitor][of.motion];
    }
    DEA_TRY(m->ctx, add_output(m, out, &of, values));
  }
  return DEA_OK;
}

/* A mode that is found, with the size of its share of dq/dV and how far that is off its mean at the
 * worst voltage. */
struct candidate {
  struct dea_reduced_mode mode;
  double size, off, Hz;
};

/* By how much the coordinate is stiffer at once than in the end: by dq/dV or, where that is 0 or
 * grows, by dq/dF. */
static double stiffening(const struct making *m, const struct dea_compliance *at)
{
  const double ratio = at->by_voltage / at->fast_by_voltage;
  return !m->viscous ? 1 : ratio > 1 ? ratio : at->by_force / at->fast_by_force;
}

/* Of the states without a force: m by x from the stiffness at once, and its shares. */
static dea_status fit_mode(struct making *m, size_t k, const struct dea_reduced_sample *free,
                           const double *x, struct candidate *out)
{
  double mass[DEA_REDUCED_VOLTAGES_MAX], share[DEA_REDUCED_VOLTAGES_MAX];
  const size_t count = m->grid.voltages, from = m->grid.even ? 1 : 0; // no dq/dV at 0 V
  struct dea_reduced_mode *mode = &out->mode;
  *out = (struct candidate){.Hz = free[0].at.modes[k].frequency_Hz};
  for (size_t i = 0; i < count; i++) {
    const struct dea_compliance_mode *at = &free[i].at.modes[k];
    const double omega = 2 * DEA_PI * at->frequency_Hz;
    mass[i] = stiffening(m, &free[i].at) / (free[i].at.by_force * omega * omega);
    share[i] = at->voltage_share;
    if (i >= from) {
      mode->share += at->share / (double)(count - from);
      mode->voltage_share += at->voltage_share / (double)(count - from);
    }
  }
  for (size_t i = from; i < count; i++) {
    out->off = fmax(out->off, fabs(share[i] - mode->voltage_share));
  }
  out->size = isfinite(mass[0]) && isfinite(mode->share) ? fabs(mode->voltage_share) : 0;
  if (out->size > 0) {
    DEA_TRY(m->ctx, dea_reduced_fit_polynomial(m->ctx, x, mass, count, mode->mass));
    DEA_TRY(m->ctx,
            dea_reduced_fit_polynomial(m->ctx, x + from, share + from, count - from, mode->by_q));
  }
  return DEA_OK;
}

/* The modes with the largest shares of dq/dV; first those that have some of dq/dF too, without
 * which a mode moves much beside the coordinate and counts in small motions alone. What others
 * have moves at once. */
static dea_status fit_modes(struct making *m, const struct dea_reduced_sample *free,
                            const double *x, struct dea_reduced_order *out)
{
  static const double least = 0.01, least_by_force = 1e-4;
  struct dea_reduced *core = &out->core;
  struct candidate of[DEA_COMPLIANCE_MODES];
  out->mode_share = m->massive ? 0 : NAN;
  for (size_t k = 0; k < DEA_COMPLIANCE_MODES && m->massive; k++) {
    DEA_TRY(m->ctx, fit_mode(m, k, free, x, &of[k]));
    of[k].size += of[k].size >= least && of[k].mode.share >= least_by_force ? 1 : 0;
  }
  double left = 1;
  while (m->massive && core->small_count < DEA_REDUCED_MODES) {
    size_t best = 0;
    for (size_t k = 1; k < DEA_COMPLIANCE_MODES; k++) {
      best = of[k].size > of[best].size ? k : best;
    }
    if (of[best].size < least) {
      break;
    }
    const struct dea_reduced_mode *mode = &core->modes[core->small_count];
    core->modes[core->small_count] = of[best].mode;
    if (of[best].size >= 1) {
      out->share_off[core->mode_count++] = of[best].off;
      left -= mode->voltage_share;
      of[best].Hz = NAN;
    }
    out->mode_share += mode->share;
    core->small_count++;
    of[best].size = 0;
  }
  if (m->massive && core->mode_count == 0) {
    return dea_fail(m->ctx, DEA_E_DOMAIN, "no mode of the device moves the coordinate");
  }
  out->share_off[core->mode_count] = left;
  for (size_t k = DEA_COMPLIANCE_MODES; k-- > 0 && m->massive;) {
    if (isfinite(of[k].Hz) && (fabs(of[k].mode.voltage_share) >= least || !(out->left_Hz > 0))) {
      out->left_Hz = of[k].Hz;
    }
  }
  return DEA_OK;
}

/* Times of the branches of all plies, with shares by modulus and thickness. */
static double add_branches(const struct dea_layout *l, struct dea_reduced *core)
{
  double sum = 0;
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_material *material = &l->plies[i].material;
    for (size_t k = 0; k < material->branch_count; k++) {
      const double tau = material->branches[k].time_s;
      int n = 0;
      while (n < core->branch_count && core->branch_s[n] != tau) {
        n++;
      }
      if (n < DEA_REDUCED_BRANCHES) {
        const double weight = material->branches[k].modulus_Pa * l->plies[i].thickness_m;
        core->branch_s[n] = tau;
        core->branch_N_per_m[n] += weight;
        core->branch_count = n == core->branch_count ? n + 1 : core->branch_count;
        sum += weight;
      }
    }
  }
  return sum;
}

/* k is such that with it the stiffness is that at once; de/dq is the root of it over that at the
 * middle. */
static dea_status fit_branches(struct making *m, const struct dea_reduced_sample *free,
                               const double *x, struct dea_reduced_order *out)
{
  double root[DEA_REDUCED_VOLTAGES_MAX];
  out->core.strain[0] = 1;
  if (!m->viscous) {
    return DEA_OK;
  }
  for (size_t i = 0; i < m->grid.voltages; i++) {
    root[i] = sqrt((stiffening(m, &free[i].at) - 1) / free[i].at.by_force);
    if (!isfinite(root[i])) {
      return dea_fail(m->ctx, DEA_E_DOMAIN, "branches do not stiffen the coordinate");
    }
  }
  double *c = out->core.strain;
  DEA_TRY(m->ctx, dea_reduced_fit_polynomial(m->ctx, x, root, m->grid.voltages, c));
  const double unit = c[0], sum = add_branches(m->device->layout, &out->core);
  for (int k = 0; k < 3; k++) {
    c[k] /= unit;
  }
  for (int k = 0; k < out->core.branch_count; k++) {
    out->core.branch_N_per_m[k] *= unit * unit / sum;
  }
  return DEA_OK;
}

static dea_status fit(struct making *m, struct dea_reduced_order *out)
{
  const struct dea_reduced_sample *free = m->samples + m->grid.forces / 2 * m->grid.voltages;
  double x[DEA_REDUCED_VOLTAGES_MAX];
  DEA_TRY(m->ctx, dea_reduced_fit_energy(&out->memory, &m->grid, 1, &out->core.energy));
  out->core.even = m->grid.even;
  out->core.middle = 0.5 * (free[0].at.value + free[m->grid.voltages - 1].at.value);
  for (size_t i = 0; i < m->grid.voltages; i++) {
    x[i] = free[i].at.value - out->core.middle;
  }
  DEA_TRY(m->ctx, fit_modes(m, free, x, out));
  DEA_TRY(m->ctx, fit_branches(m, free, x, out));
  DEA_TRY(m->ctx, fit_outputs(m, out));
  out->coordinate = m->coordinate;
  out->voltage_V[1] = m->highest_V;
  out->voltage_V[0] = m->grid.even ? -m->highest_V : 0;
  out->force[1] = m->force;
  out->force[0] = -m->force;
  out->stroke = free[m->grid.voltages - 1].at.value - free[0].at.value;
  return DEA_OK;
}

// All of it ---------------------------------------------------------------------------------------

static dea_status build(struct making *m, struct dea_reduced_order *out)
{
  const size_t samples = m->grid.forces * m->grid.voltages; // the most
  double error[2];
  DEA_TRY(m->ctx, find_monitor(m));
  m->samples = dea_arena_alloc(&m->memory, samples, sizeof *m->samples);
  m->monitors = dea_arena_alloc(&m->memory, samples * (m->device->layout->monitor_count + 1),
                                sizeof *m->monitors);
  DEA_TRY(m->ctx, dea_arena_status(&m->memory));
  m->grid.samples = m->samples;
  DEA_TRY(m->ctx, restart(m));
  DEA_TRY(m->ctx, find_range(m));
  DEA_TRY(m->ctx, compute_samples(m, error));
  out->error = error[0];
  out->charge_error = error[1];
  DEA_TRY(m->ctx, fit(m, out));
  return DEA_CHAIN(m->ctx, dea_reduced_hash(m->ctx, m->device, &m->settings, out->device));
}

dea_status dea_reduced_order_build(struct dea_context *ctx, const struct dea_device *device,
                                   const struct dea_model_settings *settings,
                                   struct dea_reduced_order **out)
{
  const double began_s = dea_clock_s();
  struct making m = {
      .ctx = ctx,
      .type = &dea_model_3d,
      .device = device,
      .settings = *settings,
      .memory = {.ctx = ctx},
      .grid = {.forces = settings->reduced.forces > 0 ? (size_t)settings->reduced.forces : 5,
               .voltages = settings->reduced.voltages > 0 ? (size_t)settings->reduced.voltages
                                                          : 2 * DEFAULT_VOLTAGES - 1,
               .even = is_even(device->layout)},
      .force = settings->reduced.force,
      .highest_V = settings->reduced.voltage_V,
      .viscous = is_viscous(device->layout)};
  *out = dea_alloc(ctx, 1, sizeof **out);
  DEA_TRY_MEMORY(*out != NULL);
  (*out)->memory.ctx = ctx;
  size_t errors = dea_finding_trial_begin(ctx);
  m.massive = dea_device_check_densities(ctx, device) == DEA_OK;
  dea_finding_trial_end(ctx, errors);
  dea_context_clear(ctx);
  dea_status status = m.highest_V > 0 ? build(&m, *out)
                                      : dea_fail(ctx, DEA_E_DESIGN,
                                                 "a reduced-order model needs a voltage above 0 "
                                                 "(compute.reduced.voltage, compute.voltage)");
  if (m.model != NULL) {
    m.type->destroy(ctx, m.model);
  }
  dea_arena_free(&m.memory);
  (*out)->made_s = dea_clock_s() - began_s;
  if (status != DEA_OK) {
    dea_reduced_order_destroy(ctx, *out);
    *out = NULL;
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}

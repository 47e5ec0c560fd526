#include "instrument/sim_bench.h"

#include <math.h>

static const double tolerance = 1e-6; // of a step, over the largest motion: below what 16 bits see
static const double short_circuit_ohm = 1e4;
static const double least_V = 10; // that counts as under voltage

struct dea_sim_bench {
  struct dea_context *ctx;
  const struct dea_protocol *protocol;
  struct dea_sim_settings settings;
  const struct dea_bench_film_type *type;
  struct dea_bench_model *model; // owned
  struct dea_load_point point;
  struct dea_sim_state state;
  double source_V, target_V; // of the amplifier now, and where it goes
  double next_s;             // length of the next step
  double charge_C;           // that the film took since the last sample, with what leaked
  size_t samples;
  double under_voltage_s;
  struct dea_profile profile; // of the model, at sample number `profile_at`; count 0: it has none
  size_t profile_at;
};

const struct dea_bench_model *dea_sim_bench_model(const struct dea_sim_bench *bench)
{
  return bench->model;
}

static double or_zero(double value)
{
  return isfinite(value) ? value : 0;
}

/* The model's answer becomes the state. */
static void store_point(struct dea_sim_bench *b, const struct dea_bench_point *at, double length_s)
{
  double charge_C = 0.5 * (at->point.charge_C + b->point.charge_C);
  b->charge_C += at->point.charge_C - b->point.charge_C;
  b->charge_C += charge_C * length_s / at->leakage_s;
  b->point = at->point;
}

static dea_status try_step(struct dea_sim_bench *b, double length_s, double source_V, bool *good)
{
  struct dea_bench_point at;
  double error = 0, factor = 0.25;
  dea_status status = b->type->advance(b->ctx, b->model, length_s, source_V, &at, &error);
  *good = status == DEA_OK && (length_s == 0 || error <= tolerance);
  if (*good) {
    b->type->accept(b->model);
    store_point(b, &at, length_s);
    factor = 0.9 * cbrt(tolerance / fmax(error, 1e-30));
    b->next_s = length_s > 0 ? fmax(b->next_s, length_s) * fmin(fmax(factor, 0.3), 3) : b->next_s;
    return DEA_OK;
  }
  if (status == DEA_OK) {
    factor = error >= 1 ? 0.95 / error : fmax(0.9 * cbrt(tolerance / error), 0.1);
  }
  b->next_s = length_s * fmin(factor, 0.7);
  return status;
}

/* The film is a resistor now. */
static void break_down(struct dea_sim_bench *b)
{
  b->state.broken = true;
  b->point.voltage_V = 0;
}

/* Goes on for some time while the source goes straight to a voltage. */
static dea_status follow(struct dea_sim_bench *b, double length_s, double end_V)
{
  // of the length: then there is nothing to be followed. A jump of some volts is charged in ns, and
  // the end of that is found in ever shorter steps; of an interval of 0.1 s this is 0.1 ps
  static const double shortest = 1e-12;
  double left_s = length_s;
  while (left_s > 0 && !b->state.broken) {
    bool good, last = b->next_s >= left_s * (1 - 1e-9);
    double h = last ? left_s : fmin(b->next_s, 0.5 * left_s);
    double source_V = last ? end_V : b->source_V + (end_V - b->source_V) * h / left_s;
    dea_status status = try_step(b, h, source_V, &good);
    if (dea_status_ends(status)) {
      return status;
    }
    if (good) {
      b->source_V = source_V;
      left_s = last ? 0 : left_s - h;
    } else if (b->next_s < shortest * length_s) {
      if (status != DEA_E_NO_EQUILIBRIUM && status != DEA_E_NOT_CONVERGED && status != DEA_OK) {
        return status;
      }
      dea_context_clear(b->ctx);
      break_down(b);
    }
  }
  b->source_V = end_V;
  return DEA_OK;
}

static dea_status jump(struct dea_sim_bench *b, double to_V)
{
  bool good;
  dea_status status = b->state.broken ? DEA_OK : try_step(b, 0, to_V, &good);
  if (status == DEA_E_NO_EQUILIBRIUM || status == DEA_E_NOT_CONVERGED) {
    dea_context_clear(b->ctx);
    break_down(b);
    status = DEA_OK;
  }
  b->source_V = to_V;
  return status;
}

/* From the last sample to this one. */
static dea_status pass(struct dea_sim_bench *b)
{
  const struct dea_quantity *slew = &b->protocol->amplifier.slew_V_per_s;
  double interval_s = 1 / b->protocol->rate_Hz.si, change_V = b->target_V - b->source_V;
  b->charge_C = 0;
  if (change_V != 0 && slew->origin == DEA_ABSENT) {
    DEA_TRY(b->ctx, jump(b, b->target_V));
  } else if (change_V != 0) {
    double ramp_s = fmin(fabs(change_V) / slew->si, interval_s);
    double reached_V = b->source_V + copysign(fmin(slew->si * ramp_s, fabs(change_V)), change_V);
    b->next_s = ramp_s;
    DEA_TRY(b->ctx, follow(b, ramp_s, reached_V));
    interval_s -= ramp_s;
  }
  b->next_s = change_V != 0 ? 0.1 * interval_s : fmax(b->next_s, 0.1 * interval_s);
  return interval_s > 0 ? follow(b, interval_s, b->source_V) : DEA_OK;
}

static void report(struct dea_sim_bench *b, double interval_s)
{
  struct dea_sim_state *s = &b->state;
  const struct dea_quantity *limit = &b->protocol->amplifier.current_A;
  s->current_A = b->charge_C / interval_s;
  s->film_V = b->point.voltage_V;
  b->under_voltage_s += fabs(s->film_V) > least_V ? interval_s : 0;
  if (!s->broken &&
      (fabs(s->film_V) >= b->settings.breakdown_V ||
       (fabs(s->film_V) > least_V && b->under_voltage_s >= b->settings.breakdown_s))) {
    break_down(b);
  }
  if (s->broken) {
    double most_A = limit->origin != DEA_ABSENT ? limit->si : INFINITY;
    s->current_A = copysign(fmin(fabs(b->source_V) / short_circuit_ohm, most_A), b->source_V);
    s->film_V = s->current_A * short_circuit_ohm;
    s->output_V = s->film_V;
    s->centre_z_m = s->fibre_tip_z_m = s->force_N = 0;
    return;
  }
  double series_V = b->settings.series_resistance_ohm * or_zero(b->point.current_A);
  s->output_V = b->settings.series_resistance_ohm > 0 ? s->film_V + series_V : s->film_V;
  s->fibre_tip_z_m = or_zero(b->point.fibre_tip_z_m);
  s->centre_z_m = isfinite(b->point.centre_z_m) ? b->point.centre_z_m : s->fibre_tip_z_m;
  s->force_N = or_zero(b->point.force_N);
  if (!isnan(b->settings.fatigue_s)) {
    double left = exp(-b->under_voltage_s / b->settings.fatigue_s);
    s->fibre_tip_z_m *= left;
    s->centre_z_m *= left;
    s->force_N *= left;
  }
}

dea_status dea_sim_bench_sample(struct dea_sim_bench *bench, double control_V,
                                struct dea_sim_state *out)
{
  double rate_Hz = bench->protocol->rate_Hz.si;
  bench->state.time_s = (double)bench->samples / rate_Hz;
  DEA_TRY(bench->ctx, bench->samples > 0 ? pass(bench) : DEA_OK);
  report(bench, 1 / rate_Hz);
  bench->samples++;
  double asked_V = control_V * bench->protocol->amplifier.gain.si;
  bench->target_V = fmin(fmax(asked_V, bench->protocol->amplifier.lowest_V.si),
                         bench->protocol->amplifier.highest_V.si);
  *out = bench->state;
  return DEA_OK;
}

/* The model's own profile, linear between its points. */
static bool model_height(struct dea_sim_bench *b, double radius_m, double *z_m)
{
  if (b->state.broken) {
    return false;
  }
  if (b->profile_at != b->samples) {
    b->profile_at = b->samples;
    if (b->type->profile(b->ctx, b->model, &b->profile) != DEA_OK || b->profile.z_m == NULL) {
      b->profile.count = 0;
      dea_context_clear(b->ctx);
    }
  }
  const struct dea_profile profile = b->profile;
  for (size_t i = 1; i < profile.count; i++) {
    double a = profile.radius_m[i - 1], c = profile.radius_m[i];
    if (a >= 0 && c > a && radius_m >= a && radius_m <= c) {
      double share = (radius_m - a) / (c - a);
      *z_m = profile.z_m[i - 1] + share * (profile.z_m[i] - profile.z_m[i - 1]);
      return true;
    }
  }
  return false;
}

double dea_sim_bench_height(struct dea_sim_bench *bench, double radius_m)
{
  const struct dea_sim_state *s = &bench->state;
  double z_m, frame = bench->model->frame_radius_m, tip = bench->model->fibre_tip_radius_m;
  if (radius_m >= frame) {
    return 0;
  }
  if (model_height(bench, radius_m, &z_m)) {
    return z_m;
  }
  return radius_m >= tip ? s->fibre_tip_z_m * (frame - radius_m) / (frame - tip)
                         : s->centre_z_m + (s->fibre_tip_z_m - s->centre_z_m) * radius_m / tip;
}

static dea_status begin(struct dea_sim_bench *b)
{
  const struct dea_quantity *limit = &b->protocol->amplifier.current_A;
  const struct dea_bench_circuit circuit = {b->settings.series_resistance_ohm,
                                            limit->origin != DEA_ABSENT ? limit->si : INFINITY};
  struct dea_bench_point at;
  DEA_TRY(b->ctx, b->type->open(b->ctx, b->protocol->film, b->settings.model, b->settings.monitor,
                                &b->model));
  DEA_TRY(b->ctx, b->type->begin(b->ctx, b->model, &circuit, &at));
  b->point = at.point;
  return DEA_OK;
}

dea_status dea_sim_bench_create(struct dea_context *ctx, const struct dea_protocol *protocol,
                                const struct dea_sim_settings *settings, struct dea_sim_bench **out)
{
  *out = NULL;
  struct dea_sim_bench *bench = dea_alloc(ctx, 1, sizeof *bench);
  DEA_TRY_MEMORY(bench != NULL);
  *bench = (struct dea_sim_bench){
      .ctx = ctx, .protocol = protocol, .settings = *settings, .type = protocol->film->type};
  dea_status status = begin(bench);
  DEA_TRY_ELSE(ctx, status, dea_sim_bench_destroy(ctx, bench));
  *out = bench;
  return DEA_OK;
}

void dea_sim_bench_destroy(struct dea_context *ctx, struct dea_sim_bench *bench)
{
  if (bench != NULL) {
    bench->type->close(ctx, bench->model);
    dea_free(ctx, bench);
  }
}

/* Instrument "sim": the whole bench, with a model of the design as its film. It plays the output,
 * reads the inputs and sends profiles. How it gets to what is true is in sim_bench.h; all that it
 * adds to that comes from one stream of random numbers, drawn sample after sample, so that a seed
 * gives the same recording however it is read. */
#include "base/clock.h"
#include "instrument/instrument_make.h"
#include "instrument/sim_bench.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { FAST, REAL };
enum {
  POINTS_MAX = 4096,
  BLOCK_SAMPLES = 1024,   // handed over together
  CALL_SAMPLES = 1 << 14, // simulated within one call at most
};

struct raw {
  struct dea_label kind, model, monitor;
  struct dea_choice pace;
  struct dea_quantity seed, series_resistance_ohm, breakdown_V, breakdown_s, fatigue_s;
  struct dea_quantity discharge_Hz, discharge_V, discharge_C;
  struct dea_quantity voltage_V, current_A, displacement_m, force_N, profile_m; // noise
  struct dea_quantity displacement_drift_m_per_s, force_drift_N_per_s, force_offset_N;
  struct dea_quantity lost, outliers, missing;
  struct dea_quantity points, frame_rate_Hz, tilt_rad, centre_m, frame_height_m, frame_width_m;
};

static const char *const paces[] = {"fast", "real", NULL};

#define AT(member) offsetof(struct raw, member)
#define NUMBER(name, member, si, most, usual, text)                                                \
  DEA_NUMBER_ROW(name, AT(member), si, usual, text, .max = most, .default_text = usual)
#define SIGNED_NUMBER(name, member, si, most, usual, text)                                         \
  DEA_NUMBER_ROW(name, AT(member), si, usual, text, .min = -(most), .max = most,                   \
                 .default_text = usual)

static const struct dea_field fields[] = {
    DEA_LABEL_ROW("kind", AT(kind), "sim",
                  "kind of instrument; may be left out in the section `sim`", .required = true),
    DEA_LABEL_ROW("model", AT(model), "lumped", "model of the film; one that knows time",
                  .default_text = "lumped"),
    DEA_LABEL_ROW("monitor", AT(monitor), "hub_z",
                  "displacement of the device by which the film moves",
                  .absent_text = "of a film that is no disc the first monitor's z"),
    DEA_CHOICE_ROW("pace", AT(pace), paces, "real", "as fast as it can, or as slow as a bench",
                   .default_text = "fast"),
    DEA_INTEGER_ROW("seed", AT(seed), "2",
                    "of all that is random: the same seed gives the same recording", .max = 9e15,
                    .default_text = "1"),
    NUMBER("series_resistance", series_resistance_ohm, "ohm", 1e12, "0 ohm",
           "between amplifier and film"),
    DEA_NUMBER_ROW("breakdown_voltage", AT(breakdown_V), "V", "7.5 kV",
                   "voltage on the film at which it becomes a short circuit", .above_min = true,
                   .max = 1e6, .absent_text = "never"),
    DEA_NUMBER_ROW("breakdown_time", AT(breakdown_s), "s", "36000 s",
                   "seconds under voltage after which it becomes one", .above_min = true,
                   .max = 1e12, .absent_text = "never"),
    DEA_NUMBER_ROW("fatigue_time", AT(fatigue_s), "s", "500000 s",
                   "seconds under voltage in which displacement and force fall to 1/e",
                   .above_min = true, .max = 1e12, .absent_text = "never"),
    NUMBER("discharge_rate", discharge_Hz, "Hz", 1e6, "0 Hz", "partial discharges a second"),
    NUMBER("discharge_voltage", discharge_V, "V", 1e6, "0 kV", "voltage above which there are any"),
    NUMBER("discharge_charge", discharge_C, "C", 1, "50 nC", "charge of each"),
    NUMBER("voltage_noise", voltage_V, "V", 1e5, "5 V",
           "standard deviation of the measured voltage"),
    NUMBER("current_noise", current_A, "A", 1, "1 uA", "of the current"),
    NUMBER("displacement_noise", displacement_m, "m", 1, "1 um", "of point lasers"),
    NUMBER("force_noise", force_N, "N", 10, "0.2 mN", "of the force cell"),
    NUMBER("profile_noise", profile_m, "m", 1, "2 um", "of each point of the profile sensor"),
    SIGNED_NUMBER("displacement_drift", displacement_drift_m_per_s, "m/s", 1.0, "0 um/s",
                  "drift of lasers and profile sensor"),
    SIGNED_NUMBER("force_drift", force_drift_N_per_s, "N/s", 10.0, "0 mN/s",
                  "drift of the force cell"),
    SIGNED_NUMBER("force_offset", force_offset_N, "N", 10.0, "0 mN", "reading without load"),
    NUMBER("lost", lost, "1", 1, "0 %", "share of the samples that do not arrive"),
    NUMBER("outliers", outliers, "1", 1, "0.1 %",
           "share of profile points that are off by up to 1 mm"),
    NUMBER("missing", missing, "1", 1, "0.5 %", "share of profile points without a value"),
    DEA_INTEGER_ROW("profile_points", AT(points), "320",
                    "points of the profile sensor; 0: there is none", .max = POINTS_MAX,
                    .default_text = "320"),
    DEA_NUMBER_ROW("frame_rate", AT(frame_rate_Hz), "Hz", "20 Hz", "profiles a second",
                   .above_min = true, .max = 1e5, .default_text = "20 Hz"),
    SIGNED_NUMBER("tilt", tilt_rad, "radian", 1.0, "0.2 degree", "between profile sensor and film"),
    SIGNED_NUMBER("centre", centre_m, "m", 1.0, "0 mm",
                  "where the film's centre is in the sensor's picture"),
    NUMBER("frame_height", frame_height_m, "m", 0.1, "2 mm", "of the frame above the film"),
    NUMBER("frame_width", frame_width_m, "m", 0.1, "3 mm",
           "of the frame in the picture, on each side"),
};

const struct dea_record dea_instrument_sim_record = {"sim", "a simulated bench", fields,
                                                     sizeof fields / sizeof fields[0]};

/* Random numbers, of a seed. */
struct random {
  uint64_t state;
  double spare; // second one of a pair of normal numbers; NAN: none
};

struct sim {
  struct dea_instrument base;
  struct raw raw;
  const struct dea_protocol *protocol;
  struct dea_sim_bench *bench;
  struct random random;
  bool real_time, stopped;
  double *x_m, *z_m;       // [profile_points]
  double *volts;           // [BLOCK_SAMPLES][inputs]
  double *queue;           // control voltages that wait
  size_t queued, capacity; // in the queue
  size_t put, done;        // samples that came in all, and that were simulated
  size_t frames;           // that were due
};

// Opening ----------------------------------------------------------------------------------------

static dea_status check(const struct dea_reader *reader, const void *data,
                        const struct dea_protocol *protocol)
{
  const struct raw *raw = data;
  if (protocol->film == NULL) {
    return dea_finding_add(reader->ctx, DEA_ERROR, raw->kind.location,
                           "the simulated bench needs a film: name its `design`");
  }
  const char *names[16], *name;
  size_t count = 0;
  bool there = false, moves;
  for (size_t i = 0; (name = protocol->film->type->model(i, &moves)) != NULL; i++) {
    bool is = strcmp(name, raw->model.text) == 0;
    if (is && moves) {
      return DEA_OK;
    }
    there = there || is;
    if (moves && count < sizeof names / sizeof names[0]) {
      names[count++] = name;
    }
  }
  char hint[DEA_HINT_SIZE], list[DEA_HINT_SIZE];
  return dea_finding_add(
      reader->ctx, DEA_ERROR, raw->model.location, "%s '%.60s'%s%s; models with time are: %s",
      there ? "model" : "there is no model", raw->model.text,
      there ? " does not support transients" : "",
      dea_name_hint(raw->model.text, names, count, hint), dea_names_list(names, count, list));
}

static struct dea_sim_settings settings_of(const struct raw *raw)
{
  return (struct dea_sim_settings){raw->model.text,
                                   raw->monitor.text[0] != '\0' ? raw->monitor.text : NULL,
                                   raw->series_resistance_ohm.si,
                                   raw->breakdown_V.si,
                                   raw->breakdown_s.si,
                                   raw->fatigue_s.si};
}

static void close_sim(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct sim *s = (struct sim *)instrument;
  dea_sim_bench_destroy(ctx, s->bench);
  dea_free(ctx, s->x_m);
  dea_free(ctx, s->z_m);
  dea_free(ctx, s->volts);
  dea_free(ctx, s->queue);
  dea_free(ctx, s);
}

/* Memory, and where the sensor looks. */
static dea_status prepare(struct dea_context *ctx, struct sim *s)
{
  const struct raw *raw = &s->raw;
  size_t points = (size_t)raw->points.si;
  s->x_m = dea_alloc(ctx, points, sizeof *s->x_m);
  s->z_m = dea_alloc(ctx, points, sizeof *s->z_m);
  s->volts = dea_alloc(ctx, BLOCK_SAMPLES * s->protocol->input_count, sizeof *s->volts);
  DEA_TRY_MEMORY(s->x_m != NULL && s->z_m != NULL && s->volts != NULL);
  double half_m = dea_sim_bench_model(s->bench)->frame_radius_m + raw->frame_width_m.si;
  for (size_t i = 0; i < points; i++) {
    double share = points > 1 ? (double)i / (double)(points - 1) : 0.5;
    s->x_m[i] = raw->centre_m.si + half_m * (2 * share - 1);
  }
  s->base.profile_points = points;
  s->base.x_m = s->x_m;
  s->base.roles = DEA_PLAYS_OUTPUT | DEA_READS_INPUTS | (points > 0 ? DEA_SENDS_PROFILES : 0u);
  return DEA_OK;
}

static dea_status open_sim(struct dea_context *ctx, struct dea_instrument *instrument,
                           const void *raw, const struct dea_protocol *protocol)
{
  struct sim *s = (struct sim *)instrument;
  s->raw = *(const struct raw *)raw;
  s->protocol = protocol;
  s->random = (struct random){(uint64_t)s->raw.seed.si, NAN};
  s->real_time = s->raw.pace.value == REAL;
  s->base.patient = !s->real_time;
  const struct dea_sim_settings settings = settings_of(&s->raw);
  DEA_TRY(ctx, dea_sim_bench_create(ctx, protocol, &settings, &s->bench));
  return prepare(ctx, s);
}

// What is added to the truth ---------------------------------------------------------------------

static const double two_pi = 6.28318530717958647692;
enum { ADC_BITS = 16 };

/* splitmix64: Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014. */
static uint64_t draw(struct random *random)
{
  uint64_t z = (random->state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/* In [0, 1). */
static double uniform(struct random *random)
{
  return ldexp((double)(draw(random) >> 11), -53);
}

/* Of mean 0 and standard deviation 1 (Box and Muller). */
static double normal(struct random *random)
{
  if (!isnan(random->spare)) {
    double spare = random->spare;
    random->spare = NAN;
    return spare;
  }
  double radius = sqrt(-2 * log(1 - uniform(random)));
  double angle = two_pi * uniform(random);
  random->spare = radius * sin(angle);
  return radius * cos(angle);
}

/* The nearest step of a converter that ends at its range. */
static double convert(double volts, double range_V)
{
  double step_V = ldexp(range_V, 1 - ADC_BITS);
  return fmin(fmax(step_V * round(volts / step_V), -range_V), range_V - step_V);
}

/* What a channel of a kind shows, without its noise; *sigma: of that. */
static double shown_value(const struct raw *raw, const struct dea_sim_state *state, int kind,
                          double *sigma)
{
  switch (kind) {
  case DEA_CHANNEL_VOLTAGE:
    *sigma = raw->voltage_V.si;
    return state->output_V;
  case DEA_CHANNEL_CURRENT:
    *sigma = raw->current_A.si;
    return state->current_A;
  case DEA_CHANNEL_DISPLACEMENT:
    *sigma = raw->displacement_m.si;
    return state->centre_z_m + raw->displacement_drift_m_per_s.si * state->time_s;
  case DEA_CHANNEL_FORCE:
    *sigma = raw->force_N.si;
    return state->force_N + raw->force_offset_N.si + raw->force_drift_N_per_s.si * state->time_s;
  default:
    *sigma = 0;
    return 0;
  }
}

/* Volts at the wires of all inputs of the protocol for a sample; all NAN when it is lost. volts:
 * [inputs]. */
static void read_inputs(struct sim *s, const struct dea_sim_state *state, double *volts)
{
  const struct raw *raw = &s->raw;
  double interval_s = 1 / s->protocol->rate_Hz.si, spike_A = 0, sigma;
  bool lost = uniform(&s->random) < raw->lost.si;
  bool discharge = uniform(&s->random) < raw->discharge_Hz.si * interval_s;
  if (discharge && fabs(state->film_V) > raw->discharge_V.si) {
    spike_A = copysign(raw->discharge_C.si / interval_s, state->film_V);
  }
  for (size_t i = 0; i < s->protocol->input_count; i++) {
    const struct dea_protocol_input *input = &s->protocol->inputs[i];
    double value = shown_value(raw, state, input->kind.value, &sigma);
    value += sigma * normal(&s->random);
    value += input->kind.value == DEA_CHANNEL_CURRENT ? spike_A : 0;
    volts[i] = lost ? NAN : convert((value - input->at_zero) / input->per_volt, input->range_V.si);
  }
}

/* A frame of the profile sensor. */
static void read_profile(struct sim *s, double time_s)
{
  static const double largest_outlier_m = 1e-3;
  const struct raw *raw = &s->raw;
  double frame_m = dea_sim_bench_model(s->bench)->frame_radius_m, slope = tan(raw->tilt_rad.si);
  double drift_m = raw->displacement_drift_m_per_s.si * time_s;
  for (size_t i = 0; i < s->base.profile_points; i++) {
    double radius_m = fabs(s->x_m[i] - raw->centre_m.si);
    double film_m =
        radius_m < frame_m ? dea_sim_bench_height(s->bench, radius_m) : raw->frame_height_m.si;
    double error_m = raw->profile_m.si * normal(&s->random);
    bool outlier = uniform(&s->random) < raw->outliers.si;
    double spike_m = largest_outlier_m * (2 * uniform(&s->random) - 1);
    bool missing = uniform(&s->random) < raw->missing.si;
    s->z_m[i] =
        missing ? NAN : film_m + drift_m + slope * s->x_m[i] + error_m + (outlier ? spike_m : 0);
  }
}

// Playing ----------------------------------------------------------------------------------------

static dea_status start_sim(struct dea_context *ctx, struct dea_instrument *instrument)
{
  (void)ctx;
  instrument->start_s = dea_clock_s();
  return DEA_OK;
}

/* Samples that the clock has come to, of those that were put. */
static size_t due_samples(const struct sim *s)
{
  if (!s->real_time) {
    return s->put;
  }
  double passed = floor((dea_clock_s() - s->base.start_s) * s->protocol->rate_Hz.si) + 1;
  return passed < (double)s->put ? (size_t)fmax(passed, 0) : s->put;
}

static dea_status set_outputs(struct dea_context *ctx, struct dea_instrument *instrument,
                              const double *volts, size_t count)
{
  static const double longest_s = 1; // that is queued in real time
  struct sim *s = (struct sim *)instrument;
  double most = longest_s * s->protocol->rate_Hz.si;
  DEA_TRY(ctx, dea_protocol_guard(ctx, s->protocol, volts, count));
  while (s->real_time && (double)(s->put - due_samples(s)) > most && !dea_interrupted(ctx)) {
    dea_clock_wait(0.01);
  }
  if (s->queued + count > s->capacity) {
    size_t capacity = 2 * s->capacity + count;
    double *moved = dea_resize(ctx, s->queue, capacity, sizeof *moved);
    DEA_TRY_MEMORY(moved != NULL);
    s->queue = moved;
    s->capacity = capacity;
  }
  memcpy(s->queue + s->queued, volts, count * sizeof *volts);
  s->queued += count;
  s->put += count;
  return DEA_OK;
}

/* One sample into its place, and the frame that is due then. */
static dea_status sample(struct sim *s, double control_V, double *volts,
                         const struct dea_sink *sink)
{
  struct dea_sim_state state;
  DEA_TRY_STATUS(dea_sim_bench_sample(s->bench, control_V, &state));
  read_inputs(s, &state, volts);
  s->base.lost += s->protocol->input_count > 0 && isnan(volts[0]) ? 1 : 0;
  double frame_s = (double)s->frames / s->raw.frame_rate_Hz.si;
  if (s->base.profile_points == 0 || state.time_s < frame_s * (1 - 1e-12)) {
    return DEA_OK;
  }
  s->frames++;
  read_profile(s, state.time_s);
  return sink->profile(sink->user, state.time_s, s->z_m);
}

static dea_status get(struct dea_context *ctx, struct dea_instrument *instrument, double timeout_s,
                      const struct dea_sink *sink)
{
  static const double glance_s = 0.005;
  struct sim *s = (struct sim *)instrument;
  size_t inputs = s->protocol->input_count;
  double until_s = dea_clock_s() + timeout_s;
  while (due_samples(s) == s->done && s->real_time && dea_clock_s() < until_s &&
         !dea_interrupted(ctx)) {
    dea_clock_wait(fmin(glance_s, timeout_s));
  }
  size_t left = due_samples(s) - s->done, taken = 0;
  left = s->stopped ? 0 : left < CALL_SAMPLES ? left : CALL_SAMPLES;
  dea_status status = DEA_OK;
  while (status == DEA_OK && taken < left) {
    size_t count = 0;
    while (status == DEA_OK && count < BLOCK_SAMPLES && taken < left) {
      status = sample(s, s->queue[taken++], s->volts + count++ * inputs, sink);
    }
    status = status == DEA_OK ? sink->samples(sink->user, s->volts, count) : status;
  }
  s->done += taken;
  s->queued -= taken;
  if (taken > 0) {
    memmove(s->queue, s->queue + taken, s->queued * sizeof *s->queue);
  }
  return status;
}

static struct dea_zero stop(struct dea_context *ctx, struct dea_instrument *instrument)
{
  (void)ctx;
  ((struct sim *)instrument)->stopped = true;
  return (struct dea_zero){DEA_ZERO_COMMANDED, NAN, NULL};
}

const struct dea_instrument_type dea_instrument_sim = {
    .name = "sim",
    .record = &dea_instrument_sim_record,
    .raw_size = sizeof(struct raw),
    .size = sizeof(struct sim),
    .roles = DEA_PLAYS_OUTPUT | DEA_READS_INPUTS | DEA_SENDS_PROFILES,
    .check = check,
    .open = open_sim,
    .start = start_sim,
    .put = set_outputs,
    .get = get,
    .stop = stop,
    .close = close_sim,
};

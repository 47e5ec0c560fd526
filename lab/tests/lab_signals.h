/* Recordings of a made-up bench whose truth is known: square cycles, a film in a frame under a line
 * laser, sensors with correlated noise, drift and failures. */
#pragma once

#include "recording/recording.h"
#include "testing.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Numbers ----------------------------------------------------------------------------------------

static inline double signal_uniform(uint64_t *seed) // SplitMix64
{
  uint64_t z = (*seed += 0x9e3779b97f4a7c15U);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return ((double)((z ^ (z >> 31)) >> 11) + 0.5) * 0x1p-53;
}

static inline double signal_normal(uint64_t *seed)
{
  double r = sqrt(-2.0 * log(signal_uniform(seed)));
  return r * cos(2.0 * acos(-1.0) * signal_uniform(seed));
}

/* Next value of noise with standard deviation 1 whose neighbours have the correlation rho. */
static inline double signal_correlated(uint64_t *seed, double rho, double before)
{
  return rho * before + sqrt(1.0 - rho * rho) * signal_normal(seed);
}

/* Mean and standard deviation of pulls. */
struct signal_pulls {
  double sum, squares, n;
};

static inline void signal_pull(struct signal_pulls *pulls, double estimate, double truth,
                               double uncertainty)
{
  double pull = (estimate - truth) / uncertainty;
  if (!isfinite(pull)) {
    fail_msg("%g of %g +- %g is no pull", estimate, truth, uncertainty);
  }
  pulls->sum += pull;
  pulls->squares += pull * pull;
  pulls->n += 1.0;
}

static inline void signal_check_pulls(const char *what, const struct signal_pulls *pulls)
{
  double mean = pulls->sum / pulls->n;
  double std = sqrt((pulls->squares - pulls->n * mean * mean) / (pulls->n - 1.0));
  print_message("pulls of %-28s %4.0f: mean %6.3f, std %5.3f\n", what, pulls->n, mean, std);
  assert_true(fabs(mean) < 0.2);
  assert_true(fabs(std - 1.0) < 0.25);
}

// The bench --------------------------------------------------------------------------------------

enum { SIGNAL_LEVELS_MAX = 10 };

struct signal_bench {
  double rate_Hz, frame_Hz; // of the channels, of the profiles
  size_t points;            // of a profile; 0: none
  double lead_s, cycle_s;   // rest before; half of a cycle is active, then rest
  size_t cycles, level_count;
  double levels_V[SIGNAL_LEVELS_MAX];
  double tau_s, m_per_V2; // the film follows with this time constant, to m_per_V2 V^2
  double sigma, rho;      // of a sample, over its 1 unit [m, N]; of neighbours
  double drift_per_s;     // of the sensors [m/s, N/s]
  bool command, voltage, displacement, force, list;
  double N_per_V2, preload_N, cell_N; // force; the cell reads cell_N unloaded
  // profiles
  double centre_m, tilt, height_m, film_m, electrode_m, tip_m, frame_m; // frame_m: its height
  double cone;                                      // slope inside the electrode, of that outside
  double point_sigma, common_sigma, outliers, lost; // shares of the points
  bool framed;
};

static inline struct signal_bench signal_bench_plain(void)
{
  return (struct signal_bench){
      .rate_Hz = 200.0,
      .frame_Hz = 40.0,
      .lead_s = 1.0,
      .cycle_s = 2.0,
      .cycles = 5,
      .level_count = 1,
      .levels_V = {6000.0},
      .tau_s = 0.03,
      .m_per_V2 = 300e-6 / 36e6,
      .N_per_V2 = 0.1 / 36e6,
      .command = true,
      .list = true,
      .film_m = 15e-3,
      .electrode_m = 3.75e-3,
      .tip_m = 3e-3,
      .frame_m = 2e-3,
      .framed = true,
  };
}

static inline double signal_end_s(const struct signal_bench *b)
{
  return b->lead_s + b->cycle_s * (double)(b->cycles * b->level_count);
}

/* Asked voltage and how far the film is on its way, 0 to the level's voltage squared. */
static inline double signal_voltage(const struct signal_bench *b, double time_s)
{
  double since = time_s - b->lead_s + 1e-9;
  if (since < 0.0 || since >= b->cycle_s * (double)(b->cycles * b->level_count)) {
    return 0.0;
  }
  size_t cycle = (size_t)(since / b->cycle_s);
  return since - (double)cycle * b->cycle_s < 0.5 * b->cycle_s ? b->levels_V[cycle / b->cycles]
                                                               : 0.0;
}

static inline double signal_square(const struct signal_bench *b, double time_s)
{
  double since = time_s - b->lead_s + 1e-9;
  if (since < 0.0) {
    return 0.0;
  }
  size_t last = b->cycles * b->level_count, cycle = (size_t)(since / b->cycle_s);
  cycle = cycle < last ? cycle : last - 1;
  double V = b->levels_V[cycle / b->cycles], t = since - (double)cycle * b->cycle_s;
  double half = 0.5 * b->cycle_s;
  if (t < half) { // what is left of the cycle before is not told: tau is far below half
    return V * V * -expm1(-t / b->tau_s);
  }
  return V * V * exp(-(t - half) / b->tau_s);
}

/* Height over the radius for a displacement of 1 outside of the electrode's edge, where it is 1:
 * straight to the frame, and inside with `cone` of that slope. */
static inline double signal_shape(const struct signal_bench *b, double r)
{
  double slope = 1.0 / (b->film_m - b->electrode_m), a = fabs(r);
  return a >= b->film_m        ? 0.0
         : a >= b->electrode_m ? (b->film_m - a) * slope
                               : 1.0 + b->cone * (b->electrode_m - a) * slope;
}

static inline void *signal_room(size_t count, size_t size)
{
  void *memory = calloc(count + 1, size);
  assert_non_null(memory);
  return memory;
}

static inline struct dea_channel *signal_channel(struct dea_recording *r, const char *name,
                                                 enum dea_channel_kind kind, double rate_Hz,
                                                 size_t count)
{
  struct dea_channel *c = &r->channels[r->channel_count++];
  *c = (struct dea_channel){.kind = kind, .interval_s = 1.0 / rate_Hz, .filter_Hz = NAN};
  snprintf(c->name, sizeof c->name, "%s", name);
  c->values = signal_room(count, sizeof *c->values);
  c->count = count;
  return c;
}

static inline void signal_fill_channels(const struct signal_bench *b, struct dea_recording *r,
                                        uint64_t *seed)
{
  size_t n = (size_t)(signal_end_s(b) * b->rate_Hz + 0.5);
  const struct {
    bool there;
    enum dea_channel_kind kind;
  } all[] = {{b->command, DEA_CHANNEL_COMMAND},
             {b->voltage, DEA_CHANNEL_VOLTAGE},
             {b->displacement, DEA_CHANNEL_DISPLACEMENT},
             {b->force, DEA_CHANNEL_FORCE}};
  for (size_t k = 0; k < 4; k++) {
    if (!all[k].there) {
      continue;
    }
    struct dea_channel *c =
        signal_channel(r, dea_channel_names[all[k].kind], all[k].kind, b->rate_Hz, n);
    double noise = signal_normal(seed);
    for (size_t i = 0; i < n; i++) {
      double t = dea_channel_time(c, i);
      noise = signal_correlated(seed, b->rho, noise);
      double sensed = b->drift_per_s * t + b->sigma * noise;
      c->values[i] = all[k].kind == DEA_CHANNEL_COMMAND   ? signal_voltage(b, t)
                     : all[k].kind == DEA_CHANNEL_VOLTAGE ? signal_voltage(b, t) + 5.0 * noise
                     : all[k].kind == DEA_CHANNEL_FORCE
                         ? b->cell_N + (t > 0.5 * b->lead_s ? b->preload_N : 0.0) +
                               b->N_per_V2 * signal_square(b, t) + sensed
                         : b->m_per_V2 * signal_square(b, t) + sensed;
    }
  }
}

/* Film, frame of 4 mm width on both sides, and nothing beside it. */
static inline double signal_height(const struct signal_bench *b, double x, double square)
{
  double r = x - b->centre_m, z = b->height_m + b->tilt * r;
  if (fabs(r) > b->film_m) {
    return b->framed && fabs(r) < b->film_m + 4e-3 ? z + b->frame_m : NAN;
  }
  return z + b->m_per_V2 * square * signal_shape(b, r);
}

static inline void signal_fill_profiles(const struct signal_bench *b, struct dea_recording *r,
                                        uint64_t *seed)
{
  struct dea_profiles *p = &r->profiles;
  p->points = b->points;
  p->count = (size_t)(signal_end_s(b) * b->frame_Hz);
  p->x_m = signal_room(p->points, sizeof *p->x_m);
  p->time_s = signal_room(p->count, sizeof *p->time_s);
  p->z_m = signal_room(p->count * p->points, sizeof *p->z_m);
  double half = b->film_m + (b->framed ? 3.5e-3 : -1e-3), common = signal_normal(seed);
  for (size_t i = 0; i < p->points; i++) {
    p->x_m[i] = -half + 2.0 * half * (double)i / (double)(p->points - 1);
  }
  for (size_t f = 0; f < p->count; f++) {
    double t = p->time_s[f] = ((double)f + 0.3) / b->frame_Hz;
    double square = signal_square(b, t);
    common = signal_correlated(seed, b->rho, common);
    double moved = b->common_sigma * common + b->drift_per_s * t;
    for (size_t i = 0; i < p->points; i++) {
      double z = signal_height(b, p->x_m[i], square) + moved;
      z += b->point_sigma > 0.0 ? b->point_sigma * signal_normal(seed) : 0.0;
      double luck = b->outliers + b->lost > 0.0 ? signal_uniform(seed) : 1.0;
      p->z_m[f * p->points + i] = luck < b->outliers             ? z + 5e-3 * signal_uniform(seed)
                                  : luck < b->outliers + b->lost ? NAN
                                                                 : z;
    }
  }
}

static inline struct dea_recording signal_record(const struct signal_bench *b, uint64_t seed)
{
  struct dea_recording r = {.file = "", .title = "", .complete = true};
  seed = seed * 0x2545f4914f6cdd1dU + 12345U;
  signal_fill_channels(b, &r, &seed);
  if (b->points > 0) {
    signal_fill_profiles(b, &r, &seed);
  }
  if (b->list) {
    r.cycle_count = b->cycles * b->level_count;
    r.cycles = signal_room(r.cycle_count, sizeof *r.cycles);
    for (size_t k = 0; k < r.cycle_count; k++) {
      r.cycles[k] = (struct dea_recorded_cycle){
          .step = k / b->cycles,
          .number = k % b->cycles,
          .start_s = b->lead_s + b->cycle_s * (double)k,
          .end_s = b->lead_s + b->cycle_s * (double)(k + 1),
          .level_V = b->levels_V[k / b->cycles],
      };
    }
  }
  return r;
}

static inline void signal_free(struct dea_recording *r)
{
  for (size_t c = 0; c < r->channel_count; c++) {
    free(r->channels[c].values);
    free(r->channels[c].time_s);
  }
  free(r->profiles.x_m);
  free(r->profiles.time_s);
  free(r->profiles.z_m);
  free(r->cycles);
  *r = (struct dea_recording){0};
}

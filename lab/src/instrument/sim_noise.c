#include "instrument/sim_noise.h"

#include <math.h>

static const double two_pi = 6.28318530717958647692;
enum { ADC_BITS = 16 };

struct dea_sim_random dea_sim_random_of(uint64_t seed)
{
  return (struct dea_sim_random){seed, NAN};
}

/* splitmix64: Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014. */
static uint64_t draw(struct dea_sim_random *random)
{
  uint64_t z = (random->state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/* In [0, 1). */
static double uniform(struct dea_sim_random *random)
{
  return ldexp((double)(draw(random) >> 11), -53);
}

/* Of mean 0 and standard deviation 1 (Box and Muller). */
static double normal(struct dea_sim_random *random)
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

static double true_value(const struct dea_sim_noise *noise, const struct dea_sim_state *state,
                         int kind)
{
  switch (kind) {
  case DEA_CHANNEL_VOLTAGE:
    return state->output_V;
  case DEA_CHANNEL_CURRENT:
    return state->current_A;
  case DEA_CHANNEL_DISPLACEMENT:
    return state->centre_z_m + noise->displacement_drift_m_per_s * state->time_s;
  case DEA_CHANNEL_FORCE:
    return state->force_N + noise->force_offset_N + noise->force_drift_N_per_s * state->time_s;
  default:
    return 0;
  }
}

void dea_sim_read_inputs(const struct dea_protocol *protocol, const struct dea_sim_noise *noise,
                         const struct dea_sim_state *state, struct dea_sim_random *random,
                         double *volts)
{
  double interval_s = 1 / protocol->rate_Hz.si, spike_A = 0;
  bool lost = uniform(random) < noise->lost;
  bool discharge = uniform(random) < noise->discharges_per_s * interval_s;
  if (discharge && fabs(state->film_V) > noise->discharge_above_V) {
    spike_A = copysign(noise->discharge_C / interval_s, state->film_V);
  }
  for (size_t i = 0; i < protocol->input_count; i++) {
    const struct dea_protocol_input *input = &protocol->inputs[i];
    int kind = input->kind.value;
    double value = true_value(noise, state, kind) + noise->sigma[kind] * normal(random);
    value += kind == DEA_CHANNEL_CURRENT ? spike_A : 0;
    volts[i] = lost ? NAN : convert((value - input->at_zero) / input->per_volt, input->range_V.si);
  }
}

void dea_sim_read_profile(struct dea_sim_bench *bench, const struct dea_sim_noise *noise,
                          double time_s, struct dea_sim_random *random, const double *x_m,
                          size_t points, double *z_m)
{
  static const double largest_outlier_m = 1e-3;
  double frame_m = dea_sim_bench_model(bench)->frame_radius_m, slope = tan(noise->tilt_rad);
  double drift_m = noise->displacement_drift_m_per_s * time_s;
  for (size_t i = 0; i < points; i++) {
    double radius_m = fabs(x_m[i] - noise->centre_m);
    double film_m =
        radius_m < frame_m ? dea_sim_bench_height(bench, radius_m) : noise->frame_height_m;
    double error_m = noise->profile_sigma_m * normal(random);
    bool outlier = uniform(random) < noise->outliers;
    double spike_m = largest_outlier_m * (2 * uniform(random) - 1);
    bool missing = uniform(random) < noise->missing;
    z_m[i] = missing ? NAN : film_m + drift_m + slope * x_m[i] + error_m + (outlier ? spike_m : 0);
  }
}

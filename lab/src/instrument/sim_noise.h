/* What the simulated bench adds to the truth. Everything comes from one stream of random numbers,
 * drawn sample after sample, so that a seed gives the same recording however it is read. */
#pragma once

#include "instrument/sim_bench.h"

#include <stdint.h>

struct dea_sim_noise {
  double sigma[DEA_CHANNEL_KINDS]; // standard deviation, SI of the kind
  double displacement_drift_m_per_s, force_drift_N_per_s;
  double force_offset_N; // of the unloaded cell
  double lost;           // share of samples
  double discharges_per_s, discharge_above_V, discharge_C;
  // Of the profile sensor.
  double profile_sigma_m, tilt_rad, centre_m, frame_height_m;
  double outliers, missing; // shares of the points
};

/* Random numbers, of a seed. */
struct dea_sim_random {
  uint64_t state;
  double spare; // second one of a pair of normal numbers; NAN: none
};
struct dea_sim_random dea_sim_random_of(uint64_t seed);

/* Volts at the wires of all inputs of the protocol for a sample; all NAN when it is lost. volts:
 * [inputs]. */
void dea_sim_read_inputs(const struct dea_protocol *protocol, const struct dea_sim_noise *noise,
                         const struct dea_sim_state *state, struct dea_sim_random *random,
                         double *volts);
/* A frame of the profile sensor. x_m, z_m: [points]. */
void dea_sim_read_profile(struct dea_sim_bench *bench, const struct dea_sim_noise *noise,
                          double time_s, struct dea_sim_random *random, const double *x_m,
                          size_t points, double *z_m);

/* Amplifier and film of the simulated bench: what is true at every sample, without any noise.
 *
 * The output holds a control voltage from its sample to the next one. The amplifier follows it as
 * fast as its slew limit lets it, the film is charged with at most its current limit, and the model
 * moves the film. What an input reads at a sample is what is there just before the output changes,
 * as with a DAQ whose inputs and outputs have one clock. */
#pragma once

#include "protocol/protocol.h"

struct dea_sim_settings {
  const char *model;
  const char *monitor; // by which the film moves; NULL: none named
  double series_resistance_ohm;
  double breakdown_V; // on the film; NAN: none
  double breakdown_s; // under voltage until it breaks down; NAN: never
  double fatigue_s;   // under voltage in which what it moves and presses falls to 1/e; NAN: never
};

/* Truth at one sample. */
struct dea_sim_state {
  double time_s;
  double output_V;      // of the amplifier
  double film_V;        // on the film
  double current_A;     // of the amplifier, mean since the last sample, as its monitor shows it
  double centre_z_m;    // positive to the fibres; 0 for a model that stays flat
  double fibre_tip_z_m; // at the fibre tips
  double force_N;       // as the model answers it, 0 when it does not
  bool broken;          // the film broke down: a short circuit from then on
};

struct dea_sim_bench;

/* Film at rest at 0 V. protocol: lent; has a design. DEA_E_UNSUPPORTED for a model without time.
 * out: owned by the caller, NULL on failure. */
dea_status dea_sim_bench_create(struct dea_context *ctx, const struct dea_protocol *protocol,
                                const struct dea_sim_settings *settings,
                                struct dea_sim_bench **out);
void dea_sim_bench_destroy(struct dea_context *ctx, struct dea_sim_bench *bench);
/* Its model of the film; lent. */
const struct dea_bench_model *dea_sim_bench_model(const struct dea_sim_bench *bench);

/* The next sample: what is read at it, and then the control voltage [V] that the output takes. A
 * film that loses its equilibrium breaks down. */
dea_status dea_sim_bench_sample(struct dea_sim_bench *bench, double control_V,
                                struct dea_sim_state *out);
/* Height [m] at a radius >= 0 of the stretched flat film at the last sample: that of the model when
 * it knows one, else a cone from the frame to the fibre tips and on to the centre. */
double dea_sim_bench_height(struct dea_sim_bench *bench, double radius_m);

/* The lumped model in time (docs/theory/time.md, section 5). */
#pragma once

#include "model/lumped/lumped.h"
#include "model/model.h"

/* One moment. l_a as in lumped.h; rates by time. */
struct dea_lumped_state {
  double time_s;
  double electrode_stretch, rate_per_s, acceleration_per_s2;
  struct dea_equal_tensor active[DEA_BRANCHES_MAX], passive[DEA_BRANCHES_MAX]; // A_i
  struct dea_circuit_state circuit;
  double imbalance_Pa;    // of eq 16 with the branches: what accelerates
  double stored_energy_J; // film, field and branches
  double branch_loss_J;
};

/* What does not change in time, and the state. */
struct dea_lumped_motion {
  struct dea_lumped lumped; // with the branches of the step
  struct dea_time_options options;
  double volume_m3;  // unstretched, of the electrode disc
  double mass_kg_m2; // M: the kinetic energy is M/2 (dl_a/dt)^2
  struct dea_lumped_state now, trial;
  double largest_motion, largest_voltage_V, largest_work_J; // so far, for the estimate of error
};

/* Inertia of electrode disc and annulus for l_a (docs/theory/time.md, section 5) [kg m^2]; 0 where
 * the density is unknown. */
double dea_lumped_mass(const struct dea_device *device);

/* Starts at a stretch in equilibrium at a voltage. DEA_E_DOMAIN beyond the law's domain. */
dea_status dea_lumped_begin(struct dea_lumped_motion *motion, double electrode_stretch,
                            double voltage_V);
/* The lumped model with the branches as they are at a moment, as it is felt by what is fast. */
struct dea_lumped dea_lumped_frozen(const struct dea_lumped_motion *motion,
                                    const struct dea_lumped_state *moment);
/* From `now` to `trial`, as advance of struct dea_model_type; no message is recorded. */
dea_status dea_lumped_advance(struct dea_lumped_motion *motion, const struct dea_time_step *step,
                              double *error);
void dea_lumped_accept(struct dea_lumped_motion *motion);

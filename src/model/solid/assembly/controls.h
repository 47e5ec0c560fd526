/* State and controls of a solid as vectors. State: displacements, potentials and all multipliers.
 * Controls, what an equilibrium is asked for at: the voltage, the dead loads and charges [dofs],
 * the displacements of held components [node_count][3] (0 where free), the channels' own voltages
 * [channel_count], the parameters of all loads.
 * Only what they are differs between them; a step goes a share of the way of all of them alike. */
#pragma once

#include "model/solid/assembly/problem.h"

/* Memory for states and controls of the solid as it is now. */
dea_status dea_load_steps_prepare(struct dea_context *ctx, struct dea_solid *s);
/* Displacements and all multipliers, to and from one vector [state_count]. */
void dea_solid_state_get(const struct dea_solid *s, double *state);
void dea_solid_state_set(struct dea_solid *s, const double *state);
/* As they stand, and as the next solve wants them. */
void dea_solid_controls_get(struct dea_solid *s, double *controls);
void dea_solid_controls_goal(struct dea_solid *s, double voltage_V, double *controls);
/* Voltage, dead loads and parameters; the held components stay where they are. */
void dea_solid_controls_set(struct dea_solid *s, const double *controls);
/* Sets work.increment: from the held components' displacements to those of the controls. false:
 * they are there. */
bool dea_solid_controls_increment(struct dea_solid *s, const double *controls);

/* Where the solid has been. */
struct dea_solid_saved_state {
  struct dea_arena memory;
  double *state, *controls;
};
/* out: freed by the caller, also on failure. */
dea_status dea_solid_save_state(struct dea_context *ctx, struct dea_solid *solid,
                                struct dea_solid_saved_state *out);
void dea_solid_saved_state_free(struct dea_solid_saved_state *saved);
/* Brings the solid back to there. */
void dea_solid_restore_state(struct dea_solid *solid, const struct dea_solid_saved_state *at);

/* A charge of the supply, or of one channel, that is given in place of its voltage
 * (docs/theory/devices.md, "Charge control"): a load of the solid that lifts the voltages of
 * channels, each by its share of one voltage V, until the sum of their shares times their charges
 * is what is given. */
#pragma once

#include "model/solid/assembly/problem.h"

/* The load, which does nothing yet; dea_charge_hold makes it too. DEA_E_UNSUPPORTED for a coupled
 * field and for films that wrinkle, whose charge is no line in the voltage. */
dea_status dea_charge_create(struct dea_context *ctx, struct dea_solid *solid);
/* From the charge there is now on, the next solve goes to this one [C] of a channel, 0: of the
 * supply; the same one until it is released. */
dea_status dea_charge_hold(struct dea_context *ctx, struct dea_solid *solid, size_t channel,
                           double charge_C);
/* No lift any more. */
void dea_charge_release(struct dea_solid *solid);
bool dea_charge_is_held(const struct dea_solid *solid);
/* Of one that is held, as it stands (the last goal, or how far a solve came): Q, V, and dQ/dV at
 * the last displacements that were evaluated. */
struct dea_charge_values {
  size_t channel; // 0: of the supply
  double charge_C, lift_V, capacitance_F;
};
struct dea_charge_values dea_charge_now(const struct dea_solid *solid);

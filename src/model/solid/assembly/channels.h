/* Electrodes on several voltages: charge by channel, and how it follows the voltages
 * (docs/theory/devices.md). Charges and voltages have a place for ground, [0], and one for each
 * channel. */
#pragma once

#include "model/solid/assembly/solid.h"

/* Sets active, between, share, and the own voltages. DEA_E_ARGUMENT for a channel that there is
 * not, DEA_E_UNSUPPORTED for several in a coupled field. */
dea_status dea_solid_channels_create(struct dea_context *ctx, struct dea_solid *s,
                                     const struct dea_solid_options *options);

/* Voltages of the channels at the last equilibrium, [channel_count + 1]. */
void dea_solid_channel_voltages(const struct dea_solid *solid, double *voltage_V);

/* Charge over voltage of an element between electrodes at displacements u that are held. */
dea_status dea_solid_element_capacitance(struct dea_solid *solid, size_t e, const double *u,
                                         double *capacitance_F);
/* Current over the voltage of the whole through films whose conductance is so many times their
 * capacitance, per_s [part_material_count]. DEA_E_UNSUPPORTED for a coupled field. */
dea_status dea_solid_conductance(struct dea_context *ctx, struct dea_solid *solid,
                                 const double *per_s, double *conductance_S);

/* Charges at the last equilibrium, [channel_count + 1], whose sum is 0, and the currents that leak
 * from the channels through films of such a conductance, [channel_count + 1], followed by the power
 * that this takes; per_s and leak_A: NULL where they are not wanted. DEA_E_UNSUPPORTED for a
 * coupled field. */
dea_status dea_solid_flows(struct dea_context *ctx, struct dea_solid *solid, const double *per_s,
                           double *charge_C, double *leak_A);

/* What charges change by with the voltages: capacitance_F [channel_count + 1] squared, symmetric,
 * the change of charge k with voltage l in row k; rows and columns sum to 0. held: of the film as
 * it is held in place; otherwise it moves along, by the tangent at the equilibrium, which has to be
 * stable: DEA_E_NO_EQUILIBRIUM where it is not. DEA_E_UNSUPPORTED for a coupled field. */
dea_status dea_solid_capacitances(struct dea_context *ctx, struct dea_solid *solid, bool held,
                                  double *capacitance_F);

/* Force on the unknowns [dofs] per volt of a channel, or for 0 of the voltage of the whole, which
 * all channels share: at the equilibrium, at displacements that are held, without the parts of
 * supports. Not for a coupled field. */
dea_status dea_solid_voltage_force(struct dea_context *ctx, struct dea_solid *solid, size_t channel,
                                   double *force);

/* The film as lumped and axisymmetric see it: one sheet in plane stress, with or without
 * electrodes.
 *
 * Symbol   meaning                                             unit
 * H0       thickness of the unstretched film                   m
 * E~       nominal field V/H0                                  V/m   paper eq 4
 * l1, l2   in-plane stretches, counted from the unstretched film
 * W        energy per unstretched volume of the film           Pa    paper eq 6 */
#pragma once

#include "device/device.h"
#include "material/plane.h"

struct dea_film {
  const struct dea_material *material;
  const struct dea_material *electrode; // NULL without stiffness
  double electrode_ratio;               // 2 t_e / H0, both electrodes, unstretched
  double thickness_m;                   // H0
};

/* Film of a device. DEA_E_DESIGN when electrodes have a thickness but no law. device: lent. */
dea_status dea_film_create(struct dea_context *ctx, const struct dea_device *device,
                           struct dea_film *out);

/* A note where the device asks for weight, which models of a flat film do not have. model: its
 * name. */
dea_status dea_film_report_weight(struct dea_context *ctx, const struct dea_device *device,
                                  const char *model);

/* W, nominal stresses s_i = dW/dl_i (paper eqs 5, 13) and their derivatives, per unstretched volume
 * of the film. active: with electrodes and field; the electrodes are printed on the unstretched
 * film and stretch with it. */
dea_status dea_film_eval(const struct dea_film *film, bool active, double nominal_field_V_per_m,
                         double l1, double l2, struct dea_plane *out);

/* Principal tensions, true stress times current thickness: T_1 = s_1 H0 / l_2 [N/m]. */
void dea_film_tension(const struct dea_film *film, const struct dea_plane *plane, double l1,
                      double l2, double *t1_N_per_m, double *t2_N_per_m);

/* 1 - E/E_b at these stretches; NAN when the breakdown field is unknown. */
double dea_film_breakdown_margin(const struct dea_film *film, double nominal_field_V_per_m,
                                 double l1, double l2);

/* Capacitance of a patch of given unstretched volume [m^3]: eps (l1 l2)^2 volume / H0^2 [F]. */
double dea_film_capacitance(const struct dea_film *film, double volume_m3, double l1, double l2);

/* A modulus [Pa] that makes energies of this film of order one: the law's shear modulus. */
double dea_film_modulus(const struct dea_film *film);

/* H0 sqrt(mu/eps) [V]: the voltage that makes the Maxwell stress of order mu. */
double dea_film_voltage_scale(const struct dea_film *film);

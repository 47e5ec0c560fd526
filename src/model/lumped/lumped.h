/* The paper's model (eqs 1-20, corrected; docs/theory/lumped.md): an active disc and the passive
 * film around it, each with one equibiaxial stretch, and stiff fibres that turn strain into lift.
 *
 * Symbol   meaning                                                        unit
 * l_a      electrode stretch, counted from the pre-stretched film         1     lambda_a
 * l_p      stretch of the passive film, counted likewise                  1     lambda_p
 * l_A, l_P the same, counted from the unstretched film: l_a l_pre, ...    1     paper eq 16
 * R        coverage of the film by the electrode                          1     paper eq 17
 * s        nominal stress, mean of the two in-plane directions            Pa    paper eqs 5, 13 */
#pragma once

#include "material/branch.h"
#include "model/film.h"

struct dea_lumped {
  struct dea_film film;
  double pre_stretch, coverage;
  double electrode_radius_m; // in the stretched film
  // Viscous branches of active and passive film in a step in time (B of material/branch.h); zeros:
  // none, or relaxed.
  struct dea_equal_tensor active_known, passive_known;
};

/* Imbalance of eq 16 and what belongs to it, at l_a and a nominal field. */
struct dea_lumped_balance {
  double imbalance_Pa; // s(l_A, E~) - s(l_P); 0 in equilibrium, < 0 when the film would expand
  double slope_Pa;     // d imbalance / d l_a; > 0: stable
  double slope_field_Pa_m_per_V; // d imbalance / d E~
  double energy_Pa; // W(l_A, E~) + (1 - R)/R W(l_P), per unstretched volume of the electrode disc
  double branch_energy_Pa;          // B : C/2, which is part of it
  double passive_stretch;           // l_p
  struct dea_plane active, passive; // stresses with branches; W and k without
};

/* DEA_E_DOMAIN outside 0 < l_a < 1/R or the law's domain. */
dea_status dea_lumped_balance_eval(const struct dea_lumped *lumped, double electrode_stretch,
                                   double nominal_field_V_per_m, struct dea_lumped_balance *out);

/* Fibres as rigid rods hinged at the frame (eqs 18-20). */
struct dea_lift {
  double fibre_length_m;    // L_f
  double tip_per_stretch_m; // d(tip radius)/d l_a: r_a for a tip at the electrode edge (eq 18)
};

/* Kinematics of a device with fibres: the tip may lie on the electrode or short of it. */
struct dea_lift dea_lift_create(const struct dea_device *device);
/* Height of the fibre tip [m] at an electrode stretch (eqs 18-20, positive root); 0 for l_a <= 1;
 * NAN when the tip would have to move further than the fibre is long. */
double dea_lift_height(const struct dea_lift *lift, double electrode_stretch);
/* Force [N] that holds the centre at height z when the electrode is stretched as z demands:
 * F = -dPi/dz at constant voltage. */
dea_status dea_lift_force(const struct dea_lumped *lumped, const struct dea_lift *lift,
                          double nominal_field_V_per_m, double height_m, double *force_N);
/* Largest force of the load line 0 <= z <= height_free_m, and where it is. */
dea_status dea_lift_force_max(const struct dea_lumped *lumped, const struct dea_lift *lift,
                              double nominal_field_V_per_m, double height_free_m, double *force_N,
                              double *height_m);

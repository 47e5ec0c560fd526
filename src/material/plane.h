/* An incompressible film in plane stress whose principal axes are known: the two in-plane stretches
 * give everything (lambda_3 = 1/(lambda_1 lambda_2), paper eq 2). */
#pragma once

#include "material/material.h"

/* Energy per unstretched volume [Pa], nominal stresses s_i = dW/dlambda_i [Pa] (paper eq 5, one
 * in-plane direction at a time) and their derivatives [Pa]. */
struct dea_plane {
  dea_scalar W;
  dea_scalar s1, s2;
  dea_scalar k11, k12, k22;
};

/* Elastic part. lambda1 is the direction that fibre_angle of an anisotropic law counts from.
 * DEA_E_DOMAIN beyond the law's domain or for a stretch that is not positive, DEA_E_ARGUMENT
 * without an incompressible law. */
dea_status DEA_NAME(dea_plane_elastic)(const struct dea_material *material, dea_scalar lambda1,
                                       dea_scalar lambda2, struct dea_plane *out);

/* Electric part W_E = -(eps_0 eps_r/2) E~^2 (lambda1 lambda2)^2 (paper eq 14) at a nominal field
 * E~ = V/H [V/m], H the unstretched thickness; with a permittivity that depends on stretch its
 * derivative (electrostriction) is included. Never fails for positive stretches. */
void DEA_NAME(dea_plane_electric)(const struct dea_material *material, double nominal_field_V_per_m,
                                  dea_scalar lambda1, dea_scalar lambda2, struct dea_plane *out);

/* True breakdown field [V/m] at the mean in-plane stretch s; NAN when unknown. */
double dea_breakdown_field(const struct dea_material *material, double mean_stretch);

/* How far a stretched film uses what its law is good for; NAN where the law does not lock up, or
 * the range of its data is unknown. */
struct dea_reach {
  double locking_share; // 1 at the locking stretch
  double range_share;   // 1 at the end of the measured stretches
};
/* lambda1, lambda2: principal stretches in the plane, from the unstretched film. A material without
 * a law has neither. */
struct dea_reach dea_material_reach(const struct dea_material *material, double lambda1,
                                    double lambda2);
/* *reach becomes the larger of the two, share by share; NAN counts as nothing. */
void dea_reach_merge(struct dea_reach *reach, struct dea_reach other);

/* Makes at_rest and exponent from the law for a film of an unstretched thickness > 0 under
 * electrodes of an unstretched area > 0; 0 for either: that of the law (docs/theory/breakdown.md).
 * Without a law the two numbers stay as they are. */
void dea_breakdown_specialise(double thickness_m, double area_m2, struct dea_breakdown *breakdown);

/* Probability that the film breaks down on the way to a state of that margin 1 - E/E_b, its
 * smallest: exact for a uniform field, else an upper bound. NAN without Weibull's shape or a
 * margin. */
double dea_breakdown_probability(const struct dea_breakdown *breakdown, double margin);
/* The same by the largest and by the smallest value of the sources, in this order; NAN where there
 * is no range. */
void dea_breakdown_probability_band(const struct dea_breakdown *breakdown, double margin,
                                    double out[2]);

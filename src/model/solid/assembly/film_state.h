/* What is said of the film at the last equilibrium: capacitance and extremes. */
#pragma once

#include "material/plane.h"
#include "model/solid/assembly/solid.h"

/* Capacitance between the electrodes: charge over the voltage that all channels have their shares
 * of. NAN without electrodes, and where a channel has a voltage of its own (channels.h). smooth:
 * with less rounding, for differences. */
dea_status dea_solid_capacitance(struct dea_context *ctx, struct dea_solid *solid, bool smooth,
                                 double *capacitance_F);

/* Extremes of films. Those that cannot move, in a clamp or under a rigid body, have no tension that
 * counts. */
struct dea_solid_extremes {
  double true_field_V_per_m;    // largest V over the current thickness
  double area;                  // largest stretch of area between electrodes, of the flat film
  double breakdown_margin;      // smallest; NAN when unknown
  double breakdown_probability; // largest; NAN when unknown
  /* Smallest principal membrane force per current length: of a dielectric ply and electrodes of a
   * thickness on it, and where there is none of all plies together. INFINITY without a film. */
  double min_tension_N_per_m;
  double compression_ratio; // integral of the compression of plies that are bonded to each other,
                            // of which one is a film, over 4 pi^2 D, D their bending stiffness
  struct dea_reach reach;   // of the films' laws
};
/* What a part material is as a film. */
struct dea_solid_film_data {
  const struct dea_material *material; // NULL: it is no film
  double pre_stretch;                  // root of its area's
};
/* films: [part_material_count]. */
dea_status dea_solid_extremes(struct dea_solid *solid, const struct dea_solid_film_data *films,
                              struct dea_solid_extremes *out);

/* ---- slopes, for gradients (docs/theory/gradients.md) ---- */

enum dea_film_extreme { DEA_FILM_FIELD, DEA_FILM_MARGIN, DEA_FILM_TENSION, DEA_FILM_EXTREMES };

/* Where an extreme is: an element, a point in its plane, and of the tension the direction in which
 * it is least, on the basis of dea_membrane_force. */
struct dea_film_place {
  size_t element;
  int point;
  double direction[2]; // of length 1
};
/* That of the last equilibrium; false where there is none. All ranks get the same. */
bool dea_solid_extreme_find(struct dea_solid *solid, const struct dea_solid_film_data *films,
                            enum dea_film_extreme which, struct dea_film_place *out);
/* Its quantity at a place, at a voltage; NAN where it is not defined. Of the tension the one in
 * that direction, which has the same slope as the least one and is as smooth as stresses are. */
double dea_solid_extreme_at(const struct dea_solid *solid, const struct dea_solid_film_data *films,
                            enum dea_film_extreme which, const struct dea_film_place *place,
                            double voltage_V);
/* Its slope by the unknowns, out [dofs], and by the multipliers [elements][pressures]; both are
 * added to. */
void dea_solid_extreme_slope(const struct dea_solid *solid, const struct dea_solid_film_data *films,
                             enum dea_film_extreme which, const struct dea_film_place *place,
                             double *out, double *pressures);
/* The slope of the smooth capacitance by the unknowns, out [dofs]; *known: false where it is NAN.
 */
dea_status dea_solid_capacitance_slope(struct dea_context *ctx, struct dea_solid *solid,
                                       double *out, bool *known);

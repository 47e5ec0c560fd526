/* What is said of the film at the last equilibrium: capacitance and extremes. */
#ifndef DEA_MODEL_SOLID_ASSEMBLY_FILM_H
#define DEA_MODEL_SOLID_ASSEMBLY_FILM_H

#include "material/plane.h"
#include "model/solid/assembly/solid.h"

/* Capacitance between the electrodes: charge over the voltage that all channels have their shares
 * of. NAN without electrodes, and where a channel has a voltage of its own (channels.h). */
dea_status dea_solid_capacitance(struct dea_context *ctx, struct dea_solid *solid,
                                 double *capacitance_F);

/* Extremes of the film (elements of constituents with a permittivity). */
struct dea_solid_extremes {
  double true_field_V_per_m;  // largest V over the current thickness
  double breakdown_margin;    // smallest; NAN when unknown
  double min_tension_N_per_m; // smallest principal membrane force per current length
  double compression_ratio; // integral of compression over 4 pi^2 D, D the film's bending stiffness
  struct dea_reach reach;   // of the film's law
};
/* What a constituent is as a film, for its breakdown field. */
struct dea_solid_film_data {
  const struct dea_material *material; // NULL: not looked at
  double pre_stretch;                  // root of its area's
};
/* films: [constituent_count]. */
dea_status dea_solid_extremes(struct dea_solid *solid, const struct dea_solid_film_data *films,
                              struct dea_solid_extremes *out);

#endif

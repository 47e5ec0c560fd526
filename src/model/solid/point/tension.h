/* The plane film under a voltage as an energy of its two stretches, and what is left of it when the
 * film wrinkles (docs/theory/membrane.md).
 *
 * Symbol   meaning                                                       unit
 * l1, l2   in-plane stretches counted from the unstretched film          1
 * f        W(l1, l2) - (eps/2)(V/H)^2 (l1 l2)^2, energy per volume       Pa
 * b        natural width: f_2(l1, b) = 0                                 1 */
#ifndef DEA_MODEL_SOLID_POINT_TENSION_H
#define DEA_MODEL_SOLID_POINT_TENSION_H

#include "material/plane.h"

struct dea_tension {
  const struct dea_material *material; // isotropic law; permittivity
  double nominal_field_V_per_m;        // V/H, H: thickness unstretched
  /* B of a step in time along l1, along l2 and across the film (viscous.h), which then counts in f:
   * 1/2 (B_1 (l1^2 - 1) + B_2 (l2^2 - 1) + B_3 (1/(l1 l2)^2 - 1)); NULL: none. */
  const double *viscous_Pa;
};

enum dea_tension_state { DEA_TAUT, DEA_WRINKLED, DEA_SLACK };

/* f and its derivatives at l1, l2 > 0; DEA_E_DOMAIN beyond the law's domain. */
dea_status dea_tension_taut(const struct dea_tension *film, double l1, double l2,
                            struct dea_plane *out);

/* The same of the quasi-convex envelope of f, l1 >= l2 >= 0: f, uniaxial tension, or a constant.
 * With B the axes of wrinkles are those of l1 and l2.
 * natural: the stretches of the film itself, which is larger than its place where it wrinkles.
 * DEA_E_DOMAIN also where it has no natural width because it thins without limit. */
dea_status dea_tension_relaxed(const struct dea_tension *film, double l1, double l2,
                               struct dea_plane *out, double natural[2],
                               enum dea_tension_state *state);

#endif

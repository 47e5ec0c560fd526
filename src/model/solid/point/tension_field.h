/* The plane film under a voltage as an energy of its metric, and what is left of it when the film
 * wrinkles (docs/theory/membrane.md). Tensors of the plane in the order 11 22 12.
 *
 * Symbol   meaning                                                                     unit
 * C        metric of the place that the film has, counted from the unstretched film    1
 * C*       metric of the film itself, C or larger                                      1
 * B        branches of a step in time (viscous.h), in the plane and across the film    Pa
 * g        W(C) - (eps/2)(V/H)^2 det C + 1/2 (B : C + B_33/det C), per volume          Pa
 * S, D     2 dg/dC and 2 dS/dC                                                         Pa */
#pragma once

#include "material/plane.h"

struct dea_tension {
  const struct dea_material *material; // isotropic law; permittivity
  double nominal_field_V_per_m;        // V/H, H: thickness unstretched
  double B[3], B_across;               // 0 but in a step in time with branches
};

enum dea_tension_state { DEA_TAUT, DEA_WRINKLED, DEA_SLACK };

struct dea_tension_point {
  double W, S[3], D[3][3];
  double own[3]; // C*
  enum dea_tension_state state;
};

/* g at C* = C; DEA_E_DOMAIN beyond the law's domain and for a C that is not positive definite. */
dea_status dea_tension_taut(const struct dea_tension *film, const double C[3],
                            struct dea_tension_point *out);

/* The least g of all C* that are not smaller than C: g itself, uniaxial tension, or a constant. C
 * is positive semidefinite. DEA_E_DOMAIN also where the film thins without limit. */
dea_status dea_tension_relaxed(const struct dea_tension *film, const double C[3],
                               struct dea_tension_point *out);

/* A point of the film as a surface, incompressible by construction (docs/theory/membrane.md).
 *
 * Symbol   meaning                                                                     unit
 * F        dx/dX, its in-plane columns F_1, F_2; F[2 i + J] here                       1
 * G        pre-stretch, symmetric; C = G c G with c_JL = F_J . F_L                     1
 * W        energy per volume of film, with field (tension_field.h)                     Pa */
#pragma once

#include "model/solid/point/part_material.h"
#include "model/solid/point/tension_field.h"

/* Whether a membrane can be of it: DEA_E_UNSUPPORTED without an isotropic law. */
dea_status dea_membrane_check(const struct dea_part_material *part_material);

/* What lies between the mid-surface of a film and what is bonded on it, h/2 thick: free of stress
 * at rest, with the shear compliance of the film from there to its bonded face (theory). film:
 * relaxed (dea_part_material_relax). Statuses of dea_membrane_check. */
dea_status dea_membrane_bond(const struct dea_part_material *film, struct dea_part_material *bond);

/* Energy per volume, first Piola-Kirchhoff stress P[2 i + J] and tangent A[6 (2 i + J) + 2 k + L]
 * by F, and the larger and smaller principal tension: Cauchy stress times current over reference
 * thickness. */
struct dea_membrane_point {
  double W, P[6], A[36];
  double area;          // current over reference area of the film itself: |F_1 x F_2| if taut
  double own[3];        // metric c* of the film itself, 11 22 12: F^T F if taut
  double tension_Pa[2]; // per current length of the film itself
  enum dea_tension_state state; // DEA_TAUT when the part material is not relaxed
};

/* field_V_per_m: V/h, 0 where there is none. viscous: of a step in time B of the point (viscous.h),
 * of which 23 and 13 are not used; NULL: none. DEA_E_DOMAIN beyond the law's domain. */
dea_status dea_membrane_point(const struct dea_part_material *part_material, const double *viscous,
                              const double F[6], double field_V_per_m,
                              struct dea_membrane_point *out);

/* Membrane force P F^T / area on an orthonormal basis of the current tangent plane, of which the
 * first vector is along F_1. P: per reference length [3][2], F: of the plane [3][2], area: |F_1 x
 * F_2|. out: 11 22 12. */
void dea_membrane_force(const double P[6], const double F[6], double area, double out[3]);

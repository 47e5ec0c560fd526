/* What an element is made of, and its energy, stress and tangent at a point.
 *
 * Energy per volume of the stretched flat film (docs/theory/solid.md), of an incompressible law:
 *
 *   W(F G) + p0 (J - 1) + kappa_s/2 ((J^2 - 1)/2 - ln J) - (eps/2) E^2 |F_1 x F_2|^2
 *
 * with a permittivity that may depend on the area stretch |F_1 x F_2| (docs/theory/mesh.md). A
 * part material of a compressible law (fibre) has W alone of the first line. */
#pragma once

#include "base/context.h"
#include "material/material.h"
#include "material/point.h"
#include "model/solid/point/vectors.h"

#include <math.h>

/* How much of an energy is wanted; each level has those before it. DEA_TANGENT_PREDICTED: of a load
 * with multipliers the tangent at these alone, without what the penalty adds to them. */
enum dea_eval_order { DEA_ENERGY, DEA_FORCE, DEA_TANGENT, DEA_TANGENT_PREDICTED };

/* What a part of an actuator is, for what is told of it. */
enum dea_part { DEA_PART_FILM, DEA_PART_ELECTRODE, DEA_PART_GLUE, DEA_PART_FIBRE };

struct dea_part_material {
  enum dea_part part;
  const struct dea_law *law;
  double param[DEA_LAW_PARAM_MAX]; // of the law, SI
  double pre_stretch[3];           // diagonal of G, det G = 1
  double pre_shear;                // G_12 = G_21: pre-stretches at an angle to the axes
  double direction[2];             // a0 of a law with one, in the plane of the unstretched film
  double p0_Pa, kappa_s_Pa;        // dea_part_material_relax sets them
  double kappa_Pa;                 // bulk modulus of the projected part, of the element
  double permittivity_F_per_m;     // eps of the flat part material, 0: no electric energy
  /* d eps/d sqrt(a), a = |F_1 x F_2|: eps = permittivity + slope (sqrt(a) - 1). */
  double permittivity_slope_F_per_m;
  double thickness_m;       // of all layers together
  double layers;            // over each of which the voltage stands; 0: 1
  double density_kg_per_m3; // 0 for a part without mass
  bool relaxed;             // flat elements wrinkle instead of taking pressure (tension_field.h)
  /* Of a step in time (viscous.h): B [points of the element][6], lent, NULL: none; and b. */
  const double *viscous;
  double viscous_Pa;
};

/* A part that is bonded free of stress, of the compressible neo-Hookean law. param: Young's modulus
 * [Pa], Poisson's ratio below 0.5; copied. */
struct dea_part_material dea_part_material_bonded(const double param[2]);

/* Sets a law and its parameters [law->param_count], which are copied. */
void dea_part_material_set_law(struct dea_part_material *part_material, const struct dea_law *law,
                               const double *param);

/* Whether the pressure is not the law's but a multiplier's. */
static inline bool dea_part_material_takes_pressure(const struct dea_part_material *part_material)
{
  return part_material->law->compressible == NULL;
}

/* The reference field E at a voltage between the electrodes, 0 without one. */
static inline double dea_part_material_field(const struct dea_part_material *part_material,
                                             double voltage_V)
{
  const double layers = fmax(1, part_material->layers);
  return voltage_V != 0 ? layers * voltage_V / part_material->thickness_m : 0;
}

/* G X G of a symmetric tensor of the plane (11 22 12), as C of the flat part material becomes that
 * of the unstretched one, and its stress that of the flat one. out may be X. */
void dea_part_material_pull_back(const struct dea_part_material *part_material, const double X[3],
                                 double out[3]);

/* Shear modulus of the ground state [Pa]. */
double dea_part_material_modulus(const struct dea_part_material *part_material);

/* E / (1 - nu^2) of the ground state [Pa], which plates bend with. */
double dea_part_material_plate_modulus(const struct dea_part_material *part_material);

/* Sets p0 so that the undeformed part material has no stress through the thickness, and the kappa_s
 * that keeps such a part material free of false unstable modes. Nothing to do for a compressible
 * law.
 */
dea_status dea_part_material_relax(struct dea_part_material *part_material);

/* Energy and stress by F, at cofactors cof and determinant J of F, and the tangent where it is
 * wanted (point->A is not set otherwise). pressure: added as p dJ/dF (of what takes one; its energy
 * is the caller's). field_V_per_m: reference field E between the electrodes, 0 where there is none.
 * DEA_E_DOMAIN beyond the law's domain. */
dea_status dea_part_material_point(const struct dea_part_material *part_material, const double F[9],
                                   const double cof[9], double J, double pressure,
                                   double field_V_per_m, bool tangent, struct dea_point *point);

/* The pointwise part kappa_s/2 ((J^2 - 1)/2 - ln J) and its derivatives by J: kappa_s/2 (J - 1)^2
 * near 1, and a barrier before J = 0. */
double dea_part_material_pointwise(const struct dea_part_material *part_material, double J,
                                   double *slope, double *curvature);

/* Second Piola-Kirchhoff stress S = F^-1 P from the first one. */
void dea_part_material_second_stress(const double cof[9], double J, const double P[9], double S[9]);

/* Puts other stresses into a tangent: `pressure` more as p dJ/dF, and then S (11 22 33 23 13 12) in
 * place of F^-1 P in its geometric part. P stays. */
void dea_part_material_restress(const double F[9], const double cof[9], double J, double pressure,
                                const double S[6], struct dea_point *point);

/* Cofactors dJ/dF of a 3 x 3 matrix, row by row; returns its determinant J. */
double dea_cofactors(const double F[9], double cof[9]);

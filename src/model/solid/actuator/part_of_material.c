#include "model/solid/actuator/part_of_material.h"

#include <math.h>

static const double kappa_share = 100; // kappa over the shear modulus
static const double same_angle = 1e-9; // of a quarter turn: along an axis

/* Poisson's ratios from there on are those of an incompressible solid: kappa is large enough. */
static const double incompressible = 0.49;

struct dea_part_material dea_part_material_stretched(enum dea_part part,
                                                     const struct dea_material *material,
                                                     const double pre_stretch[2], double angle_rad)
{
  const double quarter = 0.5 * acos(-1.0), turns = angle_rad / quarter, whole = round(turns);
  bool along = pre_stretch[0] == pre_stretch[1] || fabs(turns - whole) < same_angle;
  bool across = along && fmod(whole, 2) != 0;
  double l1 = pre_stretch[across ? 1 : 0], l2 = pre_stretch[across ? 0 : 1];
  double middle = 0.5 * (l1 + l2), half = 0.5 * (l1 - l2);
  const double direction_rad = angle_rad + material->fibre_angle_rad; // G leaves its own axes
  struct dea_part_material out = {
      .part = part,
      .pre_stretch = {l1, l2, 1 / (l1 * l2)},
      .direction = {cos(direction_rad), sin(direction_rad)},
      .kappa_Pa = kappa_share * material->law->shear_modulus(material->param),
  };
  if (!along) { // G = R diag(l1, l2) R^T by the double angle
    out.pre_stretch[0] = middle + half * cos(2 * angle_rad);
    out.pre_stretch[1] = middle - half * cos(2 * angle_rad);
    out.pre_shear = half * sin(2 * angle_rad);
  }
  dea_part_material_set_law(&out, material->law, material->param);
  return out;
}

struct dea_part_material dea_part_material_free(enum dea_part part, double young_modulus_Pa,
                                                double poisson_ratio)
{
  const double param[] = {young_modulus_Pa, poisson_ratio}, shear_modulus = young_modulus_Pa / 3;
  struct dea_part_material out = dea_part_material_bonded(param);
  out.part = part;
  if (poisson_ratio >= incompressible) {
    dea_part_material_set_law(&out, dea_law_find("neo-hookean"), &shear_modulus);
    out.kappa_Pa = kappa_share * shear_modulus;
  }
  return out;
}

/* eps_r = at_rest + slope (s - 1), s = sqrt(l1 l2) sqrt(area stretch). */
void dea_part_material_set_permittivity(struct dea_part_material *part_material,
                                        const struct dea_permittivity *permittivity,
                                        double thickness_m)
{
  double l = sqrt(1 / part_material->pre_stretch[2]), slope = permittivity->slope;
  part_material->permittivity_F_per_m = DEA_EPSILON_0 * (permittivity->at_rest + slope * (l - 1));
  part_material->permittivity_slope_F_per_m = DEA_EPSILON_0 * slope * l;
  part_material->thickness_m = thickness_m;
}

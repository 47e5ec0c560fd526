/* Paper eqs 15-17. The energy of active and passive film with the constraint of eq 17 has the
 * imbalance of eq 16 as its derivative, so that its second derivative says what is stable. */
#include "model/lumped/lumped.h"

/* Mean nominal stress and its derivative along an equibiaxial stretch: eq 13 in one direction at a
 * time, which for isotropic laws is the same in both. */
static double mean_stress(const struct dea_plane *plane)
{
  return 0.5 * (plane->s1 + plane->s2);
}

static double mean_slope(const struct dea_plane *plane)
{
  return 0.5 * (plane->k11 + 2 * plane->k12 + plane->k22);
}

dea_status dea_lumped_balance_eval(const struct dea_lumped *lumped, double electrode_stretch,
                                   double nominal_field_V_per_m, struct dea_lumped_balance *out)
{
  double R = lumped->coverage, l_a = electrode_stretch;
  double l_p = (1 - R * l_a) / (1 - R); // paper eq 17
  double l_A = l_a * lumped->pre_stretch, l_P = l_p * lumped->pre_stretch;
  if (!(l_a > 0 && l_p > 0)) {
    return DEA_E_DOMAIN;
  }
  DEA_TRY_STATUS(dea_film_eval(&lumped->film, true, nominal_field_V_per_m, l_A, l_A, &out->active));
  DEA_TRY_STATUS(dea_film_eval(&lumped->film, false, 0, l_P, l_P, &out->passive));
  double W[2], s[2], k[2]; // of the branches
  dea_equal_stress(&lumped->active_known, l_A, &W[0], &s[0], &k[0]);
  dea_equal_stress(&lumped->passive_known, l_P, &W[1], &s[1], &k[1]);
  out->passive_stretch = l_p;
  out->active.s1 += s[0];
  out->active.s2 += s[0];
  out->passive.s1 += s[1];
  out->passive.s2 += s[1];
  out->imbalance_Pa = mean_stress(&out->active) - mean_stress(&out->passive); // paper eq 16
  out->slope_Pa = lumped->pre_stretch * (mean_slope(&out->active) + k[0] +
                                         R / (1 - R) * (mean_slope(&out->passive) + k[1]));
  out->branch_energy_Pa = W[0] + (1 - R) / R * W[1];
  struct dea_plane unit; // the electric stress goes with the square of the field
  dea_plane_electric(lumped->film.material, 1, l_A, l_A, &unit);
  out->slope_field_Pa_m_per_V = 2 * nominal_field_V_per_m * mean_stress(&unit);
  out->energy_Pa = out->active.W + (1 - R) / R * out->passive.W + out->branch_energy_Pa;
  return DEA_OK;
}

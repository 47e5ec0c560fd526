/* Paper eqs 18-20 and the force of the same energy (docs/theory/lumped.md, sections 4 and 5). */
#include "model/lumped/lumped.h"

#include <math.h>

struct dea_lift dea_lift_create(const struct dea_device *device)
{
  double r_a = device->electrode_radius_m, r_t = device->fibre_tip_radius_m;
  double R = device->coverage;
  struct dea_lift lift = {.fibre_length_m = device->fibre_length_m, .tip_per_stretch_m = r_t};
  if (r_t > r_a) { // passive film between electrode and tip: r_a l_a + (r_t - r_a) l_p, eq 17
    lift.tip_per_stretch_m = r_a - (r_t - r_a) * R / (1 - R);
  }
  return lift;
}

double dea_lift_height(const struct dea_lift *lift, double electrode_stretch)
{
  double u = (electrode_stretch - 1) * lift->tip_per_stretch_m; // paper eq 18, at the tip
  if (u <= 0) {
    return 0;
  }
  double L_f = lift->fibre_length_m;
  double cosine = 1 - u / L_f; // paper eq 20: L_r = cos(a) L_f + r_t + u
  return cosine > 0 ? L_f * sqrt(1 - cosine * cosine) : NAN; // paper eq 19
}

dea_status dea_lift_force(const struct dea_lumped *lumped, const struct dea_lift *lift,
                          double nominal_field_V_per_m, double height_m, double *force_N)
{
  double L_f = lift->fibre_length_m, r_a = lumped->electrode_radius_m;
  double cosine = sqrt(1 - (height_m / L_f) * (height_m / L_f));
  double l_a = 1 + L_f * (1 - cosine) / lift->tip_per_stretch_m;
  double dl_a = height_m / (L_f * cosine) / lift->tip_per_stretch_m; // d l_a/dz = tan(a)/(dr/dl_a)
  struct dea_lumped_balance balance;
  DEA_TRY_STATUS(dea_lumped_balance_eval(lumped, l_a, nominal_field_V_per_m, &balance));
  // dPi/dl_a = 2 l_pre (s_A - s_P) times the unstretched volume pi r_a^2 h
  double l_pre = lumped->pre_stretch;
  double volume = DEA_PI * r_a * r_a * lumped->film.thickness_m / (l_pre * l_pre);
  *force_N = -2 * l_pre * balance.imbalance_Pa * volume * dl_a;
  return DEA_OK;
}

dea_status dea_lift_force_max(const struct dea_lumped *lumped, const struct dea_lift *lift,
                              double nominal_field_V_per_m, double height_free_m, double *force_N,
                              double *height_m)
{
  static const double golden = 0.61803398874989485;
  double low = 0, high = height_free_m, force[2] = {0, 0};
  double z[2] = {high - golden * (high - low), low + golden * (high - low)};
  for (int i = 0; i < 2; i++) {
    DEA_TRY_STATUS(dea_lift_force(lumped, lift, nominal_field_V_per_m, z[i], &force[i]));
  }
  while (high - low > 1e-9 * height_free_m) { // golden section: one maximum
    if (force[0] > force[1]) {
      high = z[1];
      z[1] = z[0];
      force[1] = force[0];
      z[0] = high - golden * (high - low);
      DEA_TRY_STATUS(dea_lift_force(lumped, lift, nominal_field_V_per_m, z[0], &force[0]));
    } else {
      low = z[0];
      z[0] = z[1];
      force[0] = force[1];
      z[1] = low + golden * (high - low);
      DEA_TRY_STATUS(dea_lift_force(lumped, lift, nominal_field_V_per_m, z[1], &force[1]));
    }
  }
  *height_m = 0.5 * (low + high);
  *force_N = fmax(force[0], force[1]);
  return DEA_OK;
}

#include "model/film.h"

#include <math.h>

dea_status dea_film_create(struct dea_context *ctx, const struct dea_device *device,
                           struct dea_film *out)
{
  *out = (struct dea_film){.material = &device->film,
                           .thickness_m = device->film_thickness_unstretched_m};
  DEA_TRY(ctx, dea_device_check(ctx, device));
  if (device->film.law == NULL || !(device->film.permittivity.at_rest > 0)) {
    return dea_fail(ctx, DEA_E_DESIGN,
                    "film material '%s' has no hyperelastic law or no permittivity",
                    device->film.name);
  }
  if (device->electrode_thickness_m > 0) {
    if (device->electrode.law == NULL) {
      return dea_fail(ctx, DEA_E_DESIGN,
                      "electrode material '%s' has no hyperelastic law, so electrodes of %g um "
                      "cannot be given a stiffness; set electrodes.thickness to 0 um",
                      device->electrode.name, 1e6 * device->electrode_thickness_m);
    }
    out->electrode = &device->electrode;
    out->electrode_ratio = 2 * device->electrode_thickness_m / device->film_thickness_unstretched_m;
  }
  return DEA_OK;
}

static void add(struct dea_plane *sum, double factor, const struct dea_plane *term)
{
  sum->W += factor * term->W;
  sum->s1 += factor * term->s1;
  sum->s2 += factor * term->s2;
  sum->k11 += factor * term->k11;
  sum->k12 += factor * term->k12;
  sum->k22 += factor * term->k22;
}

dea_status dea_film_report_weight(struct dea_context *ctx, const struct dea_device *device,
                                  const char *model)
{
  if (device->gravity != DEA_GRAVITY_OFF) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "model %s does not support weight: its film stays flat (gravity)",
                                 model));
  }
  return DEA_OK;
}

dea_status dea_film_eval(const struct dea_film *film, bool active, double nominal_field_V_per_m,
                         double l1, double l2, struct dea_plane *out)
{
  struct dea_plane term;
  DEA_TRY_STATUS(dea_plane_elastic(film->material, l1, l2, out));
  if (!active) {
    return DEA_OK;
  }
  dea_plane_electric(film->material, nominal_field_V_per_m, l1, l2, &term);
  add(out, 1, &term);
  if (film->electrode != NULL) {
    DEA_TRY_STATUS(dea_plane_elastic(film->electrode, l1, l2, &term));
    add(out, film->electrode_ratio, &term);
  }
  return DEA_OK;
}

void dea_film_tension(const struct dea_film *film, const struct dea_plane *plane, double l1,
                      double l2, double *t1_N_per_m, double *t2_N_per_m)
{
  *t1_N_per_m = plane->s1 * film->thickness_m / l2;
  *t2_N_per_m = plane->s2 * film->thickness_m / l1;
}

double dea_film_breakdown_margin(const struct dea_film *film, double nominal_field_V_per_m,
                                 double l1, double l2)
{
  double field = nominal_field_V_per_m * l1 * l2; // paper eq 4
  return 1 - fabs(field) / dea_breakdown_field(film->material, sqrt(l1 * l2));
}

double dea_film_capacitance(const struct dea_film *film, double volume_m3, double l1, double l2)
{
  struct dea_plane unit; // at 1 V/m the electric energy is -(1/2) eps (l1 l2)^2
  dea_plane_electric(film->material, 1, l1, l2, &unit);
  return -2 * unit.W * volume_m3 / (film->thickness_m * film->thickness_m);
}

double dea_film_modulus(const struct dea_film *film)
{
  return film->material->law->shear_modulus(film->material->param);
}

double dea_film_voltage_scale(const struct dea_film *film)
{
  double eps = DEA_EPSILON_0 * film->material->permittivity.at_rest;
  return film->thickness_m * sqrt(dea_film_modulus(film) / eps);
}

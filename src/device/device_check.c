#include "device/device.h"
#include "material/plane.h"

#include <math.h>
#include <stdio.h>

/* A range of one of its numbers; NAN is in none. */
struct range {
  const char *what;
  double value, above, below;
};

dea_status dea_device_check(struct dea_context *ctx, const struct dea_device *d)
{
  bool fibres = d->fibre_count > 0;
  const struct range ranges[] = {
      {"film thickness [m]", d->film_thickness_unstretched_m, 0, INFINITY},
      {"stretched film thickness [m]", d->film_thickness_m, 0, INFINITY},
      {"pre-stretch", d->pre_stretch, 0, INFINITY},
      {"electrode radius [m]", d->electrode_radius_m, 0, d->frame_radius_m},
      {"coverage", d->coverage, 0, 1},
      {"radius of the fibre tips [m]", fibres ? d->fibre_tip_radius_m : 1, 0, INFINITY},
      {"fibre length [m]", fibres ? d->fibre_length_m : 1, 0, INFINITY},
  };
  for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
    const struct range *r = &ranges[i];
    if (!(r->value > r->above && r->value < r->below)) {
      return dea_fail(ctx, DEA_E_DESIGN,
                      "the device's %s is %g, and has to be above %g and below %g", r->what,
                      r->value, r->above, r->below);
    }
  }
  return DEA_OK;
}

static dea_status check_density(struct dea_context *ctx, const struct dea_material *material)
{
  return material->density_kg_per_m3 > 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DESIGN,
                        "weight and inertia need the density of the material '%s' "
                        "(materials[].density)",
                        material->name);
}

dea_status dea_layout_check_densities(struct dea_context *ctx, const struct dea_layout *l)
{
  for (size_t i = 0; i < l->ply_count; i++) {
    DEA_TRY(ctx, check_density(ctx, &l->plies[i].material));
  }
  return DEA_OK;
}

dea_status dea_device_check_densities(struct dea_context *ctx, const struct dea_device *d)
{
  if (!d->disc) {
    return dea_layout_check_densities(ctx, d->layout);
  }
  DEA_TRY(ctx, check_density(ctx, &d->film));
  return d->fibre_count > 0 ? check_density(ctx, &d->fibre) : DEA_OK;
}

dea_status dea_device_refuse_densities(struct dea_context *ctx, struct dea_location where,
                                       const struct dea_device *device)
{
  char why[DEA_TITLE_SIZE];
  const dea_status status = dea_device_check_densities(ctx, device);
  if (status == DEA_OK) {
    return DEA_OK;
  }
  snprintf(why, sizeof why, "%s", dea_context_message(ctx));
  dea_context_clear(ctx);
  return dea_refuse(ctx, where, why);
}

void dea_device_fit_breakdown(struct dea_device *device)
{
  double radius_m = device->electrode_radius_m / device->pre_stretch; // unstretched
  if (device->film.breakdown.known) {
    dea_breakdown_specialise(device->film_thickness_unstretched_m, DEA_PI * radius_m * radius_m,
                             &device->film.breakdown);
  }
}

/* From a device to its plate. */
#include "model/solid/actuator/actuator.h"

#include "model/solid/mesh/cuts.h"

#include <math.h>

/* Sizes of elements over the electrode radius at refinement 1, which each refinement more halves
 * (docs/theory/mesh.md has the study that they come from). The fine edge is for the ends of fibres:
 * without them it is four times as large. */
static const double size_share = 0.26, beside_share = 0.13, edge_share = 0.0125;

dea_status dea_fibre_disc_of_device(struct dea_context *ctx, const struct dea_device *d,
                                    const struct dea_model_settings *settings,
                                    struct dea_fibre_disc *out)
{
  double finer = exp2(1 - fmax(1, settings->refinement)), a = d->electrode_radius_m;
  double l = d->pre_stretch;
  *out = (struct dea_fibre_disc){
      .order = settings->order > 0 ? settings->order : 2,
      .order_z = settings->order_z > 0 ? settings->order_z : 2,
      .through = settings->elements_z > 0 ? settings->elements_z : 1,
      .membrane = settings->film == DEA_FILM_MEMBRANE,
      .fibres = d->fibre_count,
      .sectors = 1,
      .electrode_radius = a,
      .frame_radius = d->frame_radius_m,
      .tip_radius = d->fibre_tip_radius_m,
      .outer_radius = d->frame_radius_m - d->fibre_outer_gap_m,
      .tip_width = d->fibre_tip_width_m > 0 ? d->fibre_tip_width_m : d->fibre_width_m,
      .outer_width = d->fibre_width_m,
      .film_thickness = d->film_thickness_m,
      .electrode_thickness = d->electrode_thickness_m / (l * l), // they are stretched with the film
      .glue_thickness = d->bond_thickness_m,
      .fibre_thickness = d->fibre_thickness_m,
      .end = d->outer_end == DEA_END_HINGED ? DEA_FIBRE_DISC_HINGED : DEA_FIBRE_DISC_CLAMPED,
      .size = size_share * a * finer,
      .edge = (d->fibre_count > 0 ? 1 : 4) * edge_share * a * finer,
      .beside = beside_share * a * finer,
      .finer_at_tips = exp2(settings->tip_refinement - fmax(1, settings->refinement)),
  };
  if (settings->field == DEA_FIELD_COUPLED && out->through > 1 &&
      out->through <= DEA_FIBRE_DISC_THROUGH_MAX) { // elements at the edge as wide as thick
    double cuts[DEA_FIBRE_DISC_THROUGH_MAX + 1];
    dea_cuts_through((size_t)out->through, cuts);
    out->fringe = d->film_thickness_m * cuts[1] * finer;
  }
  if (d->film.law->anisotropic) { // its direction turns with the angle around the centre
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "model 3d does not know films with a direction of their own (law '%s') yet",
                    d->film.law->name);
  }
  if (settings->domain == DEA_DOMAIN_DISC) {
    out->sectors = dea_fibre_disc_sectors(out);
  }
  return DEA_OK;
}

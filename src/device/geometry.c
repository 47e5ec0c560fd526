/* Symbols: l_pre pre-stretch, L_r frame radius, r_a electrode radius, r_t radius of the fibre tips,
 * w_t fibre width at the tip, N number of fibres; all lengths in the stretched film. */
#include "device/geometry.h"

#include <math.h>

/* Parts that touch exactly do not overlap; the file's decimals leave a rounding error. */
static const double touching = 1e-9;

double dea_length_stretched_m(const struct dea_inplane_length *length, double pre_stretch)
{
  return length->state == DEA_UNSTRETCHED ? length->length.si * pre_stretch : length->length.si;
}

/* The one of the three ways to say where the tips are that the design uses. */
static const struct dea_inplane_length *given_tip(const struct dea_design *design)
{
  return design->fibres.length.length.origin != DEA_ABSENT       ? &design->fibres.length
         : design->fibres.tip_radius.length.origin != DEA_ABSENT ? &design->fibres.tip_radius
                                                                 : &design->fibres.overlap;
}

static double tip_radius(const struct dea_design *design, const struct dea_device *device)
{
  const struct dea_inplane_length *given = given_tip(design);
  const double length_m = dea_length_stretched_m(given, device->pre_stretch);
  return given == &design->fibres.length       ? device->frame_radius_m - length_m
         : given == &design->fibres.tip_radius ? length_m
                                               : device->electrode_radius_m - length_m;
}

static void fill_fibres(const struct dea_design *design, struct dea_device *device)
{
  device->fibre_count = (int)design->fibres.count.si;
  const double step = 2 * DEA_PI / device->fibre_count, angle = design->fibres.angle_rad.si;
  device->angle_rad = angle - step * floor(angle / step);
  device->fibre_width_m = design->fibres.width_m.si;
  device->fibre_thickness_m = design->fibres.thickness_m.si;
  device->fibre_tip_width_m = design->fibres.tip_width_m.origin != DEA_ABSENT
                                  ? design->fibres.tip_width_m.si
                                  : device->fibre_width_m;
  device->fibre_tip_radius_m = tip_radius(design, device);
  device->fibre_length_m = device->frame_radius_m - device->fibre_tip_radius_m;
  device->fibre_overlap_m = device->electrode_radius_m - device->fibre_tip_radius_m;
  device->bond_thickness_m = design->fibres.bond_thickness_m.si;
  device->bond_modulus_Pa = design->fibres.bond_modulus_Pa.si;
  device->outer_end = (enum dea_outer_end)design->fibres.outer_end.value;
  device->fibre_outer_gap_m =
      device->outer_end == DEA_END_FREE
          ? dea_length_stretched_m(&design->fibres.outer_gap, device->pre_stretch)
          : 0;
}

void dea_geometry_fill(const struct dea_design *design, struct dea_device *device)
{
  double l_pre = design->pre_stretch.si;
  device->film_thickness_unstretched_m = design->film.thickness_m.si;
  device->pre_stretch = l_pre;
  device->film_thickness_m = design->film.thickness_m.si / (l_pre * l_pre); // paper eq 2
  device->frame_radius_m = design->frame.radius_m.si;
  device->electrode_radius_m = dea_length_stretched_m(&design->electrodes.radius, l_pre);
  device->electrode_thickness_m = design->electrodes.thickness_m.si;
  device->sheet_resistance_ohm[0] = device->sheet_resistance_ohm[1] =
      design->electrodes.sheet_resistance_ohm.si;
  double ratio = device->electrode_radius_m / device->frame_radius_m;
  device->coverage = design->compute.coverage.origin != DEA_ABSENT ? design->compute.coverage.si
                     : design->compute.coverage_by.value == DEA_COVERAGE_AREA ? ratio * ratio
                                                                              : ratio;
  device->gravity = (enum dea_gravity)design->gravity.value;
  if (design->has_fibres) {
    fill_fibres(design, device);
  }
  dea_device_fit_breakdown(device);
}

/* The ends of a fibre are cut along circles (docs/theory/mesh.md): one of width w on the circle r
 * reaches to the angle asin(w/(2 r)) from its axis, which must not lie beyond the ray halfway to
 * the neighbour, at pi/N. */
static dea_status check_neighbours(struct dea_context *ctx, const struct dea_design *design,
                                   const struct dea_device *device)
{
  int N = device->fibre_count;
  double capacity = sin(fmin(DEA_PI / N, DEA_PI / 2)), w_t = device->fibre_tip_width_m,
         r_t = device->fibre_tip_radius_m, w = device->fibre_width_m,
         r_o = device->frame_radius_m - device->fibre_outer_gap_m;
  bool tapers = design->fibres.tip_width_m.origin != DEA_ABSENT;
  if (w_t > 2 * r_t * capacity * (1 + touching)) {
    struct dea_location location = N > 1    ? design->fibres.count.location
                                   : tapers ? design->fibres.tip_width_m.location
                                            : design->fibres.width_m.location;
    return dea_finding_add(
        ctx, DEA_ERROR, location,
        N > 1 ? "%d fibres of %.4g mm width overlap each other at their tips, %.4g mm from "
                "the centre (stretched); there they may be at most %.4g mm wide, or their "
                "tips must be at least %.4g mm from the centre"
              : "%d fibre of %.4g mm width does not fit on the circle of its tip, %.4g mm from the "
                "centre (stretched); there it may be at most %.4g mm wide, or its tip must be at "
                "least %.4g mm from the centre",
        N, 1e3 * w_t, 1e3 * r_t, 2e3 * r_t * capacity, 1e3 * w_t / (2 * capacity));
  }
  if (w > 2 * r_o * capacity * (1 + touching)) {
    return dea_finding_add(ctx, DEA_ERROR, design->fibres.width_m.location,
                           "%d fibres of %.4g mm width overlap each other at the frame, where they "
                           "may be at most %.4g mm wide",
                           N, 1e3 * w, 2e3 * r_o * capacity);
  }
  return DEA_OK;
}

/* The free outer end of a fibre has film between itself and the frame, and lies outside of its tip.
 */
static dea_status check_outer_end(struct dea_context *ctx, const struct dea_design *design,
                                  const struct dea_device *device)
{
  const struct dea_quantity *gap = &design->fibres.outer_gap.length;
  if (device->outer_end != DEA_END_FREE) {
    bool given = gap->origin == DEA_GIVEN || gap->origin == DEA_OVERRIDE;
    return given ? dea_finding_add(ctx, DEA_WARNING, gap->location,
                                   "outer_gap has no effect: the outer end is not free")
                 : DEA_OK;
  }
  if (device->fibre_outer_gap_m < device->fibre_length_m * (1 - touching)) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_ERROR, gap->location,
                         "a gap of %.4g mm (stretched) at the frame leaves nothing of fibres that "
                         "reach %.4g mm from it to their tips",
                         1e3 * device->fibre_outer_gap_m, 1e3 * device->fibre_length_m);
}

static dea_status check_fibres(struct dea_context *ctx, const struct dea_design *design,
                               const struct dea_device *device)
{
  double r_t = device->fibre_tip_radius_m, frame = device->frame_radius_m;
  struct dea_location location = given_tip(design)->length.location;
  if (device->fibre_width_m >= 2 * frame) {
    return dea_finding_add(ctx, DEA_ERROR, design->fibres.width_m.location,
                           "fibres of %.4g mm width do not fit into a frame of %.4g mm inner "
                           "diameter",
                           1e3 * device->fibre_width_m, 2e3 * frame);
  }
  if (r_t <= touching * frame) {
    return dea_finding_add(ctx, DEA_ERROR, location,
                           "the fibres, %.4g mm long from a frame of %.4g mm inner radius "
                           "(stretched), %s",
                           1e3 * device->fibre_length_m, 1e3 * frame,
                           r_t < -touching * frame ? "reach beyond the centre"
                                                   : "meet at the centre");
  }
  if (r_t >= frame * (1 - touching)) {
    return dea_finding_add(
        ctx, DEA_ERROR, location,
        "the fibre tips, %.4g mm from the centre (stretched), are not inside the "
        "frame of %.4g mm inner radius",
        1e3 * r_t, 1e3 * frame);
  }
  DEA_TRY(ctx, check_outer_end(ctx, design, device));
  return check_neighbours(ctx, design, device);
}

dea_status dea_geometry_fit_studies(struct dea_context *ctx, const struct dea_design *design,
                                    const struct dea_device *device)
{
  for (size_t i = 0; i < design->compute.settings_count; i++) {
    const struct dea_settings *settings = &design->compute.settings[i];
    if (settings->section->fit != NULL) {
      DEA_TRY(ctx, settings->section->fit(ctx, settings, device));
    }
  }
  return DEA_OK;
}

dea_status dea_geometry_check(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_device *device)
{
  double r_a = device->electrode_radius_m, frame = device->frame_radius_m;
  if (r_a >= frame * (1 - touching)) { // then the tips of fibres mean nothing either
    return dea_finding_add(ctx, DEA_ERROR, design->electrodes.radius.length.location,
                           "the electrodes, %.4g mm in radius (stretched), do not fit into the "
                           "frame of %.4g mm inner radius",
                           1e3 * r_a, 1e3 * frame);
  }
  DEA_TRY(ctx, dea_geometry_fit_studies(ctx, design, device));
  return design->has_fibres ? check_fibres(ctx, design, device) : DEA_OK;
}

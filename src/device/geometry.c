/* Symbols: l_pre pre-stretch, L_r frame radius, r_a electrode radius, r_t radius of the fibre tips,
 * w fibre width, N number of fibres; all lengths in the stretched film. */
#include "device/geometry.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* Parts that touch exactly do not overlap; the file's decimals leave a rounding error. */
static const double touching = 1e-9;

/* Length in the stretched film: an unstretched one grows with the film. */
static double stretched(const struct dea_inplane_length *length, double pre_stretch)
{
  return length->state == DEA_UNSTRETCHED ? length->length.si * pre_stretch : length->length.si;
}

/* The one of the three ways to say where the tips are that the design uses. */
static const struct dea_quantity *tip_value(const struct dea_design *design)
{
  if (design->fibres.length.length.origin != DEA_ABSENT) {
    return &design->fibres.length.length;
  }
  if (design->fibres.tip_radius.length.origin != DEA_ABSENT) {
    return &design->fibres.tip_radius.length;
  }
  return &design->fibres.overlap.length;
}

static double tip_radius(const struct dea_design *design, const struct dea_device *device)
{
  const struct dea_quantity *given = tip_value(design);
  if (given == &design->fibres.length.length) {
    return device->frame_radius_m - stretched(&design->fibres.length, device->pre_stretch);
  }
  if (given == &design->fibres.tip_radius.length) {
    return stretched(&design->fibres.tip_radius, device->pre_stretch);
  }
  return device->electrode_radius_m - stretched(&design->fibres.overlap, device->pre_stretch);
}

static void fill_fibres(const struct dea_design *design, struct dea_device *device)
{
  device->fibre_count = (int)design->fibres.count.si;
  device->fibre_width_m = design->fibres.width_m.si;
  device->fibre_thickness_m = design->fibres.thickness_m.si;
  device->fibre_tip_radius_m = tip_radius(design, device);
  device->fibre_length_m = device->frame_radius_m - device->fibre_tip_radius_m;
  device->fibre_overlap_m = device->electrode_radius_m - device->fibre_tip_radius_m;
  device->bond_thickness_m = design->fibres.bond_thickness_m.si;
  device->bond_modulus_Pa = design->fibres.bond_modulus_Pa.si;
  device->outer_end = (enum dea_outer_end)design->fibres.outer_end.value;
}

void dea_geometry_fill(const struct dea_design *design, struct dea_device *device)
{
  double l_pre = design->pre_stretch.si;
  device->film_thickness_unstretched_m = design->film.thickness_m.si;
  device->pre_stretch = l_pre;
  device->film_thickness_m = design->film.thickness_m.si / (l_pre * l_pre); // paper eq 2
  device->frame_radius_m = design->frame.radius_m.si;
  device->electrode_radius_m = stretched(&design->electrodes.radius, l_pre);
  device->electrode_thickness_m = design->electrodes.thickness_m.si;
  double ratio = device->electrode_radius_m / device->frame_radius_m;
  device->coverage = design->compute.coverage.origin != DEA_ABSENT ? design->compute.coverage.si
                     : design->compute.coverage_by.value == DEA_COVERAGE_AREA ? ratio * ratio
                                                                              : ratio;
  if (design->has_fibres) {
    fill_fibres(design, device);
  }
}

/* N radial strips of width w: the corner of a tip, at the angle atan(w/(2 r_t)) from its axis, must
 * not lie beyond the ray halfway to the neighbour, at pi/N. */
static dea_status check_neighbours(struct dea_context *ctx, const struct dea_design *design,
                                   const struct dea_device *device)
{
  double half_angle = pi / device->fibre_count, w = device->fibre_width_m,
         r_t = device->fibre_tip_radius_m;
  if (device->fibre_count < 2 || atan2(w / 2, r_t) <= half_angle * (1 + touching)) {
    return DEA_OK;
  }
  return dea_finding_add(
      ctx, DEA_ERROR, design->fibres.count.place,
      "%d fibres of %.4g mm width overlap each other at their tips, %.4g mm from "
      "the centre (stretched); there they may be at most %.4g mm wide, or their "
      "tips must be at least %.4g mm from the centre",
      device->fibre_count, 1e3 * w, 1e3 * r_t, 2e3 * r_t * tan(half_angle),
      1e3 * w / (2 * tan(half_angle)));
}

static dea_status check_fibres(struct dea_context *ctx, const struct dea_design *design,
                               const struct dea_device *device)
{
  double r_t = device->fibre_tip_radius_m, frame = device->frame_radius_m;
  struct dea_place place = tip_value(design)->place;
  if (device->fibre_width_m >= 2 * frame) {
    return dea_finding_add(ctx, DEA_ERROR, design->fibres.width_m.place,
                           "fibres of %.4g mm width do not fit into a frame of %.4g mm inner "
                           "diameter",
                           1e3 * device->fibre_width_m, 2e3 * frame);
  }
  if (r_t <= touching * frame) {
    return dea_finding_add(ctx, DEA_ERROR, place,
                           "the fibres, %.4g mm long from a frame of %.4g mm inner radius "
                           "(stretched), %s",
                           1e3 * device->fibre_length_m, 1e3 * frame,
                           r_t < -touching * frame ? "reach beyond the centre"
                                                   : "meet at the centre");
  }
  if (r_t >= frame * (1 - touching)) {
    return dea_finding_add(
        ctx, DEA_ERROR, place,
        "the fibre tips, %.4g mm from the centre (stretched), are not inside the "
        "frame of %.4g mm inner radius",
        1e3 * r_t, 1e3 * frame);
  }
  return check_neighbours(ctx, design, device);
}

dea_status dea_geometry_check(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_device *device)
{
  double r_a = device->electrode_radius_m, frame = device->frame_radius_m;
  if (r_a >= frame * (1 - touching)) { // then the tips of fibres mean nothing either
    return dea_finding_add(ctx, DEA_ERROR, design->electrodes.radius.length.place,
                           "the electrodes, %.4g mm in radius (stretched), do not fit into the "
                           "frame of %.4g mm inner radius",
                           1e3 * r_a, 1e3 * frame);
  }
  return design->has_fibres ? check_fibres(ctx, design, device) : DEA_OK;
}

#include "fabricate/fab_geometry.h"

#include "device/geometry.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* Parts that touch exactly do not overlap; the file's decimals leave a rounding error. */
static const double touching = 1e-9;

/* Leads run halfway between two fibres, that of the bottom electrode as far from the other one as
 * that allows. One fibre alone has them at right angles. */
static void place_leads(struct dea_fab_geometry *plan)
{
  const struct dea_quantity *given = &plan->design->fabrication.leads.angle_rad;
  int N = plan->device->fibre_count, fibres = N == 1 ? 2 : N;
  double half = fibres > 0 ? pi / fibres : 0, step = 2 * half;
  plan->lead_angle_rad[DEA_FAB_TOP] = given->origin != DEA_ABSENT ? given->si : half;
  double opposite = plan->lead_angle_rad[DEA_FAB_TOP] + pi;
  plan->lead_angle_rad[DEA_FAB_BOTTOM] =
      fibres > 0 ? half + step * floor((opposite - half) / step + 0.5 - 1e-9) : opposite;
}

/* Three marks: two on the wider way from the top lead to the bottom one, one on the other way. All
 * three distances between them differ, so that a sheet that is turned over or around does not fit:
 * two equal ones would let it be turned over. */
static void place_marks(struct dea_fab_geometry *plan)
{
  double from = plan->lead_angle_rad[DEA_FAB_TOP];
  double way = plan->lead_angle_rad[DEA_FAB_BOTTOM] - from;
  way -= 2 * pi * floor(way / (2 * pi));
  bool wider = way >= pi * (1 - 1e-9);
  double two = wider ? way : way - 2 * pi, one = wider ? way - 2 * pi : way;
  plan->mark_angle_rad[0] = from + two / 3;
  plan->mark_angle_rad[1] = from + 2 * two / 3;
  plan->mark_angle_rad[2] = from + 0.4 * one;
}

static void fill(struct dea_fab_geometry *plan)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const struct dea_device *d = plan->device;
  double l = plan->stretch = d->pre_stretch;
  plan->kerf_m = f->kerf_m.si;
  plan->feature_m = f->minimum_feature_m.si;
  plan->copies = (int)f->copies.si;
  plan->electrode_m = d->electrode_radius_m;
  plan->frame_m = d->frame_radius_m;
  plan->ring_m = plan->frame_m + f->ring.width_m.si;
  plan->blank_m = plan->ring_m + dea_length_stretched_m(&f->blank.margin, l);
  plan->lead_width_m = dea_length_stretched_m(&f->leads.width, l);
  plan->pad_m = 0.5 * dea_length_stretched_m(&f->leads.pad_diameter, l);
  plan->pad_centre_m = 0.5 * (plan->frame_m + plan->ring_m);
  plan->contact_window_m = 0.5 * f->ring.contact_window_m.si;
  plan->mark_m = 0.5 * dea_length_stretched_m(&f->mark_diameter, l);
  plan->grid_m = dea_length_stretched_m(&f->grid_spacing, l);
  plan->cross_m = fmin(0.1 * plan->grid_m, 0.5e-3 * l);
  plan->holder_m = plan->frame_m;
  if (d->fibre_count > 0) {
    bool held = d->outer_end != DEA_END_FREE;
    plan->fibre_outer_m = plan->frame_m - d->fibre_outer_gap_m;
    plan->fibre_end_m = held ? plan->frame_m + f->holder.anchor_m.si : plan->fibre_outer_m;
    plan->holder_m = fmax(plan->fibre_end_m, plan->frame_m) + f->holder.tab_length_m.si;
    plan->tab_width_m = f->holder.tab_width_m.si;
  }
  plan->mark_centre_m = 0.5 * (plan->holder_m + plan->ring_m);
  place_leads(plan);
  place_marks(plan);
}

/* ---- checks ---- */

dea_status dea_fab_check_cutter(struct dea_context *ctx, const struct dea_fab_geometry *plan)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  if (plan->kerf_m <= plan->feature_m) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_ERROR, f->kerf_m.location,
                         "kerf: a cut of %.4g mm width makes no features of %.4g mm "
                         "(minimum_feature)",
                         1e3 * plan->kerf_m, 1e3 * plan->feature_m);
}

static dea_status check_leads(struct dea_context *ctx, const struct dea_fab_geometry *plan)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  double w = plan->lead_width_m, l = plan->stretch;
  if (w >= 2 * fmin(plan->electrode_m, plan->pad_m)) {
    bool pad = plan->pad_m < plan->electrode_m;
    return dea_finding_add(
        ctx, DEA_ERROR, f->leads.width.length.location,
        "leads of %.4g mm width are wider than the %s of %.4g mm diameter (stretched)", 1e3 * w,
        pad ? "pad" : "electrode", 2e3 * fmin(plan->electrode_m, plan->pad_m));
  }
  if (plan->pad_m > 0.5 * (plan->ring_m - plan->frame_m) * (1 + touching)) {
    return dea_finding_add(ctx, DEA_ERROR, f->leads.pad_diameter.length.location,
                           "a pad of %.4g mm diameter (%.4g mm unstretched) does not fit on the "
                           "ring of %.4g mm width (ring.width)",
                           2e3 * plan->pad_m, 2e3 * plan->pad_m / l,
                           1e3 * (plan->ring_m - plan->frame_m));
  }
  if (plan->contact_window_m > plan->pad_m * (1 + touching)) {
    return dea_finding_add(ctx, DEA_ERROR, f->ring.contact_window_m.location,
                           "a contact window of %.4g mm diameter is larger than the pad of %.4g mm "
                           "(stretched)",
                           2e3 * plan->contact_window_m, 2e3 * plan->pad_m);
  }
  // strips of width w, at an angle to each other, lie apart from the radius w/(2 sin(angle/2)) on
  double angle = plan->lead_angle_rad[DEA_FAB_BOTTOM] - plan->lead_angle_rad[DEA_FAB_TOP];
  double apart = 0.5 * w / fabs(sin(0.5 * angle));
  if (!(apart <= plan->electrode_m * (1 + touching))) {
    return dea_finding_add(ctx, DEA_ERROR, f->leads.width.length.location,
                           "the leads of the two electrodes overlap outside of the electrodes, "
                           "which would make active film that is not in the design");
  }
  return DEA_OK;
}

/* Whether the strip around the top lead's axis meets that around a fibre's, of a width at a
 * distance from the centre; angle between them. */
static bool strips_meet(const struct dea_fab_geometry *plan, double angle, double distance,
                        double width)
{
  return cos(angle) > 0 &&
         distance * fabs(sin(angle)) < 0.5 * (plan->lead_width_m + width * cos(angle));
}

/* Top leads go under fibres where these are close; that can be built but not simulated. */
static dea_status check_lead_under_fibres(struct dea_context *ctx,
                                          const struct dea_fab_geometry *plan)
{
  const struct dea_device *d = plan->device;
  double tip = fmax(d->fibre_tip_radius_m, plan->electrode_m);
  for (int k = 0; k < d->fibre_count; k++) {
    double angle = plan->lead_angle_rad[DEA_FAB_TOP] - 2 * pi * k / d->fibre_count;
    if (strips_meet(plan, angle, tip, d->fibre_tip_width_m) || // either end of a taper
        strips_meet(plan, angle, plan->fibre_outer_m, d->fibre_width_m)) {
      return dea_finding_add(ctx, DEA_WARNING,
                             plan->design->fabrication.leads.width.length.location,
                             "the lead of the top electrode, %.4g mm wide (stretched), runs under "
                             "a fibre; what that does to the bond and the motion is not simulated",
                             1e3 * plan->lead_width_m);
    }
  }
  return DEA_OK;
}

/* Marks lie on the ring, and apart from the pads. */
static dea_status check_marks(struct dea_context *ctx, const struct dea_fab_geometry *plan)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  struct dea_location location = f->mark_diameter.length.location;
  double capacity = plan->ring_m - plan->holder_m, needed = 2 * (plan->mark_m + plan->feature_m);
  if (needed > capacity * (1 + touching)) {
    return dea_finding_add(ctx, DEA_ERROR, location,
                           "alignment marks of %.4g mm diameter (stretched) do not fit on the %s, "
                           "%.4g mm wide, with %.4g mm (minimum_feature) around them",
                           2e3 * plan->mark_m,
                           plan->device->fibre_count > 0 ? "fibres' holder" : "ring",
                           1e3 * capacity, 1e3 * plan->feature_m);
  }
  for (int m = 0; m < DEA_FAB_MARKS; m++) {
    for (int side = 0; side < 2; side++) {
      double a = plan->mark_angle_rad[m], b = plan->lead_angle_rad[side];
      double apart = hypot(plan->mark_centre_m * cos(a) - plan->pad_centre_m * cos(b),
                           plan->mark_centre_m * sin(a) - plan->pad_centre_m * sin(b));
      // in the unstretched film, where both are cut from one stencil
      if (apart < plan->mark_m + plan->pad_m + plan->feature_m * plan->stretch) {
        return dea_finding_add(ctx, DEA_ERROR, f->leads.pad_diameter.length.location,
                               "parts overlap: a pad of %.4g mm diameter (stretched) reaches to an "
                               "alignment mark of %.4g mm",
                               2e3 * plan->pad_m, 2e3 * plan->mark_m);
      }
    }
  }
  return DEA_OK;
}

static dea_status check_fibres(struct dea_context *ctx, const struct dea_fab_geometry *plan)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const struct dea_device *d = plan->device;
  if (plan->tab_width_m > d->fibre_width_m * (1 + touching)) {
    return dea_finding_add(ctx, DEA_ERROR, f->holder.tab_width_m.location,
                           "a tab of %.4g mm width is wider than a fibre of %.4g mm",
                           1e3 * plan->tab_width_m, 1e3 * d->fibre_width_m);
  }
  if (plan->holder_m >= plan->ring_m * (1 - touching)) {
    return dea_finding_add(ctx, DEA_ERROR, f->holder.anchor_m.location,
                           "a fibre is longer than the frame: with its anchor and its tab it "
                           "reaches %.4g mm from the centre, and the ring ends at %.4g mm",
                           1e3 * plan->holder_m, 1e3 * plan->ring_m);
  }
  return DEA_OK;
}

/* What the film is marked with has to be countable. */
static dea_status check_grid(struct dea_context *ctx, const struct dea_fab_geometry *plan)
{
  enum { CROSSES_MAX = 10000 };
  double across = 2 * plan->blank_m / plan->grid_m;
  if (across * across <= CROSSES_MAX) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_ERROR, plan->design->fabrication.grid_spacing.length.location,
                         "a grid of %.4g mm (stretched) has more than %d crosses on a film of "
                         "%.4g mm diameter",
                         1e3 * plan->grid_m, (int)CROSSES_MAX, 2e3 * plan->blank_m);
}

dea_status dea_fab_geometry_make(struct dea_context *ctx, const struct dea_design *design,
                                 const struct dea_device *device, struct dea_fab_geometry *out)
{
  *out = (struct dea_fab_geometry){.design = design, .device = device};
  fill(out);
  size_t before = dea_finding_count(ctx, DEA_ERROR);
  DEA_TRY(ctx, dea_fab_check_cutter(ctx, out));
  DEA_TRY(ctx, check_grid(ctx, out));
  DEA_TRY(ctx, check_leads(ctx, out));
  if (device->fibre_count > 0) {
    DEA_TRY(ctx, check_fibres(ctx, out));
    DEA_TRY(ctx, check_lead_under_fibres(ctx, out));
  }
  return dea_finding_count(ctx, DEA_ERROR) > before ? DEA_OK : check_marks(ctx, out);
}

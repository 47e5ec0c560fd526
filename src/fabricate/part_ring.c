/* The frame that holds the pre-stretch: a ring with holes over the alignment marks and a window to
 * the pad of the bottom electrode. */
#include "fabricate/part_list.h"

#include <math.h>

static void build(const struct dea_fab_geometry *plan, struct dea_part *part)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  double angle = plan->lead_angle_rad[DEA_FAB_BOTTOM], R = plan->frame_m, o = plan->ring_m;
  double x = plan->pad_centre_m * cos(angle), y = plan->pad_centre_m * sin(angle);
  struct dea_location inner = plan->design->frame.radius_m.location;
  dea_part_circle(part, DEA_LAYER_CUT_INNER, 0, 0, R, inner);
  dea_draw_marks(plan, false, 1, DEA_LAYER_CUT_INNER, part);
  if (plan->contact_window_m > 0) {
    double w = plan->contact_window_m;
    dea_part_circle(part, DEA_LAYER_CUT_INNER, x, y, w, f->ring.contact_window_m.location);
    dea_part_measure(part, DEA_MEASURE_DIAMETER, x - w, y, x + w, y, "contact",
                     f->ring.contact_window_m.location);
  }
  dea_part_circle(part, DEA_LAYER_CUT_OUTER, 0, 0, o, f->ring.width_m.location);
  dea_part_measure(part, DEA_MEASURE_DIAMETER, -R, 0, R, 0, "frame", inner);
  dea_part_measure(part, DEA_MEASURE_DIAMETER, 0, -o, 0, o, "ring", f->ring.width_m.location);
  double mx = plan->mark_centre_m * cos(plan->mark_angle_rad[0]), m = plan->mark_m,
         my = plan->mark_centre_m * sin(plan->mark_angle_rad[0]);
  dea_part_measure(part, DEA_MEASURE_DIAMETER, mx - m, my, mx + m, my, "mark",
                   f->mark_diameter.length.location);
}

const struct dea_part_type dea_part_ring = {
    .name = "frame",
    .title = "Frame of the pre-stretch",
    .seen = "seen from the side of the fibres",
    .state = DEA_STRETCHED,
    .build = build,
};

/* The film as it is cut from the roll, with the grid from which its stretch is measured. */
#include "fabricate/part_list.h"

#include <math.h>

void dea_draw_marks(const struct dea_fab_geometry *plan, bool mirrored, double scale,
                    enum dea_layer layer, struct dea_part *part)
{
  struct dea_location location = plan->design->fabrication.mark_diameter.length.location;
  for (int m = 0; m < DEA_FAB_MARKS; m++) {
    double x = cos(plan->mark_angle_rad[m]), y = sin(plan->mark_angle_rad[m]);
    dea_part_circle(part, layer, scale * plan->mark_centre_m * (mirrored ? -x : x),
                    scale * plan->mark_centre_m * y, scale * plan->mark_m, location);
  }
}

/* Whether a cross at this place of the stretched film would lie on something else. */
static bool is_taken(const struct dea_fab_geometry *plan, double x, double y)
{
  double r = hypot(x, y), clear = 1.5 * plan->cross_m + plan->feature_m;
  bool taken = r < plan->frame_m + clear || r > plan->blank_m - clear;
  for (int side = 0; side < 2; side++) {
    double a = plan->lead_angle_rad[side];
    taken |= hypot(x - plan->pad_centre_m * cos(a), y - plan->pad_centre_m * sin(a)) <
             plan->pad_m + clear;
  }
  for (int m = 0; m < DEA_FAB_MARKS; m++) {
    double a = plan->mark_angle_rad[m];
    taken |= hypot(x - plan->mark_centre_m * cos(a), y - plan->mark_centre_m * sin(a)) <
             plan->mark_m + clear;
  }
  return taken;
}

void dea_draw_grid(const struct dea_fab_geometry *plan, double scale, struct dea_part *part)
{
  struct dea_location location = plan->design->fabrication.grid_spacing.length.location;
  int n = (int)(plan->blank_m / plan->grid_m);
  double arm = scale * plan->cross_m;
  for (int j = -n; j <= n; j++) {
    for (int i = -n; i <= n; i++) {
      if (!is_taken(plan, i * plan->grid_m, j * plan->grid_m)) {
        double x = scale * i * plan->grid_m, y = scale * j * plan->grid_m;
        dea_part_line(part, DEA_LAYER_MARK, x - arm, y, x + arm, y, location);
        dea_part_line(part, DEA_LAYER_MARK, x, y - arm, x, y + arm, location);
      }
    }
  }
}

static void build(const struct dea_fab_geometry *plan, struct dea_part *part)
{
  double scale = 1 / plan->stretch, edge = scale * plan->blank_m;
  struct dea_location location = plan->design->fabrication.blank.margin.length.location;
  dea_draw_grid(plan, scale, part);
  dea_draw_marks(plan, false, scale, DEA_LAYER_MARK, part);
  dea_part_circle(part, DEA_LAYER_CUT_OUTER, 0, 0, edge, location);
  dea_part_measure(part, DEA_MEASURE_DIAMETER, -edge, 0, edge, 0, "film", location);
  dea_part_measure(part, DEA_MEASURE_LENGTH, -scale * plan->grid_m, -0.86 * edge, 0, -0.86 * edge,
                   "grid", plan->design->fabrication.grid_spacing.length.location);
}

const struct dea_part_type dea_part_film = {
    .name = "film",
    .title = "Film, unstretched, with marker grid",
    .seen = "seen from the side of the fibres",
    .state = DEA_UNSTRETCHED,
    .build = build,
};

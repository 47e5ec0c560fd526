/* Stencils of the electrodes, for the unstretched film: disc, lead and pad as one opening. The
 * bottom electrode is printed first, onto the face that then lies down, so its stencil is seen from
 * there. */
#include "fabricate/part_list.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

void dea_draw_electrode(const struct dea_fab_geometry *plan, enum dea_fab_geometry_side side,
                        bool mirrored, double scale, enum dea_layer layer, struct dea_part *part)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  struct dea_location disc = plan->design->electrodes.radius.length.location;
  struct dea_location lead = f->leads.width.length.location,
                      pad = f->leads.pad_diameter.length.location;
  double angle = mirrored ? pi - plan->lead_angle_rad[side] : plan->lead_angle_rad[side];
  double r = scale * plan->electrode_m, w = scale * plan->lead_width_m, p = scale * plan->pad_m;
  double a = asin(0.5 * w / r), b = asin(0.5 * w / p), c = cos(angle), s = sin(angle);
  const double centre[2] = {0, 0};
  const double pad_centre[2] = {scale * plan->pad_centre_m * c, scale * plan->pad_centre_m * s};
  double x = r * cos(a), along = scale * plan->pad_centre_m - p * cos(b);
  dea_part_begin(part, layer, true);
  dea_part_arc(part, centre, r, angle + a, angle + 2 * pi - a, disc);
  dea_part_point(part, c * x + s * 0.5 * w, s * x - c * 0.5 * w, lead);
  dea_part_arc(part, pad_centre, p, angle + pi + b, angle + 3 * pi - b, pad);
  dea_part_point(part, c * along - s * 0.5 * w, s * along + c * 0.5 * w, lead);
}

static void build(const struct dea_fab_geometry *plan, enum dea_fab_geometry_side side,
                  bool mirrored, struct dea_part *part)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  double scale = 1 / plan->stretch, half = scale * plan->blank_m, r = scale * plan->electrode_m;
  double angle = mirrored ? pi - plan->lead_angle_rad[side] : plan->lead_angle_rad[side];
  struct dea_location edge = f->blank.margin.length.location;
  dea_draw_electrode(plan, side, mirrored, scale, DEA_LAYER_CUT_INNER, part);
  dea_draw_marks(plan, mirrored, scale, DEA_LAYER_CUT_INNER, part);
  dea_part_begin(part, DEA_LAYER_CUT_OUTER, true);
  dea_part_point(part, half, half, edge);
  dea_part_point(part, -half, half, edge);
  dea_part_point(part, -half, -half, edge);
  dea_part_point(part, half, -half, edge);
  double height = fmin(2e-3, 0.06 * half);
  dea_part_write(part, 0, -0.94 * half, height, "%s", side == DEA_FAB_TOP ? "TOP" : "BOTTOM");
  double c = cos(angle + 0.5 * pi), s = sin(angle + 0.5 * pi), d = scale * plan->pad_centre_m;
  double w = 0.5 * scale * plan->lead_width_m;
  double mx = 0.5 * (r + d - scale * plan->pad_m) * cos(angle),
         my = 0.5 * (r + d - scale * plan->pad_m) * sin(angle);
  dea_part_measure(part, DEA_MEASURE_DIAMETER, -r * c, -r * s, r * c, r * s, "electrode",
                   plan->design->electrodes.radius.length.location);
  dea_part_measure(part, DEA_MEASURE_LENGTH, mx - w * c, my - w * s, mx + w * c, my + w * s, "lead",
                   f->leads.width.length.location);
  double px = d * cos(angle), py = d * sin(angle), p = scale * plan->pad_m;
  dea_part_measure(part, DEA_MEASURE_DIAMETER, px - p * c, py - p * s, px + p * c, py + p * s,
                   "pad", f->leads.pad_diameter.length.location);
  dea_part_measure(part, DEA_MEASURE_LENGTH, -half, half, half, half, "stencil", edge);
}

static void build_top(const struct dea_fab_geometry *plan, struct dea_part *part)
{
  build(plan, DEA_FAB_TOP, false, part);
}

static void build_bottom(const struct dea_fab_geometry *plan, struct dea_part *part)
{
  build(plan, DEA_FAB_BOTTOM, true, part);
}

const struct dea_part_type dea_part_stencil_top = {
    .name = "stencil-top",
    .title = "Stencil of the top electrode, printed second",
    .seen = "seen from the side of the fibres",
    .state = DEA_UNSTRETCHED,
    .build = build_top,
};

const struct dea_part_type dea_part_stencil_bottom = {
    .name = "stencil-bottom",
    .title = "Stencil of the bottom electrode, printed first",
    .seen = "seen from its own side, away from the fibres",
    .state = DEA_UNSTRETCHED,
    .mirrored = true,
    .build = build_bottom,
};

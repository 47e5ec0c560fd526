/* The fibres in their holder, of one sheet: each hangs on a tab, which is cut once it is bonded. A
 * fibre that the frame holds goes on as an anchor that lies on the ring. */
#include "fabricate/part_list.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* Angle from a fibre's axis to its edge, of half a width at a distance from the centre. */
static double edge_angle(double half_width, double distance)
{
  return asin(fmin(1, half_width / distance));
}

/* Point of a fibre's edge at a distance from the centre: side -1, 1; half its width there. */
static void add_corner(const struct dea_fab_geometry *plan, int number, double distance, int side,
                       double half, struct dea_location location, struct dea_part *part)
{
  double angle = 2 * pi * number / plan->device->fibre_count, c = cos(angle), s = sin(angle);
  double x = sqrt(distance * distance - half * half), y = side * half;
  dea_part_point(part, c * x - s * y, s * x + c * y, location);
}

/* One long edge, from its outer end inwards (side -1) or from the tip outwards (side 1): the places
 * where it bends. The last corner belongs to what comes next. */
static void add_edge(const struct dea_fab_geometry *plan, int number, int side,
                     struct dea_part *part)
{
  const struct dea_device *d = plan->device;
  struct dea_location location = plan->design->fibres.width_m.location;
  double outer = plan->fibre_outer_m;
  bool anchored = plan->fibre_end_m > outer;
  if (side > 0) {
    add_corner(plan, number, d->fibre_tip_radius_m, 1, 0.5 * d->fibre_tip_width_m, location, part);
  } else {
    add_corner(plan, number, plan->fibre_end_m, -1, 0.5 * d->fibre_width_m, location, part);
  }
  if (anchored) {
    add_corner(plan, number, outer, side, 0.5 * d->fibre_width_m, location, part);
  }
}

/* The step from the tab to the wider fibre, along the circle of the fibre's end. */
static void add_step(const struct dea_fab_geometry *plan, int number, int side,
                     struct dea_part *part)
{
  struct dea_location location = plan->design->fabrication.holder.tab_width_m.location;
  const double centre[2] = {0, 0};
  double end = plan->fibre_end_m, axis = 2 * pi * number / plan->device->fibre_count;
  double tab = axis + side * edge_angle(0.5 * plan->tab_width_m, end);
  double fibre = axis + side * edge_angle(0.5 * plan->device->fibre_width_m, end);
  if (plan->tab_width_m < plan->device->fibre_width_m * (1 - 1e-9)) {
    dea_part_arc(part, centre, end, side < 0 ? tab : fibre, side < 0 ? fibre : tab, location);
  }
}

/* The opening between holder and fibres, counter-clockwise. */
static void add_opening(const struct dea_fab_geometry *plan, struct dea_part *part)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const struct dea_device *d = plan->device;
  const double centre[2] = {0, 0};
  int N = d->fibre_count;
  double t = 0.5 * plan->tab_width_m, on_holder = edge_angle(t, plan->holder_m);
  double at_tip = edge_angle(0.5 * d->fibre_tip_width_m, d->fibre_tip_radius_m);
  struct dea_location tab = f->holder.tab_width_m.location,
                      length = f->holder.tab_length_m.location;
  dea_part_begin(part, DEA_LAYER_CUT_INNER, true);
  for (int k = 0; k < N; k++) {
    double axis = 2 * pi * k / N;
    add_corner(plan, k, plan->holder_m, -1, t, tab, part);
    add_step(plan, k, -1, part);
    add_edge(plan, k, -1, part);
    dea_part_arc(part, centre, d->fibre_tip_radius_m, axis - at_tip, axis + at_tip,
                 plan->design->fibres.count.location);
    add_edge(plan, k, 1, part);
    add_step(plan, k, 1, part);
    add_corner(plan, k, plan->fibre_end_m, 1, t, tab, part);
    dea_part_arc(part, centre, plan->holder_m, axis + on_holder, axis + 2 * pi / N - on_holder,
                 length);
  }
}

void dea_draw_fibre(const struct dea_fab_geometry *plan, int number, enum dea_layer layer,
                    struct dea_part *part)
{
  const struct dea_device *d = plan->device;
  struct dea_location location = plan->design->fibres.width_m.location;
  const double centre[2] = {0, 0};
  double outer = plan->fibre_outer_m, tip = d->fibre_tip_radius_m;
  double axis = 2 * pi * number / d->fibre_count;
  double a = edge_angle(0.5 * d->fibre_width_m, outer);
  double b = edge_angle(0.5 * d->fibre_tip_width_m, tip);
  dea_part_begin(part, layer, true);
  dea_part_arc(part, centre, outer, axis - a, axis + a, location);
  add_corner(plan, number, outer, 1, 0.5 * d->fibre_width_m, location, part);
  dea_part_arc(part, centre, tip, axis + b, axis - b, location);
  add_corner(plan, number, tip, -1, 0.5 * d->fibre_tip_width_m, location, part);
}

void dea_draw_anchor(const struct dea_fab_geometry *plan, int number, enum dea_layer layer,
                     struct dea_part *part)
{
  const struct dea_device *d = plan->device;
  struct dea_location location = plan->design->fabrication.holder.anchor_m.location;
  const double centre[2] = {0, 0};
  double inner = plan->fibre_outer_m, end = plan->fibre_end_m;
  double half = 0.5 * d->fibre_width_m, axis = 2 * pi * number / d->fibre_count;
  double a = edge_angle(half, end), b = edge_angle(half, inner);
  if (end > inner) {
    dea_part_begin(part, layer, true);
    dea_part_arc(part, centre, end, axis - a, axis + a, location);
    add_corner(plan, number, end, 1, half, location, part);
    dea_part_arc(part, centre, inner, axis + b, axis - b, location);
    add_corner(plan, number, inner, -1, half, location, part);
  }
}

static void build(const struct dea_fab_geometry *plan, struct dea_part *part)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const struct dea_device *d = plan->device;
  double o = plan->ring_m, tip = d->fibre_tip_radius_m, end = plan->fibre_end_m;
  double outer = plan->fibre_outer_m, half = 0.5 * d->fibre_width_m;
  add_opening(plan, part);
  dea_draw_marks(plan, false, 1, DEA_LAYER_CUT_INNER, part);
  dea_part_circle(part, DEA_LAYER_CUT_OUTER, 0, 0, o, f->ring.width_m.location);
  dea_part_measure(part, DEA_MEASURE_DIAMETER, 0, -o, 0, o, "holder", f->ring.width_m.location);
  dea_part_measure(part, DEA_MEASURE_LENGTH, tip, 0, outer, 0, "fibre",
                   plan->design->fibres.width_m.location);
  if (end > outer) {
    dea_part_measure(part, DEA_MEASURE_LENGTH, outer, 0, end, 0, "anchor",
                     f->holder.anchor_m.location);
  }
  dea_part_measure(part, DEA_MEASURE_LENGTH, outer, -half, outer, half, "width",
                   plan->design->fibres.width_m.location);
}

const struct dea_part_type dea_part_fibres = {
    .name = "fibres",
    .title = "Fibres in their holder",
    .seen = "seen from the side of the fibres",
    .state = DEA_STRETCHED,
    .of_fibres = true,
    .build = build,
};

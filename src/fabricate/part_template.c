/* The template: what the stretched film has to look like, printed on paper and laid under it. */
#include "fabricate/part_list.h"

static void build(const struct dea_fab_geometry *plan, struct dea_part *part)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  struct dea_location film = f->blank.margin.length.location,
                      frame = plan->design->frame.radius_m.location;
  double edge = plan->blank_m, r = plan->frame_m;
  dea_draw_grid(plan, 1, part);
  dea_draw_marks(plan, false, 1, DEA_LAYER_MARK, part);
  dea_draw_electrode(plan, DEA_FAB_TOP, false, 1, DEA_LAYER_MARK, part);
  dea_draw_electrode(plan, DEA_FAB_BOTTOM, false, 1, DEA_LAYER_MARK, part);
  for (int k = 0; k < plan->device->fibre_count; k++) {
    dea_draw_fibre(plan, k, DEA_LAYER_MARK, part);
  }
  dea_part_circle(part, DEA_LAYER_MARK, 0, 0, r, frame);
  dea_part_circle(part, DEA_LAYER_MARK, 0, 0, plan->ring_m, f->ring.width_m.location);
  dea_part_circle(part, DEA_LAYER_MARK, 0, 0, edge, film);
  dea_part_measure(part, DEA_MEASURE_DIAMETER, -edge, 0, edge, 0, "film", film);
  dea_part_measure(part, DEA_MEASURE_LENGTH, -plan->grid_m, -0.9 * edge, 0, -0.9 * edge, "grid",
                   f->grid_spacing.length.location);
}

const struct dea_part_type dea_part_template = {
    .name = "template",
    .title = "Template of the stretched film, for paper",
    .seen = "seen from the side of the fibres",
    .state = DEA_STRETCHED,
    .paper = true,
    .build = build,
};

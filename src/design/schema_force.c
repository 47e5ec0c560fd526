/* Keys of `compute.force`. */
#include "design/schema.h"

#include <stddef.h>

#define AT(member) offsetof(struct dea_design_raw, design.compute.force.member)

// In the order of enum dea_indenter_shape.
static const char *const tips[] = {"sphere", "flat", "cylinder", NULL};
static const char *const sides[] = {"fibres", "back", NULL};

static const struct dea_field fields[] = {
    {.key = "tip",
     .kind = DEA_FIELD_CHOICE,
     .offset = AT(tip),
     .choices = tips,
     .default_text = "sphere",
     .doc = "shape of the tip; a cylinder lies on its side along the first fibre",
     .example = "sphere"},
    {.key = "radius",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(radius_m),
     .unit = "m",
     .above_min = true,
     .max = 0.1,
     .default_text = "1.5 mm",
     .doc = "radius of the tip",
     .example = "1.5 mm"},
    {.key = "edge_radius",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(edge_radius_m),
     .unit = "m",
     .above_min = true,
     .max = 0.1,
     .default_text = "0.2 mm",
     .doc = "radius of the rounded edge of a flat tip",
     .example = "0.2 mm"},
    {.key = "side",
     .kind = DEA_FIELD_CHOICE,
     .offset = AT(side),
     .choices = sides,
     .default_text = "fibres",
     .doc = "where the tip comes from: the side of the fibres or the other",
     .example = "fibres"},
    {.key = "depth",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(depths_m),
     .unit = "m",
     .min = -0.1,
     .max = 0.1,
     .list_min = 1,
     .list_max = DEA_DESIGN_STOPS_MAX,
     .element_size = sizeof(struct dea_quantity),
     .count_offset = AT(depth_count),
     .doc = "how far the tip is pressed beyond touching the flat film, at 0 V; negative: a gap",
     .example = "[0 mm, 1 mm, 2 mm]"},
    {.key = "preload",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(preloads_N),
     .unit = "N",
     .above_min = true,
     .max = 100,
     .list_min = 1,
     .list_max = DEA_DESIGN_STOPS_MAX,
     .element_size = sizeof(struct dea_quantity),
     .count_offset = AT(preload_count),
     .doc = "forces that the tip is pressed to at 0 V, instead of depths or besides",
     .example = "[0.18 N]"},
};

const struct dea_record dea_force_record = {"force", "force on a rigid tip", fields,
                                            sizeof fields / sizeof fields[0]};
